// A real gpiochip made through gpio-sim's configfs; its lines are pulled through sysfs.
#pragma once

#include <string>
#include <vector>

namespace surefoot::vm {

class SimulatedChip {
public:
    /// There when it is made. Lines have these names; the chip has the label.
    SimulatedChip(const std::string& label, std::vector<std::string> names);
    ~SimulatedChip();
    SimulatedChip(const SimulatedChip&) = delete;
    SimulatedChip& operator=(const SimulatedChip&) = delete;

    /// As a chip that is unplugged, and plugged again.
    bool remove();
    bool bring();
    [[nodiscard]] bool made() const { return made_; }
    bool pull(std::size_t line, bool high);
    [[nodiscard]] const std::string& chip() const { return chip_; }  ///< "gpiochip1"

private:
    std::string folder_, chip_, sysfs_;
    std::vector<std::string> names_;
    bool made_ = false;
};

}  // namespace surefoot::vm
