// What benches of one scene open alike: the model, a path through it, and the costs of this machine.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>

#include "render/model/cost.hpp"
#include "render/model/model.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/result.hpp"
#include "tools/walk/path_source.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::bench {

/// Which scene, as a command line names it.
struct SceneArguments {
    std::string model_file, path_file = {};  ///< no path: the model's own
    double lift_m = 0;
    std::string state_dir = {};                ///< empty: the user's
    bool fitted = false;                       ///< with the fit to the model, as `surefoot calibrate MODEL.walk` left it
    std::uint32_t width = 1280, height = 720;  ///< the fit's conditions
    std::string backend = "egl";
};

struct Scene {
    model::Model model;
    walk::ChosenPath path;
    model::CostModel costs;
};

/// Prints what the table says of itself. Errors: files that are missing or wrong.
inline Result<Scene> open_scene(const SceneArguments& a) {
    model::WalkFileInfo info;
    auto model = model::read_walk(a.model_file, &info);
    if (!model) return model.error();
    auto path = walk::choose_path(a.path_file, a.model_file, *model, a.lift_m);
    if (!path) return path.error();
    const std::string state = walk::state_directory(a.state_dir);
    std::string note;
    auto costs = walk::load_costs(state, "", note);
    if (costs && a.fitted) costs = walk::fitted_costs(state, *costs, {info.hash, a.width, a.height, a.backend});
    if (!costs) return costs.error();
    if (!note.empty()) fmt::print(stderr, "{}\n", note);
    return Scene{std::move(*model), std::move(*path), std::move(*costs)};
}

/// Prints the error; returns the exit status.
inline int fail(const Error& error) {
    fmt::print(stderr, "{}\n", error.text());
    return 1;
}

}  // namespace surefoot::bench
