// From an imported scene to a model: clusters, levels of detail, boxes, splits, every error bounded.
#pragma once

#include <cstdint>
#include <optional>

#include "render/import/scene.hpp"
#include "render/model/cost.hpp"
#include "render/model/limits.hpp"
#include "render/model/model.hpp"
#include "render/model/sun_time.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"

namespace surefoot::bake {

enum class Quality { draft, full };

/// Settings of a bake.
struct BakeOptions {
    Quality quality = Quality::draft;
    double level_ratio = 0;             ///< of triangles, from a level to the next coarser; 0: by the quality
    bool whole_objects = false;         ///< objects are cut for too many triangles alone, not for their length
    int workers = 0;                    ///< 0: all cores
    double frame_us = 33333;            ///< the frame of the 1/16 rule, at 30 Hz
    std::optional<model::SunTime> sun;  ///< the caller sees that it is above the horizon; none: the scene's, else a fixed one
    std::optional<double> fog_visibility_m;        ///< in metres, 0: no fog; none: the scene's
    bool water_by_name = false;                    ///< as is_named_water() says, where a file says nothing
    bool light_by_pixel = false;                   ///< of all lit materials, where a file says nothing
    bool sky = false;                              ///< behind everything, also where no file names one
    const model::CostModel* costs = nullptr;       ///< calibrated; null: default_costs()
    model::Counts max_counts = model::max_counts;  ///< limits of the model; tests lower them
};

/// Deterministic at any worker count. Errors: nothing drawable, stopped by the user, out of limits.
Result<model::Model> bake(const importer::Scene& scene, const BakeOptions& options, const Progress& progress);

}  // namespace surefoot::bake
