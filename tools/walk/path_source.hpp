// Where a walk's path comes from: the requested file, the one beside the model, the model's own, or one around its box.
#pragma once

#include <string>
#include <string_view>

#include "config/settings.hpp"
#include "render/model/model.hpp"
#include "rt/base/path.hpp"
#include "rt/base/random.hpp"
#include "rt/base/result.hpp"

namespace surefoot::walk {

/// The path of a walk, and where it comes from.
struct ChosenPath {
    Path path;
    std::string source;  ///< the file, "default path, ...", or "generated tour"
};

/// In place of a file: neither a file nor the model's default path, but the tour around the model's box.
constexpr std::string_view no_path = "none";

/// `requested`: a CSV file, `no_path`, or empty. lift_m is added to every y (recorded drives give the vehicle's ground pose).
Result<ChosenPath> choose_path(const std::string& requested, const std::string& model_file, const model::Model& model,
                               double lift_m);

/// A random pose: up to 3 m from the path, in any direction about the horizon. For measuring predictions.
Pose random_pose(const Path& path, Random& random);

/// 40 s: from above one corner, round the model once, closing in to its middle.
Path generated_tour(const model::Model& model);

/// Gives all poses the seat's field of view, if there is a seat. Start, viewpoints, tour and steered poses are of the path.
void apply_seat(const config::Settings& settings, Path& path);

}  // namespace surefoot::walk
