// Animations of glTF nodes to rigid motions: translations and rotations; all else is refused by name.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "render/import/finish.hpp"
#include "render/import/gltf_parts.hpp"

namespace surefoot::importer {

namespace {

constexpr std::size_t max_keys_of_motion = 1U << 16U;
/// Of all tracks of a file: a translation and a rotation for each key that a model may have. As many of scales are read.
constexpr std::uint64_t max_keys_of_file = 2 * std::uint64_t{model::max_motion_keys};
constexpr double scale_slack = 1e-4;  // relative, of scales over 1
constexpr double unit_slack = 0.01;   // exporters write rotations as rounded bytes

Between between_of(const std::string& interpolation) {
    return interpolation == "STEP" ? Between::step : interpolation == "CUBICSPLINE" ? Between::spline : Between::linear;
}

bool finite_values(const dvec4& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

template <class T>
bool holds_index(const std::vector<T>& list, int index) {
    return index >= 0 && static_cast<std::size_t>(index) < list.size();
}

}  // namespace

AnimationReader::AnimationReader(const tinygltf::Model& model, const std::string& file, Scene& scene)
    : model_(model),
      file_(file),
      scene_(scene),
      nodes_(model.nodes.size()),
      drawn_(model.nodes.size(), false),
      refused_(model.nodes.size(), false),
      extents_(model.animations.size()),
      first_motion_(scene.motions.size()) {
    if (model.animations.empty()) return;
    find_drawn();
    if (const std::uint64_t keys = count_keys(); keys > max_keys_of_file) {
        flawed(Flaw::all_keys, fmt::format("All nodes are drawn at rest: their animations have {} keys, and a file may have {}",
                                           keys, max_keys_of_file));
        return;
    }
    if (const std::uint64_t keys = count_scales(); keys > max_keys_of_file) {
        flawed(Flaw::all_keys,
               fmt::format("All nodes are drawn at rest: their animations have {} keys of scales, and a file may have {}", keys,
                           max_keys_of_file));
        return;
    }
    find_worlds();
    for (int a = 0; a < static_cast<int>(model.animations.size()); ++a) read_animation(a);
}

void AnimationReader::flawed(Flaw flaw, std::string text) {
    Flawed& kind = flaws_[static_cast<std::size_t>(flaw)];
    if (kind.count++ == 0) kind.first = std::move(text);
}

void AnimationReader::warn() {
    for (Flawed& flaw : flaws_) {
        if (flaw.count == 2) flaw.first += "; 1 other is like it";
        if (flaw.count > 2) flaw.first += fmt::format("; {} others are like it", flaw.count - 1);
        const auto kind = static_cast<Flaw>(&flaw - flaws_.data());
        if (flaw.count > 0) scene_.warnings.push_back(fmt::format("{}. {}", flaw.first, remedy_of(kind)));
        flaw = {};
    }
}

const char* AnimationReader::remedy_of(Flaw flaw) {
    switch (flaw) {
        case Flaw::empty:
            return "Remove it, or give it keys";
        case Flaw::order:
            return "Sort the keys by time";
        case Flaw::number:
            return "Correct that number in the modelling program";
        case Flaw::quaternion:
            return "Normalize the rotations before the export";
        case Flaw::duration:
            return "Let it last from 0.001 to 500 000 s";
        case Flaw::scale:
            return "Take that animation out, or let a translation or rotation show the same";
        case Flaw::weights:
        case Flaw::kind:
        case Flaw::skin:
            return "Animate translations and rotations of nodes alone";
        case Flaw::matrix:
            return "Export the node's translation, rotation and scale in place of the matrix";
        case Flaw::taken:
            return "Join the animations of a node into one";
        case Flaw::shear:
            return "Apply the scale of the nodes above it";
        case Flaw::keys:
            return "Export fewer keys a second";
        case Flaw::all_keys:
            return "Export it with fewer keys a second, or with fewer animated nodes";
        case Flaw::depth:
            return "Let fewer animated nodes stand below each other";
        case Flaw::no_loop:
            return "End it as it begins, if it is to go round";
        case Flaw::broken:
        case Flaw::length:
        case Flaw::count:
            break;
    }
    return export_again;
}

std::string AnimationReader::name_of_node(int node) const {
    const std::string& name = model_.nodes[static_cast<std::size_t>(node)].name;
    return name.empty() ? fmt::format("node {}", node) : name;
}

std::string AnimationReader::name_of_animation(int animation) const {
    const std::string& name = model_.animations[static_cast<std::size_t>(animation)].name;
    return name.empty() ? fmt::format("animation {}", animation) : name;
}

/// Bones and cameras move nothing that is drawn: nobody needs to hear of their flaws.
void AnimationReader::find_drawn() {
    std::vector<int>& parent = parents_;
    parent.assign(nodes_.size(), -1);
    for (std::size_t n = 0; n < nodes_.size(); ++n)
        for (const int child : model_.nodes[n].children)
            if (holds_index(nodes_, child) && parent[static_cast<std::size_t>(child)] < 0)
                parent[static_cast<std::size_t>(child)] = static_cast<int>(n);
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        if (model_.nodes[n].mesh < 0) continue;
        for (int at = static_cast<int>(n); at >= 0 && !drawn_[static_cast<std::size_t>(at)];
             at = parent[static_cast<std::size_t>(at)])
            drawn_[static_cast<std::size_t>(at)] = true;
    }
}

/// Frames of all nodes to the world, at rest. Cycles are refused later.
void AnimationReader::find_worlds() {
    worlds_.assign(nodes_.size(), dmat4(1.0));
    std::vector<bool> found(nodes_.size(), false);
    std::vector<std::size_t> way;  // upwards to what is known
    for (std::size_t n = 0; n < nodes_.size(); ++n) {
        for (int at = static_cast<int>(n); at >= 0 && !found[static_cast<std::size_t>(at)];
             at = parents_[static_cast<std::size_t>(at)]) {
            way.push_back(static_cast<std::size_t>(at));
            found[way.back()] = true;
        }
        for (; !way.empty(); way.pop_back())
            worlds_[way.back()] = parent_world(way.back()) * local_matrix(model_.nodes[way.back()]);
    }
}

dmat4 AnimationReader::parent_world(std::size_t node) const {
    return parents_[node] < 0 ? dmat4(1.0) : worlds_[static_cast<std::size_t>(parents_[node])];
}

/// Whether the channel's node and sampler exist, and its values are read: they move something that is drawn.
bool AnimationReader::is_read(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& channel) const {
    if (!holds_index(nodes_, channel.target_node) || !holds_index(animation.samplers, channel.sampler)) return false;
    const auto node = static_cast<std::size_t>(channel.target_node);
    return drawn_[node] && model_.nodes[node].skin < 0 && model_.nodes[node].matrix.size() != 16;
}

/// Of an accessor. Nothing: it does not exist, or has too many to be read.
std::optional<std::uint64_t> AnimationReader::readable_values(int accessor) const {
    if (!holds_index(model_.accessors, accessor)) return {};
    const std::size_t count = model_.accessors[static_cast<std::size_t>(accessor)].count;
    return count <= 3 * max_keys_of_motion ? std::optional<std::uint64_t>(count) : std::nullopt;
}

/// All keys that are read below, before any is: a small file may have one long track at many nodes. Times without values are
/// read too.
std::uint64_t AnimationReader::count_keys() const {
    std::uint64_t keys = 0;
    std::vector<std::size_t> first(nodes_.size(), model_.animations.size());  // the animation that moves a node
    for (std::size_t a = 0; a < model_.animations.size(); ++a) {
        const tinygltf::Animation& animation = model_.animations[a];
        for (const tinygltf::AnimationChannel& channel : animation.channels) {
            if (channel.target_path != "translation" && channel.target_path != "rotation") continue;
            if (!is_read(animation, channel)) continue;
            const auto node = static_cast<std::size_t>(channel.target_node);
            const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(channel.sampler)];
            const auto times = readable_values(sampler.input), values = readable_values(sampler.output);
            if (!times || !values) continue;
            first[node] = std::min(first[node], a);
            if (first[node] != a) continue;
            keys += std::max(*times, *values / (between_of(sampler.interpolation) == Between::spline ? 3U : 1U));
        }
    }
    return keys;
}

