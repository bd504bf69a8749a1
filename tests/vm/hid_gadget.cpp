// A USB device of the kernel's own (dummy_hcd and f_hid): the real usbhid path, with a cable that can be pulled.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "rt/base/random.hpp"
#include "tests/vm/hang_up.hpp"
#include "tests/vm/hid_checks.hpp"
#include "tests/vm/walker.hpp"

namespace surefoot::vm {

namespace {

/// Made through configfs; gone when destroyed.
class Gadget {
public:
    explicit Gadget(const input::Recording& like) : controller_(controller()) {
        const std::string function = root + "/functions/hid.0", strings = root + "/strings/0x409";
        std::error_code problem;
        std::filesystem::create_directories(strings, problem);
        std::filesystem::create_directories(function, problem);
        std::filesystem::create_directories(root + "/configs/c.1", problem);
        made_ = !controller_.empty() && put(root + "/idVendor", "0x1d50") && put(root + "/idProduct", "0x8100") &&
                put(strings + "/product", like.name + " gadget") && put(strings + "/serialnumber", "vm-gadget-1") &&
                put(function + "/protocol", "0") && put(function + "/subclass", "0") && put(function + "/report_length", "7") &&
                put(function + "/report_desc", {reinterpret_cast<const char*>(like.descriptor.data()), like.descriptor.size()});
        std::filesystem::create_symlink(function, root + "/configs/c.1/hid.0", problem);
        made_ = made_ && !problem;
    }
    ~Gadget() {
        if (fd_ >= 0) ::close(fd_);
        if (plugged_) pull();
        std::error_code problem;
        std::filesystem::remove(root + "/configs/c.1/hid.0", problem);
        for (const char* part : {"/configs/c.1", "/functions/hid.0", "/strings/0x409", ""}) ::rmdir((root + part).c_str());
    }
    Gadget(const Gadget&) = delete;
    Gadget& operator=(const Gadget&) = delete;

    [[nodiscard]] bool made() const { return made_; }
    bool plug() {
        plugged_ = put(root + "/UDC", controller_);
        if (fd_ < 0 && wait_for_file("/dev/hidg0", 2000)) fd_ = ::open("/dev/hidg0", O_RDWR | O_CLOEXEC | O_NONBLOCK);
        return plugged_ && fd_ >= 0;
    }
    void pull() { plugged_ = !put(root + "/UDC", "\n") && plugged_; }
    bool send(std::span<const std::byte> report) const {
        return ::write(fd_, report.data(), report.size()) == static_cast<ssize_t>(report.size());
    }

private:
    static std::string controller() {
        std::error_code problem;
        for (const auto& entry : std::filesystem::directory_iterator("/sys/class/udc", problem))
            return entry.path().filename().string();
        return {};
    }
    inline static const std::string root = "/sys/kernel/config/usb_gadget/surefoot";
    std::string controller_;
    int fd_ = -1;
    bool made_ = false, plugged_ = false;
};

}  // namespace

void check_gadget(Checks& checks, const Guest& guest) {
    if (!std::filesystem::exists("/sys/kernel/config/usb_gadget") || std::filesystem::is_empty("/sys/class/udc")) {
        checks.not_run("usb_gadget", "this kernel has no dummy_hcd or no f_hid");
        return;
    }
    Gadget gadget(like(guest, "f310-like"));
    if (!gadget.made() || !gadget.plug()) {
        checks.check("usb_gadget", false, "the gadget could not be made: see the guest's log");
        return;
    }
    sleep_ms(1000);
    const auto list = nlohmann::json::parse(output_of(guest.tool + " devices list --json 2>/dev/null"), nullptr, false);
    int found = 0;
    if (!list.is_discarded())
        for (const auto& d : list["devices"])
            found += d.value("vid_pid", "") == "1d50:8100" || d.dump().find("gadget") != std::string::npos ? 1 : 0;
    checks.check("usb_gadget.one_device", found == 1, fmt::format("{} listed", found));
    Walker walker;
    Random random(5);
    std::vector<double> rest;
    int moved = 0, late = 0, stood_still = 0;
    constexpr int times = 20;
    for (int i = 0; i < times; ++i) {
        if (i > 0) gadget.plug();
        if (!walker.until([&] { return walker.source->devices() == 1; }, 10'000)) break;
        if (walker.router.steering_now() == 0) break;
        const HangUp hang_up(walker.node.substr(5));  // without "/dev/"
        const auto report = pad_at(static_cast<int>(random.below(70)), static_cast<int>(random.below(70)));
        // Until it moves: emulated, a report's way through the USB stack takes its time, and before neutral has been seen nothing
        // moves.
        for (int tries = 0; tries < 10 && walker.speed() <= 0.01; ++tries) {
            walker.hold([&] { gadget.send(pad_at(128, 128)); }, 60 + 60 * tries);
            walker.hold([&] { gadget.send(report); }, 150);
        }
        moved += walker.speed() > 0.01 ? 1 : 0;
        walker.longest_gap_ns = 0;
        std::thread cable([&] { gadget.pull(); });
        // Silence alone brings rest too, by the age limit; what counts is the time after the node hung up.
        const bool rested = walker.until([&] { return walker.speed() == 0 && walker.source->devices() == 0; }, 5000);
        const std::int64_t rest_ns = now_ns();
        cable.join();
        for (const std::int64_t from = now_ns(); hang_up.at_ns() == 0 && ms_since(from) < 1000;)
            sleep_ms(1);  // the other reader's turn
        if (!rested || hang_up.at_ns() == 0) continue;
        rest.push_back(std::max(0.0, static_cast<double>(rest_ns - hang_up.at_ns()) * 1e-6));
        if (rest.back() <= 50) continue;
        if (walker.longest_gap_ns > 10'000'000)
            ++stood_still;  // the host did not run the loop
        else
            ++late;
    }
    const double latest = rest.empty() ? -1 : *std::max_element(rest.begin(), rest.end());
    checks.check(
        "usb_gadget.cable_pulled", rest.size() == times && moved == times && late == 0 && stood_still <= times / 2,
        fmt::format("{} of {} at rest, {} were moving; at most {:.1f} ms after the hang-up (at most 50; {} later, and {} more "
                    "where the host held the loop for over 10 ms)",
                    rest.size(), times, moved, latest, late, stood_still));
}

}  // namespace surefoot::vm
