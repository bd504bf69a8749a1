// Where pictures are drawn for comparison: places of a path, and an engine for them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "render/gl/backends.hpp"
#include "render/model/view.hpp"
#include "rt/base/path.hpp"
#include "rt/base/result.hpp"

namespace surefoot::accuracy {

/// What is drawn, from where, and by what.
struct PlacesRequest {
    std::string model_file, path_file, state_dir;
    std::string backend{gl::usual_backend};
    std::uint32_t width = 1280, height = 720, poses = 16;
    int repeats = 3;  ///< submissions a pose; the median counts
    int workers = 0, rasterisers = 0;
    double lift_m = 0;
    double shift_x = 0, shift_y = 0;  ///< off axis, as model::Viewport has it
    double hour = -1;                 ///< of the day; below 0: the model's own light
    double time_s = 0;                ///< of the model's animations

    [[nodiscard]] model::Viewport viewport() const { return {width, height, shift_x, shift_y}; }
};

/// An engine, and what it draws with.
struct PlacesEngine {
    std::unique_ptr<Engine> engine;
    std::string machine, uncalibrated;  ///< uncalibrated: where this machine's cost table is missing, what, and the remedy
};

/// `options` gets the request's device and workers; single places have no check within a frame and no hysteresis. Errors: a
/// backend that draws nothing, and those of cost tables and devices.
Result<PlacesEngine> open_engine_of_places(const PlacesRequest& request, model::Model model, std::uint64_t model_hash,
                                           EngineOptions options);

/// So many poses along a path, each from the middle of its share.
std::vector<Pose> poses_along(const Path& path, std::uint32_t count);

}  // namespace surefoot::accuracy
