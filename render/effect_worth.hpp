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
    model::EffectMask mask = 0;    ///< the switch: all that is left out
    model::EffectMask own = 0;     ///< what no smaller group holds: its worth is of these
    model::EffectMask priced = 0;  ///< own, and reading the map of what moves: its price is of these
};
static_assert(prepare::max_effect_groups == gl::max_switches);

/// The groups of some switches. Sunlight leaves out sun and shadows; the shadows are the smaller group's own.
std::vector<EffectGroup> groups_of(std::span<const model::EffectMask> switches);
/// Those that own something, and so may be bought. What only the others have of the price goes to the larger ones.
std::vector<EffectGroup> groups_for_sale(std::span<const model::EffectMask> switches);

/// Differences by node, group and light. Each leaf is shaded at points of its full detail with and without the group: the mean
/// squared difference of the colours counts. A cluster has the mean of its leaves, by their size. Losses of forms are measured
/// in the model's own light. So in a darker one, where forms lose less, differences count by how much darker the model is.
/// A light is worked out bit by bit as at() needs it, and those of the next hours before. Each call but the first does a bounded
/// part. Meanwhile the nearest known one counts. So what at() returns depends on the hours of the calls before.
class EffectWorth {
public:
    EffectWorth() = default;
    /// hours: of the day, rising from 0 to 24, between which a light is interpolated; empty: the model's own light.
    /// `sky`: the colour behind everything, which fog takes. Needs the model's texels, but not later. The model must outlive it.
    EffectWorth(const model::Model& model, std::span<const EffectGroup> groups, std::span<const double> hours,
                const std::array<float, 3>& sky);

    /// What the groups lose at an hour; no number: the first light. The first call works out whole lights, which takes a while.
    /// `without`: effects that pictures are drawn without. Where fog is one, it takes nothing from what others show.
    /// The spans live as long as this. One thread at a time.
    /// Allocates nothing.
    [[nodiscard]] std::array<prepare::EffectLoss, prepare::max_effect_groups> at(float hour, model::EffectMask without = 0);
    [[nodiscard]] bool any() const { return !losses_.empty(); }

private:
    /// A light that is being worked out, node by node: first leaves, then sums upwards, group by group.
    struct Pass {
        std::size_t moment = 0, node = 0, summed = 0;
        double energy = 0;
    };
    /// Two lights, and the share of the second one.
    struct Between {
        std::size_t before = 0, after = 0;
        float share = 0;
    };

    std::span<float> losses_of(std::size_t moment, std::size_t group) {
        return std::span(losses_).subspan((moment * groups_.size() + group) * nodes_, nodes_);
    }
    [[nodiscard]] Between around(double hour) const;
    [[nodiscard]] Between known_around(const Between& wanted, double hour) const;
    void work(const Between& wanted);
    std::size_t go_on(std::size_t moment, std::size_t max_steps);
    void shade(std::size_t end);
    void go_up(std::size_t end);
    void follow(double hour);
    void look_ahead(const Between& now);

    const model::Model* model_ = nullptr;
    std::vector<EffectGroup> groups_;
    std::vector<double> hours_;
    std::array<float, 3> sky_{};
    std::vector<model::Daylight> moments_;
    std::vector<bool> known_;  ///< moments that are worked out
    Pass pass_;
    bool started_ = false;  ///< some light is known
    int day_runs_ = 0;      ///< 1: on, -1: back, 0: not yet
    double last_hour_ = 0, own_energy_ = 0;
    std::size_t nodes_ = 0;
    std::vector<vec3> mean_texels_;     ///< by texture
    std::vector<double> weight_, sum_;  ///< by node: of its leaves' sizes; of a pass upwards
    std::vector<float> losses_;         ///< [(light * groups + group) * nodes + node]
};

}  // namespace surefoot
