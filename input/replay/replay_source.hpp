// A recording as a source of reports: each comes when its recorded time has come, counted from the first one.
#pragma once

#include "input/hid/decoder.hpp"
#include "input/replay/recorded_device.hpp"
#include "input/report_source.hpp"

namespace surefoot::input {

/// Reports are stamped with their due time, as the kernel would do, so a late reader shows in their age. A time that goes back
/// counts as the time before. After the last report, silence means rest for every device.
class ReplaySource final : public ReportSource {
public:
    explicit ReplaySource(RecordedDevice recorded);

    void begin(Steering& steering, std::int64_t start_ns) override REQUIRES(steering.steers);
    [[nodiscard]] std::int64_t next_ns() const override;
    void wait(rt::Clock& clock, std::int64_t until_ns) override;
    Lines drain(Steering& steering, std::int64_t now_ns) override REQUIRES(steering.steers);

    [[nodiscard]] const StampLog& log() const override { return log_; }
    [[nodiscard]] std::uint64_t refused() const override { return refused_; }
    [[nodiscard]] std::vector<rt::SteeringDevice> devices() const override;
    [[nodiscard]] const RecordedDevice& recorded() const { return recorded_; }

private:
    RecordedDevice recorded_;
    ReportDecoder decoder_;
    DeviceState state_;
    std::vector<std::int64_t> due_ns_;  ///< one a report, from the first; never falling
    StampLog log_;
    std::uint64_t refused_ = 0;
    std::int64_t start_ns_ = 0;
    std::size_t next_ = 0;
    int device_ = -1;
};

}  // namespace surefoot::input
