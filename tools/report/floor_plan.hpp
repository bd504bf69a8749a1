// A floor plan: what blocks a walker at breast height, with a path and its viewpoints, as one SVG picture.
#pragma once

#include <string>

#include "render/model/model.hpp"
#include "rt/base/path.hpp"

namespace surefoot::report {

/// North (-Z) is up. Walls are cut 1 m above the floor that the nearest part of the path walks on; floors there are grey. A path
/// that flies shows the outlines of blocks of triangles instead. Viewpoints: eight, at equal times.
std::string floor_plan_svg(const model::Model& model, const Path& path, const std::string& title);

}  // namespace surefoot::report
