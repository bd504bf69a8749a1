// Values: text to value within the schema's limits, value to text, and the rules across keys.
#include "config/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

namespace surefoot::config {

namespace {

/// As a basic string of TOML.
std::string toml_string(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

bool is_file_name(std::string_view text, double most) {
    const auto control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
    return static_cast<double>(text.size()) <= most && std::none_of(text.begin(), text.end(), control);
}

std::string joined(std::span<const std::string_view> words) {
    std::string text;
    for (const auto word : words) text += (text.empty() ? "" : ", ") + std::string(word);
    return text;
}

std::optional<double> number_in(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
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
            return fmt::format("a whole number from {} to {}", number_text(entry.min), number_text(entry.max));
        case Kind::flag:
            return "true or false";
        case Kind::choice:
            return "one of " + joined(entry.choices);
        case Kind::colour:
            return "a colour as \"#rrggbb\"";
        case Kind::file:
            return fmt::format("a file name of at most {} bytes", number_text(entry.max));
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

std::optional<std::string> assign(Settings& settings, const Entry& entry, const Value& value) {
    const auto refusal = [&] { return fmt::format("{} = {} is not {}", entry.key, text_of(value), allowed(entry)); };
    if (const auto* number = std::get_if<double>(&value)) {
        const bool numeric = entry.kind == Kind::number || entry.kind == Kind::integer;
        const bool whole = entry.kind != Kind::integer || std::floor(*number) == *number;
        if (!numeric || !whole || !(*number >= entry.min && *number <= entry.max)) return refusal();
        if (entry.kind == Kind::number)
            settings.*std::get<double Settings::*>(entry.member) = *number;
        else
            settings.*std::get<std::int64_t Settings::*>(entry.member) = static_cast<std::int64_t>(*number);
        return std::nullopt;
    }
    if (const auto* flag = std::get_if<bool>(&value)) {
        if (entry.kind != Kind::flag) return refusal();
        settings.*std::get<bool Settings::*>(entry.member) = *flag;
        return std::nullopt;
    }
    const auto& text = std::get<std::string>(value);
    const bool fits =
        (entry.kind == Kind::choice && std::find(entry.choices.begin(), entry.choices.end(), text) != entry.choices.end()) ||
        (entry.kind == Kind::colour && is_colour(text)) || (entry.kind == Kind::file && is_file_name(text, entry.max));
    if (!fits) return refusal();
    settings.*std::get<std::string Settings::*>(entry.member) = text;
    return std::nullopt;
}

Error unknown_key(std::string place, std::string_view key) {
    const auto nearest = nearest_key(key);
    return {std::move(place), fmt::format("unknown key '{}'", key),
            nearest.empty() ? "'surefoot config --print' lists the keys" : fmt::format("did you mean '{}'?", nearest)};
}

std::string Origin::text() const {
    if (command_line) return "command line";
    if (file.empty()) return "default";
    return fmt::format("{}:{}{}", file, line, profile.empty() ? "" : fmt::format(" (profile {})", profile));
}

Origin Configuration::origin(std::string_view key) const {
    const auto* entry = find_entry(key);
    const auto found = entry == nullptr ? origins.end() : origins.find(entry->key);
    return found == origins.end() ? Origin{} : found->second;
}

Result<void> set_value(Configuration& configuration, std::string_view key, std::string_view text) {
    const auto* entry = find_entry(key);
    if (entry == nullptr) return unknown_key("command line", key);
    Value value = std::string(text);
    if (entry->kind == Kind::number || entry->kind == Kind::integer) {
        if (const auto number = number_in(text)) value = *number;
    } else if (entry->kind == Kind::flag) {
        if (text == "true" || text == "on" || text == "yes" || text == "1") value = true;
        if (text == "false" || text == "off" || text == "no" || text == "0") value = false;
    }
    if (auto problem = assign(configuration.values, *entry, value)) return Error{"command line", *problem, {}};
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
                     fmt::format("{} is not below frame_priority {}", s.raster_priority, s.frame_priority),
                     "the frame thread must be able to interrupt the rasterisers"};
    if (s.worker_priority >= s.raster_priority)
        return Error{place("worker_priority"),
                     fmt::format("{} is not below raster_priority {}", s.worker_priority, s.raster_priority),
                     "load beside the rasterisers must not hold them up"};
    if (s.budget_ms > 0 && s.late == "lock" && s.budget_ms > 1000.0 / s.rate_hz)
        return Error{place("budget_ms"),
                     fmt::format("{} ms is longer than a frame at {} Hz ({:.3f} ms)", s.budget_ms, s.rate_hz, 1000.0 / s.rate_hz),
                     "lower the budget or the rate, or use late = \"float\""};
    return {};
}

std::string file_setting(const Configuration& configuration, std::string_view key, std::string_view word) {
    const Entry* entry = find_entry(key);
    const std::string& name = configuration.values.*std::get<std::string Settings::*>(entry->member);
    const Origin origin = configuration.origin(entry->key);
    if (name.empty() || name == word || origin.file.empty() || name.front() == '/') return name;
    return (std::filesystem::path(origin.file).parent_path() / name).string();
}

std::string value_text(const Settings& settings, const Entry& entry) {
    struct Writer {
        const Settings& s;
        std::string operator()(double Settings::*m) const { return number_text(s.*m); }
        std::string operator()(std::int64_t Settings::*m) const { return std::to_string(s.*m); }
        std::string operator()(bool Settings::*m) const { return s.*m ? "true" : "false"; }
        std::string operator()(std::string Settings::*m) const { return toml_string(s.*m); }
    };
    return std::visit(Writer{settings}, entry.member);
}

std::string commented_defaults() {
    std::string text = "# Surefoot settings. Every line shows a default; take away the '#' to change it.\n";
    const Settings defaults;
    for (const Entry& entry : schema())
        text += fmt::format("\n# {} {}{}.\n# {} = {}\n", entry.help, entry.kind == Kind::flag ? "" : "Allowed: ", allowed(entry),
                            entry.key, value_text(defaults, entry));
    return text;
}

std::string explain(const Configuration& configuration) {
    std::size_t widest = 7;
    for (const Entry& entry : schema()) widest = std::max(widest, configuration.origin(entry.key).text().size());
    std::string text;
    for (const Entry& entry : schema())
        text += fmt::format("{:<16} {:<12} {:<8} {:<{}}  {}\n", entry.key, value_text(configuration.values, entry), entry.unit,
                            configuration.origin(entry.key).text(), widest, limits_of(entry));
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
