// Where the pictures of a walk lie: squares of 64, 128 or 256 texels in layers of 256 x 256. Numbers only: no graphics API.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace surefoot::cache {

/// The side of a layer, and the smallest and largest sides of pictures in it, in texels.
constexpr std::uint32_t layer_texels = 256, min_slot_texels = 64, max_slot_texels = 256;

/// A square of texels in one layer.
struct Slot {
    std::uint16_t layer = 0, column = 0, row = 0;  ///< of its first texel
    std::uint16_t texels = 0;                      ///< of a side; 0: none
    friend bool operator==(const Slot&, const Slot&) = default;
};

/// Gives out slots of a fixed memory. Buddies: a square lies at a multiple of its side, so that freed ones join by themselves.
/// After it is made, nothing allocates. The same calls give the same slots.
class Slots {
public:
    explicit Slots(std::uint32_t layers = 0) : used_(layers, 0) {}
    /// The fullest place that it fits: first in quarters that are used already, then in layers that are, then in the lowest empty
    /// layer. Nothing where there is no room, or no slot has this side.
    std::optional<Slot> take(std::uint32_t texels);
    /// Gives back what take() gave. A slot without texels is none.
    void give(const Slot& slot);
    [[nodiscard]] std::uint64_t bytes() const { return bytes_; }  ///< of all slots that are taken
    [[nodiscard]] std::uint32_t layers() const { return static_cast<std::uint32_t>(used_.size()); }

private:
    std::vector<std::uint16_t> used_;  ///< by layer: a bit for each square of 64 texels
    std::uint64_t bytes_ = 0;
};

}  // namespace surefoot::cache
