// The host's steal of each core, as evidence beside the threads' clocks. The kernel may charge stolen time to the thread that
// ran: then it looks like work. Plain numbers in, records judged: nothing here reads a clock or a file.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rt/base/mutex.hpp"
#include "rt/frame/record.hpp"
#include "rt/threads/placement.hpp"

namespace surefoot::rt {

/// Judges records by the growth of the cores' steal between readings. Any thread but the frame's may read, and any one judge.
///
/// A frame's readings are the last one before it was due and the first one after its end. A reading counts in ticks of 10 ms, and
/// frames between two readings share its growth. So this is evidence and no measurement of one frame. What the frames' own clocks
/// saw as stolen is taken off first, and each millisecond of steal explains one miss only.
class StealEvidence {
public:
    /// rasterisers: cores of the threads for which submission and rasterising wait; may be empty.
    StealEvidence(int frame_core, const CpuMask& rasterisers) : frame_core_(frame_core), rasterisers_(rasterisers.cpus()) {}

    /// A reading, begun then: steal of each core since boot, by its number. Empty: the kernel does not say. Who reads makes sure
    /// that readings come in their order.
    void read(std::int64_t now_ns, std::span<const double> core_steal_ms);
    /// Records in order, once each, that ended before the last reading. Fills core_steal_ns. A miss that looks like this
    /// program's work becomes `stolen`, and is not own, where the steal that is left is at least its lateness.
    void judge(std::span<FrameRecord> records);

private:
    /// Between two readings.
    struct Interval {
        std::int64_t from_ns = 0, to_ns = 0;
        std::int64_t grown_ns = 0;       ///< of the core whose steal grew most
        std::int64_t left_ns = 0;        ///< of it, that explains nothing yet
        std::int64_t frame_left_ns = 0;  ///< of the frame thread's core alone
    };
    [[nodiscard]] std::span<Interval> around(const FrameRecord& record) REQUIRES(mutex_);

    const int frame_core_;
    const std::vector<int> rasterisers_;
    Mutex mutex_;
    std::vector<double> last_ms_ GUARDED_BY(mutex_);
    std::int64_t last_ns_ GUARDED_BY(mutex_) = 0;
    std::vector<Interval> intervals_ GUARDED_BY(mutex_);  ///< the newest; a frame longer than all of them is not judged
};

}  // namespace surefoot::rt
