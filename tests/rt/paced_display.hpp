// A display for tests: its refreshes come by a clock of its own, and it shows what it was handed early enough.
#pragma once

#include <cstdint>

namespace surefoot::test {

/// Refresh j is at first_ns + j * refresh_ns, as this machine's clock has it.
struct PacedDisplay {
    double refresh_ns = 16'666'667;
    double first_ns = 0;
    std::int64_t needs_ns = 400'000;  ///< so much before a refresh a picture must be handed over

    [[nodiscard]] std::int64_t at_ns(std::int64_t refresh) const {
        return static_cast<std::int64_t>(first_ns + static_cast<double>(refresh) * refresh_ns);
    }
    /// The refresh that shows a picture handed over then.
    [[nodiscard]] std::int64_t shows(std::int64_t handed_ns) const {
        auto refresh = static_cast<std::int64_t>((static_cast<double>(handed_ns + needs_ns) - first_ns) / refresh_ns);
        while (at_ns(refresh) < handed_ns + needs_ns) ++refresh;
        return refresh;
    }
};

}  // namespace surefoot::test
