// Live devices as a source of reports: a thread finds and opens them, the router maps them; wired switches and a window included.
//
//   sf-devices: finds, opens, maps ─► LiveDevices ─► DeviceRouter ─┐
//   sf-lines: opens ─► GpioPanel ─► PanelDevice ───────────────────┼► Steering        messages ─► ring ─► whoever prints
//   sf-window: reads events ─► WindowFeed ─► WindowDevice ─────────┘
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "input/devices/device_router.hpp"
#include "input/gpio/panel_device.hpp"
#include "input/map/steering_file.hpp"
#include "input/report_source.hpp"
#include "input/window/window_device.hpp"
#include "rt/exchange/spsc_ring.hpp"

namespace surefoot::input {

/// Settings of a live source.
struct LiveOptions {
    std::vector<DeviceMapping> mappings;  ///< none fits a device: the default of its class
    std::vector<LineConfig> lines;        ///< must have passed check_lines
    OpenLines open_lines = input::open_lines;
    void* lines_context = nullptr;
    Opening lines_opened = Opening::own_thread;
    bool devices = true;                         ///< false: none is looked for
    std::shared_ptr<WindowFeed> window;          ///< its keyboard and mouse steer too; null: there is none
    double window_deg_per_px = 0.15;             ///< turn for each pixel of its pointer
    std::size_t stamps = std::size_t{1} << 20U;  ///< number of reports whose age is kept: 17 minutes at 1 kHz
};

/// For the real clock only. Without any device or window the walk rests until one is plugged in; one message says so, and it is
/// no error.
class LiveSource final : public ReportSource {
public:
    /// The real devices, found from now on. Error: udev cannot be used.
    static Result<std::unique_ptr<LiveSource>> open(LiveOptions options);
    LiveSource(LiveOptions options, std::unique_ptr<DeviceSource> devices);

    void begin(Steering& steering, std::int64_t start_ns) override REQUIRES(steering.steers);
    [[nodiscard]] std::int64_t next_ns() const override { return never_ns; }
    void wait(rt::Clock& clock, std::int64_t until_ns) override;
    Lines drain(Steering& steering, std::int64_t now_ns) override REQUIRES(steering.steers);
    [[nodiscard]] const StampLog& log() const override { return log_; }
    [[nodiscard]] std::uint64_t refused() const override { return router_ ? router_->refused_reports() : 0; }
    [[nodiscard]] std::uint64_t illegal_encoder_steps() const override { return panel_ ? panel_->illegal_encoder_steps() : 0; }
    [[nodiscard]] std::vector<rt::SteeringDevice> devices() const override;
    /// How many devices steer now, as of the last drain; any thread.
    [[nodiscard]] int steering_now() const { return steering_now_.load(std::memory_order_relaxed); }

    /// The next message for the user; false: none. For one thread other than the draining one.
    bool next_message(MessageLine& message) { return messages_.try_pop(message); }
    /// Messages that came too fast for that thread.
    [[nodiscard]] std::uint64_t lost_messages() const { return messages_.dropped(); }

private:
    void warn_if_nobody_steers(std::int64_t now_ns);
    void watch();

    LiveOptions options_;
    rt::SpscRing<MessageLine> messages_{128};
    MessageSink sink_;
    std::unique_ptr<DeviceSource> devices_;
    std::optional<DeviceRouter> router_;
    std::optional<PanelDevice> panel_;
    std::optional<WindowDevice> window_;
    std::vector<pollfd> watched_;  ///< of panel and window
    StampLog log_;
    std::int64_t start_ns_ = 0;
    std::atomic<int> steering_now_{0};
    bool somebody_ = false;         ///< a device steers, or the message about none was emitted
    bool unused_reported_ = false;  ///< of mappings that fit no device
};

/// Whether the steering file has an emergency stop. If so, a latched stop is kept across restarts.
bool has_stop(const SteeringFile& steering);

}  // namespace surefoot::input
