// TOML into settings, with line and key in every error. toml++'s exceptions end here.
#include <fmt/format.h>

#include <toml++/toml.h>

#include <optional>
#include <string>

#include "config/settings.hpp"
#include "config/values.hpp"
#include "rt/base/file.hpp"

namespace surefoot::config {

namespace {

constexpr std::uint64_t max_bytes = 1U << 20U;  // no settings file is near a mebibyte

std::string place_of(const std::string& name, const toml::source_region& source) {
    return fmt::format("{}:{}", name, source.begin.line);
}

std::optional<Value> value_of(const toml::node& node) {
    if (const auto flag = node.value_exact<bool>()) return *flag;
    if (const auto text = node.value_exact<std::string>()) return *text;
    if (const auto whole = node.value_exact<std::int64_t>()) return static_cast<double>(*whole);
    if (const auto number = node.value_exact<double>()) return *number;
    return std::nullopt;
}

Result<void> apply_key(Configuration& into, std::string_view key, const toml::node& node, const std::string& name) {
    const std::string place = place_of(name, node.source());
    const Entry* entry = find_entry(key);
    if (entry == nullptr) return unknown_key(place, key);
    const auto value = value_of(node);
    if (!value) return Error{place, fmt::format("{} is not {}", key, allowed(*entry)), {}};
    if (auto problem = assign(into.values, *entry, *value)) return Error{place, *problem, {}};
    into.origins[std::string(entry->key)] = {name, node.source().begin.line, false};
    return {};
}

Result<void> apply_table(Configuration& into, const toml::table& table, const std::string& name, bool top) {
    for (const auto& [key, node] : table) {
        if (top && key.str() == "profile") continue;
        if (auto applied = apply_key(into, key.str(), node, name); !applied) return applied;
    }
    return {};
}

/// Every profile is checked, also those not asked for: a slip should not wait for the day it is used.
Result<void> apply_profiles(Configuration& into, const toml::table& root, const std::string& name, std::string_view wanted) {
    const toml::node* profiles = root.get("profile");
    if (profiles != nullptr && !profiles->is_table())
        return Error{place_of(name, profiles->source()), "profile is not a table", "write [profile.NAME] and keys below it"};
    std::string names;
    bool found = false;
    if (profiles != nullptr) {
        for (const auto& [key, node] : *profiles->as_table()) {
            if (!node.is_table())
                return Error{place_of(name, node.source()), fmt::format("profile.{} is not a table", key.str()),
                             "write [profile.NAME] and keys below it"};
            Configuration trial = into;
            if (auto applied = apply_table(trial, *node.as_table(), name, false); !applied) return applied;
            names += (names.empty() ? "" : ", ") + std::string(key.str());
            if (key.str() != wanted) continue;
            found = true;
        }
        if (found) return apply_table(into, *profiles->as_table()->get(wanted)->as_table(), name, false);
    }
    if (wanted.empty()) return {};
    return Error{name, fmt::format("has no profile '{}'", wanted), names.empty() ? "it has none" : "it has " + names};
}

}  // namespace

Result<void> load_text(Configuration& configuration, std::string_view text, const std::string& name, std::string_view profile) {
    Configuration trial = configuration;
    try {
        const toml::table root = toml::parse(text, name);
        if (auto applied = apply_table(trial, root, name, true); !applied) return applied;
        if (auto applied = apply_profiles(trial, root, name, profile); !applied) return applied;
    } catch (const toml::parse_error& error) {
        return Error{place_of(name, error.source()), std::string(error.description()), "see https://toml.io for the syntax"};
    }
    configuration = std::move(trial);
    return {};
}

Result<void> load_file(Configuration& configuration, const std::string& file, std::string_view profile) {
    const auto text = read_text(file, max_bytes);
    if (!text) return text.error();
    return load_text(configuration, *text, file, profile);
}

}  // namespace surefoot::config