/// The same of scales. Many nodes may share a track of them, which is read once.
std::uint64_t AnimationReader::count_scales() const {
    std::uint64_t keys = 0;
    std::set<std::pair<int, bool>> counted;
    for (const tinygltf::Animation& animation : model_.animations) {
        for (const tinygltf::AnimationChannel& channel : animation.channels) {
            if (channel.target_path != "scale" || !is_read(animation, channel)) continue;
            const tinygltf::AnimationSampler& sampler = animation.samplers[static_cast<std::size_t>(channel.sampler)];
            const bool spline = between_of(sampler.interpolation) == Between::spline;
            if (counted.insert({sampler.output, spline}).second)
                keys += readable_values(sampler.output).value_or(0) / (spline ? 3U : 1U);
        }
    }
    return keys;
}

void AnimationReader::read_animation(int animation) {
    const tinygltf::Animation& from = model_.animations[static_cast<std::size_t>(animation)];
    if (from.channels.empty())
        flawed(Flaw::empty, fmt::format("Animation '{}' is ignored: it has no channels", name_of_animation(animation)));
    moved_.clear();
    for (const tinygltf::AnimationChannel& channel : from.channels) read_channel(animation, channel);
    measure(animation);
}

void AnimationReader::refuse(int node, Flaw flaw, const std::string& why) {
    refused_[static_cast<std::size_t>(node)] = true;
    flawed(flaw, fmt::format("Node '{}' is drawn at rest: {}", name_of_node(node), why));
}

