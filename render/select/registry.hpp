// The registry of selectors: name, help, and how each is made. To add one: a file in this folder, and its entry in entries.hpp
// and registry.cpp. Schema, help and settings page follow.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

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
    bool guarantees = false;    ///< buys SelectInput::max_error_rad first; others ignore it
    bool follows_time = false;  ///< goes by how long the frame before took: single places have none
    bool keeps_target = false;  ///< promises SelectInput::target_error_rad of every cut: records say whether it was kept
    bool by_value = false;      ///< of those that go by a budget: more time goes to what has most value for it
};

constexpr std::string_view usual_selector = "threshold";
constexpr std::string_view full_detail_selector = "flat";

/// Those that show every visible object. Settings choose among them.
std::span<const SelectorEntry> selectors();
/// Those that leave objects out. Only commands that compare know them.
std::span<const SelectorEntry> dropping_selectors();
/// Their names, and why no settings may choose them.
std::span<const Named> refused_selectors();
/// Of both lists. An unknown name is an Error that lists the selectors().
Result<const SelectorEntry*> selector_named(std::string_view name);

/// An error where max_error_rad is above 0 and the selector does not guarantee it.
Result<void> can_guarantee(const SelectorEntry& selector, double max_error_rad);

/// Of both lists; null for an unknown name.
const Selector* find_selector(std::string_view name);
/// Of selectors().
std::span<const std::string_view> selector_names();
/// Of selectors(), then of dropping_selectors().
std::vector<std::string_view> compared_names();

}  // namespace surefoot::select
