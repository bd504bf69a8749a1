// Live devices and wired lines as a walk's source, in virtual time: what steers, what stops, what is said, and that none of it
// needs memory.
#include "input/live_source.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>

#include "input/devices/live.hpp"
#include "rt/clock/clock.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/placement.hpp"
#include "tests/input/fake_devices.hpp"
#include "tests/input/fake_lines.hpp"
#include "tests/input/plain_stick.hpp"

namespace surefoot::input {
namespace {

using test::at;
using test::FakeChip;
using test::FakeDevices;
using test::stick;

constexpr std::int64_t tick_ns = 2'000'000;

LineConfig line(const std::string& name, LineRole role, const std::string& place) {
    LineConfig c;
    c.name = name;
    c.role = role;
    c.request.chip = "gpiochip0";
    c.request.line = place;
    return c;
}
/// Line 0 is the stop (closed: active), 1 its reset, 2 a button, 3 and 4 an encoder.
std::vector<LineConfig> lines() {
    return {line("ESTOP", LineRole::stop, "0"), line("RESET", LineRole::stop_reset, "1"),
            line("next_viewpoint", LineRole::button, "2"), line("speed", LineRole::encoder_a, "3"),
            line("speed", LineRole::encoder_b, "4")};
}

/// The input thread's loop in virtual time. Its calls are made as that thread makes them: without memory, where that counts.
struct Rig {
    explicit Rig(std::vector<LineConfig> wired = {}, std::vector<DeviceMapping> mappings = {}) {
        chip.level[0] = true;
        auto fake = std::make_unique<FakeDevices>();
        devices = fake.get();
        devices->attachment_factory = attachment_factory(mappings);
        LiveOptions options;
        options.mappings = std::move(mappings);
        options.lines = std::move(wired);
        options.open_lines = test::open_fake;
        options.lines_context = &chip;
        options.lines_opened = Opening::same_thread;  // in virtual time
        options.stamps = 1000;
        source = std::make_unique<LiveSource>(std::move(options), std::move(fake));
        source->begin(steering, devices->now_ns);
    }
    NavigationSample tick() {
        devices->now_ns += tick_ns;
        const std::uint64_t before = rt::guard_counters().own_violations;
        {
            const rt::OwnScope own;
            steering.steers.plays();
            const Lines wired = source->drain(steering, devices->now_ns);
            sample = steering.tick(wired, devices->now_ns);
        }
        violations += rt::guard_counters().own_violations - before;
        presses += sample.next_viewpoint ? 1 : 0;
        for (MessageLine note; source->next_message(note);) messages.emplace_back(note.view());
        return sample;
    }
    void run(int ticks) {
        for (int i = 0; i < ticks; ++i) tick();
    }
    void hold(int device, int x, int y, int ticks) {
        for (int i = 0; i < ticks; ++i) {
            devices->send(device, at(x, y));
            tick();
        }
    }
    [[nodiscard]] double speed() const { return glm::length(sample.velocity_m_s); }
    [[nodiscard]] int count_messages(const std::string& what) const {
        return static_cast<int>(std::count_if(messages.begin(), messages.end(),
                                              [&](const std::string& s) { return s.find(what) != std::string::npos; }));
    }

