// How often frames use each effect, and which objects of the model hold it.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "rt/base/progress.hpp"
#include "tools/accuracy/all_on.hpp"

namespace surefoot::accuracy {

constexpr std::uint32_t min_use_poses = 200;  ///< evenly along the path
constexpr double walked_rate_hz = 30;         ///< of the frames that count as walked
constexpr std::size_t max_holders = 3;

/// What so many frames drew, by effect in bit order.
struct FramesInUse {
    std::uint32_t frames = 0;
    std::uint64_t triangles = 0;
    std::array<std::uint32_t, model::effect_count> frames_with{};  ///< in which any drawn item has the effect
    TrianglesByEffect triangles_with{};
    std::array<std::uint64_t, model::effect_count> items_with{};   ///< of all frames
    std::array<std::uint32_t, model::effect_count> first_frame{};  ///< with such an item, if there is one
    std::array<model::Index, model::effect_count> first_rep{};     ///< of these items, the one with most triangles
    /// By representation: the frames in which it is drawn with the effect.
    std::array<std::map<model::Index, std::uint32_t>, model::effect_count> frames_of_rep;

    /// Adds a frame that draws these representations. of_reps: triangles_of_reps() of the model.
    void add(const model::Model& model, std::span<const TrianglesByEffect> of_reps, std::span<const model::Index> reps);
    [[nodiscard]] double share_of_frames(std::size_t effect) const;     ///< 0..1
    [[nodiscard]] double share_of_triangles(std::size_t effect) const;  ///< 0..1
};

/// All objects of one name, and what they hold of an effect.
struct Holder {
    std::string name;           ///< may be empty
    std::uint32_t objects = 0;  ///< of that name, with the effect
    double share = 0;           ///< 0..1, of the effect's triangles in full detail
};

/// All items of one name that frames draw with an effect. Which place: of the node that is drawn most often.
struct DrawnHolder {
    std::string name;            ///< of a node; may be empty
    std::uint64_t items = 0;     ///< in all frames together
    model::Index node = 0;       ///< the one drawn most often
    dvec3 middle_m{0.0};         ///< of its box
    std::uint32_t vertices = 0;  ///< of its form's triangles with the effect
    std::uint32_t see_sky = 0;   ///< how many of them see any sky on a side that shows
};

/// Those with most items first.
std::vector<DrawnHolder> drawn_holders(const model::Model& model, const FramesInUse& frames, std::size_t effect);

/// At most max_holders names of objects, those with most triangles first.
std::vector<Holder> holders_of(const model::Model& model, std::size_t effect);

/// Frames along a path: all in full detail, and as a walk at walked_rate_hz selects them by the cost table.
struct UseOfEffects {
    FramesInUse full, walked;
    double rate_hz = walked_rate_hz;
};

/// The node that a representation is a form of; none: there is none.
model::Index node_of(const model::Model& model, model::Index rep);

/// Draws nothing. Call it on the thread that draws. Ends early where the user stops it.
UseOfEffects measure_use(Engine& engine, std::span<const Pose> poses, const Progress& progress, double time_s = 0);

}  // namespace surefoot::accuracy
