// Checks of option values.
#include "tools/cli/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "render/gl/backends.hpp"
#include "rt/base/text.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::cli {

CLI::Validator number_within(double min, double max, const std::string& unit) {
    return {[=](std::string& text) {
                const auto value = number_in<double>(text);
                if (value && *value >= min && *value <= max) return std::string();
                return fmt::format("'{}' is not a number from {} to {}{}{}", text, min, max, unit.empty() ? "" : " ", unit);
            },
            fmt::format("{}..{}{}{}", min, max, unit.empty() ? "" : " ", unit)};
}

CLI::Validator whole_number_within(std::uint64_t min, std::uint64_t max) {
    return {[=](std::string& text) {
                const auto value = number_in<std::uint64_t>(text);
                if (!value || *value < min || *value > max) {
                    return fmt::format("'{}' is not a whole number from {} to {}", text, min, max);
                }
                text = std::to_string(*value);
                return std::string();
            },
            fmt::format("{}..{}", min, max)};
}

CLI::Validator one_of(std::span<const std::string_view> words) {
    std::string all;
    for (const std::string_view word : words) all += (all.empty() ? "" : ", ") + std::string(word);
    const std::vector<std::string> known(words.begin(), words.end());
    return {[known, all](std::string& text) {
                if (std::find(known.begin(), known.end(), text) != known.end()) return std::string();
                return fmt::format("'{}' is not one of {}", text, all);
            },
            all};
}

CLI::Validator drawing_backend() {
    return {[](std::string& text) {
                const auto backend = gl::backend_named(text);
                if (!backend) return backend.error().text();
                if ((*backend)->draws()) return std::string();
                return fmt::format("'{}' draws nothing; use one of: {}", text, gl::drawing_backends());
            },
            ""};
}

std::span<const config::Renamed> renamed_options() { return {}; }  // no option has had another name yet: tests/known_names.txt

std::optional<std::string> renamed_option(std::span<const std::string_view> arguments) {
    for (const std::string_view argument : arguments) {
        if (!argument.starts_with("--")) continue;
        if (auto error = config::renamed_error(renamed_options(), "command line", argument.substr(0, argument.find('='))))
            return error->text();
    }
    return std::nullopt;
}

Result<Size> parse_size(const std::string& text) {
    const config::Entry& width = *walk::settings_schema().find("width");
    const config::Entry& height = *walk::settings_schema().find("height");
    const std::size_t x = text.find('x');
    const auto side = [](std::string_view digits, const config::Entry& entry) -> std::optional<std::uint32_t> {
        const auto value = number_in<std::uint32_t>(digits);
        return value && *value >= entry.min && *value <= entry.max ? value : std::nullopt;
    };
    const std::string_view all = text;
    if (x != std::string::npos) {
        const auto w = side(all.substr(0, x), width), h = side(all.substr(x + 1), height);
        if (w && h) return Size{*w, *h};
    }
    return Error{
        "--size " + text, "This is not the size of a picture",
        fmt::format("Write WIDTHxHEIGHT, for example 1280x720. Each is a whole number from {} to {}", width.min, width.max),
        ErrorKind::misuse};
}

}  // namespace surefoot::cli
