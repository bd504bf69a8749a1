// The glTF node graph to a Scene's nodes: world matrices in double, instances, cycles refused.

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "render/import/finish.hpp"
#include "render/import/gltf_parts.hpp"
#include "render/import/stand_ins.hpp"

namespace surefoot::importer {
namespace {

dmat4 compose(const dvec3& t, const dquat& r, const dvec3& s) {
    dmat4 m = glm::mat4_cast(r);
    for (int c = 0; c < 3; ++c) m[c] *= s[c];
    m[3] = dvec4(t, 1.0);
    return m;
}

dquat unit(double x, double y, double z, double w) {
    const dquat q(w, x, y, z);
    const double length = glm::length(q);
    return std::isfinite(length) && length > 1e-12 ? q / length : dquat(1, 0, 0, 0);
}

}  // namespace

dmat4 local_matrix(const tinygltf::Node& node) {
    dmat4 m(1.0);
    if (node.matrix.size() == 16) {
        for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = node.matrix[static_cast<std::size_t>(i)];
        return m;
    }
    const dvec3 t =
        node.translation.size() == 3 ? dvec3(node.translation[0], node.translation[1], node.translation[2]) : dvec3(0);
    const dvec3 s = node.scale.size() == 3 ? dvec3(node.scale[0], node.scale[1], node.scale[2]) : dvec3(1);
    const auto& q = node.rotation;
    return compose(t, q.size() == 4 ? unit(q[0], q[1], q[2], q[3]) : dquat(1, 0, 0, 0), s);
}

namespace {

NodePose rest_pose(const tinygltf::Node& node) {
    const auto& t = node.translation;
    const auto& q = node.rotation;
    return {t.size() == 3 ? dvec3(t[0], t[1], t[2]) : dvec3(0), q.size() == 4 ? unit(q[0], q[1], q[2], q[3]) : dquat(1, 0, 0, 0)};
}

float importance_of(const tinygltf::Node& node) {
    if (!node.extras.Has("importance") || !node.extras.Get("importance").IsNumber()) return 1.0F;
    const double value = node.extras.Get("importance").GetNumberAsDouble();
    return std::isfinite(value) ? static_cast<float>(std::clamp(value, 0.0, 1.0)) : 1.0F;
}

/// Extras `walk`: "block" or "pass"; else as the parent has it.
WalkRule walk_of(const tinygltf::Node& node, WalkRule inherited, Scene& scene) {
    if (!node.extras.Has("walk")) return inherited;
    const tinygltf::Value& value = node.extras.Get("walk");
    const std::string text = value.IsString() ? value.Get<std::string>() : "";
    if (text == "block") return WalkRule::block;
    if (text == "pass") return WalkRule::pass;
    scene.warnings.push_back(
        fmt::format("Node '{}': the extra 'walk' is neither \"block\" nor \"pass\"; it is ignored", node.name));
    return inherited;
}

/// EXT_mesh_gpu_instancing: one matrix an instance.
Result<std::vector<dmat4>> instances_of(const tinygltf::Model& model, const tinygltf::Value& extension,
                                        const std::string& place) {
    const tinygltf::Value& attributes = extension.IsObject() ? extension.Get("attributes") : extension;
    const auto read = [&](const char* name, std::size_t components) -> Result<FloatArray> {
        if (!attributes.IsObject() || !attributes.Has(name)) return FloatArray{};
        auto floats = read_floats(model, attributes.Get(name).GetNumberAsInt(), place);
        if (floats && floats->components != components)
            return Error{place, fmt::format("The instance attribute {} has {} components", name, floats->components),
                         export_again, ErrorKind::damaged};
        return floats;
    };
    auto t = read("TRANSLATION", 3), r = read("ROTATION", 4), s = read("SCALE", 3);
    for (const auto* array : {&t, &r, &s}) {
        if (!*array) return array->error();
    }
    const std::size_t count = std::max({t->count(), r->count(), s->count()});
    std::vector<dmat4> out;
    out.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float *ti = i < t->count() ? &t->values[i * 3] : nullptr, *ri = i < r->count() ? &r->values[i * 4] : nullptr,
                    *si = i < s->count() ? &s->values[i * 3] : nullptr;
        out.push_back(compose(ti != nullptr ? dvec3(ti[0], ti[1], ti[2]) : dvec3(0),
                              ri != nullptr ? unit(ri[0], ri[1], ri[2], ri[3]) : dquat(1, 0, 0, 0),
                              si != nullptr ? dvec3(si[0], si[1], si[2]) : dvec3(1)));
    }
    return out;
}

/// Walks the graph depth first without recursion (files nest as deep as they like).
class Walk {
public:
    Walk(const tinygltf::Model& model, const std::string& file, Scene& scene)
        : model_(model), file_(file), scene_(scene), lights_(model, scene), state_(model.nodes.size(), State::fresh) {}

