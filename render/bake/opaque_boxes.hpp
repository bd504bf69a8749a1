// Boxes whose pictures have no hole need no alpha test.
#pragma once

#include <cstddef>

#include "render/model/model.hpp"

namespace surefoot::bake {

/// Takes the mask from materials of boxes that show no hole: all that their faces may read has one alpha, which passes the test.
/// Forms and pictures stay as they are, and so do pixels of one sample. Returns how many materials changed. Call it once no box
/// is dropped any more: without a mask a form costs less.
std::size_t drop_needless_masks(model::Model& model);

}  // namespace surefoot::bake
