// The default path of a model: a minute through its rooms, over its terrain, or around it. For models that bring no path.
#pragma once

#include <string>

#include "render/model/ground.hpp"
#include "rt/base/path.hpp"
#include "rt/base/progress.hpp"

namespace surefoot::bake {

/// What the path does, in words for `bake` and `inspect`.
struct Tour {
    Path path;         ///< ten samples a second; empty only if the user stopped
    std::string kind;  ///< "through its free space", "above its ground", "around it"
};

constexpr double tour_s = 60, tour_samples_per_s = 10, max_tour_m = 84;  // at most 1.4 m/s

/// `box`: of all that is drawn. A model with free space to stand in is walked through at eye height, indoors first. One wider
/// than 2 km is flown over. Any other is circled. Deterministic for any number of threads of the caller's arena.
Tour make_tour(const model::Ground& ground, const Box& box, const Progress& progress);

}  // namespace surefoot::bake
