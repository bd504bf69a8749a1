// For which eyes a form may be drawn: the distance that it must keep, as a conic range, and the choice among such levels.
// Source: Pasman and Jansen 2002, sections 3.5 and 3.6.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "render/model/conic_range.hpp"
#include "render/model/model.hpp"

namespace surefoot::model {

/// Distance by which errors are divided, m: at least the near plane. nearest_m: from the eye to the node's box; 0 inside.
float error_distance(float nearest_m);
/// The largest angle by which the form is off full detail, as seen from that distance.
float error_rad(const Representation& rep, float nearest_m);
/// Whether the form may be drawn from that distance.
bool legal(const Representation& rep, float nearest_m);

/// The least distance to the node's box from which the form is legal, and off by at most max_error_rad. 0: everywhere.
/// Infinite: nowhere. Without max_error_rad: where it is legal.
double valid_from_m(const Representation& rep, double max_error_rad = std::numeric_limits<double>::infinity());

/// The same as a range of eyes: beyond a sphere round the middle of the node's box. No eye is in it wrongly, but for rounding;
/// some beside the box's faces are left out. All directions: no form of the bake depends on one.
ConicRange form_range(const Node& node, const Representation& rep,
                      double max_error_rad = std::numeric_limits<double>::infinity());

/// A level of detail: for which eyes it serves, and what it takes.
struct RangedLevel {
    ConicRange range;
    double takes = 0;
};

/// A node's forms, coarse to fine, by their triangles.
std::vector<RangedLevel> levels_of(const Model& model, Index node, double max_error_rad);

/// The level that takes least, of those whose ranges hold all eyes within a distance of one. Of equals the first. As many as
/// there are levels: none.
std::size_t cheapest_level(std::span<const RangedLevel> levels, const dvec3& eye, double radius_m = 0);

/// From a distance on, up to the next one's: what cheapest_level() gives.
struct LevelFrom {
    double from_m = 0;
    std::size_t level = 0;
};
/// For eyes on a ray from the levels' common centre. Ascending; the first is from 0.
std::vector<LevelFrom> levels_along(std::span<const RangedLevel> levels, const dvec3& centre, const dvec3& direction);

}  // namespace surefoot::model
