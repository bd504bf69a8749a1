// The selectors by their making, for the table of names.
#pragma once

#include "render/select/select.hpp"

namespace surefoot::select {

/// Empties a cut and keeps its room.
void clear(Cut& cut);

const Selector& depth_first();
const Selector& best_first();
const Selector& two_stage();

/// As printed in Maciel 1994, figures 3.14, 3.15 and 3.19: the children's cost is added, the parent's stays in the total.
const Selector& depth_first_1994();
const Selector& best_first_1994();
const Selector& two_stage_1994();

const Selector& flat();
const Selector& by_distance();

}  // namespace surefoot::select
