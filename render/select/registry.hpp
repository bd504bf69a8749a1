// The registry of selectors: name, help, and how each is made. To add one: a file in this folder, and its entry in entries.hpp
// and registry.cpp. Schema, help and settings page follow.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "render/select/select.hpp"
#include "rt/base/named.hpp"
#include "rt/base/result.hpp"

namespace surefoot::select {

/// What limits the detail of a selector: nothing, an angular threshold, or the frame's budget.
enum class GoesBy : std::uint8_t { nothing, threshold, budget };

/// The registry entry of a selector.
struct SelectorEntry {
    std::string_view name, help;
    GoesBy goes_by = GoesBy::budget;
    bool compared = true;  ///< by `surefoot accuracy`, if no selector is named
    const Selector& (*make)() = nullptr;
    bool guarantees = false;  ///< buys SelectInput::max_error_rad first; others ignore it
};

constexpr std::string_view usual_selector = "threshold";
constexpr std::string_view full_detail_selector = "flat";

std::span<const SelectorEntry> selectors();
/// An unknown name is an Error that lists the known ones.
Result<const SelectorEntry*> selector_named(std::string_view name);

/// An error where max_error_rad is above 0 and the selector does not guarantee it.
Result<void> can_guarantee(const SelectorEntry& selector, double max_error_rad);

/// Null for an unknown name.
const Selector* find_selector(std::string_view name);
std::span<const std::string_view> selector_names();

}  // namespace surefoot::select
