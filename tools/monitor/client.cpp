// Connects, sends the request and reads to the end, with one deadline for all of it.
#include "tools/monitor/address.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "rt/base/text.hpp"
#include "rt/clock/clock.hpp"

namespace surefoot::monitor {

namespace {

constexpr std::size_t max_bytes = 16U << 20U;

struct OwnSocket {
    int fd;
    explicit OwnSocket(int f) : fd(f) {}
    OwnSocket(const OwnSocket&) = delete;
    OwnSocket& operator=(const OwnSocket&) = delete;
    ~OwnSocket() {
        if (fd >= 0) ::close(fd);
    }
};

constexpr std::string_view start_one =
    "Start the service with `systemctl start surefootd`, start a walk with --monitor, or name its address with --socket";

Error unreachable(const Address& address, int error) {
    std::string remedy(start_one);
    if (error == EACCES || error == EPERM) remedy = "This user may not read there: join the group of its folder, or use sudo";
    return {address.text(), fmt::format("No program serves this address: {}", std::strerror(error)), remedy,
            ErrorKind::not_found};  // NOLINT(concurrency-mt-unsafe)
}

Error too_slow(const Address& address, std::int64_t timeout_ms) {
    return {address.text(), fmt::format("The server does not answer within {} s", static_cast<double>(timeout_ms) * 1e-3),
            "Run `systemctl status surefootd`: the service may be stopped, or the machine out of CPU time",
            ErrorKind::unreadable};
}

/// Whether the socket is ready before the deadline.
bool ready(int fd, short what, std::int64_t deadline_ns) {
    for (;;) {
        const std::int64_t left_ns = deadline_ns - rt::monotonic_ns();
        if (left_ns <= 0) return false;
        pollfd p{fd, what, 0};
        const int got = ::poll(&p, 1, static_cast<int>(left_ns / 1'000'000 + 1));
        if (got > 0) return true;
        if (got < 0 && errno != EINTR) return false;
    }
}

/// The body, where the answer is a whole page with status 200.
Result<std::string> body_of(const Address& address, std::string_view path, const std::string& answer) {
    const Error strange{address.text(), "Something other than a surefoot monitor answers there",
                        "Name the monitor's address with --socket", ErrorKind::damaged};
    const std::size_t head_end = answer.find("\r\n\r\n");
    if (!answer.starts_with("HTTP/1.") || answer.size() < 12 || head_end == std::string::npos) return strange;
    const int code = leading_number(std::string_view(answer).substr(9, 3), 0);
    if (code == 404)
        return Error{address.text(), fmt::format("The server has no page {}", path),
                     "Check the address: an older surefoot or another program serves there", ErrorKind::not_found};
    if (code != 200)
        return Error{address.text(), fmt::format("The server answers {} to {}", answer.substr(9, answer.find('\r') - 9), path),
                     "Check that a surefoot monitor serves there, and try again", ErrorKind::unreadable};
    const std::string_view head = std::string_view(answer).substr(0, head_end);
    constexpr std::string_view length_is = "Content-Length: ";
    const std::size_t at = head.find(length_is);
    if (at == std::string_view::npos) return strange;
    const auto length = leading_number<std::size_t>(head.substr(at + length_is.size()), 0);
    std::string body = answer.substr(head_end + 4);
    if (body.size() != length) return Error{address.text(), "The answer was cut off", "Try again", ErrorKind::unreadable};
    return body;
}

}  // namespace

Result<std::string> fetch(const Address& address, std::string_view path, std::int64_t timeout_ms) {
    const std::int64_t deadline_ns = rt::monotonic_ns() + timeout_ms * 1'000'000;
    const SocketAddress to = socket_address(address);
    const OwnSocket s(::socket(to.family(), SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    if (s.fd < 0) return unreachable(address, errno);
    while (::connect(s.fd, to.get(), to.length) != 0) {
        if (errno == EINPROGRESS) {
            if (!ready(s.fd, POLLOUT, deadline_ns)) return too_slow(address, timeout_ms);
            int error = 0;
            socklen_t length = sizeof error;
            (void)::getsockopt(s.fd, SOL_SOCKET, SO_ERROR, &error, &length);
            if (error != 0) return unreachable(address, error);
            break;
        }
        // A Unix socket's queue is full: nothing says when there is room.
        if (errno != EAGAIN && errno != EINTR) return unreachable(address, errno);
        if (rt::monotonic_ns() > deadline_ns) return too_slow(address, timeout_ms);
        ::usleep(10'000);
    }
    const std::string request = fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n", path,
                                            address.socket_path.empty() ? address.text() : "localhost");
    std::string answer;
    std::size_t sent = 0;
    std::array<char, 16384> part{};
    for (;;) {
        const bool sending = sent < request.size();
        if (!ready(s.fd, sending ? POLLOUT : POLLIN, deadline_ns)) return too_slow(address, timeout_ms);
        const ssize_t got = sending ? ::send(s.fd, request.data() + sent, request.size() - sent, MSG_NOSIGNAL)
                                    : ::read(s.fd, part.data(), part.size());
        if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
        if (got < 0) return Error{address.text(), "The connection broke off", "Try again", ErrorKind::unreadable};
        if (sending) {
            sent += static_cast<std::size_t>(got);
            continue;
        }
        if (got == 0) return body_of(address, path, answer);
        answer.append(part.data(), static_cast<std::size_t>(got));
        if (answer.size() > max_bytes)
            return Error{address.text(), "The answer does not end", "Check that a surefoot monitor serves there",
                         ErrorKind::out_of_limits};
    }
}

}  // namespace surefoot::monitor
