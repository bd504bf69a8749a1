// An hour of virtual time: eight devices at 1 kHz, from their bytes on, random and hostile. Memory flat, every velocity within
// limits, no NaN.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "rt/base/random.hpp"
#include "rt/threads/guard.hpp"
#include "tests/input/hid_test.hpp"
#include "tests/input/stick_fixture.hpp"

namespace surefoot::input {
namespace {

#ifdef SUREFOOT_SANITIZED
constexpr int hour_seconds = 600;  // the sanitizers take ten times as long
#else
constexpr int hour_seconds = 3600;
#endif
constexpr int devices = 8;

/// Two reports: x and y of eight bits, z of 32, rz of two, a relative wheel; a hat and three buttons.
constexpr std::string_view descriptor =
    "05 01 09 04 a1 01 85 01 15 00 26 ff 00 75 08 95 02 09 30 09 31 81 02 17 00 00 00 80 27 ff ff ff 7f 75 20 95 01 09 32 81 02 "
    "15 ff 25 01 75 02 09 35 81 02 75 06 81 03 15 81 25 7f 75 08 09 38 81 06 85 02 15 00 25 07 75 04 09 39 81 42 05 09 19 01 29 "
    "03 25 01 75 01 95 03 81 02 95 01 81 03 c0";

/// Where each of the nine controls lies in its report, after the id.
struct Place {
    std::string_view name;
    std::size_t report, bit, size;
};
constexpr std::array<Place, 9> places{{{"x", 0, 0, 8},
                                       {"y", 0, 8, 8},
                                       {"z", 0, 16, 32},
                                       {"rz", 0, 48, 2},
                                       {"wheel", 0, 56, 8},
                                       {"hat", 1, 0, 4},
                                       {"button-1", 1, 4, 1},
                                       {"button-2", 1, 5, 1},
                                       {"button-3", 1, 6, 1}}};

/// A device's two reports as they stand; some arrive cut short, too long, or under an id that nobody declared.
class Bytes {
public:
    Bytes() {
        reports_[0][0] = std::byte{1};
        reports_[1][0] = std::byte{2};
        rest();
    }
    void set(std::size_t control, std::int32_t value) {
        const Place& p = places[control];
        for (std::size_t i = 0; i < p.size; ++i) {
            std::byte& byte = reports_[p.report][1 + (p.bit + i) / 8];
            const std::byte mask{static_cast<std::uint8_t>(1U << ((p.bit + i) % 8))};
            byte = (static_cast<std::uint32_t>(value) >> i & 1U) != 0 ? byte | mask : byte & ~mask;
        }
    }
    void rest() {
        for (std::size_t control = 0; control < places.size(); ++control) set(control, control < 2 ? 128 : control == 5 ? 8 : 0);
    }
    std::span<const std::byte> next(Random& random) {
        const std::size_t which = random.below(8) == 0 ? 1 : 0, size = which == 0 ? 9 : 2;
        sent_ = reports_[which];
        switch (random.below(3000)) {
            case 0:
                return {sent_.data(), random.below(static_cast<std::uint32_t>(size))};
            case 1:
                return {sent_.data(), size + 1 + random.below(3)};
            case 2:
                sent_[0] = static_cast<std::byte>(3 + random.below(250));
                return {sent_.data(), size};
            default:
                return {sent_.data(), size};
        }
    }

private:
    using Report = std::array<std::byte, 12>;
    std::array<Report, 2> reports_{};
    Report sent_{};
};

/// Every kind of binding on hostile controls: full 32-bit ranges, a relative axis, a hat, buttons.
struct Hostile {
    Hostile() : device(describe_device(layout_of(hex(descriptor)), {})), controls(device.controls) {
        mapping = test::stick_mapping();
        const auto axis = [&](const char* name, Action action) {
            AxisMapping m;
            m.control.name = name;
            m.action = action;
            mapping.axes.push_back(m);
        };
        axis("z", Action::up);
        axis("rz", Action::speed);
        axis("wheel", Action::turn);
        mapping.axes[0].shape.smoothing_s = 0.02;
        mapping.hats.push_back({{"hat", 0, 0, ""}, {Action::turn, Action::look}, {}, 1, 0.05});
        mapping.buttons = {{{"button-1", 0, 0, ""}, Action::next_viewpoint, 1, 0, 0, false},
                           {{"button-2", 0, 0, ""}, Action::forward, -1, 0.05, 0.005, false},
                           {{"button-3", 0, 0, ""}, Action::reset, 1, 0, 0, false}};
    }
    HidDevice device;
    std::vector<ControlInfo> controls;
    DeviceMapping mapping;
};

std::int32_t hostile_value(Random& random, std::size_t control) {
    switch (random.below(control < 2 ? 40 : 4)) {
        case 0:
            return static_cast<std::int32_t>(random.next());
        case 1:
            return random.below(2) == 0 ? INT32_MIN : INT32_MAX;
        default:
            return control < 2 ? 128 : control == 5 ? 8 : 0;
    }
}

TEST(Hour, EightHostileDevicesStayWithinEveryLimit) {
    const Hostile hostile;
    const MotionLimits motion;
    const SafetyLimits safety;
    Steering steering(motion, safety);
    steering.steers.plays();
    Random random(2026);
    const auto compiled = compile(hostile.mapping, hostile.controls);
    ASSERT_TRUE(compiled.ok()) << compiled.error().text();
    for (int d = 0; d < devices; ++d) ASSERT_EQ(steering.attach(Mapper(*compiled), hostile.controls.size(), Reporting::learn), d);
    ASSERT_EQ(hostile.controls.size(), places.size());
    for (const Place& p : places) (void)control(hostile.device, p.name);
    std::vector<ReportDecoder> decoders(devices, ReportDecoder(hostile.device));
    std::array<DeviceState, devices> states{};
    std::array<Bytes, devices> bytes{};
    std::array<bool, devices> there{};
    std::array<std::int64_t, devices> mute_until{};
    there.fill(true);
    const auto guard = rt::guard_counters();
    const auto began = std::chrono::steady_clock::now();
    std::int64_t now = 0;
    std::uint64_t reports = 0, stops = 0;
    double fastest = 0, norm = 0;
    NavigationSample before = steering.tick({}, now);
    dvec3 walker_before{0.0};
    for (int i = 0; i < hour_seconds * 1000; ++i) {
        if (random.below(3000) == 0) {  // plugged and unplugged, outside of what may not allocate
            const int d = static_cast<int>(random.below(devices));
            const auto at = static_cast<std::size_t>(d);
            if (there[at])
                steering.detach(d);
            else
                steering.attach(Mapper(*compiled), hostile.controls.size(), static_cast<Reporting>(random.below(3)), d);
            there[at] = !there[at];
        }
        const rt::OwnScope own;
        const std::int64_t passed = random.below(5000) == 0 ? random.below(700) * 1'000'000LL : 1'000'000;
        now += passed;
        for (std::size_t d = 0; d < devices; ++d) {
            if (random.below(1000) == 0) states[d].has_value.reset();
            if (random.below(64) == 0)  // a hand moves one control
                for (int k = 0; k < 2; ++k) {
                    const std::size_t control = random.below(9);
                    bytes[d].set(control, hostile_value(random, control));
                }
            if (random.below(300) == 0) bytes[d].rest();  // and lets go of all
            if (random.below(10'000) == 0) mute_until[d] = now + 300'000'000;
            if (now < mute_until[d]) continue;
            if (decoders[d].decode(bytes[d].next(random), now, states[d]) == ReportFate::accepted)
                steering.report(static_cast<int>(d), states[d], now);
            steering.drained(static_cast<int>(d), random.below(20'000) == 0 ? 64 : 1, random.below(50'000) == 0);
            ++reports;
        }
        Lines lines;
        lines.stop = random.below(60'000) == 0;
        lines.stop_reset = random.below(50) == 0;
        const NavigationSample sample = steering.tick(lines, now);
        const double speed = glm::length(sample.velocity_m_s), turning = glm::length(sample.angular_rad_s);
        const double dt = std::min(static_cast<double>(passed) * 1e-9, longest_step_s);
        const dvec3 walker = steering.motion().velocity;
        fastest = std::max(fastest, speed);
        norm = std::max(norm, std::abs(glm::length(sample.pose.orientation) - 1));
        stops += sample.stopped ? 1 : 0;
        const bool fine =
            std::isfinite(sample.pose.position.x + sample.pose.position.y + sample.pose.position.z) && std::isfinite(speed) &&
            std::isfinite(turning) && std::isfinite(sample.uncertainty_m) && speed <= motion.max_m_s + 1e-9 &&
            turning <= std::max(motion.turn_rad_s, motion.look_rad_s) + 1e-9 &&
            (sample.stopped || glm::length(walker - walker_before) <= motion.max_m_s / motion.brake_s * dt + 1e-9) &&
            glm::length(sample.pose.position - before.pose.position) <= motion.max_m_s * dt + 1e-6;
        if (!fine) {
            const rt::DriverScope report;
            FAIL() << "at " << i << " ms: " << speed << " m/s, " << turning << " rad/s";
        }
        before = sample;
        walker_before = walker;
    }
    const auto after = rt::guard_counters();
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const SafetyState& s = steering.safety();
    std::printf(
        "%d s, %llu reports: fastest %.2f m/s, |q| off by %.1e; %llu stops, %llu overflows, %llu silences, %llu losses; stopped "
        "%.0f %% of the time; allocations %llu; %.0f ns a report\n",
        hour_seconds, static_cast<unsigned long long>(reports), fastest, norm, static_cast<unsigned long long>(s.stops),
        static_cast<unsigned long long>(s.overflows), static_cast<unsigned long long>(s.timeouts),
        static_cast<unsigned long long>(s.losses), 100.0 * static_cast<double>(stops) / (hour_seconds * 1000.0),
        static_cast<unsigned long long>(after.own_violations - guard.own_violations), took * 1e9 / static_cast<double>(reports));
    EXPECT_EQ(after.own_violations, guard.own_violations) << "nothing may be allocated or freed";
    EXPECT_LT(norm, 1e-12);
    EXPECT_GT(fastest, 1.0) << "it must have walked";
    EXPECT_GT(s.stops, 0U);
    EXPECT_GT(s.overflows, 0U);
    EXPECT_GT(s.timeouts, 0U);
    EXPECT_GT(s.losses, 0U);
    for (const ReportDecoder& decoder : decoders) {
        const ReportCounts& c = decoder.counts();
        EXPECT_TRUE(c.accepted > 0 && c.too_short > 0 && c.too_long > 0 && c.undeclared > 0);
    }
}

}  // namespace
}  // namespace surefoot::input
