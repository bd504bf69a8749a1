// One poll loop: accept within a rate, read a request, write a page, drop who is late.
#include "tools/monitor/server.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "rt/base/text.hpp"
#include "rt/clock/clock.hpp"
#include "rt/threads/placement.hpp"
#include "tools/monitor/listen.hpp"

namespace surefoot::monitor {

namespace {

constexpr std::int64_t ms_ns = 1'000'000;
constexpr std::int64_t idle_ms = 60'000;
constexpr std::int64_t no_descriptors_pause_ns = 200 * ms_ns;

std::string head(int code, std::string_view reason, std::string_view content_type, std::size_t length) {
    return fmt::format(
        "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: no-store\r\nX-Content-Type-Options: "
        "nosniff\r\n"
        "Connection: close\r\n\r\n",
        code, reason, content_type, length);
}

enum class HostField { absent, loopback, foreign, twice };

/// What the Host field of a request says; field names are in either case.
HostField host_of(std::string_view request) {
    constexpr std::string_view name = "host:";
    const auto is_name = [](char b, char a) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; };
    HostField found = HostField::absent;
    for (std::size_t at = request.find('\n'); at != std::string_view::npos; at = request.find('\n', at)) {
        std::string_view field = request.substr(++at);
        field = field.substr(0, field.find_first_of("\r\n"));
        if (field.empty()) break;  // the end of the head
        if (!std::equal(name.begin(), name.end(), field.begin(), field.begin() + std::min(field.size(), name.size()), is_name))
            continue;
        if (found != HostField::absent) return HostField::twice;
        found = host_is_loopback(trimmed(field.substr(name.size()))) ? HostField::loopback : HostField::foreign;
    }
    return found;
}

}  // namespace

/// One conversation: a request, an answer, the end.
struct Server::Reader {
    explicit Reader(int f) : fd(f) {}
    Reader(const Reader&) = delete;
    Reader& operator=(const Reader&) = delete;
    ~Reader() { ::close(fd); }
    int fd;
    std::int64_t deadline_ns = 0;
    std::string request;
    bool answering = false, over = false;
    std::string head;
    std::shared_ptr<const std::string> body;  ///< shared by all who asked for the same
    std::size_t written = 0;                  ///< of head and body
};

Server::Server(Address address, Pages pages, const ServerLimits& limits)
    : address_(std::move(address)), pages_(std::move(pages)), limits_(limits) {}

Result<std::unique_ptr<Server>> Server::listen(const Address& address, Pages pages, const ServerLimits& limits) {
    auto listener = open_listener(address);
    if (!listener) return listener.error();
    std::unique_ptr<Server> server(new Server(listener->address, std::move(pages), limits));
    server->listener_ = listener->fd;
    server->socket_inode_ = listener->socket_inode;
    server->wake_ = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (server->wake_ < 0)
        return Error{address.text(), "No file descriptor is left", "Raise the limit of open files (ulimit -n)",
                     ErrorKind::out_of_limits};
    server->thread_ = std::thread([s = server.get()] { s->run(); });
    return server;
}

Server::~Server() {
    stopping_.store(true, std::memory_order_release);
    if (thread_.joinable()) {
        const std::uint64_t one = 1;
        (void)!::write(wake_, &one, sizeof one);
        thread_.join();
    }
    readers_.clear();
    if (!address_.socket_path.empty() && socket_inode_ != 0 && inode_of(address_.socket_path) == socket_inode_)
        ::unlink(address_.socket_path.c_str());
    if (listener_ >= 0) ::close(listener_);
    if (wake_ >= 0) ::close(wake_);
}

ServerCounts Server::counts() const {
    return {answered_.load(std::memory_order_relaxed), refused_.load(std::memory_order_relaxed),
            dropped_slow_.load(std::memory_order_relaxed), dropped_full_.load(std::memory_order_relaxed),
            open_.load(std::memory_order_relaxed)};
}

void Server::run() {
    if (auto own = rt::read_thread(0)) {
        own->name = "sf-console";
        (void)rt::restore_thread(*own);
    }
    tokens_ = limits_.accepts_per_s;
    refilled_ns_ = rt::monotonic_ns();
    while (!stopping_.load(std::memory_order_acquire)) poll_once(rt::monotonic_ns());
}

