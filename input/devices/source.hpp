// The interface of live devices: events (added, refused, removed, report) in the order in which they were seen.
//
//   udev monitor, schedule ─► Finder ─► (open, described) ─► LiveDevices ─► events ─► DeviceRouter ─► Steering
//   (hot-plug, permissions)             a handle each        (poll, drain)            (mapping)
#pragma once

#include <poll.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "input/hid/device.hpp"
#include "rt/base/result.hpp"

namespace surefoot::input {

/// One hidraw node as it was found. Complete at construction; never changed.
struct PluggedDevice {
    std::string node;   ///< "/dev/hidraw0"
    std::string place;  ///< sysfs path; a new one at each plugging, even for the same socket and node
    std::string name;
    std::string socket;  ///< where it is plugged in: "usb-0000:00:14.0-2/input0"; may be empty
    std::string serial;  ///< may be empty
    std::uint16_t bus = 0, vendor = 0, product = 0;
    std::vector<std::byte> descriptor;
    HidDevice device;  ///< layout, controls, class and its reason

    /// Equal if the same device is plugged in again: from its serial, else its socket.
    [[nodiscard]] std::string identity() const;
};

/// Why a connected device is not read.
enum class Refused : std::uint8_t {
    unwanted,    ///< its class does not steer and no mapping names it; it is not opened
    descriptor,  ///< its report descriptor cannot be read or is malformed
    permission,  ///< tried again at each change of the node, and on a schedule
    failed,      ///< anything else; tried again likewise
};

/// User data of a device. The thread that opens devices makes and destroys it, so the reader does not allocate when a device
/// comes or goes.
struct DeviceAttachment {
    DeviceAttachment() = default;
    DeviceAttachment(const DeviceAttachment&) = delete;
    DeviceAttachment& operator=(const DeviceAttachment&) = delete;
    virtual ~DeviceAttachment() = default;
};

/// One change or report of a device, as a DeviceSource hands it to the reader.
struct DeviceEvent {
    enum class Kind : std::uint8_t { added, removed, refused, report, drained };
    Kind kind = Kind::report;
    int device = -1;            ///< number of this plugging, from 0, never given twice; -1: refused
    std::int64_t stamp_ns = 0;  ///< CLOCK_MONOTONIC when it was read or seen
    /// report: the id first where the device numbers its reports. Valid until the next take().
    std::span<const std::byte> bytes;
    std::uint32_t reports = 0;  ///< drained: how many reports were read until nothing was left
    Refused refused = Refused::failed;
    const Error* why = nullptr;                    ///< refused, removed; valid until the next take()
    std::shared_ptr<const PluggedDevice> plugged;  ///< added, removed, refused
    DeviceAttachment* attachment = nullptr;        ///< added: its user data, or null; valid until the take() after `removed`
};

/// One thread.
class DeviceSource {
public:
    virtual ~DeviceSource() = default;
    /// Sleeps until something has happened or may have, or until `until_ns` (CLOCK_MONOTONIC), or until a signal comes.
    virtual void wait(std::int64_t until_ns) = 0;
    /// The new events; never blocks. For each device with reports: all of them, then `drained`. Valid until the next call.
    virtual std::span<const DeviceEvent> take() = 0;
    /// Further descriptors that end wait(); replaces those of the last call.
    virtual void watch_also(std::span<const pollfd> /*others*/) {}
    /// A limitation since the start; to be shown once.
    [[nodiscard]] virtual const std::optional<Error>& trouble() const {
        static const std::optional<Error> none;
        return none;
    }
};

/// Waits, then takes: events, or none at `deadline_ns` or after a signal.
inline std::span<const DeviceEvent> poll(DeviceSource& source, std::int64_t deadline_ns) {
    const auto waiting = source.take();
    if (!waiting.empty()) return waiting;
    source.wait(deadline_ns);
    return source.take();
}

}  // namespace surefoot::input
