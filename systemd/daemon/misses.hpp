// Groups missed frames into bursts, one log line each. Pure: takes frame records in order.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "rt/frame/record.hpp"

namespace surefoot::daemon {

/// Misses with less than a second between them.
struct Burst {
    std::uint64_t misses = 0, own_misses = 0, skipped = 0;  ///< frames, frames, slots
    std::uint64_t first_slot = 0, last_slot = 0;
    std::int64_t began_ns = 0, last_ns = 0;  ///< when the first was due, and the last ended
    std::int64_t worst_late_ns = 0;          ///< end of a frame after its deadline
    std::array<std::uint64_t, rt::cause_count> causes{};
    bool goes_on = false;  ///< reported before its end, because it is long

    /// "14 frames missed in 0.8 s, 20 slots skipped, at worst 12.3 ms late: raster 12, stolen 2".
    [[nodiscard]] std::string text() const;
    /// The most frequent cause; none without misses.
    [[nodiscard]] rt::Cause main_cause() const;
};

/// The burst that is open, and the rule that ends it. One thread.
class Bursts {
public:
    static constexpr std::int64_t quiet_ns = 1'000'000'000;     ///< this long without a miss ends one
    static constexpr std::int64_t longest_ns = 60'000'000'000;  ///< a longer one is reported every minute
    /// A burst that has ended, or has lasted a minute.
    std::optional<Burst> add(const rt::FrameRecord& record);
    /// At the end of the walk: the open burst.
    std::optional<Burst> finish();

private:
    Burst open_;
};

}  // namespace surefoot::daemon
