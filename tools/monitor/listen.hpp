// Opens the listening socket. For this room only.
#pragma once

#include <cstdint>

#include "rt/base/result.hpp"
#include "tools/monitor/address.hpp"

namespace surefoot::monitor {

/// A listening socket.
struct Listener {
    int fd = -1;
    Address address;                 ///< with the port that was given
    std::uint64_t socket_inode = 0;  ///< of the socket's file
};
/// A socket that a dead process left is replaced; one that a process answers on is an Error.
Result<Listener> open_listener(const Address& address);
/// The inode of a path; 0 where there is none.
std::uint64_t inode_of(const std::string& path);

}  // namespace surefoot::monitor
