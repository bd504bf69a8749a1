// Classes by node, floors beside sheets, then one tree for what stands once and one for each shared mesh.
#include "render/bake/ground.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "render/bake/ground_build.hpp"
#include "render/bake/ground_classes.hpp"
#include "render/bake/stage.hpp"
#include "render/model/ground/near.hpp"
#include "render/model/ground/walker.hpp"

namespace surefoot::bake {

namespace {

constexpr double lattice_step_m = 1.0 / 4096;    // a quarter of a millimetre, in the world
constexpr std::size_t min_shared_triangles = 8;  // smaller meshes take less room in the world's own tree than placed

bool is_placed(const importer::Scene& scene, const importer::Node& node) {
    if (node.mesh == importer::none || scene.meshes[node.mesh].primitives.empty()) return false;
    const double volume = std::abs(glm::determinant(dmat3(node.world)));
    return std::isfinite(volume) && volume > 0;
}

model::GroundTriangle triangle_of(const GroundFacts& facts, std::size_t t, const dmat4& world) {
    const auto place = [&](std::uint32_t point) { return dvec3(world * dvec4(facts.points[point], 1.0)); };
    const bool mirrored = glm::determinant(dmat3(world)) < 0;  // fronts stay fronts
    return {place(facts.corners[t][0]), place(facts.corners[t][mirrored ? 2 : 1]), place(facts.corners[t][mirrored ? 1 : 2])};
}

double largest_scale(const dmat4& world) {
    return std::max({glm::length(dvec3(world[0])), glm::length(dvec3(world[1])), glm::length(dvec3(world[2]))});
}

class GroundMaker {
public:
    GroundMaker(const importer::Scene& scene, const Progress& progress)
        : scene_(scene),
          facts_(scene.meshes.size()),
          blocking_(scene.nodes.size()),
          stage_(progress, "ground", scene.meshes.size() + 2 * scene.nodes.size()) {}