void AnimationReader::read_channel(int animation, const tinygltf::AnimationChannel& channel) {
    const int node = channel.target_node;
    if (!holds_index(nodes_, node) ||
        !holds_index(model_.animations[static_cast<std::size_t>(animation)].samplers, channel.sampler))
        return flawed(Flaw::broken, fmt::format("Animation '{}': a channel is ignored, since its node or sampler does not exist",
                                                name_of_animation(animation)));
    const auto at = static_cast<std::size_t>(node);
    if (!drawn_[at] || refused_[at]) return;
    const tinygltf::Node& target = model_.nodes[at];
    if (channel.target_path == "weights") return refuse(node, Flaw::weights, "its animation changes weights of morph targets");
    if (target.skin >= 0) return refuse(node, Flaw::skin, "it has a skin");
    if (target.matrix.size() == 16) return refuse(node, Flaw::matrix, "it is animated, and has a matrix");
    if (channel.target_path == "scale") {
        if (!scale_stays(animation, channel)) refuse(node, Flaw::scale, "its animation changes its scale");
        return;
    }
    const bool rotation = channel.target_path == "rotation";
    if (!rotation && channel.target_path != "translation")
        return refuse(node, Flaw::kind, fmt::format("its animation changes '{}'", channel.target_path));
    AnimatedNode& animated = nodes_[at];
    if (animated.animation >= 0 && animated.animation != animation)
        return flawed(Flaw::taken,
                      fmt::format("Animation '{}' is ignored at node '{}': '{}' moves it already", name_of_animation(animation),
                                  name_of_node(node), name_of_animation(animated.animation)));
    Track& track = rotation ? animated.rotation : animated.translation;
    if (!track.empty()) return;  // the file has it twice
    Track read;
    if (!read_track(animation, channel, rotation, read)) return;
    track = std::move(read);
    if (animated.animation < 0) moved_.push_back(node);
    animated.animation = animation;
}

/// False: the node stands still, and a flaw is named.
bool AnimationReader::read_track(int animation, const tinygltf::AnimationChannel& channel, bool rotation, Track& track) {
    const int node = channel.target_node;
    const tinygltf::AnimationSampler& sampler =
        model_.animations[static_cast<std::size_t>(animation)].samplers[static_cast<std::size_t>(channel.sampler)];
    const std::string place = fmt::format("{}: animation '{}'", file_, name_of_animation(animation));
    for (const int accessor : {sampler.input, sampler.output}) {
        if (!holds_index(model_.accessors, accessor))
            return refuse(node, Flaw::broken, "an accessor of its animation is missing"), false;
        if (model_.accessors[static_cast<std::size_t>(accessor)].count > 3 * max_keys_of_motion)
            return refuse(node, Flaw::keys, fmt::format("its animation has more than {} keys", max_keys_of_motion)), false;
    }
    auto times = read_floats(model_, sampler.input, place), values = read_floats(model_, sampler.output, place);
    if (!times || !values) return refuse(node, Flaw::broken, in_short((!times ? times : values).error())), false;
    track.between = between_of(sampler.interpolation);
    const std::size_t components = rotation ? 4 : 3, each = track.between == Between::spline ? 3 : 1;
    const std::size_t count = times->count();
    if (times->components != 1 || values->components != components || values->count() < each * count)
        return refuse(node, Flaw::length, "the times and values of its animation do not fit each other"), false;
    if (count == 0) return refuse(node, Flaw::empty, "its animation has no keys"), false;
    if (count > max_keys_of_motion)
        return refuse(node, Flaw::keys, fmt::format("its animation has more than {} keys", max_keys_of_motion)), false;
    track.times.assign(times->values.begin(), times->values.end());
    for (std::size_t i = 0; i < each * count; ++i) {
        const float* v = &values->values[i * components];
        track.values.emplace_back(v[0], v[1], v[2], rotation ? v[3] : 0);
    }
    return check_times(node, track) && check_values(node, rotation, track);
}

