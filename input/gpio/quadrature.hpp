// Decodes the two lines of a rotary encoder to steps, four a cycle. Counts illegal transitions and never guesses. Pure.
#pragma once

#include <array>
#include <cstdint>

namespace surefoot::input {

/// Gray code 00 01 11 10 counts up (B leads A). Bounce alternates between two neighbours, so it cancels out.
struct Quadrature {
    std::uint8_t state = 0;  ///< A * 2 + B
    bool known = false;      ///< the first levels only set the state
    std::int64_t steps = 0;
    std::uint64_t illegal = 0;  ///< both lines changed at once: an edge was lost, or a step of unknown direction

    /// Returns -1, 0 or 1.
    int turn(bool a, bool b) {
        constexpr std::array<int, 16> table = {0, 1, -1, 2, -1, 0, 2, 1, 1, 2, 0, -1, 2, -1, 1, 0};  // [old * 4 + new]
        const auto next = static_cast<std::uint8_t>((a ? 2U : 0U) | (b ? 1U : 0U));
        const std::uint8_t old = state;
        state = next;
        if (!known) {
            known = true;
            return 0;
        }
        const int step = table[static_cast<std::size_t>(old * 4 + next)];
        if (step == 2) {
            ++illegal;
            return 0;
        }
        steps += step;
        return step;
    }
};

}  // namespace surefoot::input
