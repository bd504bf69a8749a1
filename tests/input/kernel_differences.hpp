// What Surefoot makes of reports otherwise than Linux does, on purpose: the only tables. A comparison with the kernel's events
// allows nothing that is not in them, and counts how often it needed each row. (A hat outside its range, where the two would
// differ, is in none of the recordings yet: one fails, until it is looked at.)
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string_view>

namespace surefoot::input {

enum class Difference : std::size_t { not_as_declared, null_state, hat_outside, no_code, noise, deflection };

struct DifferenceRow {
    std::string_view name, kernel, surefoot, why;
};

/// By Difference.
constexpr std::array<DifferenceRow, 6> kernel_differences = {{
    {"not as declared", "drops short reports (older kernels fill them with zeros) and cuts long ones",
     "changes nothing, and counts it",
     "a zero is full deflection of an unsigned axis; a length that is not the declared one may be another report's"},
    {"null state", "keeps an axis' last value", "has no value: at rest", "a device that says 'nothing' must not go on moving"},
    {"hat outside its range", "divides, and rounds some to north", "centred, whatever the value", "the same"},
    {"no code", "makes no event of the usage", "a control like any other", "bound by usage, whatever the name of its event"},
    {"noise", "hides or averages small steps of an axis", "every value counts", "dead zone and filter are the mapping's work"},
    {"deflection", "calls a 3D mouse's axes relative, as its descriptor does", "a deflection, held until the next report",
     "it reports how far the cap is held"},
}};

/// Usages of the real devices that give no control here, though the kernel may make events of them.
struct NoControl {
    std::string_view slug;
    std::uint32_t first = 0, last = 0;  ///< full usages
    std::uint32_t unnamed = 0;          ///< evdev's code of those events that come without a usage; 0: none do
    std::size_t events = 0;             ///< the kernel's, in all recordings of the device
    std::size_t settings = 0;           ///< synthetic reports that set such a usage
    std::string_view why;
};

constexpr std::array<NoControl, 8> without_control = {{
    {"kbd-ite-lenovo", 0x00070000, 0x00070003, 0, 0, 4, "no keys: nothing pressed, roll-over, failures"},
    {"kbd-ite-lenovo", 0x00070004, 0x0007001f, 0, 56, 28,
     "beyond max_controls: the device declares its 224 keys twice, as an array and as bits; the array's come first"},
    {"kbd-ite-lenovo", 0x000100c6, 0x000100c6, 0xf7, 2, 1, "turns the radio off: nothing to steer with"},
    {"trackball-elecom-huge2", 0x00010081, 0x00010083, 0, 6, 3, "beyond max_controls: behind 573 media keys; power and sleep"},
    {"magictrackpad2-bt", 0x00840061, 0x00840061, 0, 2, 1, "state of the battery"},
    {"magictrackpad2-bt", 0x00850044, 0x00850065, 0, 0, 5, "state of the battery"},
    {"luna-ble", 0x00060020, 0x00060020, 0, 0, 3, "state of the battery"},
    {"xbox-elite2-bt", 0x000c0081, 0x000c00a3, 0xf0, 15, 21,
     "whole bytes under usages of media keys; the kernel makes unknown keys of them, with the byte as value"},
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
