// bench_stolen_frames OUT.csv [SECONDS] [RATE]: records frames from which the host really stole, as evidence for the classifier:
// a loop that works through 72 % of its period on a FIFO thread; kept are missed frames, woken in time and never preempted, while
// the kernel's own steal clock of that core went on (it ticks every 10 ms, so a frame's own share of it is not known).
#include "tests/bench/stolen_frames.hpp"

#include <cstdlib>
#include <thread>

#include "rt/clock/clock.hpp"
#include "rt/frame/loop.hpp"
#include "rt/monitor/recorder.hpp"
#include "rt/threads/placement.hpp"
#include "rt/threads/usage.hpp"

namespace surefoot::bench {

namespace {

class Working final : public rt::FrameStages {
public:
    explicit Working(std::int64_t period_ns) : share_ns_(period_ns / 100) {}
    void sample(rt::FrameRecord& r) override { r.prepared_age = 1; }
    void select(rt::FrameRecord&) override { clock_.burn_ns(2 * share_ns_); }
    void submit(rt::FrameRecord&) override { clock_.burn_ns(36 * share_ns_); }
    void finish(rt::FrameRecord& r) override {
        clock_.burn_ns(32 * share_ns_);
        r.rastered_ns = clock_.now_ns();
        clock_.burn_ns(2 * share_ns_);
    }
    void account(rt::FrameRecord&) override {}

private:
    rt::RealClock clock_;
    std::int64_t share_ns_;
};

}  // namespace
}  // namespace surefoot::bench

int main(int argc, char** argv) {
    using namespace surefoot;
    if (argc < 2) {
        fmt::print(stderr, "usage: bench_stolen_frames OUT.csv [SECONDS] [RATE]\n");
        return 2;
    }
    const double seconds = argc > 2 ? std::atof(argv[2]) : 60, rate = argc > 3 ? std::atof(argv[3]) : 120;
    const int core = rt::allowed_cpus().cpus().back();
    const auto core_steal_ms = [core] {
        const auto steal = rt::read_steal();
        return steal && static_cast<std::size_t>(core) < steal->cpu_ms.size() ? steal->cpu_ms[static_cast<std::size_t>(core)]
                                                                              : 0.0;
    };
    rt::SpscRing<rt::FrameRecord> ring(4096);
    std::string rows = std::string(bench::stolen_header) + "\n";
    std::uint64_t missed = 0, kept = 0;
    double steal_ms = core_steal_ms();
    rt::RecorderOptions recording;
    recording.keep = false;
    recording.poll_ns = 5'000'000;  // the steal clock is read as a record comes: soon after its frame
    recording.on_record = [&](const rt::FrameRecord& r) {
        if (!r.missed) return;
        ++missed;
        const double now_ms = core_steal_ms();
        const bool in_time = (r.woken_ns - r.due_ns) * 100 < (r.deadline_ns - r.due_ns) * 3;
        if (in_time && r.involuntary == 0 && r.continued == 0 && now_ms > steal_ms) {
            rows += bench::stolen_row(r, now_ms - steal_ms);
            ++kept;
        }
        steal_ms = now_ms;
    };
    {
        rt::Recorder recorder(ring, recording);
        std::thread([&] {
            const auto placed =
                rt::place_thread(0, {.policy = rt::Policy::fifo, .priority = 80, .cpus = rt::CpuMask{core}, .name = "frame"});
            if (!placed) fmt::print(stderr, "{}\n", placed.error().text());
            rt::RealClock clock;
            rt::FrameLoopOptions options;
            options.period_ns = static_cast<std::int64_t>(1e9 / rate);
            options.frames = static_cast<std::uint64_t>(seconds * rate);
            options.continued = rt::count_continues();
            bench::Working stages(options.period_ns);
            rt::run_frame_loop(options, clock, stages, ring);
        }).join();
    }
    if (auto written = write_text(argv[1], rows); !written) {
        fmt::print(stderr, "{}\n", written.error().text());
        return 1;
    }
    fmt::print("{} missed frames, {} of them with time stolen and kept\n", missed, kept);
    return 0;
}
