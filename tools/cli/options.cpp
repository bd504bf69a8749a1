// Checks of option values.
#include "tools/cli/options.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "config/values.hpp"
#include "render/gl/backends.hpp"
#include "rt/base/text.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::cli {

Error refused_value(const std::string& given, std::string_view why, const std::string& allowed) {
    return {given, why.empty() ? "The value is not allowed" : fmt::format("The value {}", why), "Use " + allowed,
            ErrorKind::misuse};
}

CLI::Validator number_within(double min, double max, const std::string& unit) {
    return {[=](std::string& text) {
                const auto value = number_in<double>(text);
                if (value && *value >= min && *value <= max) return std::string();
                const std::string suffix = unit.empty() ? "" : " (" + unit + ")";
                return refused_value(text, "", fmt::format("a number from {} to {}{}", min, max, suffix)).text();
            },
            fmt::format("{} to {}{}{}", min, max, unit.empty() ? "" : " ", unit)};
}

CLI::Validator whole_number_within(std::uint64_t min, std::uint64_t max) {
    return {[=](std::string& text) {
                const auto value = number_in<std::uint64_t>(text);
                if (!value || *value < min || *value > max) {
                    return refused_value(text, "", fmt::format("a whole number from {} to {}", min, max)).text();
                }
                text = std::to_string(*value);
                return std::string();
            },
            fmt::format("{} to {}", min, max)};
}

CLI::Validator one_of(std::span<const std::string_view> words) {
    std::string all;
    for (const std::string_view word : words) all += (all.empty() ? "" : ", ") + std::string(word);
    const std::vector<std::string> known(words.begin(), words.end());
    return {[known, all](std::string& text) {
                if (std::find(known.begin(), known.end(), text) != known.end()) return std::string();
                return refused_value(text, "", "one of " + all).text();
            },
            all};
}

CLI::Validator drawing_backend() {
    return {[](std::string& text) {
                const auto backend = gl::backend_named(text);
                if (backend && (*backend)->draws()) return std::string();
                const std::string_view why = backend.ok() ? "draws nothing" : "";
                return refused_value(text, why, "one of " + gl::drawing_backends()).text();
            },
            ""};
}

CLI::Option* add_time(CLI::App* command, double& time_s) {
    return command
        ->add_option("--time", time_s, "Seconds since the model's animations began: what moves is drawn as it stands then")
        ->check(number_within(0, 1e6, "s"))
        ->capture_default_str();
}

void add_benefit(CLI::App* command, select::BenefitModel& model) {
    std::string help = fmt::format("Benefit of a cluster for {}. ", fmt::join(select::searches_by_benefit(), " and "));
    std::vector<std::string_view> names;
    for (const select::BenefitModelEntry& entry : select::benefit_models()) {
        help += fmt::format("{}{}: {}", names.empty() ? "" : "; ", entry.name, entry.help);
        names.push_back(entry.name);
    }
    command
        ->add_option_function<std::string>(
            "--benefit",
            [&model](const std::string& name) {
                if (const auto named = select::benefit_model_named(name)) model = *named;
            },
            help + " [" + std::string(select::usual_benefit_model) + "]")
        ->check(one_of(names));
}

Result<void> check_benefit(select::BenefitModel model, std::span<const std::string> selectors) {
    const auto searches = select::searches_by_benefit();
    const auto goes_by_it = [&](const std::string& name) {
        return std::find(searches.begin(), searches.end(), name) != searches.end();
    };
    if (model == select::BenefitModel::surefoot || std::any_of(selectors.begin(), selectors.end(), goes_by_it)) return {};
    return Error{"--benefit", "None of the compared selectors goes by a benefit that can be chosen",
                 fmt::format("Compare {}", fmt::join(searches, " or ")), ErrorKind::misuse};
}

CLI::Validator names_something() {
    return {[](std::string& text) {
                if (!text.empty()) return std::string();
                return Error{"''", "The value names nothing", "Give a name, or remove the option", ErrorKind::misuse}.text();
            },
            ""};
}

std::span<const config::Renamed> renamed_options() { return {}; }  // no option has had another name yet: tests/known_names.txt

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
