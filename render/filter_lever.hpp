// The texture filter as an item: when the second mip level of textures is offered to a frame, and what it costs there.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/model.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot {

/// What blending two mip levels adds to the raster time of each representation. The share of its textured parts counts by their
/// area and by what a pixel of their state class costs. Exact where all parts of a representation are of one class, and no price
/// of every pixel is fitted.
class FilterCosts {
public:
    FilterCosts() = default;
    /// Of a model whose costs are those of one mip level. Allocates, and passes over every triangle.
    FilterCosts(const model::Model& model, const model::CostModel& costs);

    /// False: no filter is bought.
    [[nodiscard]] bool any() const { return !growth_.empty(); }
    /// The cost of representation `r` with two mip levels; `cost` is with one.
    [[nodiscard]] model::ItemCost with(model::Index r, const model::ItemCost& cost) const {
        return {cost.submit_us, cost.raster_us * (1.0F + growth_[r])};
    }
    /// What full detail takes more, raster us: the finest choice of every visible leaf. 0 if none is textured.
    [[nodiscard]] float full_us(const prepare::PreparedFrame& set) const;

private:
    std::vector<float> growth_;  ///< by representation: 0 where nothing is textured
};

/// When a step of quality is offered whose change is seen. It is offered after a while of frames that had ample time for it, and
/// then as long as it fits. Where it did not stay long, the next wait is twice as long. Deterministic, as it counts frames.
class QualityDwell {
public:
    static constexpr double ample_share = 0.9;
    static constexpr std::uint32_t min_wait = 30, max_wait = 480;

    /// Once a frame. share: of the time for new forms, that full detail takes with the step. Above 1, or no number: it does not
    /// fit.
    bool offer(double share);
    /// Whether the frame that it was offered to has bought it.
    void answer(bool bought);
    [[nodiscard]] bool on() const { return on_; }

private:
    void leave();

    static constexpr std::uint32_t long_stay = 8;  ///< waits
    bool on_ = false;
    std::uint32_t wait_ = min_wait, calm_ = 0, kept_ = 0;  ///< frames
};

}  // namespace surefoot
