// Points of the true surface against what a captured cut draws: how far the drawn form is from them, as an angle at the eye.
// Taken from the model's meshes and the pose alone, by code that shares nothing with render/prepare and render/select.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "render/capture/capture.hpp"
#include "render/measure/mesh_distance.hpp"
#include "render/model/view.hpp"
#include "tests/bake/surface.hpp"

namespace surefoot::test {

/// What sampled points say of one cut.
struct SurfacePoints {
    std::size_t points = 0;       ///< in view
    std::size_t items = 0;        ///< coarse forms that have such points
    std::size_t beyond = 0;       ///< of the points
    double worst_rad = 0;         ///< distance to the drawn form by distance to the eye
    model::Index worst_node = 0;  ///< whose form that is
    void add(const SurfacePoints& other) {
        points += other.points;
        items += other.items;
        beyond += other.beyond;
        if (other.worst_rad > worst_rad) worst_rad = other.worst_rad, worst_node = other.worst_node;
    }
};

/// Points drawn evenly from triangles by area. `triangles` has at least one.
class PointSampler {
public:
    PointSampler(const measure::MeshView& triangles, std::uint64_t seed) : mesh_(triangles), random_(seed) {
        for (std::size_t t = 0; t < mesh_.triangles(); ++t) {
            const vec3 a = at(t, 0), area = glm::cross(at(t, 1) - a, at(t, 2) - a);
            areas_.push_back((t == 0 ? 0 : areas_.back()) + static_cast<double>(glm::length(area)));
        }
    }
    vec3 next() {
        std::uniform_real_distribution<double> part(0, 1);
        const auto found = std::upper_bound(areas_.begin(), areas_.end(), part(random_) * areas_.back());
        const auto t = static_cast<std::size_t>(std::min(found, areas_.end() - 1) - areas_.begin());
        const double u = std::sqrt(part(random_)), v = part(random_);
        return static_cast<float>(1 - u) * at(t, 0) + static_cast<float>(u * (1 - v)) * at(t, 1) +
               static_cast<float>(u * v) * at(t, 2);
    }

private:
    [[nodiscard]] vec3 at(std::size_t triangle, std::size_t corner) const {
        return mesh_.positions[mesh_.indices[3 * triangle + corner]];
    }
    measure::MeshView mesh_;
    std::mt19937_64 random_;
    std::vector<double> areas_;
};

/// Points of one item: `count` tries, of which those in view count. Float positions about the node's centre round by some
/// millionths of its size: so much is forgiven.
inline SurfacePoints points_of_item(const model::Model& model, const select::CutItem& item, const model::Frustum& frustum,
                                    const dvec3& eye, double error_rad, std::size_t count) {
    SurfacePoints out;
    const model::Node& node = model.nodes[item.node];
    const dvec3 centre = node.box.centre();
    const bake::Surface full = bake::full_detail(model, item.node, centre);
    const bake::Surface drawn = bake::surface_of(model, model.reps[item.rep], centre);
    if (full.indices.empty()) return out;
    const bool nothing = drawn.indices.empty();
    const measure::TriangleTree tree((nothing ? full : drawn).view());
    const double rounding_m = 2e-6 * node.box.diagonal();
    PointSampler sampler(full.view(), 1 + item.node);
    for (std::size_t i = 0; i < count; ++i) {
        const vec3 local = sampler.next();
        const dvec3 point = centre + dvec3(local);
        const double eye_m = glm::distance(point, eye);
        if (!(eye_m > 0) || !model::visible(frustum, Box{point, point})) continue;
        const double off_m = nothing ? node.box.diagonal() : static_cast<double>(tree.nearest(local).distance);
        ++out.points;
        const double off_rad = std::max(0.0, off_m - rounding_m) / eye_m;
        if (off_rad > error_rad) ++out.beyond;
        if (off_rad > out.worst_rad) out.worst_rad = off_rad, out.worst_node = item.node;
    }
    out.items = out.points > 0 ? 1 : 0;
    return out;
}

/// The cut of a capture, seen from a pose of its region: about `points` points in view, spread evenly over the coarse forms in
/// view. Forms that show full detail are left out.
inline SurfacePoints judge_surface_points(const capture::Capture& of, const model::Model& model, const Pose& pose,
                                          double error_rad, std::size_t points) {
    const model::Frustum frustum = model::make_frustum(pose, of.prepared.viewport, model::far_corners_m(model.nodes[0].box));
    std::vector<select::CutItem> coarse;
    for (const select::CutItem& item : of.items) {
        const model::Node& node = model.nodes[item.node];
        const bool full = model::is_full_detail(node, item.rep, model.reps[item.rep].error_m);
        if (!full && model::visible(frustum, node.box)) coarse.push_back(item);
    }
    SurfacePoints out;
    std::size_t left = coarse.size();
    for (const select::CutItem& item : coarse) {
        const std::size_t share = points > out.points ? (points - out.points + left - 1) / left : 1;
        out.add(points_of_item(model, item, frustum, pose.position, error_rad, share));
        --left;
    }
    return out;
}

}  // namespace surefoot::test
