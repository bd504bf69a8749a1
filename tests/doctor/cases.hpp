// For each check machines that pass and machines that fail; the frame core is 1.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/doctor/fake_root.hpp"
#include "tools/doctor/machine.hpp"

namespace surefoot::doctor {

struct Case {
    std::string check;
    bool passes = false;
    std::string evidence;  ///< a part of it
    FakeFiles files;
    std::function<void(Probed&)> probed;  ///< may be empty
};

std::vector<Case> scheduling_cases();  // kernel, cores, interrupts
std::vector<Case> machine_cases();     // power, time, limits, memory
std::vector<Case> service_cases();     // devices, picture, service, wake_up

}  // namespace surefoot::doctor
