// Checks of option values.
#include "tools/cli/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "config/settings.hpp"
#include "render/gl/device.hpp"

namespace surefoot::cli {

namespace {

template <class Number>
std::optional<Number> number_in(std::string_view text) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

CLI::Validator number_within(double least, double most, const std::string& unit) {
    return {[=](std::string& text) {
                const auto value = number_in<double>(text);
                if (value && *value >= least && *value <= most) return std::string();
                return fmt::format("'{}' is not a number from {} to {}{}{}", text, least, most, unit.empty() ? "" : " ", unit);
            },
            fmt::format("{}..{}{}{}", least, most, unit.empty() ? "" : " ", unit)};
}

CLI::Validator whole_number_within(std::uint64_t least, std::uint64_t most) {
    return {[=](std::string& text) {
                const auto value = number_in<std::uint64_t>(text);
                if (!value || *value < least || *value > most) {
                    return fmt::format("'{}' is not a whole number from {} to {}", text, least, most);
                }
                text = std::to_string(*value);
                return std::string();
            },
            fmt::format("{}..{}", least, most)};
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
                const auto kind = gl::parse_backend(text);
                if (!kind) return kind.error().text();
                if (*kind != gl::BackendKind::null) return std::string();
                return std::string("'null' draws nothing and takes no time; one of: egl, device, window, osmesa");
            },
            ""};
}

Result<Size> parse_size(const std::string& text) {
    const config::Entry& width = *config::find_entry("width");
    const config::Entry& height = *config::find_entry("height");
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
    return Error{"--size " + text, "is no size of a picture",
                 fmt::format("WIDTHxHEIGHT, e.g. 1280x720, each a whole number from {} to {}", width.min, width.max)};
}

}  // namespace surefoot::cli
