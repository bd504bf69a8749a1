// Checks on real gpiochips made by gpio-sim, in the guest, through the libgpiod that this program was built with: once with 1.6
// (Debian 12), once with 2 (Debian 13). What happens is logged without times, so that the two logs can be compared.
#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <sched.h>
#include <array>
#include <atomic>
#include <memory>
#include <thread>

#include "input/gpio/panel.hpp"
#include "input/safety/safety.hpp"
#include "input/safety/stop_memory.hpp"
#include "rt/base/random.hpp"
#include "tests/eventually.hpp"
#include "tests/vm/checks.hpp"
#include "tests/vm/gpio_sim.hpp"

namespace surefoot::vm {
namespace {

using namespace surefoot::input;

enum Line : std::size_t { estop, reset_line, dead_man, button, enc_a, enc_b };
const std::string label = "surefoot-panel";

std::vector<LineConfig> panel_lines() {
    const auto line = [](std::string name, LineRole role, std::string line_name, bool closed = false) {
        LineConfig c;
        c.name = std::move(name);
        c.role = role;
        c.request.chip = label;
        c.request.line = std::move(line_name);
        c.normally_closed = closed;
        return c;
    };
    return {line("stop", LineRole::stop, "ESTOP", true), line("reset", LineRole::stop_reset, "RESET"),
            line("hold", LineRole::dead_man, "DEADMAN"), line("next", LineRole::button, "BUTTON"),
            line("dial", LineRole::encoder_a, "ENC_A"),  line("dial", LineRole::encoder_b, "ENC_B")};
}

/// The panel with safety/ behind it, a step a millisecond.
struct Rig {
    Rig() : panel(panel_lines(), open_lines, nullptr) {
        const sched_param fifo{75};  // as the input thread
        if (sched_setscheduler(0, SCHED_FIFO, &fifo) != 0) std::fprintf(stderr, "SCHED_FIFO is refused\n");
        panel.service(now_ns());
        (void)panel.take_lines();  // that the lines were closed until now is no broken wire
    }
    void serve_once() {
        const std::int64_t now = now_ns();
        if (last_ns != 0) longest_gap_ms = std::max(longest_gap_ms, static_cast<double>(now - last_ns) * 1e-6);
        last_ns = now;
        panel.service(now);
        lines = panel.take_lines();
        command = step(safety, {}, {}, lines, now);
        (stop() ? stopped_once : walked_once) = true;
        if (panel.state().reports != reports) {
            reports = panel.state().reports;
            for (std::size_t i = 0; i < panel.controls().size(); ++i)
                if (panel.controls()[i].name == "dial")
                    dial += panel.state().value[i];
                else
                    pressed = panel.state().value[i] != 0;
        }
    }
    void serve(double ms) {
        for (const std::int64_t from = now_ns(); ms_since(from) < ms; sleep_ms(1)) serve_once();
    }
    /// Milliseconds until it is so; -1: not within so long.
    template <class Condition>
    double until(Condition so, double within_ms) {
        for (const std::int64_t from = now_ns(); ms_since(from) < within_ms; sleep_ms(0.5)) {
            serve_once();
            if (so()) return ms_since(from);
        }
        return -1;
    }
    [[nodiscard]] bool stop() const { return command.order == Order::stop; }

