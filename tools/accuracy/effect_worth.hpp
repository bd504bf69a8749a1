// What each effect of a model costs and shows: full detail with and without it, at places of a path.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/accuracy/effect_regions.hpp"
#include "tools/accuracy/effect_use.hpp"
#include "tools/accuracy/effect_ways.hpp"
#include "tools/accuracy/picture_difference.hpp"
#include "tools/accuracy/places.hpp"

namespace surefoot::accuracy {

/// Full detail with something, and without it: means over the places of the medians of the repeats.
struct WithAndWithout : PictureDifference {
    double with_ms = 0, without_ms = 0;
};

/// One effect of the model.
struct EffectWorth {
    std::string name, help, requested_by, reason;
    bool called_for = false;
    bool behind = false;  ///< it is drawn behind everything: in every frame, and by no item
    std::uint64_t triangles = 0;
    std::uint32_t shown_at = 0;  ///< places whose full detail uses it
    WithAndWithout worth;        ///< only if it is shown somewhere
    /// Shares of the frames along the path in which it is in use, and of their triangles; 0..1.
    double frames_share = 0, triangles_share = 0;                ///< in full detail
    double walked_frames_share = 0, walked_triangles_share = 0;  ///< as a walk at walked_rate_hz selects
    std::vector<Holder> where;                                   ///< of its triangles in full detail; empty: there are none
    std::uint32_t walked_frames = 0;                             ///< with the effect, of EffectReport::use_frames
    std::uint64_t walked_items = 0;                              ///< with it, in all of them
    std::string along_path;                                      ///< why items of the walk have it, or why none has: sentences
    std::vector<DrawnHolder> drawn;                              ///< the walk's items with it, by name: most items first
};

/// All that the page shows.
struct EffectReport {
    std::string model, path, renderer, machine, uncalibrated;
    std::uint32_t width = 0, height = 0, poses = 0;
    double hour = -1;                  ///< of the day; below 0: the model's own light
    double time_s = 0;                 ///< of the model's animations
    std::vector<EffectWorth> effects;  ///< all, in the order of application
    std::vector<EffectRegion> regions;
    std::uint32_t use_frames = 0;  ///< of the shares of frames
    ThreeWays ways;
    WithAndWithout bare;  ///< without any: ways.bare beside ways.as_called_for
};

/// Draws on the calling thread; opens an engine an effect. Errors: of the model, its path and the backend; stopped by the user.
Result<EffectReport> measure_effects(const PlacesRequest& request, const Progress& progress);

std::string effects_json(const EffectReport& report);
/// Whether the page could be written to `dir` now. Call it before drawing.
Result<void> probe_effects_page(const std::string& dir);
/// index.html, which holds all pictures, and effects.json.
Result<void> write_effects_page(const std::string& dir, const EffectReport& report);

}  // namespace surefoot::accuracy