bool AnimationReader::check_times(int node, Track& track) {
    for (const double t : track.times)
        if (!std::isfinite(t)) return refuse(node, Flaw::number, "a number of its animation is not finite"), false;
    if (std::is_sorted(track.times.begin(), track.times.end())) return true;
    flawed(Flaw::order,
           fmt::format("Node '{}': the keys of its animation are out of order; they are sorted", name_of_node(node)));
    std::vector<std::size_t> order(track.times.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return track.times[a] < track.times[b]; });
    const std::size_t each = track.between == Between::spline ? 3 : 1;
    Track sorted;
    sorted.between = track.between;
    for (const std::size_t key : order) {
        sorted.times.push_back(track.times[key]);
        for (std::size_t i = 0; i < each; ++i) sorted.values.push_back(track.values[each * key + i]);
    }
    track = std::move(sorted);
    return true;
}

bool AnimationReader::check_values(int node, bool rotation, Track& track) {
    for (const dvec4& v : track.values) {
        if (!finite_values(v)) return refuse(node, Flaw::number, "a number of its animation is not finite"), false;
        if (!rotation && glm::length(v) > farthest_m)
            return refuse(node, Flaw::number, "its animation leads beyond 1e12 m"), false;
    }
    if (!rotation) return true;
    bool unit_length = true;
    for (std::size_t key = 0; key < track.times.size(); ++key) {
        dvec4& q = track.values[track.between == Between::spline ? 3 * key + 1 : key];
        const double length = glm::length(q);
        if (!(length > 1e-6)) return refuse(node, Flaw::quaternion, "a rotation of its animation is no quaternion"), false;
        unit_length = unit_length && std::abs(length - 1) <= unit_slack;
        q /= length;
    }
    if (!unit_length)
        flawed(Flaw::quaternion, fmt::format("Node '{}': rotations of its animation have not the length 1; they are normalized",
                                             name_of_node(node)));
    return true;
}

AnimationReader::ScaleTrack AnimationReader::read_scales(int output, bool spline) const {
    ScaleTrack track;
    if (!holds_index(model_.accessors, output) ||
        model_.accessors[static_cast<std::size_t>(output)].count > 3 * max_keys_of_motion)
        return track;
    const auto values = read_floats(model_, output, file_);
    if (!values || values->components != 3) return track;
    track.min = dvec3(std::numeric_limits<double>::infinity());
    track.max = -track.min;
    for (std::size_t i = 0; i < values->count(); ++i) {
        const float* v = &values->values[3 * i];
        const dvec3 value(v[0], v[1], v[2]);
        if (!finite_values(dvec4(value, 0))) return track;
        if (!spline || i % 3 == 1)
            track.min = glm::min(track.min, value), track.max = glm::max(track.max, value);
        else if (glm::any(glm::greaterThan(glm::abs(value), dvec3(scale_slack))))
            return track;
    }
    track.usable = true;
    return track;
}

/// Exporters write scales for every node, also where none changes.
bool AnimationReader::scale_stays(int animation, const tinygltf::AnimationChannel& channel) {
    const tinygltf::AnimationSampler& sampler =
        model_.animations[static_cast<std::size_t>(animation)].samplers[static_cast<std::size_t>(channel.sampler)];
    const bool spline = between_of(sampler.interpolation) == Between::spline;
    const auto [at, is_new] = scales_.try_emplace({sampler.output, spline});
    if (is_new) at->second = read_scales(sampler.output, spline);
    const ScaleTrack& track = at->second;
    if (!track.usable) return false;
    const std::vector<double>& rest = model_.nodes[static_cast<std::size_t>(channel.target_node)].scale;
    for (int i = 0; i < 3; ++i) {
        const double as_rest = rest.size() == 3 ? rest[static_cast<std::size_t>(i)] : 1;
        const double slack = scale_slack * std::max(1.0, std::abs(as_rest));
        if (track.min[i] < as_rest - slack || track.max[i] > as_rest + slack) return false;
    }
    return true;
}

