// Reports: recorded and replayed bit for bit, and decoded to the values that the kernel itself makes of them.
#include <fcntl.h>
#include <fmt/format.h>
#include <linux/input.h>
#include <signal.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <map>

#include "input/hid/decoder.hpp"
#include "rt/base/random.hpp"
#include "tests/vm/hid_checks.hpp"
#include "tests/vm/uhid.hpp"

namespace surefoot::vm {

namespace {

using Report = std::vector<std::byte>;

/// What `surefoot devices record` writes while `reports` are sent, one a millisecond.
Result<input::Recording> recorded(const Guest& guest, const std::vector<Report>& reports, const std::string& name,
                                  bool& took_all) {
    UhidDevice device(like(guest, "f310-like"), name);
    const std::string node = device.node(), file = guest.keep + "/" + name + ".hid";
    sleep_ms(300);
    std::FILE* tool =
        popen(fmt::format("timeout 60 {} devices record {} -o {} --seconds 50 2>&1", guest.tool, node, file).c_str(), "re");
    if (tool == nullptr) return Error{guest.tool, "cannot be started", {}};
    std::array<char, 512> line{};
    while (std::fgets(line.data(), static_cast<int>(line.size()), tool) != nullptr)
        if (std::string_view(line.data()).find("are recorded to") != std::string_view::npos) break;
    took_all = true;
    for (const Report& r : reports) {
        took_all = device.send(r) && took_all;
        sleep_ms(1);
    }
    sleep_ms(200);
    device.unplug();  // ends the recording
    pclose(tool);
    return input::read_recording(file);
}

std::size_t differences(const input::Recording& got, const std::vector<Report>& sent) {
    std::size_t n = got.reports.size() > sent.size() ? got.reports.size() - sent.size() : sent.size() - got.reports.size();
    for (std::size_t i = 0; i < std::min(got.reports.size(), sent.size()); ++i) {
        const auto r = got.report(i);
        n += std::equal(r.begin(), r.end(), sent[i].begin(), sent[i].end()) ? 0 : 1;
    }
    return n;
}

/// The kernel's event device of the same HID device; -1: it has none.
int open_evdev(const std::string& hidraw) {
    std::error_code problem;
    for (const auto& input : std::filesystem::directory_iterator("/sys/class/hidraw/" + hidraw + "/device/input", problem))
        for (const auto& event : std::filesystem::directory_iterator(input.path(), problem))
            if (event.path().filename().string().starts_with("event")) {
                const std::string node = "/dev/input/" + event.path().filename().string();
                if (wait_for_file(node, 1000)) return ::open(node.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
            }
    return -1;
}

/// The kernel takes small movements for noise and hides them; here every value counts.
void without_fuzz(int fd) {
    for (unsigned code = 0; code < ABS_CNT; ++code) {
        input_absinfo info{};
        if (ioctl(fd, EVIOCGABS(code), &info) != 0 || info.maximum == info.minimum) continue;
        info.fuzz = info.flat = 0;
        (void)ioctl(fd, EVIOCSABS(code), &info);
    }
}

using Values = std::map<std::pair<unsigned, unsigned>, int>;  // by type and code

void read_events(int fd, Values& values) {
    input_event e{};
    while (::read(fd, &e, sizeof e) == static_cast<ssize_t>(sizeof e))
        if (e.type == EV_ABS || e.type == EV_KEY) values[{e.type, e.code}] = e.value;
}

/// The same values as our decoder has them. Source: hid-input.c, hidinput_configure_usage and hidinput_hid_event.
Values as_events(const input::HidDevice& device, const input::DeviceState& state, unsigned first_button) {
    static constexpr std::array<std::array<int, 2>, 8> hat = {
        {{0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}}};
    Values values;
    for (std::size_t i = 0; i < device.controls.size(); ++i) {
        const auto& c = device.controls[i];
        if (c.kind == input::ControlKind::button && c.usage_page == 9)
            values[{EV_KEY, first_button + c.usage - 1U}] = state.value[i];
        else if (c.kind == input::ControlKind::hat) {
            const std::array<int, 2> at =
                state.has_value.test(i) ? hat[static_cast<std::size_t>(state.value[i] & 7)] : std::array<int, 2>{};
            values[{EV_ABS, ABS_HAT0X}] = at[0];
            values[{EV_ABS, ABS_HAT0Y}] = at[1];
        } else if (c.kind == input::ControlKind::axis && c.usage_page == 1 && c.usage >= 0x30 && c.usage <= 0x38 && !c.relative)
            values[{EV_ABS, c.usage - 0x30U}] = state.value[i];
    }
    return values;
}

void compare(Checks& checks, const Guest& guest, const std::string& name, unsigned first_button) {
    const auto recording = like(guest, name);
    UhidDevice plugged(recording, "evdev-" + name);
    const std::string node = plugged.node();
    sleep_ms(300);
    const int fd = open_evdev(node);
    auto layout = input::read_descriptor(recording.descriptor, name);
    if (fd < 0 || !layout) {
        checks.check("evdev." + name, false, fd < 0 ? "the kernel made no event device" : layout.error().text());
        return;
    }
    without_fuzz(fd);
    const auto device = input::describe_device(std::move(*layout), {recording.vendor, recording.product, recording.name});
    input::ReportDecoder decoder(device);
    input::DeviceState state;
    Values kernel;
    Random random(7);
    std::uint64_t compared = 0, different = 0, refused = 0;
    std::string first;
    const std::uint32_t bytes = decoder.expected_bytes(0);
    for (int i = 0; i < 2000; ++i) {
        Report report(bytes);
        for (std::byte& b : report) b = static_cast<std::byte>(random.below(256));
        plugged.send(report);
        if (decoder.decode(report, now_ns(), state) != input::ReportFate::accepted) ++refused;
        read_events(fd, kernel);
        for (const auto& [at, value] : as_events(device, state, first_button)) {
            const auto reported = kernel.find(at);
            const int theirs = reported == kernel.end() ? 0 : reported->second;  // without an event it is where it began
            ++compared;
            if (theirs == value) continue;
            if (different++ == 0)
                first =
                    fmt::format("; first: report {}, type {} code {}: kernel {}, ours {}", i, at.first, at.second, theirs, value);
        }
    }
    ::close(fd);
    checks.check(
        "evdev." + name, different == 0 && compared > 10'000 && refused == 0,
        fmt::format("2000 random reports of {} bytes: {} values compared, {} differ{}", bytes, compared, different, first));
}

}  // namespace

void check_recording(Checks& checks, const Guest& guest) {
    std::vector<Report> reports;
    Random random(3);
    for (int i = 0; i < 1500; ++i) {
        Report r(7);
        for (std::byte& b : r) b = static_cast<std::byte>(random.below(256));
        reports.push_back(r);
    }
    bool sent = false;
    const auto first = recorded(guest, reports, "recorded", sent);
    if (!first) {
        checks.check("recording", false, first.error().text());
        return;
    }
    const std::size_t wrong = differences(*first, reports);
    checks.check("recording", sent && wrong == 0 && first->descriptor == like(guest, "f310-like").descriptor,
                 fmt::format("{} random reports at 1 kHz, {} recorded, {} differ", reports.size(), first->reports.size(), wrong));
    std::vector<Report> again;
    for (std::size_t i = 0; i < first->reports.size(); ++i) again.emplace_back(first->report(i).begin(), first->report(i).end());
    const auto second = recorded(guest, again, "replayed", sent);
    const std::size_t wrong_again = second ? differences(*second, reports) : reports.size();
    checks.check("replay", sent && wrong_again == 0,
                 fmt::format("the recording sent through the kernel and recorded again: {} differ", wrong_again));
}

void check_evdev(Checks& checks, const Guest& guest) {
    compare(checks, guest, "f310-like", BTN_JOYSTICK);
    compare(checks, guest, "stick-14-bit", BTN_JOYSTICK);
}

}  // namespace surefoot::vm
