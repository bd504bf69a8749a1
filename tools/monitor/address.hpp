// Where a monitor is found: a Unix socket, or a port on loopback. Written unix:/PATH (or /PATH), 127.0.0.1:9464, [::1]:9464.
// Also fetches a page from there.
#pragma once

#include <sys/socket.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "rt/base/result.hpp"

namespace surefoot::monitor {

/// Where the monitor listens: a Unix socket, or TCP on loopback.
struct Address {
    std::string socket_path;  ///< empty: TCP
    std::string host;         ///< a numeric address on loopback
    std::uint16_t port = 0;   ///< 0: any free one (a server only)
    [[nodiscard]] std::string text() const;
};

/// Errors: not an address of these forms; a socket's path that is too long; a host that is not on loopback.
Result<Address> parse_address(const std::string& text);

/// Where the service listens by default: surefoot.sock in $RUNTIME_DIRECTORY, else in /run/surefoot.
std::string default_address();

/// Whether a request's Host field names this machine: localhost or an address on loopback, with or without a port. Protects
/// from DNS rebinding: a foreign web page makes a browser send requests to a name of its own that resolves to loopback. Such a
/// request carries that name as its Host.
bool host_is_loopback(std::string_view host);

/// As the system calls want it.
struct SocketAddress {
    sockaddr_storage storage{};
    socklen_t length = 0;
    [[nodiscard]] const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
    [[nodiscard]] int family() const { return storage.ss_family; }
};
SocketAddress socket_address(const Address& address);

/// The body of GET `path`. It never waits longer than `timeout_ms`. Errors name the place and the remedy: nobody there, no
/// permission, no answer in time, another program.
Result<std::string> fetch(const Address& address, std::string_view path, std::int64_t timeout_ms = 3000);

}  // namespace surefoot::monitor
