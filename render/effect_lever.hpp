// Effects as items: what each group costs and shows in a frame, and how long one that was dropped stays away.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "render/effect_worth.hpp"
#include "render/engine.hpp"
#include "render/model/cost.hpp"
#include "render/select/item.hpp"

namespace surefoot {

/// When a dropped effect comes back: after a while, and only if it is then worth clearly more than what takes its place. Where it
/// did not stay long, the next wait is twice as long. Deterministic, as it counts frames.
class EffectDwell {
public:
    static constexpr std::uint32_t min_wait = 90, max_wait = 1440;  ///< frames: 3 to 48 s at 30 Hz
    /// At first, while resolution and corrections are found: after so many frames without it, a fall is taken back.
    static constexpr std::uint32_t start_frames = 30, start_wait = 5;
    static constexpr float value_share = 0.75F;  ///< of its value, for which it is offered while it is away

    /// Whether it is offered to the next frame. Once a frame.
    bool offer() {
        frames_ = std::min(frames_ + 1, start_frames);
        if (left_ > 0) --left_;
        return left_ == 0;
    }
    [[nodiscard]] bool away() const { return away_; }
    /// What the frame that it was offered to did.
    void answer(bool bought);

private:
    static constexpr std::uint32_t long_stay = 8;  ///< waits
    bool away_ = false;
    std::uint32_t frames_ = 0, wait_ = 0, left_ = 0, kept_ = 0;  ///< frames; the last wait, 0: it never fell
};

/// All groups of a device, and what the frames with them learnt.
struct EffectLever {
    std::array<EffectGroup, prepare::max_effect_groups> groups{};
    std::array<EffectSale, prepare::max_effect_groups> sales{};
    std::array<EffectDwell, prepare::max_effect_groups> dwell{};
    std::size_t count = 0;                                            ///< 0: no effect is bought
    std::array<float, prepare::max_effect_groups> offered_us{};       ///< to this frame; 0: not offered
    std::array<model::ItemCost, prepare::max_effect_groups> costs{};  ///< of the groups over the forms of the last cut
    model::ItemCost forms;                                            ///< of these forms, without the groups
    bool known = false;                                               ///< there was a cut
    model::EffectMask left_out = 0;                                   ///< whole groups that the next pictures are drawn without
    model::EffectMask shown = 0;  ///< priced effects of all other groups: beyond the set's prices
    double spent_us = 0;          ///< of what the last selection bought: these groups

    [[nodiscard]] std::span<const EffectGroup> all() const { return std::span(groups).first(count); }
    [[nodiscard]] model::EffectMask every() const {
        model::EffectMask mask = 0;
        for (const EffectGroup& group : all()) mask |= group.mask;
        return mask;
    }
};

}  // namespace surefoot
