// Between live devices and the steering: gives each device its mapping, decodes its reports, and passes on what comes and goes.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "input/devices/finder.hpp"
#include "input/devices/source.hpp"
#include "input/hid/decoder.hpp"
#include "input/map/mapping.hpp"
#include "input/notes.hpp"
#include "input/report_source.hpp"
#include "input/steering.hpp"

namespace surefoot::input {

/// Devices that a mapping names, whatever they are, and those that steer by their class.
Wanted wanted_by(std::vector<DeviceMapping> mappings);
/// For find_mapping().
DeviceIdentity identity_for_mapping(const PluggedDevice& device);

/// One that steered at some time.
struct MetDevice {
    std::string identity;
    rt::SteeringDevice words;
};

/// A device as the attendant takes it: everything that needs memory.
struct ReadyDevice final : Readied {
    explicit ReadyDevice(const HidDevice& device) : decoder(device) {}
    Mapper mapper;
    Reporting reporting = Reporting::learn;
    ReportDecoder decoder;
    DeviceState state;
    std::string identity, mapping;
    int configured = -1;  ///< which of the mappings; -1: the default of its class
    MetDevice met;        ///< goes to the list of those that were met
};
/// By the first mapping that fits, else the default of the device's class.
std::unique_ptr<ReadyDevice> make_ready(std::span<const DeviceMapping> mappings, const PluggedDevice& device);
/// For FinderOptions: makes ReadyDevices where devices are opened.
std::function<std::unique_ptr<Readied>(const PluggedDevice&)> readier(std::vector<DeviceMapping> mappings);

/// Of the thread that plays its steering's `steers`. attend() neither allocates nor frees, also while devices come and go, if
/// they come readied; else it makes them ready itself.
class Attendant {
public:
    /// `say` is told, once each: devices that come, go or are refused, and controls of a mapping that a device has not got.
    Attendant(std::vector<DeviceMapping> mappings, Steering& steering, Say say = {});

    void attend(const DeviceEvent& event);
    void attend(std::span<const DeviceEvent> events) {
        for (const DeviceEvent& e : events) attend(e);
    }

    struct Attended {
        int device = -1;    ///< the source's number; -1: nobody
        int steering = -1;  ///< Steering's
        std::string mapping;
        std::shared_ptr<const PluggedDevice> plugged;
    };
    /// Allocates.
    [[nodiscard]] std::vector<Attended> attended() const;
    /// Devices that steered at any time, once each; the first 64 of them.
    [[nodiscard]] std::vector<rt::SteeringDevice> met() const;
    /// How many devices steer now.
    [[nodiscard]] int steering_now() const;
    /// How many pluggings have steered.
    [[nodiscard]] std::uint64_t pluggings() const { return pluggings_; }
    /// Says which mappings no device has come by yet, but for those that `elsewhere` knows to be in use.
    void say_waiting(const std::function<bool(const DeviceMapping&)>& elsewhere) const;
    /// Short, long and undeclared reports: they changed nothing.
    [[nodiscard]] std::uint64_t refused_reports() const { return refused_reports_; }
    [[nodiscard]] std::uint64_t accepted_reports() const { return accepted_reports_; }

private:
    struct Slot {
        int device = -1, steering = -1;
        ReadyDevice* ready = nullptr;
        std::unique_ptr<ReadyDevice> own;  ///< where the device did not come readied
        std::shared_ptr<const PluggedDevice> plugged;
    };
    void added(const DeviceEvent& event) REQUIRES(steering_.steers);
    void removed(const DeviceEvent& event) REQUIRES(steering_.steers);
    [[nodiscard]] Slot* find(int device);
    [[nodiscard]] int number_before(const std::string& identity) const;
    void meet(ReadyDevice& device);

    std::vector<DeviceMapping> mappings_;
    std::vector<bool> fitted_;  ///< parallel to mappings_: some device came by it
    Steering& steering_;
    Say say_;
    std::array<Slot, max_devices> slots_;
    std::array<std::string, max_devices> identities_;  ///< by Steering's numbers: a device that comes back gets its own
    std::vector<MetDevice> met_;
    std::uint64_t pluggings_ = 0, refused_reports_ = 0, accepted_reports_ = 0;
};

}  // namespace surefoot::input
