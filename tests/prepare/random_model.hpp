// Models without geometry for tests of preparation and selection: random trees, and a town of equal objects.
#pragma once

#include <algorithm>
#include <cmath>

#include "render/model/model.hpp"
#include "rt/base/random.hpp"

namespace surefoot::test {

using model::Index;
using model::none;

/// Adds `count` forms, coarse to fine; error falls from `error_m` to zero at a leaf's last.
inline void add_reps(model::Model& m, model::Node& node, Random& random, std::uint32_t count, double error_m,
                     std::uint32_t triangles) {
    node.first_rep = static_cast<Index>(m.reps.size());
    node.rep_count = count;
    const dvec3 size = node.box.max - node.box.min;
    for (std::uint32_t k = 0; k < count; ++k) {
        model::Representation rep;
        const bool last = k + 1 == count;
        rep.error_m = last && node.child_count == 0 ? 0.0F : static_cast<float>(error_m * std::pow(0.35, k));
        rep.triangles = std::max(2U, static_cast<std::uint32_t>(triangles * std::pow(4.0, static_cast<double>(k) - count + 1)));
        rep.area_m2 = {static_cast<float>(size.y * size.z), static_cast<float>(size.x * size.z),
                       static_cast<float>(size.x * size.y)};
        if (count > 1 && !last && random.below(4) == 0) {  // a picture: only from outside
            rep.kind = model::RepKind::textured_box;
            rep.everywhere = false;
            rep.min_distance_m = static_cast<float>(random.range(0.0, 20.0));
            rep.triangles = 12;
        }
        m.reps.push_back(rep);
    }
}

/// A random tree of at least one and about `nodes` nodes; boxes lie in their parents'.
inline model::Model random_model(std::uint64_t seed, std::uint32_t nodes) {
    Random random(seed);
    model::Model m;
    m.placements.emplace_back();
    model::Node root;
    root.box = {dvec3(-50, -5, -50), dvec3(50, 15, 50)};
    m.nodes.push_back(root);
    const bool chain = random.below(16) == 0;
    for (std::size_t i = 0; i < m.nodes.size(); ++i) {
        const std::uint32_t room = nodes > m.nodes.size() ? nodes - static_cast<std::uint32_t>(m.nodes.size()) : 0;
        std::uint32_t children = chain ? 1 : (i > 0 && random.below(3) == 0 ? 0 : 1 + random.below(6));
        children = std::min(children, room);
        m.nodes[i].child_count = children;
        m.nodes[i].first_child = children > 0 ? static_cast<Index>(m.nodes.size()) : none;
        const Box box = m.nodes[i].box;
        for (std::uint32_t c = 0; c < children; ++c) {
            model::Node child;
            child.parent = static_cast<Index>(i);
            child.importance = random.below(5) == 0 ? static_cast<float>(random.unit()) : 1.0F;
            for (int axis = 0; axis < 3; ++axis) {
                const double a = random.range(box.min[axis], box.max[axis]), b = random.range(box.min[axis], box.max[axis]);
                child.box.min[axis] = std::min(a, b);
                child.box.max[axis] = std::max(a, b);
            }
            m.nodes.push_back(child);
        }
    }
    for (model::Node& node : m.nodes) {
        add_reps(m, node, random, 1 + random.below(4), node.box.diagonal() * random.range(0.02, 0.2), 100 + random.below(4000));
    }
    return m;
}

/// 4^depth objects of three forms on a square plain, in a quadtree of clusters: about 1.33 * 4^depth nodes.
inline model::Model town(std::uint32_t depth, double object_m = 6.0) {
    Random random(7);
    model::Model m;
    m.placements.emplace_back();
    const double side = object_m * static_cast<double>(1U << depth);
    model::Node root;
    root.box = {dvec3(-side / 2, 0, -side / 2), dvec3(side / 2, object_m, side / 2)};
    m.nodes.push_back(root);
    std::size_t begin = 0;
    for (std::uint32_t level = 0; level < depth; ++level) {
        const std::size_t end = m.nodes.size();
        for (std::size_t i = begin; i < end; ++i) {
            m.nodes[i].child_count = 4;
            m.nodes[i].first_child = static_cast<Index>(m.nodes.size());
            const Box box = m.nodes[i].box;
            const dvec3 middle = box.centre();
            for (int c = 0; c < 4; ++c) {
                model::Node child;
                child.parent = static_cast<Index>(i);
                child.box = box;
                ((c & 1) != 0 ? child.box.min.x : child.box.max.x) = middle.x;
                ((c & 2) != 0 ? child.box.min.z : child.box.max.z) = middle.z;
                m.nodes.push_back(child);
            }
        }
        begin = end;
    }
    for (model::Node& node : m.nodes) {
        add_reps(m, node, random, node.child_count == 0 ? 3 : 2, node.box.diagonal() * 0.05, 600);
    }
    return m;
}

/// A random eye in or around the model.
inline Pose random_pose(Random& random, double reach_m = 70.0) {
    Pose pose;
    pose.position = dvec3(random.range(-reach_m, reach_m), random.range(-8.0, 20.0), random.range(-reach_m, reach_m));
    const dquat q(random.range(-1, 1), random.range(-1, 1), random.range(-1, 1), random.range(-1, 1));
    pose.orientation = glm::length(q) > 1e-3 ? glm::normalize(q) : dquat(1, 0, 0, 0);
    pose.fov_y_rad = random.range(0.3, 2.0);
    return pose;
}

}  // namespace surefoot::test
