// Three ways to draw a model: every material with every effect, with those that it calls for, and with none.
#pragma once

#include <cstdint>
#include <span>

#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/accuracy/all_on.hpp"
#include "tools/accuracy/picture_difference.hpp"
#include "tools/accuracy/places.hpp"

namespace surefoot::accuracy {

/// One way. Its pictures are compared with those as called for; all figures are means over the places.
struct Way {
    double ms = 0;                                     ///< of a frame in full detail: medians of the repeats
    std::uint32_t programs = 0;                        ///< that the whole model needs
    double batches = 0, state_changes = 0, draws = 0;  ///< of a frame
    PictureDifference difference;                      ///< `with` is as called for
};

/// All three, drawn in turns.
struct ThreeWays {
    Way all_on, as_called_for, bare;
    AllOn spread;  ///< what all on means here
};

/// Effects of all materials.
model::EffectMask effects_of_materials(const model::Model& model);
/// These, and what is behind everything.
model::EffectMask effects_of_pictures(const model::Model& model);
/// An engine for measure_ways() that can leave all effects out.
Result<PlacesEngine> open_as_called_for(const PlacesRequest& request);
/// Opens a second engine with all on. as_called_for: has no context on this thread yet. Errors: of the model and the backend;
/// stopped by the user.
Result<ThreeWays> measure_ways(Engine& as_called_for, const PlacesRequest& request, std::span<const Pose> poses,
                               const Progress& progress);

}  // namespace surefoot::accuracy
