// Which surfaces may lie in the shadow of something that moves: what stands still, is lit, and is within reach.
#pragma once

#include <vector>

#include "render/model/model.hpp"

namespace surefoot::bake {

/// Gives effect_moving_shadow to the parts of forms that stand still within reach, and says why, or why not, in its finding.
/// Materials that others use as well are copied, and so are parts. Without anything that moves the model stays as it is, but
/// for the finding. After the other findings. Boxes of nodes are those at rest.
void add_moving_shadow(model::Model& model);

}  // namespace surefoot::bake
