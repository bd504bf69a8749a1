// A small HTTP server on one ordinary thread; the caller makes the pages. Everything is bounded: slow, stopped, half-open or very
// many readers cost the service only a little CPU time.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "rt/base/result.hpp"
#include "tools/monitor/address.hpp"

namespace surefoot::monitor {

/// Limits of the server.
struct ServerLimits {
    std::size_t readers = 32;          ///< at once; one more, and the oldest is dropped
    std::size_t request_bytes = 4096;  ///< longer ones are refused
    std::int64_t request_ms = 2000;    ///< to send the request
    std::int64_t answer_ms = 5000;     ///< to take the answer
    double accepts_per_s = 200;        ///< more wait in the system's queue, which is short
};

/// Counts of requests and readers.
struct ServerCounts {
    std::uint64_t answered = 0, refused = 0, dropped_slow = 0, dropped_full = 0, open = 0;
};

/// The server and its thread. It ends with this object.
class Server {
public:
    /// A page, ready to be sent.
    struct Page {
        std::string_view content_type;
        std::shared_ptr<const std::string> body;
    };
    /// The page of a path ("/metrics"), or nothing: 404. On the server's thread; pages may be kept and handed out again.
    using Pages = std::function<std::optional<Page>(std::string_view path)>;

    /// Listens, and serves from a thread of its own named sf-console, which inherits the caller's place: call it from a neutral
    /// thread. A socket that a dead process left is replaced; one that is alive is an Error, as is a port in use.
    static Result<std::unique_ptr<Server>> listen(const Address& address, Pages pages, const ServerLimits& limits = {});
    ~Server();  ///< ends the thread, closes everything, removes the socket
    Server(const Server&) = delete;
    Server& operator=(const Server&) = delete;

    [[nodiscard]] const Address& address() const { return address_; }  ///< with the port that was given
    [[nodiscard]] ServerCounts counts() const;

private:
    struct Reader;
    Server(Address address, Pages pages, const ServerLimits& limits);
    void run();
    void poll_once(std::int64_t now_ns);
    void accept_all(std::int64_t now_ns);
    void take_in(int fd, std::int64_t now_ns);
    void serve(Reader& reader, std::int64_t now_ns);
    bool read_request(Reader& reader);
    void answer(Reader& reader, std::int64_t now_ns);
    bool write_answer(Reader& reader);
    void drop_late(std::int64_t now_ns);
    void count_open();

    Address address_;
    Pages pages_;
    ServerLimits limits_;
    int listener_ = -1, wake_ = -1;
    std::uint64_t socket_inode_ = 0;                ///< of the socket file, so that only our own is removed
    std::vector<std::unique_ptr<Reader>> readers_;  ///< oldest first
    double tokens_ = 0;
    std::int64_t refilled_ns_ = 0, accept_again_ns_ = 0;
    std::atomic<std::uint64_t> answered_{0}, refused_{0}, dropped_slow_{0}, dropped_full_{0}, open_{0};
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace surefoot::monitor
