// Injects every cause of a miss for real into the frames of a walk: by spinning, sleeping, faulting, drawing again, a late set, a
// blocker of higher priority on the same core, or a stop of the whole process.
#pragma once

#include <semaphore.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "rt/clock/clock.hpp"
#include "rt/frame/record.hpp"
#include "rt/threads/placement.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::bench {

/// A thread that does a piece of work when it is handed one.
class Helper {
public:
    explicit Helper(const rt::Placement& placement) {
        sem_init(&requested_, 0, 0);
        sem_init(&done_, 0, 0);
        thread_ = std::thread([this, placement] {
            if (!rt::place_thread(0, placement)) misplaced_ = true;
            tid_ = rt::own_tid();
            sem_post(&done_);
            for (wait(requested_); !ending_; wait(requested_)) {
                clock_.sleep_until_ns(from_ns_);
                if (cpu_ns_ > 0) clock_.burn_ns(cpu_ns_);
                while (clock_.now_ns() < until_ns_) {
                }
                sem_post(&done_);
            }
        });
        wait(done_);
    }
    ~Helper() {
        ending_ = true;
        sem_post(&requested_);
        thread_.join();
    }
    Helper(const Helper&) = delete;
    Helper& operator=(const Helper&) = delete;

    /// From from_ns on: burns so much CPU time, and spins until until_ns.
    void schedule(std::int64_t from_ns, std::int64_t cpu_ns, std::int64_t until_ns) {
        from_ns_ = from_ns;
        cpu_ns_ = cpu_ns;
        until_ns_ = until_ns;
        sem_post(&requested_);
    }
    void finish() { wait(done_); }
    [[nodiscard]] pid_t tid() const { return tid_; }
    [[nodiscard]] bool misplaced() const { return misplaced_; }

private:
    static void wait(sem_t& semaphore) {
        while (sem_wait(&semaphore) != 0) {
        }
    }
    rt::RealClock clock_;
    sem_t requested_{}, done_{};
    std::atomic<bool> ending_{false};
    bool misplaced_ = false;
    std::int64_t from_ns_ = 0, cpu_ns_ = 0, until_ns_ = 0;
    pid_t tid_ = 0;
    std::thread thread_;
};

/// A process that stops this one and lets it go on again, for as long as it is told.
class Stopper {
public:
    /// Forks: before there are threads.
    Stopper() {
        if (pipe(ends_) != 0) return;
        const pid_t parent = getpid();
        child_ = fork();
        if (child_ != 0) return;
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close(ends_[1]);
        // At once, also where the machine is busy: a stop that falls on another frame teaches nothing.
        (void)rt::place_thread(0, {.policy = rt::Policy::fifo, .priority = 95, .cpus = {}, .name = "stopper"});
        rt::RealClock clock;
        StopRequest request;
        while (read(ends_[0], &request, sizeof request) == sizeof request) {
            // To the thread that runs: the process's own would be taken by the main thread, which waits its turn where the
            // machine is busy.
            syscall(SYS_tgkill, parent, request.thread, SIGSTOP);
            clock.sleep_until_ns(clock.now_ns() + request.for_ns);
            kill(parent, SIGCONT);
        }
        _exit(0);
    }
    ~Stopper() {
        close(ends_[0]);
        close(ends_[1]);
        if (child_ > 0) waitpid(child_, nullptr, 0);
    }
    Stopper(const Stopper&) = delete;
    Stopper& operator=(const Stopper&) = delete;
    /// Stops the whole process, through the calling thread.
    void stop_for(std::int64_t ns) {
        const StopRequest request{ns, static_cast<pid_t>(syscall(SYS_gettid))};
        (void)!write(ends_[1], &request, sizeof request);
    }

private:
    struct StopRequest {
        std::int64_t for_ns = 0;
        pid_t thread = 0;
    };
    int ends_[2] = {-1, -1};
    pid_t child_ = -1;
};

