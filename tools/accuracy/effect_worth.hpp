// What each effect of a model costs and shows: full detail with and without it, at places of a path.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/accuracy/places.hpp"

namespace surefoot::accuracy {

/// Full detail with something, and without it: means over the places of the medians of the repeats.
struct WithAndWithout {
    double with_ms = 0, without_ms = 0;
    double psnr_db = 0;         ///< of the pictures without, over all places; report::max_psnr_db: they are equal
    double flip = 0;            ///< mean
    std::string with, without;  ///< pictures of the place where they differ most, as data URIs; empty: they are equal
    std::uint32_t max_at = 0;   ///< number of that place
};

/// One effect of the model.
struct EffectWorth {
    std::string name, help, requested_by, reason;
    bool called_for = false;
    std::uint64_t triangles = 0;
    std::uint32_t shown_at = 0;  ///< places whose full detail uses it
    WithAndWithout worth;        ///< only if it is shown somewhere
};

/// All that the page shows.
struct EffectReport {
    std::string model, path, renderer, machine, uncalibrated;
    std::uint32_t width = 0, height = 0, poses = 0;
    std::vector<EffectWorth> effects;  ///< all, in the order of application
    WithAndWithout bare;               ///< without any
};

/// Draws on the calling thread; opens an engine an effect. Errors: of the model, its path and the backend; stopped by the user.
Result<EffectReport> measure_effects(const PlacesRequest& request, const Progress& progress);

std::string effects_json(const EffectReport& report);
/// Whether the page could be written to `dir` now. Call it before drawing.
Result<void> probe_effects_page(const std::string& dir);
/// index.html, which holds all pictures, and effects.json.
Result<void> write_effects_page(const std::string& dir, const EffectReport& report);

}  // namespace surefoot::accuracy
