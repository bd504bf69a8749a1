// A judge of slots that shares no code with them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "render/cache/slots.hpp"

namespace surefoot::cache {

/// Where each texel square of 64 goes, kept by another way than Slots does.
class SlotBoard {
public:
    explicit SlotBoard(std::uint32_t layers) : cells_(layers * 16, false) {}
    /// False: a cell is not as it should be.
    bool set(const Slot& slot, bool taken) {
        bool sound = slot.column % slot.texels == 0 && slot.row % slot.texels == 0;
        for (std::uint32_t y = slot.row / 64U; y < (slot.row + slot.texels) / 64U; ++y)
            for (std::uint32_t x = slot.column / 64U; x < (slot.column + slot.texels) / 64U; ++x) {
                const std::size_t cell = slot.layer * 16U + y * 4U + x;
                if (x >= 4 || y >= 4 || cell >= cells_.size() || cells_[cell] == taken) return false;
                cells_[cell] = taken;
            }
        return sound;
    }
    [[nodiscard]] std::uint64_t bytes() const {
        return static_cast<std::uint64_t>(std::count(cells_.begin(), cells_.end(), true)) * 64 * 64 * 4;
    }
    /// Whether an aligned place of this side is free.
    [[nodiscard]] bool has_room(std::uint32_t texels) const {
        const std::size_t side = texels / 64;
        for (std::size_t layer = 0; layer < cells_.size() / 16; ++layer)
            for (std::size_t y = 0; y < 4; y += side)
                for (std::size_t x = 0; x < 4; x += side) {
                    bool free = true;
                    for (std::size_t i = 0; i < side * side; ++i)
                        free = free && !cells_[layer * 16 + (y + i / side) * 4 + x + i % side];
                    if (free) return true;
                }
        return false;
    }

private:
    std::vector<bool> cells_;
};

}  // namespace surefoot::cache
