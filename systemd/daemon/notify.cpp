// One datagram a message.
#include "systemd/daemon/notify.hpp"

#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "rt/base/text.hpp"

namespace surefoot::daemon {

namespace {

constexpr std::size_t longest_line = 1500;  // of STATUS=; systemd takes more, and nobody reads it

std::int64_t number_of(const char* variable, std::int64_t otherwise) {
    const char* text = std::getenv(variable);
    return text != nullptr ? leading_number(text, otherwise) : otherwise;
}

}  // namespace

Notifier::Notifier(std::string socket) : socket_(std::move(socket)) {
    if (socket_.empty()) return;
    fd_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const timeval patience{0, 500'000};
    if (fd_ >= 0) setsockopt(fd_, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
}

Notifier::~Notifier() {
    if (fd_ >= 0) ::close(fd_);
}

bool Notifier::send(std::string_view message) {
    if (socket_.empty()) return true;
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (fd_ < 0 || socket_.size() >= sizeof address.sun_path) return false;
    std::memcpy(address.sun_path, socket_.data(), socket_.size());
    if (socket_.front() == '@') address.sun_path[0] = '\0';
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket_.size());
    const ssize_t sent =
        ::sendto(fd_, message.data(), message.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&address), length);
    return sent == static_cast<ssize_t>(message.size());
}

std::string one_line(std::string_view text) {
    std::string line(text.substr(0, longest_line));
    if (text.size() > longest_line) {
        // Not in the middle of a character of UTF-8.
        while (!line.empty() && (static_cast<unsigned char>(text[line.size()]) & 0xC0U) == 0x80U) line.pop_back();
    }
    for (char& c : line) {
        if (static_cast<unsigned char>(c) < 0x20) c = ' ';
    }
    return line;
}

std::int64_t watchdog_timeout_ns() {
    const std::int64_t own = getpid();
    if (number_of("WATCHDOG_PID", own) != own) return 0;
    const std::int64_t timeout_us = number_of("WATCHDOG_USEC", 0);
    return timeout_us > 0 ? timeout_us * 1000 : 0;
}

}  // namespace surefoot::daemon
