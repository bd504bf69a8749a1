// Machines for the checks of devices, picture, service and wake-up.
#include <unistd.h>

#include "tests/doctor/cases.hpp"

namespace surefoot::doctor {

namespace {

/// A group that files made by this test belong to.
FakeFile groups(const std::string& name) {
    return {"/etc/group", "root:x:0:\nnobody-here:x:4242424:\n" + name + ":x:" + std::to_string(getgid()) + ":\n"};
}

std::function<void(Probed&)> costs_of(const std::string& drawn_on, const std::string& measured_on, bool there = true,
                                      const std::string& error = "") {
    return [=](Probed& p) {
        p.renderer = RendererFound{"llvmpipe", "", "", drawn_on, true};
        p.costs = CostTableFound{"/state/costs.toml", there, error, measured_on};
    };
}

std::function<void(Probed&)> screen_of(bool counts) {
    return [=](Probed& p) { p.screens.emplace().screens = {{"DP-1", "1920x1080@60", true, counts}}; };
}

std::function<void(Probed&)> woken(int priority, double p99_us, double max_us, double steal_ms) {
    return [=](Probed& p) {
        WakeFigures f;
        f.source = "surefoot";
        f.slots = 10000;
        f.p99_us = p99_us;
        f.max_us = max_us;
        f.priority = priority;
        f.steal_ms = steal_ms;
        p.wake_up = f;
    };
}

}  // namespace

std::vector<Case> service_cases() {
    const std::string rule = "70-surefoot.rules";
    return {
        {"devices.hidraw", true, "1 node,", {groups("surefoot-input"), {"/dev/hidraw0", "", 0660}}, {}},
        {"devices.hidraw",
         false,
         "/dev/hidraw1 (mode 0600)",
         {groups("surefoot-input"), {"/dev/hidraw0", "", 0660}, {"/dev/hidraw1", "", 0600}},
         {}},
        {"devices.hidraw", false, "group surefoot-input", {groups("others"), {"/dev/hidraw0", "", 0660}}, {}},
        {"devices.gpio", true, "gpio", {groups("gpio"), {"/dev/gpiochip0", "", 0660}}, {}},
        {"devices.gpio", false, "/dev/gpiochip0", {groups("gpio"), {"/dev/gpiochip0", "", 0600}}, {}},
        {"devices.dri", true, "render or video", {groups("render"), {"/dev/dri/renderD128", "", 0660}}, {}},
        {"devices.dri", false, "renderD128 (mode 0640)", {groups("render"), {"/dev/dri/renderD128", "", 0640}}, {}},
        {"devices.group", true, "surefoot-input is", {groups("surefoot-input")}, {}},
        {"devices.group", false, "no group", {groups("others")}, {}},
        {"devices.udev_rule", true, "/etc/udev", {{"/etc/udev/rules.d/" + rule, "x\n"}}, {}},
        {"devices.udev_rule", true, "/usr/lib", {{"/etc/udev/rules.d/", ""}, {"/usr/lib/udev/rules.d/" + rule, "x\n"}}, {}},
        {"devices.udev_rule", false, "not installed", {{"/etc/udev/rules.d/", ""}}, {}},

        {"picture.renderer", true, "software", {}, costs_of("a", "a")},
        {"picture.renderer",
         false,
         "egl is absent",
         {},
         [](Probed& p) {
             p.renderer = RendererFound{"", "egl is absent", "apt install libegl1", "", false};
         }},
        {"picture.screen", true, "DP-1 (1920x1080@60) counts refreshes", {}, screen_of(true)},
        {"picture.screen", false, "DP-1 (1920x1080@60) counts no refreshes", {}, screen_of(false)},
        {"picture.cost_table", true, "on this machine", {}, costs_of("a", "a")},
        {"picture.cost_table", false, "on \"b\", this is \"a\"", {}, costs_of("a", "b")},
        {"picture.cost_table", false, "no cost table", {}, costs_of("a", "", false)},
        {"picture.cost_table", false, "is damaged", {}, costs_of("a", "", true, "is damaged")},

        {"service.systemd", true, "manages", {{"/run/systemd/system/", ""}}, {}},
        {"service.systemd", false, "'busybox'", {{"/proc/1/comm", "busybox\n"}}, {}},
        {"service.journald", true, "exists", {{"/run/systemd/journal/socket", ""}}, {}},
        {"service.journald", false, "does not exist", {{"/run/", ""}}, {}},
        {"service.journal_kept", true, "survives", {{"/var/log/journal/", ""}}, {}},
        {"service.journal_kept", false, "is lost", {{"/var/log/", ""}}, {}},
        {"service.disk", true, "2048 MiB", {}, [](Probed& p) { p.free_state_bytes = 2ULL << 30U; }},
        {"service.disk", false, "10 MiB", {}, [](Probed& p) { p.free_state_bytes = 10ULL << 20U; }},

        {"wake_up.usual", true, "p99 200", {}, woken(80, 200, 900, 0)},
        {"wake_up.usual", false, "p99 3000", {}, woken(80, 3000, 9000, 0)},
        {"wake_up.usual", false, "without SCHED_FIFO", {}, woken(0, 200, 900, 0)},
        {"wake_up.longest", true, "8.0 ms late", {}, woken(80, 200, 8000, 0)},
        {"wake_up.longest", false, "42.0 ms late", {}, woken(80, 200, 42000, 30)},
    };
}

}  // namespace surefoot::doctor
