// The parts of the glTF reader, in the order in which they are used; gltf.cpp puts them together.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/import/lamps.hpp"
#include "render/import/motion_tracks.hpp"
#include "render/import/scene.hpp"
#include "render/import/tinygltf.hpp"
#include "rt/base/result.hpp"

namespace surefoot::importer {

// ---- bytes to structures: the checks that tinygltf 2.7 does not make, then tinygltf ----

/// The remedy for a file that is damaged.
inline constexpr const char* export_again = "Export the model again";

/// Buffers are loaded and at least as long as their byteLength. Nothing else in the model may be trusted, except views of images:
/// accessors, views and indices are checked where they are used.
/// Images: `image` holds the encoded bytes of a data URI; else `bufferView` or `uri` locates them.
Result<tinygltf::Model> load_gltf(const std::string& file, std::vector<std::string>& warnings);

/// %20 and the like, as URIs write them.
std::string decode_uri(const std::string& uri);

// ---- accessors as flat arrays: every offset, stride, count and sparse index checked (tinygltf checks none) ----

/// An accessor as floats; normalised integers become 0..1 or -1..1 (glTF 2.0, 3.11).
struct FloatArray {
    std::vector<float> values;  ///< count * components
    std::size_t components = 0;
    [[nodiscard]] std::size_t count() const { return components == 0 ? 0 : values.size() / components; }
};

/// `place` names file and mesh in errors.
Result<FloatArray> read_floats(const tinygltf::Model& model, int accessor, const std::string& place);
/// Scalar unsigned integers.
Result<std::vector<std::uint32_t>> read_indices(const tinygltf::Model& model, int accessor, const std::string& place);

// ---- materials, textures and images to those of a Scene ----

/// The texture coordinates that a material uses, and their transform.
struct TextureUse {
    int set = 0;               ///< TEXCOORD_<set>
    vec2 offset{0}, scale{1};  ///< KHR_texture_transform
    float rotation_rad = 0;
    [[nodiscard]] bool identity() const { return offset == vec2(0) && scale == vec2(1) && rotation_rad == 0; }
    [[nodiscard]] vec2 apply(vec2 uv) const;
};

/// Fills scene.materials (one a glTF material, then a default white one) and the images that they use. Returns a TextureUse a
/// material.
std::vector<TextureUse> read_materials(const tinygltf::Model& model, const std::string& file, Scene& scene,
                                       const Progress& progress);

// ---- stand-ins: MSFT_lod, and the extra `stand_ins` with names of nodes ----

/// One glTF node stands for another.
struct StandInClaim {
    int object, stand_in;
    bool same_frame;  ///< the frames of both nodes are laid on each other; else the stand-in has the object's parent (MSFT_lod)
    bool used;        ///< of the first node with this mesh; of the others, stand-ins are only not drawn
};
/// All of a file, in its order. Warnings: nodes that do not exist.
std::vector<StandInClaim> stand_in_claims(const tinygltf::Model& model, std::vector<std::string>& warnings);

// ---- lights: the brightest distant one is the sun, the others are lamps ----

/// Takes one node after the other. Memory does not grow with the number of lights.
class LightReader {
public:
    LightReader(const tinygltf::Model& model, Scene& scene) : model_(model), scene_(scene) {}
    /// Sets scene.sun if the node holds a brighter distant light. Keeps a lamp for finish().
    void add(const tinygltf::Node& node, const dmat4& world);
    /// One warning for each kind of flaw: it names the first such light and counts the others. A stand-in ends with this: the
    /// lamps are those of its object.
    void warn();
    /// warn(), and the lamps go into the scene. Of too many the brightest stay, and a warning counts the others.
    void finish();

private:
    /// What can be wrong with a light.
    enum class Flaw : std::uint8_t { missing, kind, sun, horizon, intensity, place, direction, colour, range, cone, count };
    /// Lights with one flaw.
    struct Flawed {
        std::string first;  ///< the warning of the first one
        std::size_t count = 0;
    };

    /// `warning` is called for the first of each kind only.
    template <class Warning>
    void flawed(Flaw flaw, Warning&& warning) {
        Flawed& kind = flaws_[static_cast<std::size_t>(flaw)];
        if (kind.count++ == 0) kind.first = warning();
    }
    const tinygltf::Light* light_of(const tinygltf::Node& node);
    void add_sun(const tinygltf::Light& light, const std::string& name, const dmat4& world);
    void add_lamp(const tinygltf::Light& light, const std::string& name, const dmat4& world);
    /// False: the lamp is to be left out.
    bool set_light(const tinygltf::Light& light, Lamp& lamp);
    bool set_cone(const tinygltf::Light& light, const dmat4& world, Lamp& lamp);

