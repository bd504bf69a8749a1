// The greatest value that a frame's budget buys, for comparison with the selectors. Off line: it allocates and takes seconds.
#pragma once

#include <cstdint>
#include <string_view>

#include "render/select/registry.hpp"

namespace surefoot::select {

constexpr std::string_view oracle_name = "oracle";

/// Limits of the search. It counts steps, not seconds: the same frame has the same answer on any machine.
struct OracleLimits {
    std::uint32_t exact_leaves = 16;       ///< frames with as many visible leaves are searched to the end
    std::uint64_t max_steps = 50'000'000;  ///< of branch and bound in larger ones; half a second
    std::uint32_t max_parts = 2000;        ///< into which the bound's problem is split then; some seconds
};

/// What is known of the greatest value of a legal cut within the budget. Values of forms and of bought items, weighted pixels.
struct Optimum {
    double value = 0;     ///< of the best cut known
    double bound = 0;     ///< no cut has more. The budget is relaxed to two linear ones, and these to their Lagrangian
    bool proven = false;  ///< `value` is the optimum, to 10^-6 of it; the bound equals it then
    bool floor_binds = false;
    std::uint64_t steps = 0;
};

/// Finds the best cut by branch and bound, beginning with the best of all selectors. Hysteresis and accuracy targets do not
/// count. Source: Lagrange multipliers, Everett 1963; branch and bound, Land and Doig 1960.
Optimum find_optimum(const SelectInput& input, SelectState& state, Cut& cut, const OracleLimits& limits = {});

/// The same as a selector. It is not in selectors(): a walk cannot have it.
extern const SelectorEntry oracle_entry;

/// A selector of the registry, or the oracle; null for an unknown name.
const Selector* find_offline_selector(std::string_view name);

}  // namespace surefoot::select
