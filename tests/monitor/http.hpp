// Readers for the tests of the server: good ones, and those that misbehave.
#pragma once

#include <gtest/gtest.h>

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "tools/monitor/address.hpp"

namespace surefoot::test {

/// A connection that does what it is told, and nothing else.
class RawReader {
public:
    explicit RawReader(const monitor::Address& address, int receive_bytes = 0) {
        const monitor::SocketAddress to = monitor::socket_address(address);
        fd_ = ::socket(to.family(), SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (receive_bytes > 0) (void)::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &receive_bytes, sizeof receive_bytes);
        connected_ = ::connect(fd_, to.get(), to.length) == 0;
    }
    RawReader(RawReader&& other) noexcept : fd_(std::exchange(other.fd_, -1)), connected_(other.connected_) {}
    RawReader(const RawReader&) = delete;
    RawReader& operator=(const RawReader&) = delete;
    ~RawReader() {
        if (fd_ >= 0) ::close(fd_);
    }
    [[nodiscard]] bool connected() const { return connected_; }
    bool send_text(std::string_view text) {
        return ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size());
    }
    /// All until the other side closes, or `timeout_ms` without a byte.
    std::string listen(int timeout_ms = 3000) {
        std::string all;
        std::array<char, 65536> part{};
        for (;;) {
            pollfd p{fd_, POLLIN, 0};
            if (::poll(&p, 1, timeout_ms) <= 0) return all + "(silence)";
            const ssize_t got = ::read(fd_, part.data(), part.size());
            if (got <= 0) return all;
            all.append(part.data(), static_cast<std::size_t>(got));
        }
    }

private:
    int fd_ = -1;
    bool connected_ = false;
};

}  // namespace surefoot::test
