// Clusters by the growing grid of Maciel 1994, section 3.4.3.
#include "render/bake/cluster.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace surefoot::bake {

namespace {

struct Grower {
    std::span<const Box> objects;
    std::uint32_t max_children;
    ClusterTree tree;

    [[nodiscard]] const Box& box_of(std::uint32_t entity) const {
        return entity < objects.size() ? objects[entity] : tree.clusters[entity - objects.size()].box;
    }
    std::uint32_t make(std::vector<std::uint32_t> children);
};

/// One cluster of `children`; more than `max_children` are halved at the median of the longest axis until they fit.
std::uint32_t Grower::make(std::vector<std::uint32_t> children) {
    if (children.size() == 1) return children[0];
    while (children.size() > max_children) {
        // Groups of about `max_children`, by halving: each group is a cluster of its own.
        std::vector<std::vector<std::uint32_t>> groups{children};
        while (groups.size() < max_children && groups.front().size() > 2) {
            std::vector<std::vector<std::uint32_t>> halves;
            for (auto& group : groups) {
                Box centres;
                for (const std::uint32_t e : group) centres.grow(box_of(e).centre());
                const dvec3 size = centres.max - centres.min;
                const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.z >= size.y ? 2 : 1;
                std::sort(group.begin(), group.end(), [&](std::uint32_t a, std::uint32_t b) {
                    const double ca = box_of(a).centre()[axis], cb = box_of(b).centre()[axis];
                    return ca != cb ? ca < cb : a < b;
                });
                const auto middle = group.begin() + static_cast<std::ptrdiff_t>(group.size() / 2);
                halves.emplace_back(group.begin(), middle);
                halves.emplace_back(middle, group.end());
            }
            groups = std::move(halves);
        }
        std::vector<std::uint32_t> made;
        made.reserve(groups.size());
        for (auto& group : groups) made.push_back(make(std::move(group)));
        children = std::move(made);
    }
    ClusterTree::Cluster cluster;
    for (const std::uint32_t e : children) cluster.box.grow(box_of(e));
    std::sort(children.begin(), children.end());
    cluster.children = std::move(children);
    tree.clusters.push_back(std::move(cluster));
    return static_cast<std::uint32_t>(objects.size() + tree.clusters.size() - 1);
}

}  // namespace

ClusterTree grow_clusters(std::span<const Box> objects, std::uint32_t max_children) {
    Grower grower{objects, max_children, {}};
    std::vector<std::uint32_t> open;
    Box world;
    std::vector<double> sizes;
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
        open.push_back(i);
        world.grow(objects[i]);
        const dvec3 d = objects[i].max - objects[i].min;
        sizes.push_back(std::max({d.x, d.y, d.z}));
    }
    const dvec3 extent = world.max - world.min;
    const double whole = std::max({extent.x, extent.y, extent.z, 1e-9});
    std::sort(sizes.begin(), sizes.end());
    double cell = whole;
    while (cell > std::max(sizes[sizes.size() / 4], whole / 65536.0)) cell /= 2;
    for (; open.size() > 1; cell *= 2) {
        const bool last = cell >= whole;
        std::map<std::tuple<std::int64_t, std::int64_t, std::int64_t>, std::vector<std::uint32_t>> cells;
        std::vector<std::uint32_t> next;
        for (const std::uint32_t e : open) {
            const Box& box = grower.box_of(e);
            const dvec3 d = box.max - box.min;
            if (!last && std::max({d.x, d.y, d.z}) > cell) {
                next.push_back(e);
                continue;
            }
            const dvec3 at = last ? dvec3(0) : glm::floor((box.centre() - world.min) / cell);
            cells[{static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y), static_cast<std::int64_t>(at.z)}].push_back(
                e);
        }
        for (auto& [key, members] : cells) next.push_back(grower.make(std::move(members)));
        std::sort(next.begin(), next.end());
        open = std::move(next);
    }
    grower.tree.root = open.front();
    return std::move(grower.tree);
}

ClusterTree grow_clusters_apart(std::span<const Box> objects, const std::vector<bool>& kind, std::uint32_t max_children) {
    const auto count = static_cast<std::uint32_t>(objects.size());
    ClusterTree out;
    ClusterTree::Cluster root;
    for (const bool which : {true, false}) {
        std::vector<std::uint32_t> of_kind;
        std::vector<Box> boxes;
        for (std::uint32_t i = 0; i < count; ++i)
            if (kind[i] == which) of_kind.push_back(i), boxes.push_back(objects[i]);
        if (of_kind.empty()) continue;
        if (of_kind.size() == count) return grow_clusters(objects, max_children);
        const auto before = static_cast<std::uint32_t>(out.clusters.size()), size = static_cast<std::uint32_t>(of_kind.size());
        const auto renamed = [&](std::uint32_t e) { return e < size ? of_kind[e] : count + before + (e - size); };
        ClusterTree tree = grow_clusters(boxes, max_children);
        for (ClusterTree::Cluster& cluster : tree.clusters) {
            for (std::uint32_t& child : cluster.children) child = renamed(child);
            out.clusters.push_back(std::move(cluster));
        }
        root.children.push_back(renamed(tree.root));
        for (const Box& box : boxes) root.box.grow(box);
    }
    out.clusters.push_back(std::move(root));
    out.root = count + static_cast<std::uint32_t>(out.clusters.size()) - 1;
    return out;
}

std::vector<std::vector<std::uint32_t>> clusters_by_height(const ClusterTree& tree, std::uint32_t objects,
                                                           std::vector<std::vector<std::uint32_t>>& members) {
    std::vector<std::vector<std::uint32_t>> by_height;
    members.assign(tree.clusters.size(), {});
    std::vector<std::uint32_t> height(tree.clusters.size(), 0);
    for (std::uint32_t c = 0; c < tree.clusters.size(); ++c) {  // children come first
        for (const std::uint32_t e : tree.clusters[c].children) {
            if (e < objects) {
                members[c].push_back(e);
            } else {
                members[c].insert(members[c].end(), members[e - objects].begin(), members[e - objects].end());
                height[c] = std::max(height[c], height[e - objects] + 1);
            }
        }
        if (by_height.size() <= height[c]) by_height.resize(height[c] + 1);
        by_height[height[c]].push_back(c);
    }
    return by_height;
}

}  // namespace surefoot::bake
