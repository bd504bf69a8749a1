// The panel at work in a walk: its switches as Lines, its buttons and encoders as a device of the steering, its troubles said
// once.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "input/gpio/panel.hpp"
#include "input/map/mapping.hpp"
#include "input/notes.hpp"
#include "input/steering.hpp"

namespace surefoot::input {

/// What the steering file calls the panel: `[[device]] product_name = "gpio panel"` is its mapping.
constexpr std::string_view panel_name = "gpio panel";

/// The first mapping that names the panel; else each button and encoder does the action that it is named after; where none is
/// named so, the default of a box of buttons.
DeviceMapping panel_mapping(std::span<const DeviceMapping> mappings, std::span<const ControlInfo> controls);

/// The input thread's. step() neither allocates nor locks, whether the chip is there, missing, lost or found again, where its
/// lines are opened beside; what the GPIO library needs to read them is counted as the driver's. A chip that is missing is tried
/// again after 0.1 to 2 s.
class PanelDevice {
public:
    /// `lines` must have passed check_lines. `say` is told of each new trouble, and when it is over.
    PanelDevice(std::vector<LineConfig> lines, std::span<const DeviceMapping> mappings, OpenLines opener, void* context, Say say,
                Opening where);

    /// The first try, before the input thread starts.
    void open();

    struct Step {
        Lines lines;
        bool reported = false;  ///< a button or encoder moved
    };
    /// Takes lines that were opened, reads all, reports to `steering`, attaches and detaches there as the chip comes and goes.
    Step step(Steering& steering, std::int64_t now_ns) REQUIRES(steering.steers);

    [[nodiscard]] std::span<const pollfd> polled() const { return panel_.polled(); }
    [[nodiscard]] bool has_controls() const { return !panel_.controls().empty(); }
    [[nodiscard]] const std::string& mapping() const { return mapping_; }

private:
    void service(std::int64_t now_ns);
    void attach(Steering& steering) REQUIRES(steering.steers);

    GpioPanel panel_;
    Say say_;
    std::string mapping_;
    NoteLine said_;
    Mapper mapper_, spare_;  ///< one of them is in the steering once it was attached
    bool attached_once_ = false;
    int number_ = -1, known_ = -1;  ///< Steering's, now and ever
    std::uint64_t opens_ = 0, reports_ = 0;
};

}  // namespace surefoot::input
