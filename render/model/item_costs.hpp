// Predicted cost of a representation seen from a pose. Preparation, the null device, calibration and the coarse levels share
// this one estimate, so that they predict, charge and measure the same quantity.
#pragma once

#include <cstdint>
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
    /// The same, with the pixels that it is predicted from: all that are rasterised, overdraw included.
    [[nodiscard]] ItemCost of(Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale, float& pixels) const;
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

    const Model& model_;
    const CostModel& costs_;
    PixelEstimator estimator_;
    std::vector<std::uint32_t> grid_of_part_;
    std::vector<Class> classes_;
    std::vector<Classes> classes_of_;  ///< [representation]; representations with the same parts share an entry
};

}  // namespace surefoot::model
