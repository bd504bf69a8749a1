// Holds the frame grid to a display: its points are refreshes, and follow the display's own clock. Pure, of injected time.
#pragma once

#include <cstdint>

#include "rt/base/result.hpp"
#include "rt/base/shown.hpp"
#include "rt/clock/grid.hpp"

namespace surefoot::rt {

/// How many refreshes a slot takes at this rate. The rate must divide the display's; an Error names the rates that do.
Result<std::uint32_t> refreshes_per_slot(const Refreshes& display, double rate_hz);

/// A display's clock and this machine's differ by some parts in a million. So the grid is moved by a part of each picture's
/// error, and its period too: a loop of second order. For one thread; no call allocates.
class DisplayClock {
public:
    DisplayClock(const Refreshes& display, std::uint32_t refreshes_per_slot);

    /// A grid whose points are refreshes; slot 0 is due at the first one that is not before earliest_ns.
    [[nodiscard]] Grid grid_from(std::int64_t earliest_ns) const;
    /// A picture was shown by a refresh at shown_ns: the grid from next_slot on. Which of its points that was is not asked: a
    /// picture that missed its refresh tells as much.
    [[nodiscard]] Grid follow(const Grid& grid, std::int64_t shown_ns, std::uint64_t next_slot);
    /// Of the display, as measured; ns.
    [[nodiscard]] double refresh_ns() const { return refresh_ns_; }

private:
    Refreshes display_;
    std::uint32_t per_slot_;
    double refresh_ns_;
};

}  // namespace surefoot::rt