    /// False: stopped.
    bool run() {
        find_facts();
        if (go_) classify_solids();
        if (go_ && has_sheer()) {
            const model::Ground solid = trees();
            if (go_) classify_sheets(solid);
        } else {
            for (std::size_t n = 0; n < scene_.nodes.size(); ++n) (void)stage_.step();
        }
        return go_;
    }
    /// Solid triangles alone, without rules of nodes. False: stopped.
    bool run_opaque() {
        find_facts();
        if (go_) classify_solids(false);
        return go_;
    }
    /// What shades without being solid: masks, and solid parts smaller than a foot. False: stopped.
    bool run_leaves() {
        if (!run_opaque()) return false;
        for_all(scene_.nodes.size(), [&](std::size_t n) {
            const importer::Node& node = scene_.nodes[n];
            if (!is_placed(scene_, node) || node.motion != importer::none) return;
            std::size_t t = 0;
            for (const importer::Primitive& p : scene_.meshes[node.mesh].primitives) {
                const bool clear = scene_.materials[p.material].alpha == model::AlphaMode::blend;
                for (std::size_t i = 0; i < p.indices.size() / 3; ++i, ++t) blocking_[n][t] = !blocking_[n][t] && !clear;
            }
        });
        return true;
    }
    /// Of all nodes as they stand at rest, or of those that never move.
    [[nodiscard]] model::Ground trees(bool still_only = false);
    [[nodiscard]] model::MovingGround moving_trees();
    [[nodiscard]] BlockingTriangles& blocking() { return blocking_; }

private:
    /// Nodes that block with the same triangles of one mesh, by mesh and triangles.
    using Variants = std::map<std::pair<importer::Index, std::vector<bool>>, std::vector<std::size_t>>;
    [[nodiscard]] bool moves(std::size_t node) const { return scene_.nodes[node].motion != importer::none; }
    template <class Wanted>
    [[nodiscard]] Variants variants(const Wanted& wanted) const {
        Variants found;
        for (std::size_t n = 0; n < blocking_.size(); ++n) {
            if (!wanted(n) || std::find(blocking_[n].begin(), blocking_[n].end(), true) == blocking_[n].end()) continue;
            found[{scene_.nodes[n].mesh, blocking_[n]}].push_back(n);
        }
        return found;
    }
    void add_triangles(std::size_t node, const dmat4& world, std::vector<model::GroundTriangle>& to) const {
        const GroundFacts& facts = facts_[scene_.nodes[node].mesh];
        for (std::size_t t = 0; t < facts.corners.size(); ++t)
            if (blocking_[node][t]) to.push_back(triangle_of(facts, t, world));
    }
    /// In the mesh's frame.
    [[nodiscard]] GroundTree shared_tree(const std::vector<std::size_t>& nodes) const {
        std::vector<model::GroundTriangle> triangles;
        add_triangles(nodes.front(), dmat4(1.0), triangles);
        double scale = 0;
        for (const std::size_t n : nodes) scale = std::max(scale, largest_scale(scene_.nodes[n].world));
        return build_tree(triangles, lattice_step_m / scale);
    }
    void add_instances(const std::vector<std::size_t>& nodes, model::Ground& ground) const {
        for (const std::size_t n : nodes) {
            const dmat4& world = scene_.nodes[n].world;
            ground.instances.push_back({dvec3(world[3]), mat3(world), static_cast<std::uint32_t>(ground.meshes.size() - 1)});
        }
    }
    void find_facts() {
        std::vector<bool> used(scene_.meshes.size(), false);
        for (const importer::Node& node : scene_.nodes)
            if (is_placed(scene_, node)) used[node.mesh] = true;
        for_all(scene_.meshes.size(), [&](std::size_t m) {
            if (!go_) return;
            if (used[m]) facts_[m] = ground_facts(scene_, scene_.meshes[m]);
            if (!stage_.step()) go_ = false;
        });
    }
    void classify_solids(bool by_rules = true) {
        for_all(scene_.nodes.size(), [&](std::size_t n) {
            if (!go_) return;
            const importer::Node& node = scene_.nodes[n];
            if (is_placed(scene_, node) && (by_rules || node.motion == importer::none)) {  // what moves has no baked shadow
                const GroundFacts& facts = facts_[node.mesh];
                if (!by_rules || node.walk == importer::WalkRule::by_rule)
                    blocking_[n] = blocking_solids(facts, node.world);
                else
                    blocking_[n].assign(facts.solid.size(), node.walk == importer::WalkRule::block);
            }
            if (!stage_.step()) go_ = false;
        });
    }
    [[nodiscard]] bool has_sheer() const {
        return std::any_of(facts_.begin(), facts_.end(), [](const GroundFacts& f) { return !f.all_solid(); });
    }
    void classify_sheets(const model::Ground& solid) {
        for_all(scene_.nodes.size(), [&](std::size_t n) {
            if (!go_) return;
            const importer::Node& node = scene_.nodes[n];
            if (is_placed(scene_, node) && node.walk == importer::WalkRule::by_rule && !facts_[node.mesh].all_solid()) {
                for (const Sheet& sheet : upright_sheets(facts_[node.mesh], node.world)) {
                    if (!has_floor(solid, sheet)) continue;
                    for (const std::uint32_t t : sheet.triangles) blocking_[n][t] = true;
                }
            }
            if (!stage_.step()) go_ = false;
        });
    }
    static bool has_floor(const model::Ground& solid, const Sheet& sheet) {
        for (const dvec3& place : places_beside(sheet)) {
            // Floors between these heights, and no others, can be the one.
            const Box line{dvec3(place.x, sheet.low_m - sheet_low_m, place.z),
                           dvec3(place.x, sheet.high_m - sheet_high_m, place.z)};
            bool found = false;
            model::for_triangles_near(solid, line, [&](const model::GroundTriangle& t) {
                const dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
                if (std::abs(n.y) < floor_min_y * glm::length(n)) return;
                const double y = model::height_at(t, place.x, place.z);
                found = found || (std::isfinite(y) && stands_on(sheet, y));
            });
            if (found) return true;
        }
        return false;
    }

