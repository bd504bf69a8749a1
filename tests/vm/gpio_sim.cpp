// gpio-sim through configfs. Source: Documentation/admin-guide/gpio/gpio-sim.rst of the kernel.
#include "tests/vm/gpio_sim.hpp"

#include <unistd.h>

#include <filesystem>

#include "tests/vm/checks.hpp"

namespace surefoot::vm {

SimulatedChip::SimulatedChip(const std::string& label, std::vector<std::string> names)
    : folder_("/sys/kernel/config/gpio-sim/" + label), names_(std::move(names)) {
    std::error_code problem;
    std::filesystem::create_directory(folder_, problem);
    std::filesystem::create_directory(folder_ + "/bank", problem);
    made_ = !problem && put(folder_ + "/bank/num_lines", std::to_string(names_.size())) && put(folder_ + "/bank/label", label);
    for (std::size_t i = 0; i < names_.size(); ++i) {
        const std::string line = folder_ + "/bank/line" + std::to_string(i);
        std::filesystem::create_directory(line, problem);
        made_ = made_ && put(line + "/name", names_[i]);
    }
    made_ = made_ && bring();
}

SimulatedChip::~SimulatedChip() {
    remove();
    for (std::size_t i = 0; i < names_.size(); ++i) ::rmdir((folder_ + "/bank/line" + std::to_string(i)).c_str());
    ::rmdir((folder_ + "/bank").c_str());
    ::rmdir(folder_.c_str());
}

bool SimulatedChip::remove() { return put(folder_ + "/live", "0"); }

bool SimulatedChip::bring() {
    if (!put(folder_ + "/live", "1")) return false;
    chip_ = get(folder_ + "/bank/chip_name");
    sysfs_ = "/sys/devices/platform/" + get(folder_ + "/dev_name") + "/" + chip_;
    return wait_for_file("/dev/" + chip_, 2000);
}

bool SimulatedChip::pull(std::size_t line, bool high) {
    return put(sysfs_ + "/sim_gpio" + std::to_string(line) + "/pull", high ? "pull-up" : "pull-down");
}

}  // namespace surefoot::vm
