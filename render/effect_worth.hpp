// What leaving effects out changes of the picture, by node: the worth of an effect as an item of the budget.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/model.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot {

/// A group of effects that can be left out together, by DeviceOptions::switches.
struct EffectGroup {
    model::EffectMask mask = 0;  ///< the switch: all that is left out
    model::EffectMask own = 0;   ///< what no smaller group holds: its price and worth are of these
};
static_assert(prepare::max_effect_groups == gl::max_switches);

/// The groups of some switches. Sunlight leaves out sun and shadows; the shadows are the smaller group's own.
std::vector<EffectGroup> groups_of(std::span<const model::EffectMask> switches);

/// Differences by node, group and light. Each leaf is shaded at points of its full detail with and without the group: the mean
/// squared difference of the colours counts. A cluster has the mean of its leaves, by their size. Losses of forms are measured
/// in the model's own light. So in a darker one, where forms lose less, differences count by how much darker the model is.
/// Constant once it is made.
class EffectWorth {
public:
    EffectWorth() = default;
    /// hours: of the day, rising from 0 to 24, between which a light is interpolated; empty: the model's own light.
    /// `sky`: the colour behind everything, which fog takes. Needs the model's texels. Allocates.
    EffectWorth(const model::Model& model, std::span<const EffectGroup> groups, std::span<const double> hours,
                const std::array<float, 3>& sky);

    /// What the groups lose at an hour; no number: the first light. The spans live as long as this.
    [[nodiscard]] std::array<prepare::EffectLoss, prepare::max_effect_groups> at(float hour) const;
    [[nodiscard]] bool any() const { return !losses_.empty(); }

private:
    std::vector<EffectGroup> groups_;
    std::vector<double> hours_;
    std::size_t nodes_ = 0;
    float fog_density_ = 0;
    std::vector<float> losses_;  ///< [(light * groups + group) * nodes + node]
};

}  // namespace surefoot
