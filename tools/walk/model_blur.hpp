// Measures what each step of resolution loses on one model: pictures of full detail that are enlarged, against full detail.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/engine.hpp"
#include "rt/base/path.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"

namespace surefoot::walk {

/// Poses of the path at equal distances in time, from half such a distance after its start. One if the path has no length.
std::vector<Pose> poses_along(const Path& path, std::uint32_t count);

/// The caller has bound the engine's device. Slow: draws and reads a picture for each pose and step. Errors: no poses, stopped by
/// the user, the device is lost.
Result<model::BlurLoss> measure_blur(Engine& engine, std::span<const Pose> poses, const Progress& progress);

}  // namespace surefoot::walk
