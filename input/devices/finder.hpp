// Finds devices that come and go, and opens wanted ones. Uses udev events, a retry schedule for refused devices, and periodic
// scans, as an event may be lost. Reports each change once.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "input/devices/hid_handle.hpp"
#include "input/devices/source.hpp"
#include "input/devices/udev.hpp"
#include "input/retry.hpp"

namespace surefoot::input {

/// One change: a device found, lost or refused.
struct Discovery {
    enum class Kind : std::uint8_t { found, lost, refused };
    Kind kind = Kind::found;
    int device = -1;  ///< found, lost
    std::shared_ptr<const PluggedDevice> plugged;
    std::unique_ptr<DeviceAttachment> attachment;  ///< found, where the options make one
    HidHandle handle;                              ///< found: open
    Refused refused = Refused::failed;
    Error why;  ///< lost, refused
};

/// Whether a device is to be opened.
using Wanted = std::function<bool(const PluggedDevice&)>;
/// True for classes that steer without configuration: navigation and buttons.
bool steers_by_class(const PluggedDevice& device);

/// What the finder looks for, and how a found device is attached.
struct FinderOptions {
    Wanted wanted = steers_by_class;
    std::function<std::unique_ptr<DeviceAttachment>(const PluggedDevice&)>
        attachment_factory;  ///< called for each that is found; may be empty
    bool open = true;        ///< false: devices are listed only; `found` then carries no open handle
};

/// Lists, opens and describes HID devices, and follows their plugging. One thread calls all members; it may block.
class Finder {
public:
    static Result<Finder> create(FinderOptions options);

    /// The changes since the last call. Reads sysfs and opens devices, so it may take milliseconds.
    std::vector<Discovery> look(std::int64_t now_ns);
    /// Readable when look() may find something; -1: no monitor.
    [[nodiscard]] int fd() const { return monitor_ ? monitor_->fd() : -1; }
    /// When look() is due even without an event.
    [[nodiscard]] std::int64_t due_ns() const;
    /// Reading the device failed; it is closed and reported as gone. It is opened again, with a new number, if still plugged in.
    void failed(int device, std::int64_t now_ns);
    /// Why there is no udev monitor, if so. To be shown once.
    [[nodiscard]] const std::optional<Error>& without_monitor() const { return without_monitor_; }

private:
    enum class State : std::uint8_t { left_alone, waiting, open };
    struct Entry {
        std::shared_ptr<const PluggedDevice> plugged;
        State state = State::left_alone;
        int device = -1;
        Retry retry;
        std::string last_reported;
    };

    void scan(std::vector<Discovery>& out, std::int64_t now_ns);
    void classify(std::vector<Discovery>& out, const std::string& place, Entry& entry, const std::optional<Error>& trouble);
    void try_open(std::vector<Discovery>& out, Entry& entry, std::int64_t now_ns);

    FinderOptions options_;
    UdevContext context_;
    std::optional<UdevMonitor> monitor_;
    std::optional<Error> without_monitor_;
    std::map<std::string, Entry> entries_;  ///< by place
    std::int64_t scan_due_ns_ = 0;
    int next_number_ = 0;
};

}  // namespace surefoot::input
