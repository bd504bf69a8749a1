// Checks on real HID devices, in the guest: made through uhid, and through a USB gadget.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/vm/hid_checks.hpp"

namespace surefoot::vm {

input::Recording like(const Guest& guest, const std::string& file) {
    auto recording = input::read_recording(guest.devices + "/" + file + ".hid");
    if (!recording) {
        std::fprintf(stderr, "%s\n", recording.error().text().c_str());
        std::exit(2);
    }
    return std::move(*recording);
}

std::vector<std::byte> pad_at(int x, int y, int z, int rz) {
    const auto byte = [](int value) { return static_cast<std::byte>(value); };
    return {byte(x), byte(y), byte(z), byte(rz), byte(0x08), byte(0), byte(0)};
}

std::string output_of(const std::string& command, int* status) {
    std::string text;
    std::FILE* pipe = popen((command + " 2>&1").c_str(), "re");
    if (pipe == nullptr) return text;
    std::array<char, 4096> part{};
    while (const std::size_t got = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), got);
    const int ended = pclose(pipe);
    if (status != nullptr) *status = ended;
    return text;
}

constexpr std::array<std::pair<std::string_view, void (*)(Checks&, const Guest&)>, 11> all_checks = {{
    {"enumeration", check_enumeration},
    {"permission", check_permission},
    {"hot_plug", check_hot_plug},
    {"unplug", check_unplug},
    {"stall", check_stall},
    {"two_devices", check_two_devices},
    {"recording", check_recording},
    {"evdev", check_evdev},
    {"gadget", check_gadget},
    {"cp2112", check_cp2112},
    {"walk", check_walk},
}};

}  // namespace surefoot::vm

int main(int count, char** arguments) {
    using namespace surefoot::vm;
    if (count < 2) {
        std::fprintf(stderr,
                     "usage: vm_hid FOLDER [CHECK...]   (FOLDER has surefoot, devices/, 70-surefoot.rules, model.walk; "
                     "checks.jsonl and kept/ are written there)\n");
        return 2;
    }
    const std::string folder = arguments[1];
    const Guest guest{folder + "/surefoot", folder + "/devices", folder + "/70-surefoot.rules", folder + "/model.walk",
                      folder + "/kept"};
    Checks checks("hid", folder + "/checks.jsonl");
    if (access("/dev/uhid", W_OK) != 0) {
        checks.not_run("all", "no /dev/uhid: the kernel has no uhid module");
        return 1;
    }
    const std::vector<std::string_view> only(arguments + 2, arguments + count);
    for (const auto& [name, check] : all_checks)
        if (only.empty() || std::find(only.begin(), only.end(), name) != only.end()) check(checks, guest);
    return checks.status();
}