    LightReader& lights() { return lights_; }
    /// Nodes move as it says; without one all stand still.
    void animate(AnimationReader& reader) { animations_ = &reader; }
    /// Leaves this node out, and what is below it.
    void skip(int node) { state_[static_cast<std::size_t>(node)] = State::skipped; }

    Result<void> from(int root) {
        if (auto entered = enter(root, none); !entered) return entered;
        while (!stack_.empty()) {
            Frame& top = stack_.back();
            const auto& children = model_.nodes[static_cast<std::size_t>(top.node)].children;
            if (top.next == children.size()) {
                state_[static_cast<std::size_t>(top.node)] = State::done;
                stack_.pop_back();
                continue;
            }
            const int child = children[top.next++];
            if (auto entered = enter(child, top.index); !entered) return entered;
        }
        return {};
    }

private:
    enum class State : std::uint8_t { fresh, open, done, skipped };
    struct Frame {
        int node;
        Index index;
        std::size_t next;
    };

    std::string name_of(int node) const {
        const std::string& name = model_.nodes[static_cast<std::size_t>(node)].name;
        return name.empty() ? fmt::format("node {}", node) : name;
    }

    Result<void> enter(int node, Index parent) {
        if (node < 0 || static_cast<std::size_t>(node) >= model_.nodes.size()) {
            scene_.damaged(
                fmt::format("Child {} of '{}' does not exist", node, parent == none ? "the scene" : scene_.nodes[parent].name));
            return {};
        }
        State& state = state_[static_cast<std::size_t>(node)];
        if (state == State::open)
            return Error{file_, fmt::format("Node '{}' is its own ancestor", name_of(node)), "Break the cycle in the node graph",
                         ErrorKind::damaged};
        if (state == State::skipped) return {};
        if (state == State::done) {
            scene_.warnings.push_back(fmt::format("Node '{}' has more than one parent; only the first is kept", name_of(node)));
            return {};
        }
        state = State::open;
        add(node, parent);
        return {};
    }

    void add(int node, Index parent) {
        const tinygltf::Node& from = model_.nodes[static_cast<std::size_t>(node)];
        Node to;
        to.name = name_of(node);
        to.parent = parent;
        to.world = (parent == none ? dmat4(1.0) : scene_.nodes[parent].world) * local_matrix(from);
        to.importance = importance_of(from);
        if (parent != none) to.motion = scene_.nodes[parent].motion;
        if (animations_ != nullptr)
            to.motion = animations_->motion_of(node, rest_pose(from), parent == none ? dmat4(1.0) : scene_.nodes[parent].world,
                                               to.motion);
        to.walk = walk_of(from, parent == none ? WalkRule::by_rule : scene_.nodes[parent].walk, scene_);
        if (from.mesh >= 0 && static_cast<std::size_t>(from.mesh) < scene_.meshes.size()) to.mesh = static_cast<Index>(from.mesh);
        if (from.mesh >= 0 && to.mesh == none)
            scene_.damaged(fmt::format("Node '{}' names mesh {}, which does not exist", to.name, from.mesh));
        if (from.skin >= 0)
            scene_.warnings.push_back(
                fmt::format("Node '{}' is taken in its rest pose (skin). Apply the pose before the export", to.name));
        lights_.add(from, to.world);
        const auto index = static_cast<Index>(scene_.nodes.size());
        const auto instancing = from.extensions.find("EXT_mesh_gpu_instancing");
        scene_.nodes.push_back(std::move(to));
        if (instancing != from.extensions.end()) add_instances(index, instancing->second);
        stack_.push_back({node, index, 0});
    }

    void add_instances(Index node, const tinygltf::Value& extension) {
        auto matrices = instances_of(model_, extension, file_ + ": node '" + scene_.nodes[node].name + "'");
        if (!matrices) {
            scene_.damaged("Instances are dropped: " + in_short(matrices.error()));
            return;
        }
        const Node parent = scene_.nodes[node];
        scene_.nodes[node].mesh = none;
        for (std::size_t i = 0; i < matrices->size(); ++i) {
            scene_.nodes.push_back(Node{fmt::format("{} #{}", parent.name, i), node, parent.mesh, parent.world * (*matrices)[i],
                                        parent.importance, parent.walk, parent.motion});
        }
    }

