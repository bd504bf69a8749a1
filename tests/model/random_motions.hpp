// Random motions for tests: keys, jumps, turns of every size, and motions that carry each other.
#pragma once

#include <cmath>
#include <cstdint>

#include "render/model/model.hpp"
#include "rt/base/random.hpp"

namespace surefoot::test {

inline double within(Random& random, double low, double high) { return low + (high - low) * random.unit(); }

inline dvec3 point_within(Random& random, double reach) {
    return {within(random, -reach, reach), within(random, -reach, reach), within(random, -reach, reach)};
}

inline std::array<float, 4> random_rotation(Random& random) {
    glm::dvec4 q(0.0);
    while (!(glm::length(q) > 0.1))
        q = {within(random, -1, 1), within(random, -1, 1), within(random, -1, 1), within(random, -1, 1)};
    q = glm::normalize(q);
    return {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
}

/// It ends as it began. jumps: some keys are at one time.
inline model::Index add_motion(model::Model& model, Random& random, model::Index outer = model::none, bool jumps = true) {
    model::Motion motion;
    motion.pivot = point_within(random, 10);
    motion.first_key = static_cast<std::uint32_t>(model.motion_keys.size());
    motion.key_count = 1 + static_cast<std::uint32_t>(random.below(7));
    motion.outer = outer;
    double time_s = 0;
    for (std::uint32_t k = 0; k < motion.key_count; ++k) {
        model.motion_keys.push_back({time_s, point_within(random, 20), random_rotation(random)});
        if (k + 1 < motion.key_count && !(jumps && random.unit() < 0.2)) time_s += within(random, 0.05, 3);
    }
    motion.period_s = time_s > 0 ? time_s : 1;
    model::MotionKey& last = model.motion_keys.back();
    if (motion.key_count > 1)
        last = {motion.period_s, model.motion_keys[motion.first_key].translation, model.motion_keys[motion.first_key].rotation};
    model.motions.push_back(motion);
    return static_cast<model::Index>(model.motions.size() - 1);
}

}  // namespace surefoot::test
