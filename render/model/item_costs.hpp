// Predicted cost of a representation seen from a pose. Preparation, the null device, calibration and the coarse levels share
// this one estimate, so that they predict, charge and measure the same quantity.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/model.hpp"
#include "render/model/pixel_estimator.hpp"

namespace surefoot::model {

/// A cost table applied to a model. Each state class among the parts of a representation has its own cell of the table. So a wall
/// with one alpha-tested poster costs as much as a wall and a poster.
class ItemCosts {
public:
    /// Allocates, and passes over every triangle. `model` and `costs` must outlive it; their arrays and grids must not change.
    ItemCosts(const Model& model, const CostModel& costs);
    ItemCosts(const Model& model, const CostModel& costs, PixelEstimator estimator);
    ItemCosts(Model&&, const CostModel&) = delete;
    ItemCosts(const Model&, CostModel&&) = delete;

    /// Cost of the representation `r` of a node with box `node_box`, seen from `eye`. Finite and >= 0.
    /// Takes 0.1 us; nearby 1 to 4 us; up to 50 us where each triangle is tested (PixelEstimator::part_pixels).
    [[nodiscard]] ItemCost of(Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale) const {
        float pixels = 0;
        return of(r, node_box, eye, scale, pixels);
    }
    /// The same, with the pixels that it is predicted from: all that are rasterised, overdraw included. `hidden`: effects that
    /// are not drawn.
    [[nodiscard]] ItemCost of(Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale, float& pixels,
                              EffectMask hidden = 0) const;
    /// What these effects add to the representation where it covers so many pixels: the sum of their prices.
    [[nodiscard]] ItemCost of_effects(Index r, float pixels, EffectMask effects) const;
    /// The effects that have a price, and that some part of the model has.
    [[nodiscard]] EffectMask priced() const { return priced_; }
    [[nodiscard]] const PixelEstimator& estimator() const { return estimator_; }

private:
    [[nodiscard]] ItemCost by_cells(Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale, float& pixels) const;
    /// Parts of one state class in a representation.
    struct Class {
        std::uint32_t grid = 0;  ///< in CostModel::grids
        float triangles = 0;
        float share = 0;  ///< of the stored area of all parts
    };
    /// Some of classes_.
    struct Classes {
        std::uint32_t first = 0, count = 0;
    };
    Classes gather(const Representation& rep, std::vector<Class>& found) const;

    /// A price times the triangles of a representation, and times the share of its area.
    struct Increment {
        float submit_us = 0, raster_us = 0, raster_us_per_pixel = 0;
        [[nodiscard]] ItemCost at(float pixels) const { return {submit_us, raster_us + raster_us_per_pixel * pixels}; }
        void add(const EffectPrice& price, float triangles, float share);
    };
    void price_effects();
    void price_form(const Representation& rep, std::span<Increment> of_effects, Increment& beyond_grids) const;
    void price_part(EffectMask effects, const CostGrid& grid, float triangles, float share, std::span<Increment> of_effects,
                    Increment& beyond_grids) const;

    const Model& model_;
    const CostModel& costs_;
    PixelEstimator estimator_;
    std::vector<std::uint32_t> grid_of_part_;
    std::vector<Class> classes_;
    std::vector<Classes> classes_of_;  ///< [representation]; representations with the same parts share an entry
    EffectMask priced_ = 0;
    std::vector<EffectPrice> prices_;       ///< of priced_; empty: nothing below is filled in
    std::vector<Increment> beyond_grids_;   ///< [form]: of all effects that its grids do not hold
    std::vector<Increment> of_effects_;     ///< [form * prices + price]
    std::vector<std::uint32_t> priced_as_;  ///< [representation]: its form above; the same parts share one
};

}  // namespace surefoot::model
