// A window's keyboard and mouse as a device of the steering.
#pragma once

#include <poll.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "input/controls.hpp"
#include "input/map/mapping.hpp"
#include "input/messages.hpp"
#include "input/steering.hpp"
#include "input/window/window_feed.hpp"

namespace surefoot::input {

/// Name of the window in the steering file: its mapping is `[[device]] product_name = "window"`.
constexpr std::string_view window_device_name = "window";

/// "key-w" and so on, then "pointer-x" and "pointer-y": relative, in pixels.
std::vector<ControlInfo> window_controls();
/// The first mapping that names the window; else the usual keys. deg_per_px: turn for each pixel of the pointer.
DeviceMapping window_mapping(std::span<const DeviceMapping> mappings, double deg_per_px);
/// The keys that stop under a mapping: a bit each, in the order of window_keys().
std::uint64_t stop_keys(const DeviceMapping& mapping);
/// index-parallel to window_controls().
void fill_state(const WindowReport& report, DeviceState& state);

/// Belongs to the input thread. step() neither allocates nor locks.
class WindowDevice {
public:
    /// `sink` gets a message for each control of the mapping that the window lacks.
    WindowDevice(std::shared_ptr<WindowFeed> feed, std::span<const DeviceMapping> mappings, double deg_per_px,
                 const MessageSink& sink);

    /// Attaches it, with no key down. Before the input thread starts.
    void begin(Steering& steering, std::int64_t now_ns) REQUIRES(steering.steers);
    /// Reports all that waits; `on_report` is called with the stamp of each. Returns how many.
    template <class OnReport>
    std::size_t step(Steering& steering, std::int64_t now_ns, OnReport on_report) REQUIRES(steering.steers) {
        std::size_t count = 0;
        for (WindowReport report; number_ >= 0 && feed_->take(report); ++count) {
            fill_state(report, state_);
            steering.report(number_, state_, now_ns);
            on_report(report.stamp_ns);
        }
        if (count > 0) steering.drained(number_, 1);  // the feed loses none, however many wait
        return count;
    }

    [[nodiscard]] pollfd polled() const { return feed_->polled(); }
    [[nodiscard]] const std::string& mapping() const { return mapping_; }

private:
    std::shared_ptr<WindowFeed> feed_;
    std::string mapping_;
    Mapper mapper_;
    DeviceState state_;
    int number_ = -1;
};

}  // namespace surefoot::input
