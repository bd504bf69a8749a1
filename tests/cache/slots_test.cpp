// Slots of pictures: no two overlap, bytes are exact, and nothing is left behind.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "render/cache/slots.hpp"
#include "rt/base/random.hpp"

namespace surefoot::cache {
namespace {

/// Where each texel square of 64 goes, kept by another way than Slots does.
class Board {
public:
    explicit Board(std::uint32_t layers) : cells_(layers * 16, false) {}
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

void take_and_give(std::uint32_t layers, int operations, std::uint64_t seed) {
    Random random(seed);
    Slots slots(layers);
    Board board(layers);
    std::vector<Slot> held;
    for (int i = 0; i < operations; ++i) {
        const bool full_phase = i / 1000 % 2 == 0;  // fills up, then empties
        if (held.empty() || random.unit() < (full_phase ? 0.7 : 0.3)) {
            const std::uint32_t texels = 64U << random.below(3);
            const bool room = board.has_room(texels);
            const auto slot = slots.take(texels);
            ASSERT_EQ(slot.has_value(), room) << i;
            if (!slot) continue;
            ASSERT_EQ(slot->texels, texels);
            ASSERT_TRUE(board.set(*slot, true)) << i;
            held.push_back(*slot);
        } else {
            const std::size_t which = random.below(static_cast<std::uint32_t>(held.size()));
            std::swap(held[which], held.back());
            slots.give(held.back());
            ASSERT_TRUE(board.set(held.back(), false)) << i;
            held.pop_back();
        }
        if (i % 64 != 0) continue;
        ASSERT_EQ(slots.bytes(), board.bytes()) << i;
    }
    for (const Slot& slot : held) slots.give(slot);
    EXPECT_EQ(slots.bytes(), 0U);
    for (std::uint32_t i = 0; i < layers; ++i) EXPECT_TRUE(slots.take(256)) << "nothing is left behind";
    EXPECT_FALSE(slots.take(64));
    EXPECT_EQ(slots.bytes(), std::uint64_t{layers} * 256 * 256 * 4);
}

TEST(PictureSlots, NeverOverlapAndLeaveNothingBehind) { take_and_give(5, 100'000, 1); }

TEST(PictureSlotsAtNight, NeverOverlapAndLeaveNothingBehind) { take_and_give(64, 1'000'000, 2); }

TEST(PictureSlots, SmallOnesKeepLayersWhole) {
    Slots slots(2);
    for (int i = 0; i < 16; ++i) EXPECT_EQ(slots.take(64)->layer, 0);
    EXPECT_EQ(slots.take(256)->layer, 1);
    EXPECT_FALSE(slots.take(64));
}

TEST(PictureSlots, OtherSidesAndNoLayersGiveNothing) {
    Slots none_at_all, some(1);
    EXPECT_FALSE(none_at_all.take(64));
    for (const std::uint32_t texels : {0U, 1U, 63U, 96U, 257U, 512U}) EXPECT_FALSE(some.take(texels)) << texels;
    some.give({});
    EXPECT_EQ(some.bytes(), 0U);
}

}  // namespace
}  // namespace surefoot::cache
