// Opens a recording for steering: describes and classifies its device, chooses the mapping and binds it. All its errors come from
// here.
#pragma once

#include <string>

#include "input/hid/device.hpp"
#include "input/map/mapper.hpp"
#include "input/map/steering_file.hpp"
#include "input/replay/recording.hpp"

namespace surefoot::input {

/// Maximum length of a recording: that of a walk.
constexpr double max_recording_s = 1e6;

/// A recording, with its device described and mapped.
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

/// Reads `file` and takes the first matching mapping of `steering`, or the default of the device's class. Errors name the file
/// and the line or byte. Errors: not a recording, cut off, no descriptor, a refused descriptor, no reports, reports that do not
/// fit it, a class that does not steer. If the device lacks a control of the mapping, the place is `steering_name`.
Result<RecordedDevice> open_recorded(const std::string& file, const SteeringFile& steering, const std::string& steering_name);

}  // namespace surefoot::input
