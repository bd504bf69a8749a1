// A recording made ready to steer: its device described and classed, its mapping chosen and bound. All refusals come from here.
#pragma once

#include <string>

#include "input/hid/device.hpp"
#include "input/map/mapper.hpp"
#include "input/map/steering_file.hpp"
#include "input/replay/recording.hpp"

namespace surefoot::input {

/// What a recording may span: as long as a walk.
constexpr double max_recording_s = 1e6;

struct RecordedDevice {
    std::string file;
    Recording recording;
    HidDevice device;
    Mapper mapper;
    std::string mapping;  ///< its name, or which default it is
    Reporting reporting = Reporting::learn;

    /// From the first report to the last.
    [[nodiscard]] double duration_s() const;
};

/// Reads `file` and takes the first mapping of `steering` that fits, or the default of the device's class. Errors name the file
/// and the line or byte: not a recording, no descriptor, no reports, cut off, refused descriptor, a class that does not steer,
/// reports that do not fit the descriptor, a mapping whose controls the device has not got (then `steering_name` is the place).
Result<RecordedDevice> open_recorded(const std::string& file, const SteeringFile& steering, const std::string& steering_name);

}  // namespace surefoot::input
