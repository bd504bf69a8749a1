// Values: text to value within the schema's limits, value to text, and the rules across keys.
#include "config/values.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <type_traits>
#include <utility>

#include "config/seat.hpp"
#include "rt/base/text.hpp"

namespace surefoot::config {

namespace {

bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }

/// As a basic string of TOML: control characters are escaped.
std::string toml_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (is_control(c)) {
            out += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
            continue;
        }
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

bool is_plain_text(std::string_view text, double max_length) {
    return static_cast<double>(text.size()) <= max_length && std::none_of(text.begin(), text.end(), is_control);
}

bool is_colour(std::string_view text) {
    return text.size() == 7 && text[0] == '#' &&
           text.substr(1).find_first_not_of("0123456789abcdefABCDEF") == std::string_view::npos;
}

/// A number as a person writes it: 30, 0.01, 1.25.
std::string number_text(double value) { return fmt::format("{}", value); }

std::string limits_of(const Entry& entry) {
    switch (entry.kind) {
        case Kind::number:
            return fmt::format("a number from {} to {}", number_text(entry.min), number_text(entry.max));
        case Kind::integer:
            if (!entry.only.empty()) return fmt::format("one of {}", fmt::join(entry.only, ", "));
            return fmt::format("a whole number from {} to {}", number_text(entry.min), number_text(entry.max));
        case Kind::flag:
            return "true or false";
        case Kind::choice:
            return "one of " + names_in_words(entry.choices);
        case Kind::colour:
            return "a colour as \"#rrggbb\"";
        case Kind::file:
            return fmt::format("a file name of at most {} bytes without control characters", number_text(entry.max));
        case Kind::text:
            return fmt::format("a text of at most {} bytes without control characters", number_text(entry.max));
    }
    return {};
}

}  // namespace

std::string allowed(const Entry& entry) {
    std::string text = limits_of(entry);
    if (!entry.unit.empty()) text += fmt::format(" ({})", entry.unit);
    return text;
}

std::string text_of(const Value& value) {
    if (const auto* number = std::get_if<double>(&value)) return number_text(*number);
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
    return toml_string(std::get<std::string>(value));
}

std::string_view absent_because(const Entry& entry, std::string_view name) {
    const Named* known = find_named(entry.absent, name);
    return known == nullptr ? std::string_view() : known->help;
}

namespace {

/// Numbers and choices go into members of several types; the entry's kind and limits have been checked.
void put_number(Settings& settings, const Entry& entry, double number) {
    const auto put = [&](auto member) {
        using T = std::remove_reference_t<decltype(settings.*member)>;
        if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) settings.*member = static_cast<T>(number);
    };
    std::visit(put, entry.member);
}

void put_choice(Settings& settings, const Entry& entry, const Named& chosen) {
    const auto put = [&](auto member) {
        using T = std::remove_reference_t<decltype(settings.*member)>;
        if constexpr (std::is_same_v<T, std::string>)
            settings.*member = chosen.name;
        else if constexpr (std::is_enum_v<T>)
            settings.*member = static_cast<T>(&chosen - entry.choices.data());
    };
    std::visit(put, entry.member);
}

}  // namespace

