// What drawing a representation is predicted to cost, seen from a pose: the one estimate that prepare, the null device, the
// calibration and the coarse levels share, so that what is predicted, charged and measured is the same quantity.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/cost.hpp"
#include "render/model/model.hpp"
#include "render/model/surfaces.hpp"

namespace surefoot::model {

/// A cost table applied to a model. Each state class of a representation's parts counts with its own cell of the table: a wall
/// with one masked poster on it costs what walls cost, and a poster.
class ItemCosts {
public:
    /// Allocates, and passes over every triangle; `model` and `costs` outlive it, and change neither their arrays nor their
    /// grids.
    ItemCosts(const Model& model, const CostModel& costs);
    ItemCosts(const Model& model, const CostModel& costs, Surfaces surfaces);
    ItemCosts(Model&&, const CostModel&) = delete;
    ItemCosts(const Model&, CostModel&&) = delete;

    /// Of the representation `r` of a node with box `node_box` seen from `eye`. Finite and >= 0. 0.1 us; nearby 1 to 4 us,
    /// and where each triangle is looked at (Surfaces::part_pixels) up to 25.
    [[nodiscard]] ItemCost of(Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale) const;

private:
    /// Parts of one state class in a representation.
    struct Class {
        std::uint32_t grid = 0;  ///< in CostModel::grids
        float triangles = 0;
        float share = 0;  ///< of the area of its parts, as they are stored
    };
    /// Some of classes_.
    struct Classes {
        std::uint32_t first = 0, count = 0;
    };
    Classes gather(const Representation& rep, std::vector<Class>& found) const;

    const Model& model_;
    const CostModel& costs_;
    Surfaces surfaces_;
    std::vector<std::uint32_t> grid_of_part_;
    std::vector<Class> classes_;
    std::vector<Classes> classes_of_;  ///< [representation]; those that share their parts share these
};

}  // namespace surefoot::model
