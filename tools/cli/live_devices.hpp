// What the commands on live devices share: which device is meant, devices as words and JSON, and their newest values.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "input/devices/live.hpp"
#include "input/hid/decoder.hpp"

namespace surefoot::cli {

using DevicePointer = std::shared_ptr<const input::PluggedDevice>;

/// Whether `text` means this device: "/dev/hidraw0", "hidraw0", "046d:c626", or a part of its name in letters of either case.
bool means(const std::string& text, const input::PluggedDevice& device);

/// "/dev/hidraw0  046d:c626  3Dconnexion SpaceNavigator"
std::string device_line(const input::PluggedDevice& device);
nlohmann::ordered_json device_json(const input::PluggedDevice& device);

/// Every device that is plugged in, those that are malformed or do not steer included; none is opened.
Result<std::vector<input::Discovery>> plugged_devices();
/// The one that `text` means; else an error that names those that are there.
Result<DevicePointer> one_device(const std::string& text);

/// Opens what `text` means, all that steer where it is empty.
Result<std::unique_ptr<input::LiveDevices>> open_devices(const std::string& text);

/// Newest values of the open devices.
class LiveStates {
public:
    struct Device {
        explicit Device(DevicePointer p) : plugged(std::move(p)), decoder(plugged->device) {}
        DevicePointer plugged;
        input::ReportDecoder decoder;
        input::DeviceState state;
        std::int64_t first_ns = 0;
        bool changed = false;  ///< since the caller set it false
    };
    /// The device that the event is of, or null (refused).
    Device* take(const input::DeviceEvent& event);
    [[nodiscard]] std::map<int, std::unique_ptr<Device>>& devices() { return devices_; }

private:
    std::map<int, std::unique_ptr<Device>> devices_;
};

/// So many seconds from now, never where seconds is 0; nanoseconds of CLOCK_MONOTONIC.
std::int64_t end_after(double seconds);

}  // namespace surefoot::cli