std::optional<Error> assign(Settings& settings, const Entry& entry, const Value& value) {
    const auto refusal = [&](std::string_view why = "is not allowed") {
        return Error{
            {}, fmt::format("The value {} = {} {}", entry.key, text_of(value), why), "Use " + allowed(entry), ErrorKind::misuse};
    };
    if (const auto* number = std::get_if<double>(&value)) {
        const bool numeric = entry.kind == Kind::number || entry.kind == Kind::integer;
        const bool whole = entry.kind != Kind::integer || std::floor(*number) == *number;
        const bool listed = entry.only.empty() || std::find(entry.only.begin(), entry.only.end(), *number) != entry.only.end();
        if (!numeric || !whole || !listed || !(*number >= entry.min && *number <= entry.max)) return refusal();
        put_number(settings, entry, *number);
        return std::nullopt;
    }
    if (const auto* flag = std::get_if<bool>(&value)) {
        if (entry.kind != Kind::flag) return refusal();
        settings.*std::get<bool Settings::*>(entry.member) = *flag;
        return std::nullopt;
    }
    const auto& text = std::get<std::string>(value);
    if (entry.kind == Kind::choice) {
        const Named* chosen = find_named(entry.choices, text);
        const std::string_view absent = absent_because(entry, text);
        if (chosen == nullptr && !absent.empty()) return refusal(absent);
        if (chosen == nullptr) return refusal();
        put_choice(settings, entry, *chosen);
        return std::nullopt;
    }
    const bool free = entry.kind == Kind::file || entry.kind == Kind::text;
    const bool fits = (entry.kind == Kind::colour && is_colour(text)) || (free && is_plain_text(text, entry.max));
    if (!fits) return refusal();
    settings.*std::get<std::string Settings::*>(entry.member) = text;
    return std::nullopt;
}

Error unknown_key(const Schema& schema, std::string place, std::string_view key) {
    if (auto renamed = renamed_error(schema.renamed(), place, key)) return *renamed;
    const auto nearest = schema.nearest(key);
    return {std::move(place), fmt::format("The key '{}' is unknown", key),
            nearest.empty() ? "See `surefoot config --print` for the keys" : fmt::format("Did you mean '{}'?", nearest),
            ErrorKind::misuse};
}

std::string Origin::text() const {
    if (command_line) return "command line";
    if (file.empty()) return "default";
    return fmt::format("{}:{}{}", file, line, profile.empty() ? "" : fmt::format(" (profile {})", profile));
}

Origin Configuration::origin(std::string_view key) const {
    const auto* entry = schema->find(key);
    const auto found = entry == nullptr ? origins.end() : origins.find(entry->key);
    return found == origins.end() ? Origin{} : found->second;
}

Result<void> set_value(Configuration& configuration, std::string_view key, std::string_view text) {
    const auto* entry = configuration.schema->find(key);
    if (entry == nullptr) return unknown_key(*configuration.schema, "command line", key);
    Value value = std::string(text);
    if (entry->kind == Kind::number || entry->kind == Kind::integer) {
        if (const auto number = number_in<double>(text)) value = *number;
    } else if (entry->kind == Kind::flag) {
        if (text == "true" || text == "on" || text == "yes" || text == "1") value = true;
        if (text == "false" || text == "off" || text == "no" || text == "0") value = false;
    }
    if (auto refused = assign(configuration.values, *entry, value)) {
        refused->place = "command line";
        return *refused;
    }
    configuration.origins[std::string(entry->key)] = {{}, 0, true, {}};
    return {};
}

Result<void> check(const Configuration& configuration) {
    const Settings& s = configuration.values;
    const auto place = [&](std::string_view key) {
        const Origin origin = configuration.origin(key);
        return fmt::format("{} ({})", key, origin.text());
    };
    if (s.raster_priority >= s.frame_priority)
        return Error{place("raster_priority"),
                     fmt::format("The priority {} is not below frame_priority {}", s.raster_priority, s.frame_priority),
                     "Lower it, so that the frame thread can interrupt the rasterisers", ErrorKind::misuse};
    if (s.worker_priority >= s.raster_priority)
        return Error{place("worker_priority"),
                     fmt::format("The priority {} is not below raster_priority {}", s.worker_priority, s.raster_priority),
                     "Lower it, so that workers do not delay the rasterisers", ErrorKind::misuse};
    if (s.budget_ms > 0 && s.late == rt::LatePolicy::lock && s.budget_ms > 1000.0 / s.rate_hz)
        return Error{place("budget_ms"),
                     fmt::format("A budget of {} ms is longer than a frame at {} Hz ({:.3f} ms)", s.budget_ms, s.rate_hz,
                                 1000.0 / s.rate_hz),
                     "Lower the budget or the rate, or use late = \"float\"", ErrorKind::misuse};
    if (s.hour < 0 && s.hour != -1)
        return Error{place("hour"), fmt::format("The hour {} is not on a clock", s.hour),
                     "Use 0 to 24, or -1 for the model's own light", ErrorKind::misuse};
    if (s.hour_speed != 0 && s.hour < 0)
        return Error{place("hour_speed"), fmt::format("A speed of {} h/min needs an hour to begin at", s.hour_speed),
                     "Set the hour too, from 0 to 24", ErrorKind::misuse};
    if (auto problem = seat_problem(s))
        return Error{place(problem->key), std::move(problem->what), std::move(problem->remedy), ErrorKind::misuse};
    return {};
}

