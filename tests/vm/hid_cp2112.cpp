// A gpiochip that can be unplugged: a CP2112 bridge, played through uhid to the kernel's own hid-cp2112. A stop wired to it stops
// the walk when the bridge is pulled. The driver polls every 40 ms, so it shows hot-plug and nothing about time.
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <filesystem>

#include "input/gpio/panel.hpp"
#include "tests/vm/hid_checks.hpp"
#include "tests/vm/uhid.hpp"

namespace surefoot::vm {

namespace {

// Source: hid-cp2112.c. Reports: 2 GPIO configuration, 3 levels, 4 set levels, 5 version, 6 SMBus configuration.
Features bridge(const std::atomic<std::uint8_t>& levels) {
    const auto bytes = [](std::initializer_list<int> values) {
        std::vector<std::byte> out;
        for (const int v : values) out.push_back(static_cast<std::byte>(v));
        return out;
    };
    Features features;
    features.get = [bytes, &levels](std::uint8_t id) -> std::optional<std::vector<std::byte>> {
        switch (id) {
            case 2:
                return bytes({2, 0, 0, 0, 0});
            case 3:
                return bytes({3, levels.load()});
            case 5:
                return bytes({5, 0x0c, 2});
            case 6:
                return bytes({6, 0, 1, 0x86, 0xa0, 2, 0, 0, 0, 0, 0, 0, 0, 0});
            default:
                return std::nullopt;
        }
    };
    features.set = [](std::uint8_t id, std::span<const std::byte>) { return id == 2 || id == 4 || id == 6; };
    return features;
}

input::Recording bridge_device() {
    input::Recording r;
    for (const int b : {0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x85, 0x13, 0x15, 0x00, 0x26,
                        0xff, 0x00, 0x75, 0x08, 0x95, 0x3f, 0x09, 0x01, 0x81, 0x02, 0xc0})
        r.descriptor.push_back(static_cast<std::byte>(b));
    r.name = "CP2112 HID USB-to-SMBus bridge";
    r.bus = 3;
    r.vendor = 0x10c4;
    r.product = 0xea90;
    return r;
}

}  // namespace

void check_cp2112(Checks& checks, const Guest&) {
    if (!std::filesystem::exists("/sys/module/hid_cp2112")) return checks.not_run("cp2112", "this kernel has no hid-cp2112");
    std::atomic<std::uint8_t> levels{0xff};
    auto device = std::make_unique<UhidDevice>(bridge_device(), "cp2112", bridge(levels));
    input::LineConfig stop;
    stop.name = "stop";
    stop.role = input::LineRole::stop;
    stop.request.chip = "cp2112_gpio";
    stop.request.line = "0";
    input::GpioPanel panel({stop}, input::open_lines, nullptr);
    const auto until = [&](auto so, int within_ms) {
        for (const std::int64_t from = now_ns(); ms_since(from) < within_ms; sleep_ms(1)) {
            panel.service(now_ns());
            if (so()) return ms_since(from);
        }
        return -1.0;
    };
    const double opened = until([&] { return panel.open(); }, 10'000);
    if (opened < 0) return static_cast<void>(checks.check("cp2112", false, "no chip: " + std::string(panel.problem())));
    (void)panel.take_lines();
    sleep_ms(200);
    panel.service(now_ns());
    (void)panel.take_lines();  // the driver's first poll tells a rising edge that never was
    sleep_ms(100);
    panel.service(now_ns());
    const bool closed = !panel.take_lines().stop;
    levels = 0xfe;
    const double asserted = until([&] { return panel.take_lines().stop; }, 2000);
    levels = 0xff;
    until([&] { return !panel.take_lines().stop; }, 2000);
    std::thread cable([&] { device->unplug(); });
    const double pulled = until([&] { return panel.take_lines().stop; }, 5000);
    const bool gone = until([&] { return !panel.open(); }, 5000) >= 0;
    cable.join();
    const std::string problem(panel.problem());
    device = std::make_unique<UhidDevice>(bridge_device(), "cp2112", bridge(levels));
    const double back = until([&] { return panel.open(); }, 10'000);
    checks.check("cp2112", closed && asserted >= 0 && pulled >= 0 && gone && back >= 0,
                 fmt::format("{}, opened contact stops, bridge pulled stops ({}: \"{}\"), there again after {:.0f} ms",
                             closed ? "closed" : "NOT closed", gone ? "told" : "NOT told", problem, back));
}

}  // namespace surefoot::vm
