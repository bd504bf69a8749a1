// The checks on HID devices, a function each; hid_main.cpp runs them in order.
#pragma once

#include <string>

#include "input/replay/recording.hpp"
#include "tests/vm/checks.hpp"

namespace surefoot::vm {

/// Where the guest has what the checks need.
struct Guest {
    std::string tool;     ///< the shipped binary
    std::string devices;  ///< folder of tests/input/devices
    std::string rules;    ///< systemd/70-surefoot.rules
    std::string model;    ///< a baked model; may be absent
    std::string keep;     ///< folder whose content comes back
};

void check_enumeration(Checks& checks, const Guest& guest);
void check_permission(Checks& checks, const Guest& guest);
void check_hot_plug(Checks& checks, const Guest& guest);
void check_unplug(Checks& checks, const Guest& guest);
void check_stall(Checks& checks, const Guest& guest);
void check_two_devices(Checks& checks, const Guest& guest);
void check_recording(Checks& checks, const Guest& guest);
void check_evdev(Checks& checks, const Guest& guest);
void check_gadget(Checks& checks, const Guest& guest);
void check_cp2112(Checks& checks, const Guest& guest);
void check_walk(Checks& checks, const Guest& guest);

/// A device of tests/input/devices, under neutral ids; ends the program where it is not there.
input::Recording like(const Guest& guest, const std::string& file);
/// Its reports: x, y, z, rz (128: centre), hat at its centre, no button. f310-like.
std::vector<std::byte> pad_at(int x, int y, int z = 128, int rz = 128);
/// Both outputs of a command; `status` its exit status.
std::string output_of(const std::string& command, int* status = nullptr);

}  // namespace surefoot::vm