/// Memory that the kernel gives anew, page by page, at the first touch of each.
class FreshPages {
public:
    static constexpr std::size_t bytes = 768U << 20U, page = 4096;  // 200 000 faults: 50 ms at least
    FreshPages() {
        void* const mapped = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        memory_ = mapped == MAP_FAILED ? nullptr : static_cast<unsigned char*>(mapped);
        if (memory_ != nullptr) madvise(memory_, bytes, MADV_NOHUGEPAGE);
    }
    ~FreshPages() {
        if (memory_ != nullptr) munmap(memory_, bytes);
    }
    FreshPages(const FreshPages&) = delete;
    FreshPages& operator=(const FreshPages&) = delete;
    /// Not in a frame: it takes its time.
    void renew() const {
        munlock(memory_, bytes);  // a walk locks all memory that it finds
        madvise(memory_, bytes, MADV_DONTNEED);
    }
    void fault_until(std::int64_t until_ns) const {
        const rt::RealClock clock;
        for (std::size_t at = 0; at < bytes && clock.now_ns() < until_ns; at += page)
            const_cast<volatile unsigned char&>(memory_[at]) = 1;
    }

private:
    unsigned char* memory_ = nullptr;
};

/// Injects one cause into the frames of a walk. Every so many frames one takes 20 to 36 ms more. All members but seen() and
/// delay_preparing() belong to the frame thread.
class Injector {
public:
    static constexpr std::size_t max_frames = 60'000;

    /// Wants `wanted` frames that missed by the cause.
    Injector(rt::Cause cause, int wanted, std::int64_t period_ns, int frame_core, Stopper& stopper);

    walk::Fault at(walk::FramePhase phase, const rt::FrameRecord& record);
    /// On the prepare thread: falls behind when a set is to grow too old.
    void delay_preparing();
    /// On the monitor thread. Ends the walk once enough frames have missed.
    void seen(const rt::FrameRecord& record);

    /// After the walk: whether the injection was carried out in this frame.
    [[nodiscard]] bool injected(std::uint64_t frame) const { return frame < max_frames && marks_[frame].carried_out; }
    /// The host stole while it ran as well, by its own account (/proc/stat, in steps of 10 ms): it had two causes, and nobody
    /// knows which took more.
    [[nodiscard]] bool has_two_causes(std::uint64_t frame) const { return marks_[frame].stolen_too; }
    [[nodiscard]] const std::atomic<bool>& enough() const { return enough_; }
    [[nodiscard]] bool blocked() const { return !blocker_.misplaced(); }

private:
    struct Mark {
        std::atomic<bool> carried_out{false}, stolen_too{false};
    };
    void begin(const rt::FrameRecord& record);
    void in_select(const rt::FrameRecord& record);
    walk::Fault in_submit(const rt::FrameRecord& record);
    walk::Fault in_raster(const rt::FrameRecord& record);
    void in_present(const rt::FrameRecord& record);
    void carried_out(const rt::FrameRecord& record);
    [[nodiscard]] bool planned(std::uint64_t frame) const;
    [[nodiscard]] bool now(const rt::FrameRecord& record, rt::Cause cause) const {
        return cause_ == cause && planned(record.frame);
    }
    [[nodiscard]] std::int64_t extra_ns(std::uint64_t frame) const;
    bool stopped_for(std::int64_t ns);

    rt::Cause cause_;
    int wanted_;
    std::int64_t period_ns_;
    std::uint64_t frames_apart_;  ///< from one injection to the next
    Stopper& stopper_;
    Helper blocker_;                   ///< above the frame thread, on its core
    std::optional<FreshPages> pages_;  ///< for page faults
    rt::RealClock clock_;
    std::vector<Mark> marks_;  ///< by frame
    double steal_before_ms_ = 0;
    std::int64_t drawing_since_ns_ = 0;
    bool blocking_ = false, stalls_ = false;
    std::atomic<bool> stall_{false}, enough_{false};
    int missed_ = 0;  ///< of the monitor thread
};

}  // namespace surefoot::bench
