// Between live devices and the steering: gives each device its mapping, decodes its reports, and passes on what comes and goes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "input/devices/finder.hpp"
#include "input/devices/source.hpp"
#include "input/hid/decoder.hpp"
#include "input/map/mapping.hpp"
#include "input/steering.hpp"

namespace surefoot::input {

/// Devices that a mapping names, whatever they are, and those that steer by their class.
Wanted wanted_by(std::vector<DeviceMapping> mappings);
/// For find_mapping().
DeviceIdentity identity_for_mapping(const PluggedDevice& device);

/// The input thread's; attend() does not allocate while no device comes or goes.
class Attendant {
public:
    using Say = std::function<void(const std::string&)>;
    /// `say` is told, once each: devices that come, go or are refused, and controls of a mapping that a device has not got.
    Attendant(std::vector<DeviceMapping> mappings, Steering& steering, Say say = {});

    void attend(const DeviceEvent& event);
    void attend(std::span<const DeviceEvent> events) {
        for (const DeviceEvent& e : events) attend(e);
    }

    struct Attended {
        int device = -1;    ///< the source's number
        int steering = -1;  ///< Steering's
        std::string mapping;
        std::shared_ptr<const PluggedDevice> plugged;
    };
    [[nodiscard]] std::vector<Attended> attended() const;
    /// Short, long and undeclared reports: they changed nothing.
    [[nodiscard]] std::uint64_t refused_reports() const { return refused_reports_; }
    [[nodiscard]] std::uint64_t accepted_reports() const { return accepted_reports_; }

private:
    struct Device {
        explicit Device(const HidDevice& d) : decoder(d) {}
        Attended attended;
        ReportDecoder decoder;
        DeviceState state;
    };
    void added(const DeviceEvent& event);
    void removed(const DeviceEvent& event);
    [[nodiscard]] Device* find(int device);
    void say(const std::string& text) const {
        if (say_) say_(text);
    }

    std::vector<DeviceMapping> mappings_;
    Steering& steering_;
    Say say_;
    std::vector<std::unique_ptr<Device>> devices_;
    std::map<std::string, int> numbers_;  ///< Steering's numbers by identity: a device that comes back gets its own
    std::uint64_t refused_reports_ = 0, accepted_reports_ = 0;
};

}  // namespace surefoot::input