    FakeChip chip;
    Steering steering{MotionLimits{}, SafetyLimits{}};
    FakeDevices* devices = nullptr;
    std::unique_ptr<LiveSource> source;
    NavigationSample sample;
    std::vector<std::string> messages;
    std::uint64_t violations = 0;
    int presses = 0;
};

TEST(LiveSource, ComesWalksGoesComesBackAndNeedsNoMemoryForIt) {
    Rig rig;
    for (int round = 0; round < 3; ++round) {
        const int device = rig.devices->plug(stick(), "s1");
        rig.hold(device, 0, -127, 100);
        EXPECT_EQ(rig.speed(), 0) << "deflected since it came";
        rig.hold(device, 0, 0, 20);
        rig.hold(device, 0, -127, 200);
        EXPECT_GT(rig.speed(), 0.5) << "round " << round;
        rig.devices->pull(device);
        rig.run(25);
        EXPECT_EQ(rig.speed(), 0) << "50 ms after it was pulled";
    }
    EXPECT_EQ(rig.violations, 0U);
    if (!rt::guard_active()) std::printf("allocations are not counted in this build\n");
    EXPECT_EQ(rig.source->log().count(), 960U);
    EXPECT_EQ(rig.count_messages("The device steers by the mapping \"default: joystick\""), 3);
    EXPECT_EQ(rig.count_messages("was unplugged"), 3);
    ASSERT_EQ(rig.source->devices().size(), 1U) << "one device, however often it comes";
    EXPECT_EQ(rig.source->devices()[0].name, "test stick");
    EXPECT_EQ(rig.source->devices()[0].mapping, "default: joystick");
}

TEST(LiveSource, ManyDevicesComeAndGoWithoutMemory) {
    Rig rig;
    std::vector<int> there;
    for (int i = 0; i < 300; ++i) {
        there.push_back(rig.devices->plug(stick(), "serial number " + std::to_string(i % 40)));
        rig.hold(there.back(), 0, 0, 2);
        if (there.size() == max_devices) {
            for (const int d : there) rig.devices->pull(d);
            there.clear();
            rig.tick();
        }
    }
    EXPECT_EQ(rig.violations, 0U);
    EXPECT_EQ(rig.source->devices().size(), 40U);
}

TEST(LiveSource, NobodyToSteerIsRestAndReportedOnce) {
    Rig rig;
    rig.run(2000);
    EXPECT_EQ(rig.count_messages("No connected device steers"), 1);
    EXPECT_EQ(rig.speed(), 0);
    EXPECT_EQ(rig.violations, 0U);
    Rig steered;
    const int device = steered.devices->plug(stick());
    steered.hold(device, 0, 0, 5);
    steered.devices->pull(device);
    steered.run(2000);
    EXPECT_EQ(steered.count_messages("No connected device"), 0) << "it was, and its going is said";
}

TEST(LiveSource, WhatTheDevicesHaveToDoWithoutIsReportedOnce) {
    auto fake = std::make_unique<FakeDevices>();
    fake->without = Error{"udev", "Events cannot be received", "Allow netlink sockets"};
    LiveSource source(LiveOptions{}, std::move(fake));
    Steering steering{MotionLimits{}, SafetyLimits{}};
    steering.steers.plays();
    source.begin(steering, 1'000'000'000);
    for (int i = 0; i < 100; ++i) (void)source.drain(steering, 1'000'000'000 + i * tick_ns);
    int messages = 0;
    for (MessageLine note; source.next_message(note);)
        messages += note.view().find("Events cannot be received. Allow netlink sockets.") != std::string::npos ? 1 : 0;
    EXPECT_EQ(messages, 1);
}

// A service that may open no netlink socket looks around instead; here no descriptor is left for one.
TEST(LiveDevices, KnowWhyNoEventsCome) {
#ifdef SUREFOOT_SANITIZED
    GTEST_SKIP() << "the sanitizer opens a pipe to check an object's type, and here no descriptor is left for one";
#endif
    rlimit before{};
    getrlimit(RLIMIT_NOFILE, &before);
    rlimit none = before;
    none.rlim_cur = static_cast<rlim_t>(::dup(STDERR_FILENO));
    ::close(static_cast<int>(none.rlim_cur));
    setrlimit(RLIMIT_NOFILE, &none);
    const auto blind = open_live({});
    setrlimit(RLIMIT_NOFILE, &before);
    ASSERT_TRUE(blind.ok());
    ASSERT_TRUE((*blind)->trouble().has_value());
    EXPECT_NE((*blind)->trouble()->text().find("udev"), std::string::npos);
    EXPECT_FALSE((*blind)->trouble()->remedy.empty());
}

TEST(LiveSource, AMappingThatFitsNothingIsReportedOnceAndTheOthersAreNot) {
    const auto named = [](const char* name, const char* product) {
        DeviceMapping m;
        m.name = name;
        m.match.product_name = product;
        AxisMapping forward;
        forward.control.name = "y";
        forward.action = Action::forward;
        m.axes.push_back(forward);
        return m;
    };
    DeviceMapping off = named("switched off", "Other");
    off.axes.clear();
    Rig rig({}, {named("typo", "Sitck"), off, named("ours", "")});
    rig.devices->plug(stick());
    rig.run(2000);
    EXPECT_EQ(rig.count_messages("[[device]] 1 \"typo\" matches no connected device"), 1);
    EXPECT_EQ(rig.count_messages("matches no connected device"), 1);
    EXPECT_EQ(rig.violations, 0U);
}

TEST(LiveSource, ARefusedDeviceIsReportedWithItsRemedy) {
    Rig rig;
    Error why{"/dev/hidraw7 (pad)", "The device cannot be opened: Permission denied", "Install the rules"};
    DeviceEvent e;
    e.kind = DeviceEvent::Kind::refused;
    e.why = &why;
    rig.devices->push(e);
    rig.tick();
    EXPECT_EQ(rig.count_messages("/dev/hidraw7 (pad): The device cannot be opened: Permission denied. Install the rules."), 1);
    Error endless{"place", std::string(5000, 'x'), "remedy"};
    e.why = &endless;
    rig.devices->push(e);
    rig.tick();
    EXPECT_EQ(rig.messages.back().size(), MessageLine{}.text.size()) << "cut, not overrun";
    EXPECT_EQ(rig.violations, 0U);
}

TEST(LiveSource, NotesThatNobodyTakesAreCountedAndHarmNothing) {
    Rig rig;
    for (int i = 0; i < 500; ++i) {
        const int device = rig.devices->plug(stick());
        rig.devices->pull(device);
        rig.devices->now_ns += tick_ns;
        rig.steering.steers.plays();
        (void)rig.source->drain(rig.steering, rig.devices->now_ns);
    }
    EXPECT_GT(rig.source->lost_messages(), 0U);
    int left = 0;
    for (MessageLine note; rig.source->next_message(note);) ++left;
    EXPECT_EQ(left + static_cast<int>(rig.source->lost_messages()), 1000);
}

TEST(LivePanel, ItsStopLatchesInTheSameStepAndItsResetTakesItOff) {
    Rig rig(lines());
    const int device = rig.devices->plug(stick());
    rig.hold(device, 0, 0, 10);
    rig.hold(device, 0, -127, 200);
    ASSERT_GT(rig.speed(), 0.5);
    rig.chip.set(0, false, rig.devices->now_ns + 1);  // the contact opens
    rig.devices->send(device, at(0, -127));
    EXPECT_TRUE(rig.tick().stopped);
    EXPECT_EQ(rig.speed(), 0);
    rig.chip.set(0, true, rig.devices->now_ns + 1);
    rig.hold(device, 0, -127, 100);
    rig.steering.steers.plays();
    EXPECT_TRUE(rig.steering.safety().latched) << "closed again is not reset";
    rig.chip.set(1, true, rig.devices->now_ns + 1);
    rig.hold(device, 0, -127, 10);
    EXPECT_FALSE(rig.steering.safety().latched);
    EXPECT_EQ(rig.speed(), 0) << "the stick is still pushed";
    rig.hold(device, 0, 0, 10);
    rig.hold(device, 0, -127, 200);
    EXPECT_GT(rig.speed(), 0.5);
    EXPECT_EQ(rig.violations, 0U);
}

TEST(LivePanel, ButtonsAndEncodersSteerAsADeviceOfTheirOwn) {
    Rig rig(lines());
    rig.run(20);
    EXPECT_EQ(rig.presses, 0);
    for (int i = 0; i < 3; ++i) {
        rig.chip.set(2, true, rig.devices->now_ns + 1);
        rig.run(20);
        rig.chip.set(2, false, rig.devices->now_ns + 1);
        rig.run(20);
    }
    EXPECT_EQ(rig.presses, 3) << "by its name";
    ASSERT_EQ(rig.source->devices().size(), 1U);
    EXPECT_EQ(rig.source->devices()[0].name, panel_name);
    EXPECT_EQ(rig.source->devices()[0].device_class, "buttons");
    EXPECT_GE(rig.source->log().count(), 6U) << "what the panel tells counts as reports";
    EXPECT_EQ(rig.count_messages("No connected device"), 0);
    EXPECT_EQ(rig.source->illegal_encoder_steps(), 0U);
    rig.chip.level[3] = rig.chip.level[4] = true;  // both lines of the encoder, without an edge
    rig.run(20);
    EXPECT_EQ(rig.source->illegal_encoder_steps(), 1U);
    EXPECT_EQ(rig.violations, 0U);
}

TEST(LivePanel, AVanishedChipIsAStopReportedOnceAndTheNextOneServesAgain) {
    Rig rig(lines());
    const int device = rig.devices->plug(stick());
    rig.hold(device, 0, 0, 10);
    rig.hold(device, 0, -127, 200);
    ASSERT_GT(rig.speed(), 0.5);
    rig.chip.gone = true;
    rig.devices->send(device, at(0, -127));
    EXPECT_TRUE(rig.tick().stopped);
    rig.run(3000);
    EXPECT_TRUE(rig.sample.stopped);
    EXPECT_EQ(rig.count_messages("The chip is gone"), 1);
    EXPECT_GT(rig.chip.tried, 2);
    EXPECT_LE(rig.count_messages(std::string(panel_name)), 2) << "each trouble once";
    rig.chip.gone = false;
    rig.run(1200);  // tried every 2 s by now
    EXPECT_EQ(rig.count_messages("The lines are open"), 1);
    rig.steering.steers.plays();
    EXPECT_TRUE(rig.steering.safety().latched) << "back is not reset";
    rig.chip.set(2, true, rig.devices->now_ns + 1);
    rig.chip.set(1, true, rig.devices->now_ns + 1);
    rig.run(20);
    EXPECT_FALSE(rig.steering.safety().latched);
    rig.chip.set(2, false, rig.devices->now_ns + 1);
    rig.run(20);
    rig.chip.set(2, true, rig.devices->now_ns + 1);
    rig.run(20);
    EXPECT_GE(rig.presses, 1) << "its buttons steer again";
}

TEST(LivePanel, ABusyLineIsAStopThatNamesWhoHasIt) {
    FakeChip chip;
    chip.busy_by = "gpiomon";
    std::vector<std::string> messages;
    PanelDevice panel(
        lines(), {}, test::open_fake, &chip, [&](std::string_view text) { messages.emplace_back(text); }, Opening::same_thread);
    panel.open();
    Steering steering{MotionLimits{}, SafetyLimits{}};
    steering.steers.plays();
    for (int i = 1; i < 200; ++i) EXPECT_TRUE(panel.step(steering, i * tick_ns).lines.stop);
    ASSERT_EQ(messages.size(), 1U);
    EXPECT_NE(messages[0].find("gpiomon"), std::string::npos) << messages[0];
    chip.busy_by.clear();
    chip.level[0] = true;
    bool stop = true;
    for (int i = 200; i < 2000; ++i) stop = panel.step(steering, i * tick_ns).lines.stop;
    EXPECT_FALSE(stop);
}

/// A chip that another thread opens: there or not, as the test wants it; closed while it is there.
struct SharedChip {
    std::atomic<bool> there{false};
    std::atomic<int> tried{0}, closed{0};
    std::atomic<pid_t> opened_by{0}, closed_by{0};
};
class SharedLines final : public GpioLines {
public:
    explicit SharedLines(SharedChip& chip) : chip_(chip) {}
    ~SharedLines() override {
        chip_.closed_by = rt::own_tid();
        ++chip_.closed;
    }
    [[nodiscard]] std::span<const pollfd> polled() const override { return {}; }
    Result<std::size_t> read(std::span<LineEdge>) override {
        if (chip_.there) return std::size_t{0};
        return Error{"gpiochip7 of the panel", "The chip is gone, as far as anybody can tell", "Plug it in again"};
    }
    Result<void> levels(std::span<bool> active) override {
        std::fill(active.begin(), active.end(), true);
        return {};
    }

private:
    SharedChip& chip_;
};
Result<std::unique_ptr<GpioLines>> open_shared(std::span<const LineRequest>, std::string_view, void* context) {
    auto& chip = *static_cast<SharedChip*>(context);
    chip.opened_by = rt::own_tid();
    const int tried = ++chip.tried;
    if (!chip.there) return Error{"gpiochip7 of the panel", "cannot be opened, try " + std::to_string(tried), "plug it in"};
    return std::unique_ptr<GpioLines>(std::make_unique<SharedLines>(chip));
}

/// The input thread's ticks in real time, under the guard, until something has come about; false: it has not in ten seconds.
struct GuardedTicks {
    PanelDevice& panel;
    Steering steering{MotionLimits{}, SafetyLimits{}};
    std::uint64_t violations = 0, drivers = 0;
    bool stop = true;

    template <class Done>
    bool until(const Done& done) {
        const rt::RealClock clock;
        const std::int64_t deadline_ns = clock.now_ns() + 10'000'000'000;
        while (!done() && clock.now_ns() < deadline_ns) {
            const rt::GuardCounters before = rt::guard_counters();
            {
                const rt::OwnScope own;
                steering.steers.plays();
                stop = panel.step(steering, clock.now_ns()).lines.stop;
            }
            violations += rt::guard_counters().own_violations - before.own_violations;
            drivers += rt::guard_counters().driver_allocations - before.driver_allocations;
            std::this_thread::sleep_for(std::chrono::microseconds(500));  // the tick
        }
        return done();
    }
};

TEST(LivePanel, AChipThatIsMissingOrGoesIsOpenedAndClosedBesideTheInputThread) {
    SharedChip chip;
    std::size_t times = 0;
    PanelDevice panel(
        lines(), {}, open_shared, &chip, [&](std::string_view) { ++times; }, Opening::own_thread);
    panel.open();
    EXPECT_EQ(chip.tried, 1) << "the first try is over before the input thread starts";
    EXPECT_EQ(times, 1U);
    GuardedTicks ticks{panel};
    ASSERT_TRUE(ticks.until([&] { return chip.tried >= 3; })) << "tried again by itself";
    EXPECT_TRUE(ticks.stop);
    EXPECT_EQ(ticks.violations, 0U);
    EXPECT_EQ(ticks.drivers, 0U) << "nothing is hidden as the driver's: nothing was read";
    EXPECT_NE(chip.opened_by, rt::own_tid());
    chip.there = true;
    ASSERT_TRUE(ticks.until([&] { return !ticks.stop; }));
    EXPECT_EQ(ticks.drivers, 0U);
    chip.there = false;
    ASSERT_TRUE(ticks.until([&] { return chip.closed == 1; }));
    EXPECT_TRUE(ticks.stop);
    EXPECT_NE(chip.closed_by, rt::own_tid());
    chip.there = true;
    ASSERT_TRUE(ticks.until([&] { return !ticks.stop; })) << "found again";
    EXPECT_EQ(ticks.violations, 0U);
    EXPECT_GE(times, 5U) << "missing (each new reason), there, gone, there";
}

TEST(LivePanel, TheSteeringFileNamesItsMappingElseTheLinesDo) {
    const std::vector<LineConfig> wired = lines();
    FakeChip chip;
    const GpioPanel panel(wired, test::open_fake, &chip);
    const DeviceMapping named = panel_mapping({}, panel.controls());
    ASSERT_EQ(named.buttons.size(), 1U);
    EXPECT_EQ(named.buttons[0].action, Action::next_viewpoint);
    ASSERT_EQ(named.axes.size(), 1U);
    EXPECT_EQ(named.axes[0].action, Action::speed);
    DeviceMapping any, own;
    any.name = "any device";  // empty: fits every HID device; a panel must be named
    own.name = "the panel's";
    own.match.product_name = "GPIO panel";
    EXPECT_EQ(panel_mapping(std::vector{any, own}, panel.controls()).name, "the panel's");
    EXPECT_EQ(panel_mapping(std::vector{any}, panel.controls()).name, named.name);
    auto plain = wired;
    plain[2].name = "knob";
    plain[3].name = plain[4].name = "wheel";
    const GpioPanel nameless(plain, test::open_fake, &chip);
    EXPECT_EQ(panel_mapping({}, nameless.controls()).buttons.at(0).action, Action::next_viewpoint) << "as a box of buttons";
}

TEST(HasStop, IsAStopLineOrAControlThatStops) {
    SteeringFile file;
    EXPECT_FALSE(has_stop(file));
    file.lines = {line("hand", LineRole::dead_man, "0"), line("go", LineRole::button, "1")};
    EXPECT_FALSE(has_stop(file));
    file.lines.push_back(line("ESTOP", LineRole::stop, "2"));
    EXPECT_TRUE(has_stop(file));
    file.lines.clear();
    DeviceMapping m;
    m.buttons.push_back({});
    m.buttons.back().action = Action::stop;
    file.devices.push_back(m);
    EXPECT_TRUE(has_stop(file));
}

}  // namespace
}  // namespace surefoot::input
