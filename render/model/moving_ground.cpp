// Bounds of the ground that moves, and its checks.
#include "render/model/moving_ground.hpp"

#include <string_view>

#include <fmt/format.h>

#include "render/model/model.hpp"

namespace surefoot::model {

namespace {

constexpr std::uint64_t max_reach_keys = 1U << 22U;  // beyond it, what one motion moves has its bounds in common

Error moving_error(std::size_t index, std::string_view what) {
    return {fmt::format("moving ground [{}]", index), std::string(what), "Bake the model again", ErrorKind::damaged};
}

}  // namespace

void index_moving_ground(Model& model) {
    MovingGround& moving = model.moving_ground;
    std::vector<Box> at_rest, of_motion(model.motions.size()), ways;
    std::uint64_t keys = 0;
    for (std::size_t i = 0; i < moving.motions.size(); ++i) {
        at_rest.push_back(box_of(moving.rest, moving.rest.instances[i]));
        of_motion[moving.motions[i]].grow(at_rest[i]);
        for (Index m = moving.motions[i]; m != none; m = model.motions[m].outer) keys += model.motions[m].key_count;
    }
    std::vector<MotionReach> of_all(of_motion.size());  // where each by itself would take long
    for (std::size_t m = 0; m < of_motion.size() && keys > max_reach_keys; ++m)
        if (!of_motion[m].empty()) of_all[m] = reach_of(model, static_cast<Index>(m), of_motion[m]);
    moving.reach.clear();
    for (std::size_t i = 0; i < moving.motions.size(); ++i) {
        const Index motion = moving.motions[i];
        moving.reach.push_back(keys > max_reach_keys ? of_all[motion] : reach_of(model, motion, at_rest[i]));
        ways.push_back(moving.reach.back().box);
    }
    moving.rest.instance_boxes = tree_over(ways);
}

Result<void> validate_moving_ground(const Model& model) {
    const MovingGround& moving = model.moving_ground;
    if (auto checked = validate(moving.rest); !checked)
        return Error{"moving " + checked.error().place, checked.error().what, checked.error().remedy, checked.error().kind};
    if (!moving.rest.meshes.empty() && moving.rest.meshes[0].block_count != 0)
        return moving_error(0, "Some triangles have no motion");
    if (moving.motions.size() != moving.rest.instances.size())
        return moving_error(moving.motions.size(), "There is not one motion for every instance");
    for (std::size_t i = 0; i < moving.motions.size(); ++i)
        if (moving.motions[i] >= model.motions.size()) return moving_error(i, "The motion is out of range");
    return {};
}

}  // namespace surefoot::model
