// The panel in a walk: its switches as Lines, its buttons and encoders as a device of the steering. Logs each problem once.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "input/gpio/panel.hpp"
#include "input/map/mapping.hpp"
#include "input/messages.hpp"
#include "input/steering.hpp"

namespace surefoot::input {

/// Name of the panel in the steering file: its mapping is `[[device]] product_name = "gpio panel"`.
constexpr std::string_view panel_name = "gpio panel";

/// The first mapping that names the panel. Else each button and encoder does the action with its name. If none has such a name:
/// the default of a button box.
DeviceMapping panel_mapping(std::span<const DeviceMapping> mappings, std::span<const ControlInfo> controls);

/// Belongs to the input thread. With Opening::own_thread, step() neither allocates nor locks, also while the chip comes and
/// goes. Allocations of the GPIO library count as the driver's. A missing chip is tried again after 0.1 to 2 s.
class PanelDevice {
public:
    /// `lines` must have passed check_lines. `sink` gets a message for each new problem, and when it is over.
    PanelDevice(std::vector<LineConfig> lines, std::span<const DeviceMapping> mappings, OpenLines opener, void* context,
                MessageSink sink, Opening where);

    /// The first try, before the input thread starts.
    void open();

    /// Result of one service of the panel.
    struct Step {
        Lines lines;
        bool reported = false;  ///< a button or encoder moved
    };
    /// Takes opened lines, reads them, and reports to `steering`. Attaches and detaches there as the chip comes and goes.
    Step step(Steering& steering, std::int64_t now_ns) REQUIRES(steering.steers);

    [[nodiscard]] std::span<const pollfd> polled() const { return panel_.polled(); }
    [[nodiscard]] bool has_controls() const { return !panel_.controls().empty(); }
    [[nodiscard]] const std::string& mapping() const { return mapping_; }
    [[nodiscard]] std::uint64_t illegal_encoder_steps() const { return panel_.illegal_encoder_steps(); }

private:
    void service(std::int64_t now_ns);
    void attach(Steering& steering) REQUIRES(steering.steers);

    GpioPanel panel_;
    MessageSink sink_;
    std::string mapping_;
    MessageLine last_problem_;
    Mapper mapper_, spare_;  ///< after the first attach, the steering holds one of them
    bool attached_once_ = false;
    int number_ = -1, known_ = -1;  ///< the number in Steering: now (-1: not attached), and at the last attach
    std::uint64_t opens_ = 0, reports_ = 0;
};

}  // namespace surefoot::input