    GpioPanel panel;
    SafetyState safety;
    Lines lines;
    Command command;
    std::int64_t last_ns = 0;   ///< set it to 0, and longest_gap_ms, to begin anew
    double longest_gap_ms = 0;  ///< between two steps
    std::uint64_t reports = 0;
    long dial = 0;
    bool pressed = false, stopped_once = false, walked_once = false;
};

class Log {
public:
    explicit Log(const std::string& file) : file_(std::fopen(file.c_str(), "w")) {}
    ~Log() {
        if (file_ != nullptr) std::fclose(file_);
    }
    Log(const Log&) = delete;
    Log& operator=(const Log&) = delete;
    void state(const char* when, const Rig& rig) {
        line(fmt::format("{}: stop {} latched {} dead-man {} pressed {} dial {} illegal {}", when, rig.lines.stop,
                         rig.safety.latched, rig.lines.dead_man, rig.pressed, rig.dial, rig.panel.illegal_encoder_steps()));
    }
    void line(const std::string& text) {
        if (file_ != nullptr) std::fputs((text + "\n").c_str(), file_);
    }

private:
    std::FILE* file_;
};

/// Edges as the back end gives them, before any meaning.
void check_edges(Checks& checks, SimulatedChip& chip, Log& log) {
    std::vector<LineRequest> requests;
    for (const LineConfig& c : panel_lines()) requests.push_back(c.request);
    const std::size_t before = open_descriptors();
    {
        auto lines = open_lines(requests, "surefoot", nullptr);
        if (!checks.check("open", lines.ok(), lines ? gpio_back_end() : lines.error().text())) return;
        int sent = 0, wrong = 0;
        std::int64_t last = 0;
        std::array<LineEdge, 32> edges;
        for (int i = 0; i < 200; ++i) {
            const std::size_t line = static_cast<std::size_t>(i * 7 % 6);
            const bool high = i / 6 % 2 == 0;
            std::array<bool, 6> was{}, is{};
            (void)(*lines)->levels(was);
            const std::int64_t from = now_ns();
            chip.pull(line, high);
            const std::size_t expected = was[line] != high ? 1 : 0;
            // An edge comes by a thread of the kernel's: when it runs is the guest's affair.
            auto got = (*lines)->read(edges);
            for (const std::int64_t waited = now_ns(); got && *got == 0 && ms_since(waited) < (expected == 0 ? 1 : 500);
                 sleep_ms(0.2))
                got = (*lines)->read(edges);
            (void)(*lines)->levels(is);
            sent += static_cast<int>(expected);
            if (!got || *got != expected || is[line] != high) {
                ++wrong;
                continue;
            }
            if (expected == 0) continue;
            const LineEdge& e = edges[0];
            if (e.line != line || e.active != high || e.stamp_ns < from || e.stamp_ns > now_ns() || e.stamp_ns < last) ++wrong;
            last = e.stamp_ns;
            log.line(fmt::format("edge: line {} active {}", e.line, e.active));
        }
        checks.check("edges", wrong == 0 && sent > 100,
                     fmt::format("{} edges, each with its line, direction and kernel's stamp; {} wrong", sent, wrong));
    }
    checks.check("descriptors", open_descriptors() == before, fmt::format("{} before, {} after", before, open_descriptors()));
    for (std::size_t i = 0; i < 6; ++i) chip.pull(i, i == estop);
}

void check_button(Checks& checks, Rig& rig, SimulatedChip& chip, Log& log) {
    chip.pull(button, true);
    const double down = rig.until([&] { return rig.pressed; }, 500);
    log.state("button down", rig);
    chip.pull(button, false);
    const double up = rig.until([&] { return !rig.pressed; }, 500);
    log.state("button up", rig);
    checks.check("button", down >= 0 && up >= 0,
                 fmt::format("down after {:.1f} ms, up after {:.1f} ms (10 ms settle)", down, up));
}

void check_stop(Checks& checks, Rig& rig, SimulatedChip& chip, Log& log) {
    chip.pull(dead_man, true);
    rig.serve(60);
    const bool walking = !rig.stop();
    log.state("before stop", rig);
    chip.pull(estop, false);
    const double ms = rig.until([&] { return rig.stop(); }, 500);
    log.state("stop", rig);
    chip.pull(estop, true);
    rig.serve(100);
    const bool stays = rig.stop() && rig.safety.latched;
    log.state("stop closed again", rig);
    chip.pull(reset_line, true);
    rig.serve(30);
    chip.pull(reset_line, false);
    rig.serve(60);
    log.state("reset", rig);
    checks.check("stop", walking && ms >= 0 && ms <= 50 && stays && !rig.safety.latched && !rig.stop(),
                 fmt::format("stopped after {:.1f} ms, {} when closed again, {} after the reset", ms,
                             stays ? "latched" : "NOT latched", rig.stop() ? "STOPPED" : "walking"));
    // A millisecond's opening, shorter than a step.
    rig.stopped_once = false;
    chip.pull(estop, false);
    chip.pull(estop, true);
    rig.serve(30);
    checks.check("stop.shortest", rig.safety.latched && rig.stopped_once, "opened and closed between two steps: latched");
    chip.pull(reset_line, true);
    rig.serve(30);
    chip.pull(reset_line, false);
    rig.serve(60);
}

void check_dead_man(Checks& checks, Rig& rig, SimulatedChip& chip, Log& log) {
    const bool before = rig.stop();
    int seen = 0;
    constexpr int times = 50;
    for (int i = 0; i < times; ++i) {
        chip.pull(dead_man, true);
        rig.serve(40);
        rig.stopped_once = false;
        chip.pull(dead_man, false);
        sleep_ms(0.2 + 0.1 * i);
        chip.pull(dead_man, true);
        seen += rig.until([&] { return rig.stop(); }, 100) >= 0 ? 1 : 0;
    }
    rig.serve(60);
    const bool after = rig.stop();
    log.state("dead-man held", rig);
    chip.pull(dead_man, false);
    const double ms = rig.until([&] { return rig.stop(); }, 500);
    log.state("dead-man let go", rig);
    checks.check(
        "dead_man", !before && !after && seen == times && ms >= 0 && ms <= 50 && !rig.safety.latched,
        fmt::format("let go for 0.2 to 5.1 ms: {} of {} stopped; let go: after {:.1f} ms; not latched", seen, times, ms));
    chip.pull(dead_man, true);
    rig.serve(60);
}

/// The dead-man's contact let go and pressed through bounces of 0.2 to 5 ms, 1 to 20 edges: it stops at the first edge of a
/// release, stays stopped through all others, and walks again only after 20 ms of quiet.
void check_bounces(Checks& checks, Rig& rig, SimulatedChip& chip, Log& log) {
    constexpr int wanted = 40;
    constexpr double quiet_ms = 20, longest_bounce_ms = 5, max_ms = 45'000;
    Random random(14);
    int rounds = 0, late = 0, walked = 0, early = 0, stuck = 0;
    double slowest_ms = 0;
    const auto bounce = [&](int edges, bool level) {
        for (int i = 0; i < edges; ++i, level = !level) {
            chip.pull(dead_man, level);
            rig.serve(random.range(0.2, longest_bounce_ms));
        }
    };
    for (const std::int64_t from = now_ns(); rounds < wanted && ms_since(from) < max_ms;) {
        (void)rig.until([&] { return !rig.stop(); }, 500);
        rig.last_ns = 0;
        rig.longest_gap_ms = 0;
        chip.pull(dead_man, false);
        const double stopped_ms = rig.until([&] { return rig.stop(); }, 500);
        rig.walked_once = false;
        const int released_by = 1 + 2 * static_cast<int>(random.below(10));
        bounce(released_by - 1, true);
        rig.serve(2 * quiet_ms);
        const int pressed_by = 1 + 2 * static_cast<int>(random.below(10));
        bounce(pressed_by - 1, true);
        const bool bounced_through = rig.walked_once;
        chip.pull(dead_man, true);
        const std::int64_t pressed = now_ns();
        const double walks_ms = rig.until([&] { return !rig.stop(); }, 500);
        // Where the guest was kept from running, a bounce may have been quiet for so long: no round.
        if (rig.longest_gap_ms > quiet_ms - longest_bounce_ms - 1 || ms_since(pressed) - std::max(walks_ms, 0.0) > quiet_ms)
            continue;
        ++rounds;
        late += stopped_ms < 0 || stopped_ms > 50 ? 1 : 0;
        walked += bounced_through ? 1 : 0;
        early += walks_ms >= 0 && walks_ms < quiet_ms - 1 ? 1 : 0;  // the edge's stamp is a little older than our clock's reading
        stuck += walks_ms < 0 ? 1 : 0;
        slowest_ms = std::max(slowest_ms, stopped_ms);
    }
    log.state("dead-man after bounces", rig);
    checks.check(
        "dead_man.bounces", rounds == wanted && late + walked + early + stuck == 0,
        fmt::format(
            "{} rounds of {}: stopped after {:.1f} ms at most; {} late, {} walked while it bounced, {} before {:.0f} ms of "
            "quiet, {} not at all",
            rounds, wanted, slowest_ms, late, walked, early, quiet_ms, stuck));
}

void check_encoder(Checks& checks, Rig& rig, SimulatedChip& chip, Log& log) {
    static constexpr std::array<std::array<bool, 2>, 4> gray = {{{false, false}, {false, true}, {true, true}, {true, false}}};
    const long from = rig.dial;
    std::size_t at = 0;
    const auto turn = [&](int steps) {
        for (int i = 0; i < std::abs(steps); ++i) {
            const std::size_t next = (at + (steps > 0 ? 1U : 3U)) % 4;
            const bool a_moves = gray[next][0] != gray[at][0];
            const std::size_t line = a_moves ? enc_a : enc_b;
            const bool level = gray[next][a_moves ? 0 : 1];
            chip.pull(line, level);
            if (i % 20 == 0) {  // a contact that bounces
                chip.pull(line, !level);
                chip.pull(line, level);
            }
            at = next;
            sleep_ms(0.4);
            rig.serve_once();
        }
    };
    turn(400);
    rig.serve(20);
    const long up = rig.dial - from;
    log.state("dial +400", rig);
    turn(-150);
    rig.serve(20);
    log.state("dial -150", rig);
    checks.check("encoder", up == 400 && rig.dial - from == 250 && rig.panel.illegal_encoder_steps() == 0,
                 fmt::format("400 steps up, 150 back, one in 20 bounces: {} and {}; {} illegal", up, rig.dial - from,
                             rig.panel.illegal_encoder_steps()));
}

void check_burst(Checks& checks, Rig& rig, SimulatedChip& chip, Log& log) {
    bool right = true;
    double latest = 0;
    const auto lost_before = rig.panel.lost_edges();
    double burst_ms = 0;
    for (int round = 0; round < 2; ++round) {
        const bool last = round % 2 == 0;
        const std::int64_t from = now_ns();
        for (int i = 0; i < 10'000; ++i) chip.pull(button, i % 2 == 0);
        burst_ms = ms_since(from);
        chip.pull(button, last);
        rig.last_ns = 0;
        rig.longest_gap_ms = 0;
        const double ms = rig.until([&] { return rig.pressed == last; }, 500);
        // A release settles 10 ms; what is judged is the time beyond it, and beyond what the host kept the loop from running.
        const double held = rig.longest_gap_ms > 2 ? rig.longest_gap_ms : 0;
        const double beyond = ms < 0 ? -1 : std::max(0.0, ms - held - (last ? 0 : 10));
        right = right && beyond >= 0 && beyond <= 10;
        latest = std::max(latest, beyond);
        rig.serve(20);
    }
    log.state("after bursts", rig);
    const auto lost = rig.panel.lost_edges() - lost_before;
    checks.check("lost_edges", right && lost > 0,
                 fmt::format("2 bursts of 10000 edges ({:.0f} ms each): the level was right after {:.1f} ms at most (10); {} "
                             "edges counted as lost",
                             burst_ms, latest, lost));
    chip.pull(button, false);
    rig.serve(40);
}

void check_busy(Checks& checks, Log& log) {
    std::vector<LineRequest> one = {panel_lines()[button].request};
    auto other = open_lines(one, "other-program", nullptr);
    Rig rig;
    rig.serve(50);
    const std::string problem(rig.panel.problem());
    const bool stopped = rig.stop();
    log.line("busy: " + problem);
    if (other) other->reset();
    const double ms = rig.until([&] { return rig.panel.open(); }, 4000);
    checks.check("busy",
                 other.ok() && problem.find("other-program") != std::string::npos &&
                     problem.find("BUTTON") != std::string::npos && stopped && ms >= 0,
                 fmt::format("\"{}\"; stopped meanwhile; open {:.0f} ms after it was let go", problem, ms));
    std::vector<LineRequest> none = {one.front()};
    none.front().line = "NOWHERE";
    const auto missing = open_lines(none, "surefoot", nullptr);
    checks.check("missing_line", !missing.ok() && missing.error().text().find("NOWHERE") != std::string::npos,
                 missing.ok() ? "opened" : missing.error().text());
}

/// A stop outlives the process that saw it, even one that is killed.
void check_restart(Checks& checks, SimulatedChip& chip, const std::string& folder) {
    const std::string file = folder + "/stop-memory";
    ::unlink(file.c_str());
    const pid_t child = fork();
    if (child == 0) {
        Rig rig;
        StopKeeper keeper(file, false);
        for (;;) {
            rig.serve(2);
            keeper.set(rig.safety.latched);
            (void)keeper.flush();
        }
    }
    sleep_ms(400);
    const bool before = load_stop(file).latched;
    chip.pull(estop, false);
    (void)test::eventually(2, [&] { return load_stop(file).latched; });
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    chip.pull(estop, true);
    const auto after = load_stop(file);
    Rig rig;
    rig.safety.latched = after.latched;
    rig.serve(100);
    checks.check("stop.restart", !before && after.latched && after.note.empty() && rig.stop() && rig.safety.latched,
                 "stopped, killed with SIGKILL, closed, started anew: latched");
}

void check_removal(Checks& checks, SimulatedChip& chip, Log& log) {
    Rig rig;
    chip.pull(estop, true);
    chip.pull(dead_man, true);
    rig.serve(100);
    const bool walking = !rig.stop();
    const std::int64_t from = now_ns();
    std::atomic<std::int64_t> removed_ns = 0;
    std::thread hand([&] {
        chip.remove();
        removed_ns = now_ns();
    });
    const double stopped = rig.until([&] { return rig.stop(); }, 3000);
    hand.join();
    // The kernel takes its time to take a chip down; when in it the lines die, it does not say.
    const double removed = static_cast<double>(removed_ns - from) * 1e-6,
                 ms = stopped < 0 ? -1 : std::max(0.0, stopped - removed);
    rig.serve(50);
    const bool latched = rig.safety.latched && rig.lines.stop;
    log.state("chip gone", rig);
    const std::string problem(rig.panel.problem());
    chip.bring();
    for (std::size_t i = 0; i < 6; ++i) chip.pull(i, i == estop || i == dead_man);
    const double back = rig.until([&] { return rig.panel.open(); }, 5000);
    rig.serve(100);
    const bool still = rig.stop() && rig.safety.latched;
    log.state("chip back", rig);
    chip.pull(reset_line, true);
    rig.serve(30);
    chip.pull(reset_line, false);
    rig.serve(60);
    log.state("reset after it came back", rig);
    checks.check("chip_removed", walking && ms >= 0 && ms <= 50 && latched && back >= 0 && still && !rig.stop(),
                 fmt::format("stopped {:.1f} ms after the kernel was done with it (which took {:.1f}), {}: \"{}\"; open again "
                             "after {:.0f} ms, {}, {} after the reset",
                             ms, removed, latched ? "latched" : "NOT latched", problem, back,
                             still ? "still latched" : "NOT latched", rig.stop() ? "STOPPED" : "walking"));
}

int run(const std::string& folder, const std::string& group) {
    Checks checks(group, folder + "/checks.jsonl");
    Log log(folder + "/kept/" + group + ".log");
    SimulatedChip chip(label, {"ESTOP", "RESET", "DEADMAN", "BUTTON", "ENC_A", "ENC_B"});
    if (!chip.made()) {
        checks.not_run("all", "gpio-sim made no chip: see the guest's log");
        return 1;
    }
    check_edges(checks, chip, log);
    {
        Rig rig;
        rig.serve(50);
        check_button(checks, rig, chip, log);
        check_stop(checks, rig, chip, log);
        check_dead_man(checks, rig, chip, log);
        check_bounces(checks, rig, chip, log);
        check_encoder(checks, rig, chip, log);
        check_burst(checks, rig, chip, log);
    }
    check_busy(checks, log);
    check_restart(checks, chip, folder);
    check_removal(checks, chip, log);
    return checks.status();
}

}  // namespace
}  // namespace surefoot::vm

int main(int count, char** arguments) {
    if (count != 3) {
        std::fprintf(stderr, "usage: vm_gpio FOLDER NAME   (checks.jsonl and kept/NAME.log are written there)\n");
        return 2;
    }
    return surefoot::vm::run(arguments[1], arguments[2]);
}
