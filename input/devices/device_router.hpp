// Connects live devices to the steering: gives each device its mapping, decodes its reports, attaches and detaches it.
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
#include "input/messages.hpp"
#include "input/report_source.hpp"
#include "input/steering.hpp"

namespace surefoot::input {

/// Wants devices that a mapping names, and those that steer by their class.
Wanted wanted_by(std::vector<DeviceMapping> mappings);
/// For find_mapping().
DeviceIdentity identity_for_mapping(const PluggedDevice& device);

/// A device that steered at any time.
struct KnownDevice {
    std::string identity;
    rt::SteeringDevice description;
};

/// A device prepared for the router: holds everything that needs memory.
struct SteeringAttachment final : DeviceAttachment {
    explicit SteeringAttachment(const HidDevice& device) : decoder(device) {}
    Mapper mapper;
    Reporting reporting = Reporting::learn;
    ReportDecoder decoder;
    DeviceState state;
    std::string identity, mapping;
    int configured = -1;  ///< which of the mappings; -1: the default of its class
    KnownDevice known;    ///< entry for known_devices()
};
/// Uses the first matching mapping, else the default of the device's class.
std::unique_ptr<SteeringAttachment> make_attachment(std::span<const DeviceMapping> mappings, const PluggedDevice& device);
/// For FinderOptions: makes SteeringAttachments where devices are opened.
std::function<std::unique_ptr<DeviceAttachment>(const PluggedDevice&)> attachment_factory(std::vector<DeviceMapping> mappings);

/// Belongs to the thread that plays its steering's `steers`. If devices come with their SteeringAttachment, dispatch() neither
/// allocates nor frees, also while they come and go. Else it makes the attachment itself.
class DeviceRouter {
public:
    /// `sink` gets a message, once each: devices that come, go or are refused; controls of a mapping that a device lacks.
    DeviceRouter(std::vector<DeviceMapping> mappings, Steering& steering, MessageSink sink = {});

    void dispatch(const DeviceEvent& event);
    void dispatch(std::span<const DeviceEvent> events) {
        for (const DeviceEvent& e : events) dispatch(e);
    }

    /// Devices that steered at any time, once each; the first 64 of them.
    [[nodiscard]] std::vector<rt::SteeringDevice> known_devices() const;
    /// How many devices steer now.
    [[nodiscard]] int steering_now() const;
    /// How many pluggings have steered.
    [[nodiscard]] std::uint64_t pluggings() const { return pluggings_; }
    /// Emits a message for each mapping that matches no device yet, except those that `elsewhere` reports as used.
    void warn_unused_mappings(const std::function<bool(const DeviceMapping&)>& elsewhere) const;
    /// Short, long and undeclared reports: they changed nothing.
    [[nodiscard]] std::uint64_t refused_reports() const { return refused_reports_; }
    [[nodiscard]] std::uint64_t accepted_reports() const { return accepted_reports_; }

private:
    struct Slot {
        int device = -1, steering = -1;
        SteeringAttachment* attachment = nullptr;
        std::unique_ptr<SteeringAttachment> own;  ///< where the device came without an attachment
        std::shared_ptr<const PluggedDevice> plugged;
    };
    void added(const DeviceEvent& event) REQUIRES(steering_.steers);
    void removed(const DeviceEvent& event) REQUIRES(steering_.steers);
    [[nodiscard]] Slot* find(int device);
    [[nodiscard]] int number_before(const std::string& identity) const;
    void remember(SteeringAttachment& device);

    std::vector<DeviceMapping> mappings_;
    std::vector<bool> fitted_;  ///< parallel to mappings_: some device came by it
    Steering& steering_;
    MessageSink sink_;
    std::array<Slot, max_devices> slots_;
    std::array<std::string, max_devices> identities_;  ///< by the numbers of Steering; a returning device gets its old number
    std::vector<KnownDevice> known_;
    std::uint64_t pluggings_ = 0, refused_reports_ = 0, accepted_reports_ = 0;
};

}  // namespace surefoot::input
