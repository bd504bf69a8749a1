// Slots as bits: each layer is 4 x 4 squares of 64 texels, numbered quarter by quarter, so that a slot is a run of bits.
#include "render/cache/slots.hpp"

#include <bit>

#include "rt/base/check.hpp"

namespace surefoot::cache {

namespace {

constexpr std::uint64_t texel_bytes = 4;
constexpr std::uint32_t cells = 16, quarter_cells = 4;

/// Squares of 64 texels that a side covers; 0: no slot has it.
std::uint32_t cells_of(std::uint32_t texels) {
    if (texels != 64 && texels != 128 && texels != 256) return 0;
    return (texels / min_slot_texels) * (texels / min_slot_texels);
}

std::uint32_t mask_of(std::uint32_t first, std::uint32_t count) { return ((1U << count) - 1U) << first; }

/// The square's number: quarters of a layer first, then quarters of these.
std::uint32_t first_cell(const Slot& slot) {
    const std::uint32_t x = slot.column / min_slot_texels, y = slot.row / min_slot_texels;
    return (y / 2 * 2 + x / 2) * quarter_cells + y % 2 * 2 + x % 2;
}

Slot slot_at(std::size_t layer, std::uint32_t first, std::uint32_t texels) {
    const std::uint32_t quarter = first / quarter_cells, within = first % quarter_cells;
    const std::uint32_t x = quarter % 2 * 2 + within % 2, y = quarter / 2 * 2 + within / 2;
    return {static_cast<std::uint16_t>(layer), static_cast<std::uint16_t>(x * min_slot_texels),
            static_cast<std::uint16_t>(y * min_slot_texels), static_cast<std::uint16_t>(texels)};
}

/// How much of what is round the place is used already: more keeps larger places whole.
std::uint32_t fullness(std::uint32_t used, std::uint32_t first) {
    const std::uint32_t quarter = mask_of(first / quarter_cells * quarter_cells, quarter_cells);
    return static_cast<std::uint32_t>((std::popcount(used & quarter) > 0 ? cells + 1 : 0) + std::popcount(used));
}

}  // namespace

std::optional<Slot> Slots::take(std::uint32_t texels) {
    const std::uint32_t count = cells_of(texels);
    if (count == 0) return std::nullopt;
    std::size_t best_layer = used_.size();
    std::uint32_t best_first = 0, best = 0;
    for (std::size_t layer = 0; layer < used_.size(); ++layer) {
        for (std::uint32_t first = 0; first < cells; first += count) {
            if ((used_[layer] & mask_of(first, count)) != 0) continue;
            const std::uint32_t full = fullness(used_[layer], first) + 1;
            if (full <= best) continue;
            best = full;
            best_layer = layer;
            best_first = first;
        }
    }
    if (best_layer == used_.size()) return std::nullopt;
    used_[best_layer] = static_cast<std::uint16_t>(used_[best_layer] | mask_of(best_first, count));
    bytes_ += texel_bytes * texels * texels;
    return slot_at(best_layer, best_first, texels);
}

void Slots::give(const Slot& slot) {
    if (slot.texels == 0) return;
    const std::uint32_t count = cells_of(slot.texels);
    const bool known = count > 0 && slot.layer < used_.size() && slot.column < layer_texels && slot.row < layer_texels &&
                       first_cell(slot) % count == 0;
    const std::uint32_t mask = known ? mask_of(first_cell(slot), count) : 0U;
    if (!CHECK_RARE(known && (used_[slot.layer] & mask) == mask, "A slot that is given back was taken")) return;
    used_[slot.layer] = static_cast<std::uint16_t>(used_[slot.layer] & ~mask);
    bytes_ -= texel_bytes * slot.texels * slot.texels;
}

}  // namespace surefoot::cache
