// A fake of systemd's end of NOTIFY_SOCKET: takes messages, and when each came.
#pragma once

#include <gtest/gtest.h>

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "rt/clock/clock.hpp"

namespace surefoot::daemon::test {

struct Message {
    std::int64_t at_ns = 0;
    std::string text;
    [[nodiscard]] bool has(std::string_view part) const { return text.find(part) != std::string::npos; }
};

class NotifySocket {
public:
    /// name: a path, or '@' and an abstract name.
    explicit NotifySocket(std::string name) : name_(std::move(name)), fd_(::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        EXPECT_LT(name_.size(), sizeof address.sun_path);
        std::memcpy(address.sun_path, name_.data(), name_.size());
        if (name_.front() == '@') address.sun_path[0] = '\0';
        const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name_.size());
        EXPECT_EQ(::bind(fd_, reinterpret_cast<const sockaddr*>(&address), length), 0) << std::strerror(errno);
    }
    ~NotifySocket() {
        ::close(fd_);
        if (name_.front() != '@') ::unlink(name_.c_str());
    }
    NotifySocket(const NotifySocket&) = delete;
    NotifySocket& operator=(const NotifySocket&) = delete;

    /// Takes messages until one fits, or `seconds` have passed: then false.
    bool wait_for(const std::function<bool(const Message&)>& fits, double seconds) {
        const std::int64_t until_ns = now_ns() + static_cast<std::int64_t>(seconds * 1e9);
        do {
            if (take_one(until_ns) && fits(all.back())) return true;
        } while (now_ns() < until_ns);
        return false;
    }
    bool wait_for(std::string_view part, double seconds) {
        return wait_for([&](const Message& m) { return m.has(part); }, seconds);
    }
    /// Takes what comes in this time.
    void listen(double seconds) {
        wait_for([](const Message&) { return false; }, seconds);
    }
    /// Takes what is there already: all that a process sent before it ended.
    void take_all() {
        while (take_one(0)) {
        }
    }
    [[nodiscard]] std::size_t count(std::string_view part, std::size_t from = 0) const {
        std::size_t found = 0;
        for (std::size_t i = from; i < all.size(); ++i) found += all[i].has(part) ? 1 : 0;
        return found;
    }
    [[nodiscard]] std::string text() const {
        std::string joined;
        for (const Message& m : all) joined += m.text + "\n--\n";
        return joined;
    }
    static std::int64_t now_ns() { return rt::RealClock().now_ns(); }

    std::vector<Message> all;

private:
    /// False: none came until then.
    bool take_one(std::int64_t until_ns) {
        const std::int64_t left_ns = std::max<std::int64_t>(0, until_ns - now_ns());
        const timespec left{left_ns / 1'000'000'000, left_ns % 1'000'000'000};
        pollfd readable{fd_, POLLIN, 0};
        if (::ppoll(&readable, 1, &left, nullptr) <= 0) return false;
        std::array<char, 8192> bytes{};
        const ssize_t got = ::recv(fd_, bytes.data(), bytes.size(), 0);
        if (got < 0) return false;
        all.push_back({now_ns(), std::string(bytes.data(), static_cast<std::size_t>(got))});
        return true;
    }

    std::string name_;
    int fd_;
};

}  // namespace surefoot::daemon::test
