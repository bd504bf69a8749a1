// Built without libgpiod: every request for lines is refused with the reason, so a configured stop stays asserted.
#include "input/gpio/lines.hpp"

namespace surefoot::input {

Result<std::unique_ptr<GpioLines>> open_lines(std::span<const LineRequest> requests, std::string_view, void*) {
    const std::string place = requests.empty() ? "gpio" : requests.front().chip + " line " + requests.front().line;
    return Error{place, "This build has no libgpiod", "Install libgpiod-dev and build again", ErrorKind::unsupported};
}

std::string gpio_back_end() { return "none: built without libgpiod"; }

}  // namespace surefoot::input