/// From the first key to the last one of what it moves. Where one node does not end as it began, all are played forth and back,
/// so that they stay in step.
void AnimationReader::measure(int animation) {
    Extent& extent = extents_[static_cast<std::size_t>(animation)];
    std::sort(moved_.begin(), moved_.end());  // flaws name the first node of the file
    for (const int node : moved_) {
        const auto n = static_cast<std::size_t>(node);
        if (refused_[n]) continue;
        for (const Track* track : {&nodes_[n].translation, &nodes_[n].rotation}) {
            if (track->empty()) continue;
            extent.from_s = extent.known ? std::min(extent.from_s, track->times.front()) : track->times.front();
            extent.to_s = extent.known ? std::max(extent.to_s, track->times.back()) : track->times.back();
            extent.known = true;
        }
    }
    if (!extent.known) return;
    const double length = extent.to_s - extent.from_s;
    if (!(length >= model::min_period_s && 2 * length <= model::max_period_s)) {
        flawed(Flaw::duration, fmt::format("Animation '{}' is ignored: it lasts {:.3g} s", name_of_animation(animation), length));
        extent.known = false;
        return;
    }
    for (const int node : moved_) {
        const auto n = static_cast<std::size_t>(node);
        if (extent.back) break;
        if (refused_[n] || loops(tracks_of(node, {}, parent_world(n)))) continue;
        extent.back = true;
        flawed(Flaw::no_loop, fmt::format("Animation '{}' does not end where it began (node '{}'); it is played forth and back",
                                          name_of_animation(animation), name_of_node(node)));
    }
}

NodeTracks AnimationReader::tracks_of(int node, const NodePose& rest, const dmat4& parent) const {
    const AnimatedNode& animated = nodes_[static_cast<std::size_t>(node)];
    const Extent& extent = extents_[static_cast<std::size_t>(animated.animation)];
    return {animated.translation, animated.rotation, rest, parent, extent.from_s, extent.to_s};
}

Index AnimationReader::motion_of(int node, const NodePose& rest, const dmat4& parent, Index outer) {
    const auto at = static_cast<std::size_t>(node);
    if (nodes_[at].animation < 0 || refused_[at]) return outer;
    const Extent& extent = extents_[static_cast<std::size_t>(nodes_[at].animation)];
    if (!extent.known) return outer;
    const NodeTracks tracks = tracks_of(node, rest, parent);
    if (stays(tracks)) return outer;
    if (!tracks.rotation.empty() && !keeps_angles(parent))
        return refuse(node, Flaw::shear, "its rotation would shear it, since it is scaled unevenly above"), outer;
    const std::uint32_t depth = outer == none ? 1 : depths_[outer - first_motion_] + 1;
    if (depth > model::max_motion_depth)
        return refuse(node, Flaw::depth, fmt::format("more than {} motions carry each other", model::max_motion_depth)), outer;
    const std::size_t room = scene_.motions.size() < model::max_motions && scene_.motion_keys.size() < model::max_motion_keys
                                 ? model::max_motion_keys - scene_.motion_keys.size()
                                 : 0;
    std::vector<model::MotionKey> keys;
    if (room > 0) keys = keys_of(tracks, extent.back, std::min(max_keys_of_motion, room));
    if (keys.empty()) return refuse(node, Flaw::keys, "there are too many motions, or it has too many keys"), outer;
    model::Motion motion;
    motion.pivot = dvec3(parent * dvec4(rest.translation, 1.0));
    for (const model::MotionKey& key : keys)
        if (!finite_values(dvec4(motion.pivot + key.translation, 0)) || glm::length(key.translation) > farthest_m)
            return refuse(node, Flaw::number, "its animation leads beyond 1e12 m"), outer;
    motion.first_key = static_cast<std::uint32_t>(scene_.motion_keys.size());
    motion.key_count = static_cast<std::uint32_t>(keys.size());
    motion.period_s = keys.back().time_s;
    motion.outer = outer;
    scene_.motions.push_back(motion);
    scene_.motion_keys.insert(scene_.motion_keys.end(), keys.begin(), keys.end());
    depths_.push_back(depth);
    return static_cast<Index>(scene_.motions.size() - 1);
}

}  // namespace surefoot::importer
