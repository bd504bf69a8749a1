// What blocks a walker and moves: trees of triangles as they are at rest, and the motion of each.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/ground.hpp"
#include "render/model/motion.hpp"
#include "rt/base/result.hpp"

namespace surefoot::model {

/// Ground whose instances move. Mesh 0 is empty, for nothing here stands in the world itself.
struct MovingGround {
    Ground rest;                         ///< instances as they stand at rest; its tree of boxes is over whole motions
    std::vector<std::uint32_t> motions;  ///< one an instance, in Model::motions
    std::vector<MotionReach> reach;      ///< one an instance; not in the file: index_moving_ground()

    [[nodiscard]] bool empty() const { return motions.empty(); }
};

/// Fills the bounds of what moves, and the boxes over them. The model must be valid.
void index_moving_ground(Model& model);

/// Checks every index, range and number that queries rely on, given that motions are valid. Errors name array and element.
Result<void> validate_moving_ground(const Model& model);

}  // namespace surefoot::model
