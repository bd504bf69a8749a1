// The flight recorder: the 120 frames around a miss, kept for whoever asks why.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rt/frame/record.hpp"

namespace surefoot::rt {

/// Fed every record in order by the monitor thread. A miss of the walk (not of the control) opens a dump, which closes `after`
/// frames later; misses while one is open belong to it. At most max_dumps are kept, the rest counted.
class FlightRecorder {
public:
    static constexpr std::size_t before = 90, after = 30;  ///< frames up to and with the miss, and after it
    explicit FlightRecorder(std::size_t max_dumps = 16);

    struct Dump {
        std::uint64_t missed_frame = 0;
        std::vector<FrameRecord> records;  ///< in order; at most 120, fewer near the run's start and end
    };
    void add(const FrameRecord& record);
    /// Closes an open dump: the run is over.
    void finish();
    [[nodiscard]] std::span<const Dump> dumps() const { return dumps_; }
    [[nodiscard]] std::uint64_t suppressed() const { return suppressed_; }

private:
    void open(const FrameRecord& miss);
    std::vector<FrameRecord> recent_;  ///< ring of `before`
    std::size_t next_ = 0;
    std::size_t left_ = 0;  ///< frames until the open dump closes; 0: none open
    std::size_t max_dumps_;
    std::vector<Dump> dumps_;
    std::uint64_t suppressed_ = 0;
};

}  // namespace surefoot::rt
