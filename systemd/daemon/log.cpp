// Lines and datagrams.
#include "systemd/daemon/log.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "rt/base/text.hpp"

namespace surefoot::daemon {

namespace {

constexpr const char* journal_socket = "/run/systemd/journal/socket";
constexpr std::size_t longest_text = 4000;  // below PIPE_BUF with its prefix: a pipe takes a line whole or not at all

void put_field(std::string& message, std::string_view name, std::string_view value) {
    message += name;
    if (value.find('\n') == std::string_view::npos) {
        message += '=';
    } else {  // NAME, line break, length as 64 bits little-endian, value
        message += '\n';
        for (unsigned i = 0; i < 8; ++i) message += static_cast<char>((value.size() >> (8U * i)) & 0xffU);
    }
    message += value;
    message += '\n';
}

/// "DEVICE:INODE" of the stream that the journal reads.
bool is_journal_stream(const char* text, int fd) {
    struct stat status {};
    if (text == nullptr || fstat(fd, &status) != 0) return false;
    const std::string_view all = text;
    const std::size_t colon = all.find(':');
    if (colon == std::string_view::npos) return false;
    return leading_number<std::uint64_t>(all.substr(0, colon), 0) == status.st_dev &&
           leading_number<std::uint64_t>(all.substr(colon + 1), 0) == status.st_ino;
}

}  // namespace

LogTarget default_target() {
    LogTarget target;
    if (is_journal_stream(std::getenv("JOURNAL_STREAM"), target.fd)) target.journal_socket = journal_socket;
    target.prefix = isatty(target.fd) != 1;
    return target;
}

std::string journal_message(Priority priority, const Event& event, std::string_view text, std::initializer_list<Field> fields,
                            std::uint64_t dropped) {
    std::string message;
    put_field(message, "MESSAGE", text);
    put_field(message, "PRIORITY", std::to_string(static_cast<int>(priority)));
    put_field(message, "SYSLOG_IDENTIFIER", "surefootd");
    put_field(message, "MESSAGE_ID", event.id);
    put_field(message, "SUREFOOT_EVENT", event.name);
    for (const Field& field : fields) put_field(message, field.name, field.value);
    if (dropped > 0) put_field(message, "SUREFOOT_DROPPED_LINES", std::to_string(dropped));
    return message;
}

Log::Log(LogTarget target) : target_(std::move(target)) {
    if (!target_.journal_socket.empty()) socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
}

Log::~Log() {
    if (socket_ >= 0) ::close(socket_);
}

void Log::write(Priority priority, const Event& event, std::string_view text, std::initializer_list<Field> fields) {
    const MutexLock lock(one_at_a_time_);
    text = text.substr(0, longest_text);
    const std::uint64_t lost = dropped_.load() - dropped_reported_;
    bool taken = false;
    if (socket_ >= 0) {
        taken = to_journal(journal_message(priority, event, text, fields, lost));
    } else {
        std::string line = target_.prefix ? fmt::format("<{}>surefootd: ", static_cast<int>(priority)) : "surefootd: ";
        line += text;
        if (lost > 0) line += fmt::format(" [{} lines before this one could not be written]", lost);
        std::replace(line.begin(), line.end(), '\n', ' ');
        taken = to_stream(line + "\n");
    }
    if (taken)
        dropped_reported_ += lost;
    else
        ++dropped_;
}

bool Log::to_journal(std::string_view message) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (target_.journal_socket.size() >= sizeof address.sun_path) return false;
    std::memcpy(address.sun_path, target_.journal_socket.data(), target_.journal_socket.size());
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + target_.journal_socket.size());
    return ::sendto(socket_, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
                    reinterpret_cast<const sockaddr*>(&address), length) == static_cast<ssize_t>(message.size());
}

/// stderr may be shared, so its flags are not touched: poll() tests first whether it takes a line.
bool Log::to_stream(std::string_view line) const {
    pollfd ready{target_.fd, POLLOUT, 0};
    if (::poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0) return false;
    return ::write(target_.fd, line.data(), line.size()) == static_cast<ssize_t>(line.size());
}

}  // namespace surefoot::daemon