    const tinygltf::Model& model_;
    Scene& scene_;
    BrightestLamps lamps_;
    std::array<Flawed, static_cast<std::size_t>(Flaw::count)> flaws_;
};

// ---- animations: rigid motions of nodes, looping; what is not rigid is refused by name ----

/// A node's animated values, as the first animation that has them says.
struct AnimatedNode {
    Track translation, rotation;
    int animation = -1;  ///< none: it stands still
};

/// All animations of a file, read once; of too many keys together none, and all nodes stand still. Then it makes the motions of
/// the nodes that draw something, one after the other.
class AnimationReader {
public:
    AnimationReader(const tinygltf::Model& model, const std::string& file, Scene& scene);
    /// Adds the node's own motion to the scene, carried by that of its parent. Returns what moves the node: `outer` if it has
    /// none of its own. `parent`: its parent's frame to world, at rest.
    Index motion_of(int node, const NodePose& rest, const dmat4& parent, Index outer);
    /// One warning for each kind of flaw: it names the first node or animation and counts the others.
    void warn();

private:
    /// What can be wrong with an animation.
    enum class Flaw : std::uint8_t {
        empty,
        broken,
        order,
        number,
        length,
        quaternion,
        duration,
        scale,
        weights,
        kind,
        skin,
        matrix,
        taken,
        shear,
        keys,
        all_keys,
        depth,
        no_loop,
        count
    };
    /// Things with one flaw.
    struct Flawed {
        std::string first;
        std::size_t count = 0;
    };
    /// One animation as a whole.
    struct Extent {
        double from_s = 0, to_s = 0;
        bool known = false, back = false;  ///< back: it is played forth and back
    };

    /// The bounds of a scale track's values, and whether it has none but finite ones and no slope.
    struct ScaleTrack {
        dvec3 min{0.0}, max{0.0};
        bool usable = false;
    };

    void flawed(Flaw flaw, std::string text);
    /// What the user can do: a whole sentence, without its full stop.
    static const char* remedy_of(Flaw flaw);
    [[nodiscard]] std::string name_of_node(int node) const;
    [[nodiscard]] std::string name_of_animation(int animation) const;
    void find_drawn();
    void find_worlds();
    [[nodiscard]] bool is_read(const tinygltf::Animation& animation, const tinygltf::AnimationChannel& channel) const;
    [[nodiscard]] std::optional<std::uint64_t> readable_values(int accessor) const;
    [[nodiscard]] std::uint64_t count_keys() const;
    [[nodiscard]] std::uint64_t count_scales() const;
    void read_animation(int animation);
    void read_channel(int animation, const tinygltf::AnimationChannel& channel);
    void refuse(int node, Flaw flaw, const std::string& why);
    bool read_track(int animation, const tinygltf::AnimationChannel& channel, bool rotation, Track& track);
    bool check_times(int node, Track& track);
    bool check_values(int node, bool rotation, Track& track);
    [[nodiscard]] ScaleTrack read_scales(int output, bool spline) const;
    [[nodiscard]] bool scale_stays(int animation, const tinygltf::AnimationChannel& channel);
    void measure(int animation);
    [[nodiscard]] dmat4 parent_world(std::size_t node) const;
    [[nodiscard]] NodeTracks tracks_of(int node, const NodePose& rest, const dmat4& parent) const;

    const tinygltf::Model& model_;
    const std::string& file_;
    Scene& scene_;
    std::vector<AnimatedNode> nodes_;
    std::vector<int> parents_;                           ///< by node; -1: none
    std::vector<dmat4> worlds_;                          ///< by node
    std::vector<bool> drawn_, refused_;                  ///< by node: something at or below it is drawn; it stands still
    std::vector<int> moved_;                             ///< nodes of the animation that is read
    std::map<std::pair<int, bool>, ScaleTrack> scales_;  ///< by accessor and whether it has tangents: many nodes may share one
    std::vector<Extent> extents_;                        ///< by animation
    std::vector<std::uint32_t> depths_;                  ///< by motion of the scene
    std::size_t first_motion_ = 0;
    std::array<Flawed, static_cast<std::size_t>(Flaw::count)> flaws_;
};

// ---- the node graph to a Scene's nodes: world matrices in double, instances, cycles refused ----

/// The node's frame to its parent's, at rest.
dmat4 local_matrix(const tinygltf::Node& node);

/// Reads the default scene, else the first, else every root; then the stand-ins, whose nodes are not drawn by themselves. Error:
/// a cycle, by node name. Warnings: deviations from the file.
Result<void> read_nodes(const tinygltf::Model& model, const std::string& file, Scene& scene);

}  // namespace surefoot::importer
