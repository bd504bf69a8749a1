// Live devices as the source of a walk's reports: the finder beside, the attendant between, wired switches with them.
//
//   sf-devices: finds, opens, maps ─► LiveDevices ─► Attendant ─┐
//   sf-lines: opens ─► GpioPanel ─► PanelDevice ────────────────┴► Steering           notes ─► ring ─► whoever prints
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "input/devices/attendant.hpp"
#include "input/gpio/panel_device.hpp"
#include "input/map/steering_file.hpp"
#include "input/report_source.hpp"
#include "rt/exchange/spsc_ring.hpp"

namespace surefoot::input {

struct LiveOptions {
    std::vector<DeviceMapping> mappings;  ///< none fits a device: the default of its class
    std::vector<LineConfig> lines;        ///< must have passed check_lines
    OpenLines open_lines = input::open_lines;
    void* lines_context = nullptr;
    Opening lines_opened = Opening::beside;
    std::size_t stamps = std::size_t{1} << 20U;  ///< of so many reports the age is kept: 17 minutes at 1 kHz
};

/// For the real clock only. No device at all is no error: the walk rests until one is plugged in, and that is said once.
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
    [[nodiscard]] std::uint64_t refused() const override { return attendant_ ? attendant_->refused_reports() : 0; }
    [[nodiscard]] std::vector<rt::SteeringDevice> devices() const override;
    /// How many devices steer now, as of the last drain; any thread.
    [[nodiscard]] int steering_now() const { return steering_now_.load(std::memory_order_relaxed); }

    /// What a person should know; false: nothing (more). For one thread, any but the one that drains.
    bool next_note(NoteLine& note) { return notes_.try_pop(note); }
    /// Notes that came too fast for that thread.
    [[nodiscard]] std::uint64_t lost_notes() const { return notes_.dropped(); }

private:
    void say_if_nobody_steers(std::int64_t now_ns);

    LiveOptions options_;
    rt::SpscRing<NoteLine> notes_{128};
    Say say_;
    std::unique_ptr<DeviceSource> devices_;
    std::optional<Attendant> attendant_;
    std::optional<PanelDevice> panel_;
    StampLog log_;
    std::int64_t start_ns_ = 0;
    std::atomic<int> steering_now_{0};
    bool somebody_ = false;      ///< steers, or its absence was said
    bool waiting_said_ = false;  ///< of mappings that fit no device
};

/// Whether anything in the steering file can stop the walk for good: then that is remembered across restarts.
bool has_stop(const SteeringFile& steering);

}  // namespace surefoot::input