    const tinygltf::Model& model_;
    const std::string& file_;
    Scene& scene_;
    LightReader lights_;
    AnimationReader* animations_ = nullptr;
    std::vector<State> state_;
    std::vector<Frame> stack_;
};

std::vector<int> nodes_without_parent(const tinygltf::Model& model) {
    std::vector<bool> child(model.nodes.size(), false);
    for (const tinygltf::Node& node : model.nodes) {
        for (const int c : node.children) {
            if (c >= 0 && static_cast<std::size_t>(c) < child.size()) child[static_cast<std::size_t>(c)] = true;
        }
    }
    std::vector<int> roots;
    for (std::size_t i = 0; i < child.size(); ++i) {
        if (!child[i]) roots.push_back(static_cast<int>(i));
    }
    // Every node is somebody's child: all are in cycles. Any of them finds one.
    if (roots.empty() && !child.empty()) roots.push_back(0);
    return roots;
}

/// Extras `fog_visibility_m` of the scene.
void read_fog(const tinygltf::Scene& from, Scene& scene) {
    if (!from.extras.IsObject() || !from.extras.Has("fog_visibility_m")) return;
    const tinygltf::Value& value = from.extras.Get("fog_visibility_m");
    const double visibility_m = value.IsNumber() ? value.GetNumberAsDouble() : -1;
    if (visibility_m >= 0 && visibility_m <= 1e7)  // NaN is neither
        scene.fog_visibility_m = visibility_m;
    else
        scene.warnings.push_back("Scene: the extra 'fog_visibility_m' is no number of 0 to 1e7 metres; there is no fog");
}

/// Extra `sky` of the scene.
void read_sky(const tinygltf::Scene& from, Scene& scene) {
    if (!from.extras.IsObject() || !from.extras.Has("sky")) return;
    const tinygltf::Value& value = from.extras.Get("sky");
    if (value.IsBool())
        scene.sky = value.Get<bool>();
    else
        scene.warnings.push_back("Scene: the extra 'sky' is left out. Set it to true or false, or remove it");
}

std::vector<int> roots_of(const tinygltf::Model& model, Scene& scene) {
    if (model.scenes.empty()) return nodes_without_parent(model);
    const int wanted = model.defaultScene;
    const bool exists = wanted >= 0 && static_cast<std::size_t>(wanted) < model.scenes.size();
    if (wanted >= 0 && !exists)
        scene.warnings.push_back(fmt::format("Default scene {} does not exist; the first is taken", wanted));
    if (model.scenes.size() > 1)
        scene.warnings.push_back(fmt::format("The file has {} scenes; only one is taken", model.scenes.size()));
    const tinygltf::Scene& taken = model.scenes[exists ? static_cast<std::size_t>(wanted) : 0];
    read_fog(taken, scene);
    read_sky(taken, scene);
    return taken.nodes;
}

/// What stands for an object: its nodes are placed behind those of the scene, joined, and taken away again.
void add_stand_in(const tinygltf::Model& model, const std::string& file, const std::vector<StandInClaim>& claims,
                  const StandInClaim& claim, Scene& scene) {
    const tinygltf::Node& object = model.nodes[static_cast<std::size_t>(claim.object)];
    const std::size_t first = scene.nodes.size(), damage = scene.damage.size();
    Walk walk(model, file, scene);
    for (const StandInClaim& other : claims)
        if (other.stand_in != claim.stand_in) walk.skip(other.stand_in);
    std::string why;
    if (auto walked = walk.from(claim.stand_in); !walked) why = in_short(walked.error());
    walk.lights().warn();
    if (scene.damage.size() > damage) why = scene.damage.back().what;
    scene.damage.resize(damage);
    const std::string name = scene.nodes[first].name;
    const dmat4 frame = claim.same_frame ? scene.nodes[first].world : local_matrix(object);
    std::vector<Placed> placed = below(scene, static_cast<Index>(first));
    for (Placed& one : placed) one.at = glm::inverse(frame) * scene.nodes[first].world * one.at;
    scene.nodes.resize(first);
    if (static_cast<std::size_t>(object.mesh) >= scene.meshes.size()) why = "the object's mesh does not exist";
    if (placed.empty() && why.empty()) why = "it has no mesh";
    if (why.empty())
        scene.stand_ins.push_back({name, static_cast<Index>(object.mesh), joined(scene, placed, name)});
    else
        scene.warnings.push_back(fmt::format("Stand-in '{}' of '{}' is left out: {}", name,
                                             object.name.empty() ? fmt::format("node {}", claim.object) : object.name, why));
}

}  // namespace

Result<void> read_nodes(const tinygltf::Model& model, const std::string& file, Scene& scene) {
    if (model.nodes.empty() && !scene.meshes.empty()) {
        scene.warnings.emplace_back("The file has no nodes; each mesh is placed once, at the origin");
        for (std::size_t i = 0; i < scene.meshes.size(); ++i)
            scene.nodes.push_back(Node{scene.meshes[i].name, none, static_cast<Index>(i), dmat4(1.0), 1.0F});
        return {};
    }
    const std::vector<StandInClaim> claims = stand_in_claims(model, scene.warnings);
    Walk walk(model, file, scene);
    AnimationReader animations(model, file, scene);
    walk.animate(animations);
    for (const StandInClaim& claim : claims) walk.skip(claim.stand_in);
    for (const int root : roots_of(model, scene)) {
        if (auto walked = walk.from(root); !walked) return walked;
    }
    animations.warn();
    walk.lights().finish();
    for (const StandInClaim& claim : claims)
        if (claim.used) add_stand_in(model, file, claims, claim, scene);
    return {};
}

}  // namespace surefoot::importer
