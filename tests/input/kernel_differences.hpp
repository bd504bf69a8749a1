// What Surefoot makes of reports otherwise than Linux does, on purpose: the one table. A comparison with the kernel's events
// allows nothing that is not in it, and counts how often it needed each. (A hat outside its range is in none of the recordings
// yet: one that differs there fails, until it is looked at.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <string_view>

namespace surefoot::input {

enum class Difference : std::size_t { not_as_declared, null_state, hat_outside, no_code };

struct DifferenceRow {
    std::string_view name, kernel, surefoot, why;
};

/// By Difference.
constexpr std::array<DifferenceRow, 4> kernel_differences = {{
    {"not as declared", "fills short reports with zeros and cuts long ones",
     "changes nothing, and counts it (the comparison of that device ends there)",
     "a zero is full deflection of an unsigned axis"},
    {"null state", "keeps an axis' last value", "has no value: at rest", "a device that says 'nothing' must not go on moving"},
    {"hat outside its range", "divides, and rounds some to north", "centred, whatever the value", "the same"},
    {"no code", "makes no event of the usage", "a control like any other", "bound by usage, whatever the name of its event"},
}};

class Differences {
public:
    void add(Difference d, std::size_t times = 1) { counts_[static_cast<std::size_t>(d)] += times; }
    [[nodiscard]] std::size_t times(Difference d) const { return counts_[static_cast<std::size_t>(d)]; }
    void print() const {
        for (std::size_t i = 0; i < kernel_differences.size(); ++i) {
            const DifferenceRow& row = kernel_differences[i];
            std::printf("%6zu times %.*s: the kernel %.*s; here: %.*s\n", counts_[i], static_cast<int>(row.name.size()),
                        row.name.data(), static_cast<int>(row.kernel.size()), row.kernel.data(),
                        static_cast<int>(row.surefoot.size()), row.surefoot.data());
        }
    }

private:
    std::array<std::size_t, kernel_differences.size()> counts_{};
};

}  // namespace surefoot::input
