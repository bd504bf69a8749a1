// The registry entries of all selectors; used in this room only.
#pragma once

#include "render/select/registry.hpp"

namespace surefoot::select {

extern const SelectorEntry flat_entry;
extern const SelectorEntry by_distance_entry;
extern const SelectorEntry depth_first_entry;
extern const SelectorEntry best_first_entry;
extern const SelectorEntry two_stage_entry;
extern const SelectorEntry threshold_entry;
extern const SelectorEntry curve_budget_entry;
extern const SelectorEntry curve_accuracy_entry;
extern const SelectorEntry depth_first_1994_entry;
extern const SelectorEntry best_first_1994_entry;
extern const SelectorEntry two_stage_1994_entry;
extern const SelectorEntry greedy_entry;
extern const SelectorEntry static_entry;
extern const SelectorEntry reactive_entry;

}  // namespace surefoot::select
