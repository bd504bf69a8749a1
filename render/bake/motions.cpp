// Motions of the bake (motions.hpp). Until sweep_boxes() all boxes are of things at rest.
#include "render/bake/motions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "render/bake/ground_build.hpp"

namespace surefoot::bake {

namespace {

using model::Index;

/// Joins trees over some of the objects into one.
class TreeJoiner {
public:
    explicit TreeJoiner(std::size_t objects) : objects_(static_cast<std::uint32_t>(objects)) {}

    /// `entities`: what the part's objects stand for. Returns its root as an entity of the whole.
    std::uint32_t add(ClusterTree part, std::span<const std::uint32_t> entities, Index motion) {
        const auto own = static_cast<std::uint32_t>(entities.size());
        const auto base = static_cast<std::uint32_t>(tree_.clusters.size());
        const auto renamed = [&](std::uint32_t e) { return e < own ? entities[e] : objects_ + base + (e - own); };
        for (ClusterTree::Cluster& cluster : part.clusters) {
            for (std::uint32_t& child : cluster.children) child = renamed(child);
            cluster.motion = motion;
            tree_.clusters.push_back(std::move(cluster));
        }
        return renamed(part.root);
    }
    /// A cluster above two others.
    std::uint32_t join(std::uint32_t a, std::uint32_t b, const Box& box) {
        tree_.clusters.push_back({box, {std::min(a, b), std::max(a, b)}});
        return objects_ + static_cast<std::uint32_t>(tree_.clusters.size() - 1);
    }
    /// displacements_m: of the entities that move though what is above them does not.
    ClusterTree take(std::uint32_t root, const std::map<std::uint32_t, double>& displacements_m) {
        for (ClusterTree::Cluster& cluster : tree_.clusters) {  // children come first
            if (cluster.motion != model::none) continue;
            for (const std::uint32_t child : cluster.children) {
                const auto moves = displacements_m.find(child);
                const double of_child = moves != displacements_m.end() ? moves->second
                                        : child < objects_             ? 0
                                                                       : tree_.clusters[child - objects_].displacement_m;
                cluster.displacement_m = std::max(cluster.displacement_m, of_child);
            }
        }
        tree_.root = root;
        return std::move(tree_);
    }

private:
    std::uint32_t objects_;
    ClusterTree tree_;
};

/// Some of the objects, with their boxes at rest.
struct Members {
    std::vector<std::uint32_t> objects;
    std::vector<Box> boxes;
    Box box;
    void add(std::uint32_t object, const Box& at) {
        objects.push_back(object);
        boxes.push_back(at);
        box.grow(at);
    }
};

ClusterTree clusters_of_still(const Members& still, const std::vector<bool>& in_rooms, std::uint32_t max_children) {
    if (in_rooms.empty()) return grow_clusters(still.boxes, max_children);
    std::vector<bool> kind;
    for (const std::uint32_t object : still.objects) kind.push_back(in_rooms[object]);
    return grow_clusters_apart(still.boxes, kind, max_children);
}

void add_box_triangles(const Box& box, std::vector<model::GroundTriangle>& to) {
    const auto corner = [&](unsigned c) {
        return dvec3((c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y,
                     (c & 4U) != 0 ? box.max.z : box.min.z);
    };
    constexpr std::array<std::array<unsigned, 4>, 6> faces = {
        {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
    for (const auto& f : faces) {
        to.push_back({corner(f[0]), corner(f[1]), corner(f[2])});
        to.push_back({corner(f[0]), corner(f[2]), corner(f[3])});
    }
}

/// Boxes that contain the way of a box. A long way is many boxes, so that what it goes round stays free.
std::vector<Box> boxes_of_way(const model::Model& model, Index motion, const Box& at_rest) {
    const model::Motion& own = model.motions[motion];
    if (own.outer != model::none) return {model::reach_of(model, motion, at_rest).box};
    constexpr std::uint32_t max_boxes = 64;
    const std::uint32_t spans = std::max(1U, own.key_count - 1), each = (spans + max_boxes - 1) / max_boxes;
    std::vector<Box> boxes;
    for (std::uint32_t first = 0; first < spans; first += each) {
        model::Model part;  // some of its keys alone
        const std::uint32_t keys = std::min(each + 1, own.key_count - first);
        const auto from = model.motion_keys.begin() + std::ptrdiff_t{own.first_key} + std::ptrdiff_t{first};
        part.motion_keys.assign(from, from + keys);
        part.motions.push_back(own);
        part.motions[0].first_key = 0;
        part.motions[0].key_count = keys;
        boxes.push_back(model::reach_of(part, 0, at_rest, false).box);
    }
    return boxes;
}

}  // namespace

std::vector<Index> adopt_motions(const importer::Scene& scene, std::vector<PlacedObject>& objects, model::Model& model) {
    std::vector<bool> used(scene.motions.size(), false);
    for (const PlacedObject& object : objects)
        for (Index m = object.motion; m != model::none && !used[m]; m = scene.motions[m].outer) used[m] = true;
    std::vector<Index> renamed(scene.motions.size(), model::none);
    for (std::size_t m = 0; m < used.size(); ++m) {  // outer ones come first
        if (!used[m]) continue;
        renamed[m] = static_cast<Index>(model.motions.size());
        model::Motion motion = scene.motions[m];
        const auto from = scene.motion_keys.begin() + static_cast<std::ptrdiff_t>(motion.first_key);
        motion.first_key = static_cast<std::uint32_t>(model.motion_keys.size());
        if (motion.outer != model::none) motion.outer = renamed[motion.outer];
        model.motion_keys.insert(model.motion_keys.end(), from, from + motion.key_count);
        model.motions.push_back(motion);
    }
    for (PlacedObject& object : objects)
        if (object.motion != model::none) object.motion = renamed[object.motion];
    return renamed;
}

ClusterTree cluster_objects(std::span<const PlacedObject> objects, const std::vector<bool>& in_rooms, const model::Model& model,
                            std::uint32_t max_children) {
    Members still, moving;
    std::map<Index, Members> by_motion;
    for (std::uint32_t i = 0; i < objects.size(); ++i)
        (objects[i].motion == model::none ? still : by_motion[objects[i].motion]).add(i, objects[i].box);
    if (by_motion.empty()) return clusters_of_still(still, in_rooms, max_children);
    TreeJoiner joiner(objects.size());
    std::map<std::uint32_t, double> displacements_m;
    for (const auto& [motion, members] : by_motion) {
        const model::MotionReach reach = model::reach_of(model, motion, members.box);
        const std::uint32_t entity = joiner.add(grow_clusters(members.boxes, max_children), members.objects, motion);
        displacements_m[entity] = reach.displacement_m;
        moving.add(entity, reach.box);
    }
    const std::uint32_t movers = joiner.add(grow_clusters(moving.boxes, max_children), moving.objects, model::none);
    if (still.objects.empty()) return joiner.take(movers, displacements_m);
    const std::uint32_t rest = joiner.add(clusters_of_still(still, in_rooms, max_children), still.objects, model::none);
    still.box.grow(moving.box);
    return joiner.take(joiner.join(rest, movers, still.box), displacements_m);
}

void add_displacement(LodChain& chain, double displacement_m) {
    if (!(displacement_m > 0)) return;
    float above = 0;
    for (std::size_t i = chain.levels.size(); i-- > 0;) {  // fine to coarse: errors keep rising
        Level& level = chain.levels[i];
        const auto error_m = static_cast<float>(static_cast<double>(level.error_m) + displacement_m);
        level.error_m = std::max(std::nextafter(error_m, std::numeric_limits<float>::infinity()), above);
        above = std::nextafter(level.error_m, std::numeric_limits<float>::infinity());
    }
}

void sweep_boxes(model::Model& model) {
    if (model.motions.empty()) return;
    for (model::Node& node : model.nodes) {
        const Index motion = model::motion_of(model, node);
        if (motion != model::none) node.box = model::reach_of(model, motion, node.box).box;
    }
    for (std::size_t i = model.nodes.size(); i-- > 1;)  // children come after their parents
        model.nodes[model.nodes[i].parent].box.grow(model.nodes[i].box);
}

std::optional<model::Ground> ground_with_ways(const model::Model& model) {
    std::vector<model::GroundTriangle> triangles;
    for (const model::Node& node : model.nodes) {
        const Index motion = model::motion_of(model, node);
        if (motion == model::none || node.child_count > 0) continue;
        for (const Box& box : boxes_of_way(model, motion, node.box)) add_box_triangles(box, triangles);
    }
    if (triangles.empty()) return {};
    model::Ground ground = model.ground;
    append(ground, build_tree(triangles, 1.0 / 4096));
    if (ground.meshes.size() > 1) {
        ground.instances.push_back({dvec3(0.0), mat3(1.0F), static_cast<std::uint32_t>(ground.meshes.size() - 1)});
        order_instances(ground);
    }
    return ground;
}

}  // namespace surefoot::bake
