// Devices that go, stall and come back deflected: at rest in time, nothing stale, no descriptor left behind.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <memory>

#include "rt/base/random.hpp"
#include "tests/vm/hang_up.hpp"
#include "tests/vm/hid_checks.hpp"
#include "tests/vm/uhid.hpp"
#include "tests/vm/walker.hpp"

namespace surefoot::vm {

namespace {

int deflected(Random& random) {
    return random.below(2) == 0 ? static_cast<int>(random.below(70)) : 186 + static_cast<int>(random.below(70));
}

struct Pull {
    bool plugged = false, moved = false, rested = false;
    double stood_still_ms = 0;  ///< longest time in which the guest did not run the loop, from the pull to rest
    double after_hang_up_ms = 1e9, after_pull_ms = 1e9;
};

/// Plugged, neutral, deflected at random for a random time, pulled with reports in flight.
Pull pull_once(Walker& walker, const input::Recording& pad, Random& random, int number) {
    Pull result;
    auto device = std::make_unique<UhidDevice>(pad, fmt::format("pull-{}", number % 7));
    walker.added_ns = walker.removed_ns = 0;
    if (!walker.until([&] { return walker.added_ns != 0; }, 10'000)) return result;
    result.plugged = true;
    const HangUp hang_up(device->node());
    walker.hold([&] { device->send(pad_at(128, 128)); }, 8);
    const auto report = pad_at(deflected(random), deflected(random), deflected(random), deflected(random));
    walker.hold([&] { device->send(report); }, random.range(15, 150));
    result.moved = walker.speed() > 0.01;
    std::atomic<std::int64_t> pulled_ns = 0;
    walker.longest_gap_ns = 0;
    std::thread cable([&] {
        for (int i = 0; i < 3; ++i) device->send(report);
        pulled_ns = now_ns();
        device->unplug();
    });
    std::int64_t rest_ns = 0;
    result.rested = walker.until(
        [&] {
            if (walker.speed() == 0 && pulled_ns != 0 && walker.removed_ns != 0 && rest_ns == 0) rest_ns = now_ns();
            return rest_ns != 0;
        },
        2000);
    cable.join();
    result.stood_still_ms = static_cast<double>(walker.longest_gap_ns) * 1e-6;
    if (rest_ns != 0) {
        result.after_pull_ms = static_cast<double>(rest_ns - pulled_ns) * 1e-6;
        if (hang_up.at_ns() != 0) result.after_hang_up_ms = static_cast<double>(rest_ns - hang_up.at_ns()) * 1e-6;
    }
    walker.run_ms(10);
    result.rested = result.rested && walker.speed() == 0;
    return result;
}

}  // namespace

void check_unplug(Checks& checks, const Guest& guest) {
    const auto pad = like(guest, "f310-like");
    Random random(1);
    Walker walker;
    walker.run_ms(200);
    (void)pull_once(walker, pad, random, 0);  // what is opened once and kept
    walker.run_ms(300);
    const std::size_t before = open_descriptors();
    constexpr int times = 200, at_most_void = 100;
    int done = 0, moved = 0, rested = 0, late = 0, not_plugged = 0, stood_still = 0;
    std::vector<double> hang_up, pull;
    for (int i = 0; done < times && stood_still < at_most_void; ++i) {
        const Pull p = pull_once(walker, pad, random, i);
        // A loop that the host did not run for so long says nothing about the time to rest: it is pulled once more. Rest itself
        // counts.
        if (p.plugged && p.rested && p.after_hang_up_ms > 50 && p.stood_still_ms > 10) {
            ++stood_still;
            continue;
        }
        ++done;
        not_plugged += p.plugged ? 0 : 1;
        moved += p.moved ? 1 : 0;
        rested += p.rested ? 1 : 0;
        late += p.after_hang_up_ms <= 50 ? 0 : 1;
        hang_up.push_back(p.after_hang_up_ms);
        pull.push_back(p.after_pull_ms);
    }
    walker.run_ms(500);
    const std::size_t after = open_descriptors();
    std::sort(hang_up.begin(), hang_up.end());
    std::sort(pull.begin(), pull.end());
    checks.check("unplug.at_rest", done == times && rested == times && late == 0 && moved > times * 9 / 10 && walker.wrong == 0,
                 fmt::format("{} of {} at rest, {} were moving, {} never came; hang-up to rest p50 {:.1f} ms, max {:.1f} ms (at "
                             "most 50; {} later); from "
                             "the pull max {:.1f} ms; {} velocities that are no numbers; {} more at rest, but later where the "
                             "host held the loop for "
                             "over 10 ms, and pulled again",
                             rested, times, moved, not_plugged, hang_up[hang_up.size() / 2], hang_up.back(), late, pull.back(),
                             walker.wrong, stood_still));
    checks.check("unplug.descriptors", before == after, fmt::format("{} before, {} after {} times", before, after, times));

    UhidDevice device(pad, "again");
    walker.added_ns = 0;
    walker.until([&] { return walker.added_ns != 0; }, 10'000);
    walker.greatest = 0;
    walker.hold([&] { device.send(pad_at(0, 0)); }, 500);
    const double deflected_speed = walker.greatest;
    walker.hold([&] { device.send(pad_at(128, 128)); }, 50);
    walker.hold([&] { device.send(pad_at(128, 0)); }, 500);
    checks.check("replug.neutral_first", deflected_speed == 0 && walker.speed() > 0.5,
                 fmt::format("deflected from the start: {:.3f}; after neutral: {:.2f}", deflected_speed, walker.speed()));
}

void check_stall(Checks& checks, const Guest& guest) {
    UhidDevice device(like(guest, "f310-like"), "stall");
    Walker walker;
    walker.until([&] { return walker.added_ns != 0; }, 10'000);
    const auto stalled = [&](const std::function<void(int)>& sent, int count) {
        walker.hold([&] { device.send(pad_at(128, 128)); }, 50);
        walker.hold([&] { device.send(pad_at(128, 0)); }, 400);
        const double before = walker.speed();
        const std::int64_t from = now_ns();
        for (int i = 0; i < count; ++i) {
            sent(i);
            while (ms_since(from) < (i + 1) * 500.0 / count) sleep_ms(0.2);
        }
        walker.step();
        const double first = walker.speed();
        walker.greatest = 0;
        walker.run_ms(100);
        const double soon = walker.speed();
        walker.run_ms(300);
        return std::array<double, 4>{before, first, soon, walker.speed()};
    };
    // 1 kHz for half a second, ending in release: the ring is full, and the release was dropped.
    const auto full = stalled([&](int i) { device.send(pad_at(128, i < 480 ? 0 : 128)); }, 500);
    walker.steering.steers.plays();
    checks.check(
        "stall.ring_overflow", full[0] > 0.5 && full[2] == 0 && walker.steering.safety().overflows >= 1,
        fmt::format("500 ms, 500 reports: speed {:.2f} before, {:.2f} one tick after, {:.2f} 100 ms after; {} overflows seen",
                    full[0], full[1], full[2], walker.steering.safety().overflows));
    // 40 reports fit; the newest one is the release.
    const auto fits = stalled([&](int i) { device.send(pad_at(128, i < 39 ? 0 : 128)); }, 40);
    checks.check("stall.release_read", fits[0] > 0.5 && fits[1] <= fits[0] && fits[2] < fits[1] && fits[3] == 0,
                 fmt::format("500 ms, 40 reports: speed {:.2f} before, {:.2f} one tick after, {:.2f} after 100 ms, {:.2f} after "
                             "400 ms (a release slows "
                             "down at 8 m/s²)",
                             fits[0], fits[1], fits[2], fits[3]));
}

void check_two_devices(Checks& checks, const Guest& guest) {
    const auto pad = like(guest, "f310-like");
    Walker walker;
    UhidDevice a(pad, "two-a"), b(pad, "two-b");
    walker.until([&] { return walker.source->devices() == 2; }, 10'000);
    walker.hold([&] { a.send(pad_at(128, 128)), b.send(pad_at(128, 128)); }, 50);
    walker.hold([&] { a.send(pad_at(128, 0)); }, 800);
    const double one = glm::length(walker.sample.velocity_m_s);
    double greatest = 0;
    walker.hold(
        [&] {
            a.send(pad_at(0, 0)), b.send(pad_at(0, 0));
            greatest = std::max(greatest, glm::length(walker.sample.velocity_m_s));
        },
        800);
    checks.check("two_devices.bounded", one > 0.5 && greatest > 0.5 && greatest <= one * 1.001,
                 fmt::format("full deflection: {:.3f} m/s by one, at most {:.3f} m/s by two, diagonally", one, greatest));
}

}  // namespace surefoot::vm
