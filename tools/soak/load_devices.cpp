// A storm of input: eight pads that report a thousand times a second, read, decoded, mapped and steered by the input room itself
// on a thread at the input thread's priority. It steers nothing that is seen: blocks of a control must be of the same walk.
#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "input/replay/recorded_device.hpp"
#include "input/replay/replay_source.hpp"
#include "input/steering.hpp"
#include "rt/base/file.hpp"
#include "rt/base/random.hpp"
#include "rt/clock/clock.hpp"
#include "rt/threads/placement.hpp"
#include "tools/soak/load_board.hpp"

namespace surefoot::soak {

namespace {

constexpr int storm_devices = 8;
constexpr std::int64_t report_every_us = 1000;
constexpr std::size_t storm_reports = 2000;  // a device, then it is pulled and comes back

/// Two sticks and eight buttons that no hand could move so: every report is a new place.
input::Recording wild_pad(std::uint64_t seed) {
    static constexpr unsigned char descriptor[] = {0x05, 0x01, 0x09, 0x05, 0xa1, 0x01,  // Generic Desktop, Game Pad, application
                                                   0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08, 0x95, 0x04,  // four bytes, 0..255
                                                   0x09, 0x30, 0x09, 0x31, 0x09, 0x32, 0x09, 0x35, 0x81, 0x02,  // X, Y, Z, Rz
                                                   0x05, 0x09, 0x19, 0x01, 0x29, 0x08, 0x25, 0x01, 0x75, 0x01,
                                                   0x95, 0x08, 0x81, 0x02,  // eight buttons
                                                   0xc0};
    input::Recording pad;
    for (const unsigned char byte : descriptor) pad.descriptor.push_back(static_cast<std::byte>(byte));
    pad.name = "storm";
    pad.place = "soak";
    pad.bus = 3;
    pad.vendor = 0x1d50;
    pad.product = 0x9002;
    Random random(seed);
    for (std::size_t i = 0; i < storm_reports; ++i) {
        std::byte report[5];
        for (std::byte& b : report) b = static_cast<std::byte>(random.below(256));
        pad.add(static_cast<std::int64_t>(i) * report_every_us, report);
    }
    return pad;
}

/// Through a file, as recordings come: parsed, described, classed, mapped. Empty where it could not be made.
std::vector<std::unique_ptr<input::ReplaySource>> open_storm(const LoadSettings& settings, std::uint64_t seed) {
    std::vector<std::unique_ptr<input::ReplaySource>> sources;
    std::string file = settings.folder + "/surefoot-storm-XXXXXX";
    const int fd = mkstemp(file.data());
    if (fd < 0) return sources;
    close(fd);
    if (write_text(file, input::write_recording(wild_pad(seed)))) {
        for (int i = 0; i < storm_devices; ++i) {
            if (auto opened = input::open_recorded(file, {}, ""))
                sources.push_back(std::make_unique<input::ReplaySource>(std::move(*opened)));
        }
    }
    unlink(file.c_str());
    return sources;
}

}  // namespace

void run_device_storm(LoadBoard& board, const LoadSettings& settings) {
    LoadCounters& c = board.of(LoadKind::devices);
    const rt::Placement as_input{.policy = rt::Policy::fifo, .priority = settings.input_priority, .cpus = {}, .name = "sf-load"};
    (void)rt::place_thread(0, as_input);  // refused: the storm comes all the same, less punctually
    rt::RealClock clock;
    for (std::uint64_t round = 1; !board.stop.load(); ++round) {
        auto sources = open_storm(settings, round);
        if (sources.empty()) {
            ++c.failures;
            std::this_thread::sleep_for(std::chrono::milliseconds(200));
            continue;
        }
        input::Steering steering({}, {});
        steering.steers.plays();
        const std::int64_t began_ns = clock.now_ns();
        for (auto& source : sources) source->begin(steering, began_ns);
        std::uint64_t counted = 0;
        for (std::size_t ms = 0; ms < storm_reports && !board.stop.load(); ++ms) {
            clock.sleep_until_ns(began_ns + static_cast<std::int64_t>(ms) * report_every_us * 1000);
            const std::int64_t now_ns = clock.now_ns();
            input::Lines lines;
            for (auto& source : sources) lines = source->drain(steering, now_ns);
            (void)steering.tick(lines, now_ns);
            std::uint64_t accepted = 0;
            for (const auto& source : sources) accepted += source->log().count();
            c.amount += accepted - counted;
            c.evidence += sources.size();
            counted = accepted;
        }
    }
}

}  // namespace surefoot::soak
