// The list of all selectors, in the order in which people see them.
#include "render/select/registry.hpp"

#include <array>
#include <vector>

#include "render/select/entries.hpp"

namespace surefoot::select {

std::span<const SelectorEntry> selectors() {
    static const std::array all = {
        flat_entry,          by_distance_entry,  depth_first_entry,    best_first_entry,       two_stage_entry,
        threshold_entry,     curve_budget_entry, curve_accuracy_entry, depth_first_1994_entry, best_first_1994_entry,
        two_stage_1994_entry};
    return all;
}

std::span<const SelectorEntry> dropping_selectors() {
    static const std::array all = {greedy_entry, static_entry, reactive_entry};
    return all;
}

std::span<const Named> refused_selectors() {
    static const std::vector<Named> all = [] {
        std::vector<Named> names;
        for (const SelectorEntry& entry : dropping_selectors())
            names.push_back(
                {entry.name, "leaves visible objects out; only --selector of surefoot compare and surefoot accuracy takes it"});
        return names;
    }();
    return all;
}

namespace {

const SelectorEntry* find_entry(std::string_view name) {
    const SelectorEntry* entry = find_named(selectors(), name);
    return entry != nullptr ? entry : find_named(dropping_selectors(), name);
}

}  // namespace

Result<const SelectorEntry*> selector_named(std::string_view name) {
    if (const SelectorEntry* entry = find_entry(name)) return entry;
    return Error{"selector '" + std::string(name) + "'", "There is no such selector",
                 "Use one of: " + names_in_words(selectors()), ErrorKind::misuse};
}

Result<void> can_guarantee(const SelectorEntry& selector, double max_error_rad) {
    if (!(max_error_rad > 0.0) || selector.guarantees) return {};
    std::string able;
    for (const SelectorEntry& entry : selectors())
        if (entry.guarantees) able += (able.empty() ? "" : ", ") + std::string(entry.name);
    return Error{"selector '" + std::string(selector.name) + "'", "It cannot guarantee a min_accuracy",
                 "Use one of: " + able + "; or set min_accuracy to 0", ErrorKind::misuse};
}

const Selector* find_selector(std::string_view name) {
    const SelectorEntry* entry = find_entry(name);
    return entry == nullptr ? nullptr : &entry->make();
}

std::span<const std::string_view> selector_names() {
    static const std::vector<std::string_view> names = [] {
        std::vector<std::string_view> out;
        for (const SelectorEntry& entry : selectors()) out.push_back(entry.name);
        return out;
    }();
    return names;
}

std::vector<std::string_view> compared_names() {
    std::vector<std::string_view> names(selector_names().begin(), selector_names().end());
    for (const SelectorEntry& entry : dropping_selectors()) names.push_back(entry.name);
    return names;
}

}  // namespace surefoot::select