std::string file_setting(const Configuration& configuration, std::string_view key, std::string_view word) {
    const Entry* entry = configuration.schema->find(key);
    const std::string& name = configuration.values.*std::get<std::string Settings::*>(entry->member);
    const Origin origin = configuration.origin(entry->key);
    if (name.empty() || name == word || origin.file.empty() || name.front() == '/') return name;
    return (std::filesystem::path(origin.file).parent_path() / name).string();
}

std::string_view choice_of(const Settings& settings, const Entry& entry) {
    const auto name = [&](auto member) -> std::string_view {
        using T = std::remove_const_t<std::remove_reference_t<decltype(settings.*member)>>;
        if constexpr (std::is_same_v<T, std::string>)
            return settings.*member;
        else if constexpr (std::is_enum_v<T>)
            return entry.choices[static_cast<std::size_t>(settings.*member)].name;
        else
            return {};
    };
    return std::visit(name, entry.member);
}

std::string value_text(const Settings& settings, const Entry& entry) {
    if (entry.kind == Kind::choice) return toml_string(choice_of(settings, entry));
    const auto text = [&](auto member) -> std::string {
        using T = std::remove_const_t<std::remove_reference_t<decltype(settings.*member)>>;
        if constexpr (std::is_same_v<T, bool>)
            return settings.*member ? "true" : "false";
        else if constexpr (std::is_same_v<T, double>)
            return number_text(settings.*member);
        else if constexpr (std::is_arithmetic_v<T>)
            return std::to_string(settings.*member);
        else if constexpr (std::is_same_v<T, std::string>)
            return toml_string(settings.*member);
        else
            return {};  // an enum is a choice
    };
    return std::visit(text, entry.member);
}

std::string commented_defaults(const Schema& schema) {
    std::string text = "# Surefoot settings. Every line shows a default; take away the '#' to change it.\n";
    for (const Entry& entry : schema.entries()) {
        text += fmt::format("\n# {} Allowed: {}.\n", entry.help, allowed(entry));
        for (const Named& choice : entry.choices) text += fmt::format("#   {:<17} {}\n", choice.name, choice.help);
        text += fmt::format("# {} = {}\n", entry.key, value_text(schema.defaults(), entry));
    }
    return text;
}

std::string explain(const Configuration& configuration) {
    std::size_t widest = 7;
    for (const Entry& entry : configuration.schema->entries())
        widest = std::max(widest, configuration.origin(entry.key).text().size());
    std::string text;
    for (const Entry& entry : configuration.schema->entries())
        text += fmt::format("{:<16} {:<12} {:<8} {:<{}}  {}\n", entry.key, value_text(configuration.values, entry), entry.unit,
                            configuration.origin(entry.key).text(), widest, limits_of(entry));
    if (const auto seat = seat_of(configuration.values))
        text += fmt::format("The seat gives a field of view of {}, in every pose.\n", seat_text(*seat));
    return text;
}

std::array<float, 3> colour_of(std::string_view text) {
    std::array<float, 3> colour{};
    for (std::size_t i = 0; i < colour.size(); ++i) {
        unsigned byte = 0;
        const auto digits = text.substr(std::min(text.size(), 1 + 2 * i), 2);
        std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
        colour[i] = static_cast<float>(byte) / 255.0F;
    }
    return colour;
}

}  // namespace surefoot::config
