// Slots of pictures: no two overlap, bytes are exact, and nothing is left behind.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "rt/base/random.hpp"
#include "tests/cache/slot_board.hpp"

namespace surefoot::cache {
namespace {

void take_and_give(std::uint32_t layers, int operations, std::uint64_t seed) {
    Random random(seed);
    Slots slots(layers);
    SlotBoard board(layers);
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