/// Waits for something to do, at most until the next deadline, and does it.
void Server::poll_once(std::int64_t now_ns) {
    const double whole = std::max(1.0, limits_.accepts_per_s);
    tokens_ = std::min(whole, tokens_ + static_cast<double>(now_ns - refilled_ns_) * 1e-9 * limits_.accepts_per_s);
    refilled_ns_ = now_ns;
    const bool may_accept = tokens_ >= 1 && now_ns >= accept_again_ns_;

    std::vector<pollfd> fds;
    fds.reserve(readers_.size() + 2);
    fds.push_back({wake_, POLLIN, 0});
    fds.push_back({may_accept ? listener_ : -1, POLLIN, 0});
    std::int64_t until_ns = now_ns + idle_ms * ms_ns;
    if (!may_accept) until_ns = std::min(until_ns, std::max(accept_again_ns_, now_ns + 10 * ms_ns));
    for (const auto& r : readers_) {
        fds.push_back({r->fd, static_cast<short>(r->answering ? POLLOUT : POLLIN), 0});
        until_ns = std::min(until_ns, r->deadline_ns);
    }
    const int wait_ms = static_cast<int>(std::max<std::int64_t>((until_ns - now_ns + ms_ns - 1) / ms_ns, 0));
    if (::poll(fds.data(), fds.size(), wait_ms) < 0 && errno != EINTR) {
        accept_again_ns_ = now_ns + no_descriptors_pause_ns;  // no memory: nothing to be done but to wait
        ::usleep(10'000);
        return;
    }
    const std::int64_t then_ns = rt::monotonic_ns();
    for (std::size_t i = 0; i < readers_.size(); ++i)
        if (fds[i + 2].revents != 0) serve(*readers_[i], then_ns);
    drop_late(then_ns);
    if (fds[1].revents != 0) accept_all(then_ns);
}

void Server::accept_all(std::int64_t now_ns) {
    while (tokens_ >= 1) {
        const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
        if (fd < 0) {
            if (errno == EINTR || errno == ECONNABORTED) continue;
            // No descriptors: the listener stays ready, and asking again at once would only burn the core.
            if (errno != EAGAIN && errno != EWOULDBLOCK) accept_again_ns_ = now_ns + no_descriptors_pause_ns;
            return;
        }
        tokens_ -= 1;
        take_in(fd, now_ns);
    }
}

void Server::take_in(int fd, std::int64_t now_ns) {
    if (readers_.size() >= limits_.readers) {
        // Whoever has been here longest is the likeliest to be stuck; a new one must always get in.
        dropped_full_.fetch_add(1, std::memory_order_relaxed);
        readers_.erase(readers_.begin());
    }
    auto& r = *readers_.emplace_back(std::make_unique<Reader>(fd));
    r.deadline_ns = now_ns + limits_.request_ms * ms_ns;
    count_open();      // before the answer: who has it may ask for the counts
    serve(r, now_ns);  // the request is often there already
    if (r.over) readers_.pop_back();
    count_open();
}

void Server::count_open() { open_.store(readers_.size(), std::memory_order_relaxed); }

void Server::serve(Reader& r, std::int64_t now_ns) {
    if (!r.answering) {
        if (!read_request(r)) {
            r.over = true;
            return;
        }
        const bool complete = r.request.find("\r\n\r\n") != std::string::npos || r.request.find("\n\n") != std::string::npos;
        if (!complete && r.request.size() <= limits_.request_bytes) return;
        answer(r, now_ns);
    }
    if (!write_answer(r)) r.over = true;
}

/// False: the reader has gone.
bool Server::read_request(Reader& r) {
    std::array<char, 1024> part{};
    while (r.request.size() <= limits_.request_bytes) {
        const ssize_t got = ::read(r.fd, part.data(), part.size());
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) return errno == EAGAIN || errno == EWOULDBLOCK;
        if (got == 0) return false;
        r.request.append(part.data(), static_cast<std::size_t>(got));
        if (r.request.find("\r\n\r\n") != std::string::npos) break;
    }
    return true;
}

void Server::answer(Reader& r, std::int64_t now_ns) {
    const auto respond = [&](int code, std::string_view reason) {
        r.body = std::make_shared<const std::string>(fmt::format("{} {}\n", code, reason));
        r.head = head(code, reason, "text/plain; charset=utf-8", r.body->size());
        refused_.fetch_add(1, std::memory_order_relaxed);
    };
    r.answering = true;
    r.deadline_ns = now_ns + limits_.answer_ms * ms_ns;
    const std::string_view line = std::string_view(r.request).substr(0, r.request.find_first_of("\r\n"));
    const std::size_t method_end = line.find(' '), path_end = line.find(' ', method_end + 1);
    const std::string_view method = line.substr(0, method_end);
    const bool request = method_end != std::string_view::npos && path_end != std::string_view::npos &&
                         line.substr(path_end + 1).starts_with("HTTP/1.");
    if (r.request.size() > limits_.request_bytes) return respond(431, "Request Header Fields Too Large");
    if (!request) return respond(400, "Bad Request");
    if (method != "GET" && method != "HEAD") return respond(405, "Method Not Allowed");
    if (address_.socket_path.empty()) {  // a port: a browser can be led here by another site's page
        const HostField host = host_of(r.request);
        const bool must_name = !line.substr(path_end + 1).starts_with("HTTP/1.0");
        if (host == HostField::twice || (host == HostField::absent && must_name)) return respond(400, "Bad Request");
        if (host == HostField::foreign) return respond(421, "Misdirected Request");
    }
    std::string_view path = line.substr(method_end + 1, path_end - method_end - 1);
    path = path.substr(0, path.find('?'));
    const auto page = pages_(path);
    if (!page) return respond(404, "Not Found");
    r.head = head(200, "OK", page->content_type, page->body->size());
    r.body = method == "HEAD" ? std::make_shared<const std::string>() : page->body;
    answered_.fetch_add(1, std::memory_order_relaxed);
}

/// False: all is written, or the reader has gone.
bool Server::write_answer(Reader& r) {
    for (;;) {
        const bool in_head = r.written < r.head.size();
        const std::string& text = in_head ? r.head : *r.body;
        const std::size_t at = in_head ? r.written : r.written - r.head.size();
        if (at >= text.size()) return false;
        const ssize_t sent = ::send(r.fd, text.data() + at, text.size() - at, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR) continue;
        if (sent < 0) return errno == EAGAIN || errno == EWOULDBLOCK;
        r.written += static_cast<std::size_t>(sent);
    }
}

void Server::drop_late(std::int64_t now_ns) {
    for (const auto& r : readers_) {
        if (r->over || now_ns < r->deadline_ns) continue;
        r->over = true;
        dropped_slow_.fetch_add(1, std::memory_order_relaxed);
    }
    std::erase_if(readers_, [](const auto& r) { return r->over; });
    count_open();
}

}  // namespace surefoot::monitor
