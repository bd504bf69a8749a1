// Both openers.
#include "input/gpio/line_opener.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <latch>
#include <semaphore>
#include <thread>

#include "input/retry.hpp"
#include "rt/base/check.hpp"
#include "rt/base/thread_annotations.hpp"
#include "rt/clock/clock.hpp"
#include "rt/exchange/spsc_ring.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::input {

namespace {

/// One try after another, each when it is due.
class LineTries {
public:
    explicit LineTries(LinesToOpen lines) : lines_(std::move(lines)) {}
    [[nodiscard]] bool due(std::int64_t now_ns) const { return !lines_.requests.empty() && !given_ && retry_.due(now_ns); }
    [[nodiscard]] bool given() const { return given_; }
    [[nodiscard]] std::int64_t next_ns() const { return retry_.next_ns; }

    std::unique_ptr<OpenedLines> make(std::int64_t now_ns) {
        auto made = std::make_unique<OpenedLines>();
        if (auto done = open_into(*made); !done) {
            made->lines.reset();
            made->error = done.error();
            retry_.failed(now_ns);
            return made;
        }
        retry_.succeeded();
        given_ = true;
        return made;
    }
    void unmake(std::unique_ptr<OpenedLines> opened, std::int64_t now_ns) {
        if (!opened->lines) return;
        given_ = false;
        retry_.failed(now_ns);
    }

private:
    Result<void> open_into(OpenedLines& out) {
        auto opened = lines_.open(lines_.requests, lines_.consumer, lines_.context);
        if (!opened) return opened.error();
        out.lines = std::move(*opened);
        return out.lines->levels({out.levels.data(), lines_.requests.size()});
    }
    LinesToOpen lines_;
    Retry retry_;
    bool given_ = false;  ///< the reader has them
};

class InlineLineOpener final : public LineOpener {
public:
    explicit InlineLineOpener(LinesToOpen lines) : tries_(std::move(lines)) {}
    void wait_for_first() override {}
    std::unique_ptr<OpenedLines> next(std::int64_t now_ns) override { return tries_.due(now_ns) ? tries_.make(now_ns) : nullptr; }
    void give_back(std::unique_ptr<OpenedLines> opened, std::int64_t now_ns) override {
        tries_.unmake(std::move(opened), now_ns);
    }

private:
    LineTries tries_;
};

class ThreadedLineOpener final : public LineOpener {
public:
    explicit ThreadedLineOpener(LinesToOpen lines) : tries_(std::move(lines)), thread_([this] { run(); }) {}
    ThreadedLineOpener(const ThreadedLineOpener&) = delete;
    ThreadedLineOpener& operator=(const ThreadedLineOpener&) = delete;
    ~ThreadedLineOpener() override {
        stopping_.store(true);
        bell_.release();
        thread_.join();
        OpenedLines* o = nullptr;
        while (found_.try_pop(o)) delete o;
        while (returned_.try_pop(o)) delete o;
    }

    void wait_for_first() override { first_.wait(); }
    std::unique_ptr<OpenedLines> next(std::int64_t /*now_ns*/) override {
        OpenedLines* o = nullptr;
        return std::unique_ptr<OpenedLines>(found_.try_pop(o) ? o : nullptr);
    }
    /// There is always room: no more are under way than the ring to the reader holds.
    void give_back(std::unique_ptr<OpenedLines> opened, std::int64_t /*now_ns*/) override {
        if (CHECK_RARE(!returned_.full(), "No more lines are under way than the ring holds") && returned_.try_push(opened.get()))
            (void)opened.release();
        bell_.release();
    }

private:
    static constexpr std::size_t max_under_way = 8;

    void run() {
        opens_.plays();
        (void)rt::place_thread(0, {.policy = rt::Policy::other, .priority = 0, .cpus = {}, .name = lines_thread_name});
        std::string last_reason;
        for (bool first = true; first || !stopping_.load(); first = false) {
            const std::int64_t now_ns = clock_.now_ns();
            for (OpenedLines* o = nullptr; returned_.try_pop(o); --under_way_)
                tries_.unmake(std::unique_ptr<OpenedLines>(o), now_ns);
            if (under_way_ < max_under_way && tries_.due(now_ns)) hand_over(tries_.make(now_ns), last_reason);
            if (first) first_.count_down();
            sleep();
        }
    }
    /// Each reason once, until another one or the lines come.
    void hand_over(std::unique_ptr<OpenedLines> made, std::string& last_reason) REQUIRES(opens_) {
        const std::string reason = made->error.text();
        if (!made->lines && reason == last_reason) return;
        last_reason = reason;
        if (!found_.try_push(made.get())) return tries_.unmake(std::move(made), clock_.now_ns());
        (void)made.release();
        ++under_way_;
    }
    void sleep() REQUIRES(opens_) {
        if (tries_.given() || under_way_ == max_under_way) return bell_.acquire();
        (void)bell_.try_acquire_for(std::chrono::nanoseconds(std::max<std::int64_t>(0, tries_.next_ns() - clock_.now_ns())));
    }

    [[no_unique_address]] ThreadRole opens_;  ///< the thread below
    LineTries tries_ GUARDED_BY(opens_);
    rt::RealClock clock_;
    rt::SpscRing<OpenedLines*> found_{max_under_way}, returned_{max_under_way};
    std::size_t under_way_ GUARDED_BY(opens_) = 0;  ///< with the reader, or on their way there or back
    std::counting_semaphore<> bell_{0};
    std::latch first_{1};
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace

std::unique_ptr<LineOpener> make_line_opener(LinesToOpen lines, Opening where) {
    if (where == Opening::same_thread || lines.requests.empty()) return std::make_unique<InlineLineOpener>(std::move(lines));
    return std::make_unique<ThreadedLineOpener>(std::move(lines));
}

}  // namespace surefoot::input