    const importer::Scene& scene_;
    std::vector<GroundFacts> facts_;  ///< by mesh
    BlockingTriangles blocking_;
    std::atomic<bool> go_{true};
    Stage stage_;
};

/// Nodes that block with the same triangles of one mesh share a tree.
model::Ground GroundMaker::trees(bool still_only) {
    const Variants all = variants([&](std::size_t n) { return !still_only || !moves(n); });
    std::vector<std::size_t> once;  // nodes
    std::vector<const std::vector<std::size_t>*> shared;
    for (const auto& [variant, nodes] : all) {
        const auto triangles = static_cast<std::size_t>(std::count(variant.second.begin(), variant.second.end(), true));
        if (nodes.size() > 1 && triangles >= min_shared_triangles)
            shared.push_back(&nodes);
        else
            once.insert(once.end(), nodes.begin(), nodes.end());
    }
    std::sort(once.begin(), once.end());
    std::vector<GroundTree> trees(shared.size() + 1);
    for_all(trees.size(), [&](std::size_t i) {
        if (i > 0) {
            trees[i] = shared_tree(*shared[i - 1]);
            return;
        }
        std::vector<model::GroundTriangle> triangles;
        for (const std::size_t n : once) add_triangles(n, scene_.nodes[n].world, triangles);
        trees[0] = build_tree(triangles, lattice_step_m);
    });
    model::Ground ground;
    for (std::size_t i = 0; i < trees.size(); ++i) {
        const bool empty = trees[i].triangles == 0;
        if (empty && i > 0) continue;
        append(ground, std::move(trees[i]));
        if (i > 0) add_instances(*shared[i - 1], ground);
    }
    order_instances(ground);
    return ground;
}

/// Every node that moves is an instance, for it moves by itself.
model::MovingGround GroundMaker::moving_trees() {
    model::MovingGround moving;
    std::vector<std::uint32_t> motions;
    for (const auto& [variant, nodes] : variants([&](std::size_t n) { return moves(n); })) {
        GroundTree tree = shared_tree(nodes);
        if (tree.triangles == 0) continue;
        if (moving.rest.meshes.empty()) append(moving.rest, {});
        append(moving.rest, std::move(tree));
        add_instances(nodes, moving.rest);
        for (const std::size_t n : nodes) motions.push_back(scene_.nodes[n].motion);
    }
    for (const std::uint32_t old : order_instances(moving.rest)) moving.motions.push_back(motions[old]);
    return moving;
}

/// Whether a default walker could stand on any triangle.
bool has_floor(const model::Ground& ground) {
    const double min_up = std::cos(model::Body{}.slope_rad);
    const Box everywhere{dvec3(-1e30), dvec3(1e30)};
    bool found = false;
    const auto look_at = [&](const model::GroundTriangle& t) {
        const dvec3 normal = glm::cross(t.b - t.a, t.c - t.a);
        const double length = glm::length(normal);
        found = found || (length > 0 && std::abs(normal.y) >= min_up * length);
    };
    model::ground_tree::in_mesh(
        ground, ground.meshes[0], everywhere, [](const dvec3& p) { return p; }, look_at);
    for (std::size_t i = 0; i < ground.instances.size() && !found; ++i) {
        const model::GroundInstance& instance = ground.instances[i];
        const dmat3 linear(instance.linear);
        model::ground_tree::in_mesh(
            ground, ground.meshes[instance.mesh], everywhere, [&](const dvec3& p) { return instance.origin + linear * p; },
            look_at);
    }
    return found;
}

}  // namespace

model::Ground make_ground(const importer::Scene& scene, const Progress& progress, BlockingTriangles* blocking,
                          model::MovingGround* moving) {
    GroundMaker maker(scene, progress);
    if (!maker.run()) return {};
    model::Ground ground = maker.trees(moving != nullptr);
    if (moving != nullptr) *moving = maker.moving_trees();
    if (blocking != nullptr) *blocking = std::move(maker.blocking());
    return ground;
}

model::Ground make_opaque_ground(const importer::Scene& scene, const Progress& progress) {
    GroundMaker maker(scene, progress);
    return maker.run_opaque() ? maker.trees() : model::Ground{};
}

model::Ground make_leaf_ground(const importer::Scene& scene, const Progress& progress) {
    GroundMaker maker(scene, progress);
    return maker.run_leaves() ? maker.trees() : model::Ground{};
}

std::vector<std::string> ground_warnings(const model::Ground& ground, const Box& all) {
    std::vector<std::string> lines;
    const dvec3 sides = all.empty() ? dvec3(0.0) : all.max - all.min;
    const double widest = std::max(sides.x, sides.z);
    if (ground.empty()) lines.emplace_back("Ground: nothing blocks a walker, so it passes through all and glides at its height");
    if (widest < 1)
        lines.push_back(fmt::format("Ground: the model is {:.3g} m wide, smaller than a walker; are its units metres?", widest));
    if (widest > 1e5) lines.push_back(fmt::format("Ground: the model is {:.3g} km wide; are its units metres?", widest / 1000));
    if (!ground.empty() && !has_floor(ground))
        lines.emplace_back("Ground: there are walls, but nothing level enough to stand on, so walkers glide at their height");
    return lines;
}

}  // namespace surefoot::bake
