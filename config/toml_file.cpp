// TOML into settings, with line and key in every error. toml++'s exceptions end here.
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "config/settings.hpp"
#include "config/values.hpp"
#include "rt/base/file.hpp"
#include "rt/base/toml_reader.hpp"

namespace surefoot::config {

namespace {

constexpr std::uint64_t max_bytes = 1U << 20U;  // no settings file is near a mebibyte

std::optional<Value> value_of(const toml::node& node) {
    if (const auto flag = node.value_exact<bool>()) return *flag;
    if (const auto text = node.value_exact<std::string>()) return *text;
    if (const auto whole = node.value_exact<std::int64_t>()) return static_cast<double>(*whole);
    if (const auto number = node.value_exact<double>()) return *number;
    return std::nullopt;
}

/// Where the reading goes: values, and all that is wrong with them.
struct Reading {
    Configuration configuration;
    std::vector<Problem> problems;
    std::vector<std::string> profiles;  ///< names, as they stand in the file
};

void complain(Reading& into, const std::string& name, const toml::node& node, Problem problem) {
    problem.file = name;
    problem.line = node.source().begin.line;
    problem.error.place = toml_place(name, node.source());
    into.problems.push_back(std::move(problem));
}

/// Not a misspelt key: in TOML all that follows a table's name belongs to it.
Error unknown_table(std::string_view key) {
    return {{},
            fmt::format("The table '{}' is unknown", key),
            "Write keys above all tables, or below [profile.NAME]",
            ErrorKind::misuse};
}

void read_key(Reading& into, std::string_view key, const toml::node& node, const std::string& name, std::string_view profile) {
    Problem problem;
    problem.key = std::string(key);
    const Schema& schema = *into.configuration.schema;
    const Entry* entry = schema.find(key);
    const auto value = value_of(node);
    if (value) problem.found = text_of(*value);
    if (entry == nullptr || node.is_table()) {
        problem.error = node.is_table() ? unknown_table(key) : unknown_key(schema, {}, key);
        problem.nearest = std::string(schema.nearest(key));
        return complain(into, name, node, std::move(problem));
    }
    problem.allowed = allowed(*entry);
    auto refused =
        value ? assign(into.configuration.values, *entry, *value)
              : Error{{}, fmt::format("The value of {} is not allowed", key), "Use " + problem.allowed, ErrorKind::misuse};
    if (refused) {
        problem.error = *refused;
        return complain(into, name, node, std::move(problem));
    }
    into.configuration.origins[std::string(entry->key)] = {name, node.source().begin.line, false, std::string(profile)};
}

void not_a_table(Reading& into, const std::string& name, const toml::node& node, std::string_view key) {
    Problem problem;
    problem.key = std::string(key);
    problem.error = {
        {}, fmt::format("The key {} is not a table", key), "Write [profile.NAME] and keys below it", ErrorKind::misuse};
    complain(into, name, node, std::move(problem));
}

/// Every profile is read, not only the requested one, so that a mistake is reported before the profile is used.
void read_profiles(Reading& into, const toml::table& root, const std::string& name, std::string_view wanted) {
    const toml::node* profiles = root.get("profile");
    if (profiles == nullptr) return;
    if (!profiles->is_table()) return not_a_table(into, name, *profiles, "profile");
    Reading laid = into;
    laid.problems.clear();
    for (const auto& [key, node] : *profiles->as_table()) {
        if (!node.is_table()) {
            not_a_table(into, name, node, fmt::format("profile.{}", key.str()));
            continue;
        }
        into.profiles.emplace_back(key.str());
        Reading trial = laid;
        for (const auto& [inner, value] : *node.as_table()) read_key(trial, inner.str(), value, name, key.str());
        into.problems.insert(into.problems.end(), trial.problems.begin(), trial.problems.end());
        if (key.str() == wanted) into.configuration = std::move(trial.configuration);
    }
}

Problem no_profile(const Reading& reading, const std::string& name, std::string_view wanted) {
    std::string names;
    for (const std::string& profile : reading.profiles) names += (names.empty() ? "" : ", ") + profile;
    Problem problem;
    problem.error = {name, fmt::format("The file has no profile '{}'", wanted),
                     names.empty() ? fmt::format("Add a table [profile.{}]", wanted) : "Choose one of " + names,
                     ErrorKind::not_found};
    problem.file = name;
    return problem;
}

/// Values over `before`, and all problems by line; the values hold only where there is none.
Reading read_toml(Configuration before, std::string_view text, const std::string& name, std::string_view profile) {
    Reading reading{std::move(before), {}, {}};
    std::uint32_t wrong_line = 0;
    const auto root = parse_toml(text, name, &wrong_line);
    if (!root) {
        Problem problem;
        problem.file = name;
        problem.line = wrong_line;
        problem.error = root.error();
        reading.problems.push_back(std::move(problem));
        return reading;
    }
    for (const auto& [key, node] : *root) {
        if (key.str() != "profile") read_key(reading, key.str(), node, name, {});
    }
    read_profiles(reading, *root, name, profile);
    std::stable_sort(reading.problems.begin(), reading.problems.end(),
                     [](const Problem& a, const Problem& b) { return a.line < b.line; });
    const bool there = std::find(reading.profiles.begin(), reading.profiles.end(), profile) != reading.profiles.end();
    if (!profile.empty() && !there) reading.problems.push_back(no_profile(reading, name, profile));
    return reading;
}

}  // namespace

Result<void> load_text(Configuration& configuration, std::string_view text, const std::string& name, std::string_view profile) {
    Reading reading = read_toml(configuration, text, name, profile);
    if (!reading.problems.empty()) return reading.problems.front().error;
    configuration = std::move(reading.configuration);
    return {};
}

std::vector<Problem> problems_in_text(const Schema& schema, std::string_view text, const std::string& name) {
    Reading reading = read_toml(Configuration(schema), text, name, {});
    if (!reading.problems.empty()) return reading.problems;
    const auto across = [&](const Configuration& configuration) {
        const auto ok = check(configuration);
        if (ok) return;
        Problem problem;
        problem.error = ok.error();
        problem.key = ok.error().place.substr(0, ok.error().place.find(' '));
        const Origin origin = configuration.origin(problem.key);
        problem.file = name;
        problem.line = origin.line;
        const auto same = [&](const Problem& known) { return known.error.text() == problem.error.text(); };
        if (std::none_of(reading.problems.begin(), reading.problems.end(), same)) reading.problems.push_back(std::move(problem));
    };
    across(reading.configuration);
    for (const std::string& profile : reading.profiles)
        across(read_toml(Configuration(schema), text, name, profile).configuration);
    return reading.problems;
}

std::vector<Problem> problems_in_file(const Schema& schema, const std::string& file) {
    const auto text = read_text(file, max_bytes);
    if (text) return problems_in_text(schema, *text, file);
    Problem problem;
    problem.error = text.error();
    problem.file = file;
    return {problem};
}

Result<void> load_file(Configuration& configuration, const std::string& file, std::string_view profile) {
    const auto text = read_text(file, max_bytes);
    if (!text) return text.error();
    return load_text(configuration, *text, file, profile);
}

}  // namespace surefoot::config
