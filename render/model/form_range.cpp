// Ranges of forms, and choices among them.
#include "render/model/form_range.hpp"

#include <algorithm>
#include <cmath>

#include "render/model/view.hpp"

namespace surefoot::model {

namespace {

constexpr double range_rounding = 1e-9, place_rounding = 1e-12;  // shares of a radius and of coordinates, added to a radius
constexpr double nowhere = std::numeric_limits<double>::infinity();

}  // namespace

float error_distance(float nearest_m) { return std::max(nearest_m, static_cast<float>(near_plane_m)); }

float error_rad(const Representation& rep, float nearest_m) { return rep.error_m / error_distance(nearest_m); }

bool legal(const Representation& rep, float nearest_m) {
    return nearest_m >= rep.min_distance_m && (rep.everywhere || nearest_m > 0.0F);
}

double valid_from_m(const Representation& rep, double max_error_rad) {
    double from_m = static_cast<double>(rep.min_distance_m);
    if (!rep.everywhere) from_m = std::max(from_m, std::numeric_limits<double>::min());  // outside of the box
    const auto error_m = static_cast<double>(rep.error_m);
    if (!(error_m > 0)) return from_m;
    if (!(max_error_rad > 0)) return nowhere;
    if (error_m <= max_error_rad * static_cast<double>(error_distance(0))) return from_m;
    return std::max(from_m, error_m / max_error_rad);
}

ConicRange form_range(const Node& node, const Representation& rep, double max_error_rad) {
    const double from_m = valid_from_m(rep, max_error_rad);
    if (!std::isfinite(from_m) || (from_m > 0 && node.box.empty())) return empty_range();
    ConicRange range;
    if (node.box.empty()) return range;
    range.centre = node.box.centre();
    if (from_m > 0)
        range.min_m = (0.5 * node.box.diagonal() + from_m) * (1 + range_rounding) + place_rounding * glm::length(range.centre);
    return range;
}

std::vector<RangedLevel> levels_of(const Model& model, Index n, double max_error_rad) {
    const Node& node = model.nodes[n];
    std::vector<RangedLevel> levels;
    for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
        const Representation& rep = model.reps[r];
        levels.push_back({form_range(node, rep, max_error_rad), static_cast<double>(rep.triangles)});
    }
    return levels;
}

std::size_t cheapest_level(std::span<const RangedLevel> levels, const dvec3& eye, double radius_m) {
    std::size_t best = levels.size();
    for (std::size_t i = 0; i < levels.size(); ++i) {
        if (!contains(levels[i].range, eye, radius_m)) continue;
        if (best == levels.size() || levels[i].takes < levels[best].takes) best = i;
    }
    return best;
}

std::vector<LevelFrom> levels_along(std::span<const RangedLevel> levels, const dvec3& centre, const dvec3& direction) {
    std::vector<double> edges_m{0};
    for (const RangedLevel& level : levels) {
        if (std::isfinite(level.range.min_m)) edges_m.push_back(level.range.min_m);
        if (std::isfinite(level.range.max_m)) edges_m.push_back(level.range.max_m);
    }
    std::sort(edges_m.begin(), edges_m.end());
    edges_m.erase(std::unique(edges_m.begin(), edges_m.end()), edges_m.end());
    std::vector<LevelFrom> along;
    for (std::size_t i = 0; i < edges_m.size(); ++i) {  // all edges have been counted: between two of them nothing changes
        const double middle_m = i + 1 < edges_m.size() ? 0.5 * (edges_m[i] + edges_m[i + 1]) : 2 * edges_m[i] + 1;
        const std::size_t level = cheapest_level(levels, centre + direction * middle_m);
        if (along.empty() || along.back().level != level) along.push_back({edges_m[i], level});
    }
    return along;
}

}  // namespace surefoot::model
