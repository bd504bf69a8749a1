// What the selectors share.
#pragma once

#include "render/select/select.hpp"

namespace surefoot::select {

/// Empties a cut and keeps its room.
void clear(Cut& cut);

}  // namespace surefoot::select
