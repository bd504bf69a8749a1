// The finder in a thread of its own: devices go to the reader, and come back to be closed, through a ring each way.
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <limits>
#include <thread>

#include "input/devices/discoverer.hpp"
#include "rt/base/thread_annotations.hpp"
#include "rt/clock/clock.hpp"
#include "rt/exchange/spsc_ring.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::input {

namespace {

struct Returned {
    Discovery* discovery = nullptr;
    bool failed = false;
};

void signal_event(int fd) {
    const std::uint64_t one = 1;
    (void)!write(fd, &one, sizeof one);
}
void clear_event(int fd) {
    std::uint64_t count = 0;
    (void)!read(fd, &count, sizeof count);
}

class ThreadedDiscoverer final : public Discoverer {
public:
    ThreadedDiscoverer(Finder finder, int to_reader, int to_finder)
        : finder_(std::move(finder)), to_reader_(to_reader), to_finder_(to_finder), thread_([this] { run(); }) {}
    ThreadedDiscoverer(const ThreadedDiscoverer&) = delete;
    ThreadedDiscoverer& operator=(const ThreadedDiscoverer&) = delete;
    ~ThreadedDiscoverer() override {
        stopping_.store(true);
        signal_event(to_finder_);
        thread_.join();
        Discovery* d = nullptr;
        while (found_.try_pop(d)) delete d;
        for (Returned r; returned_.try_pop(r);) delete r.discovery;
        ::close(to_reader_);
        ::close(to_finder_);
    }

    std::unique_ptr<Discovery> next(std::int64_t /*now_ns*/) override {
        Discovery* d = nullptr;
        if (found_.try_pop(d)) return std::unique_ptr<Discovery>(d);
        clear_event(to_reader_);
        // What came between the look and the silence would otherwise wait for the next bell.
        return std::unique_ptr<Discovery>(found_.try_pop(d) ? d : nullptr);
    }
    void give_back(std::unique_ptr<Discovery> discovery, bool failed, std::int64_t /*now_ns*/) override {
        // Full only if the finder sleeps through a hundred unpluggings: then the reader closes it itself.
        if (returned_.full()) return;
        returned_.try_push({discovery.release(), failed});
        signal_event(to_finder_);
    }
    [[nodiscard]] int fd() const override { return to_reader_; }
    [[nodiscard]] std::int64_t due_ns() const override { return std::numeric_limits<std::int64_t>::max(); }

private:
    void run() {
        finds_.plays();
        (void)rt::place_thread(0, {rt::Policy::other, 0, {}, devices_thread_name});
        std::deque<std::unique_ptr<Discovery>> waiting;
        while (!stopping_.load()) {
            const std::int64_t now = clock_.now_ns();
            for (Returned r; returned_.try_pop(r);) {
                if (r.failed) finder_.failed(r.discovery->device, now);
                delete r.discovery;
            }
            for (Discovery& d : finder_.look(now)) waiting.push_back(std::make_unique<Discovery>(std::move(d)));
            bool handed_over = false;
            while (!waiting.empty() && found_.try_push(waiting.front().get())) {
                (void)waiting.front().release();
                waiting.pop_front();
                handed_over = true;
            }
            if (handed_over) signal_event(to_reader_);
            sleep(waiting.empty() ? finder_.due_ns() : clock_.now_ns() + 10'000'000);
        }
    }
    void sleep(std::int64_t until_ns) const REQUIRES(finds_) {
        const std::int64_t left = std::max<std::int64_t>(0, until_ns - clock_.now_ns());
        const timespec wait{left / 1'000'000'000, left % 1'000'000'000};
        pollfd fds[] = {{to_finder_, POLLIN, 0}, {finder_.fd(), POLLIN, 0}};
        (void)ppoll(fds, 2, &wait, nullptr);
        if ((fds[0].revents & POLLIN) != 0) clear_event(to_finder_);
    }

    [[no_unique_address]] ThreadRole finds_;  ///< the thread below
    Finder finder_ GUARDED_BY(finds_);
    rt::RealClock clock_;
    int to_reader_, to_finder_;
    rt::SpscRing<Discovery*> found_{128};
    rt::SpscRing<Returned> returned_{128};
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<Discoverer>> threaded_discoverer(Finder finder) {
    const int to_reader = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    const int to_finder = to_reader < 0 ? -1 : eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
    if (to_finder < 0) {
        const Error error{"eventfd", std::string("No event descriptor can be made: ") + std::strerror(errno),
                          "Raise the limit of open files (ulimit -n)", ErrorKind::failed};
        if (to_reader >= 0) ::close(to_reader);
        return error;
    }
    return std::unique_ptr<Discoverer>(std::make_unique<ThreadedDiscoverer>(std::move(finder), to_reader, to_finder));
}

}  // namespace surefoot::input
