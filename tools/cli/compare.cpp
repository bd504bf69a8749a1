// surefoot compare: the same walk by every selector, or with other settings: pictures against full detail and times, as a table.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/values.hpp"
#include "render/gl/backends.hpp"
#include "render/select/registry.hpp"
#include "rt/base/text.hpp"
#include "tools/accuracy/compare.hpp"
#include "tools/accuracy/sweep.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/walk_settings.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::cli {

namespace {

constexpr std::array<std::string_view, 2> resources = {"time", "triangles"};

struct CompareArguments {
    accuracy::CompareRequest request;
    std::uint32_t value_frames = 20;
    bool value_frames_given = false;
    std::string resource{resources[0]}, out;
    std::vector<std::string> with;  ///< KEY=VALUE[,KEY=VALUE...], a walk each
    std::shared_ptr<SettingArguments> settings = std::make_shared<SettingArguments>();
    bool json = false;
};

accuracy::FindShares find_shares(const CompareArguments& a) {
    if (a.value_frames == 0 || !a.with.empty()) return nullptr;
    return [&a](std::span<const std::string> selectors, double budget_us, const Progress& progress) {
        accuracy::ShareRequest request;
        request.selectors.assign(selectors.begin(), selectors.end());
        request.frames = a.value_frames;
        request.budget_us = budget_us;
        request.limits.max_steps = 10'000'000;  // both together about half a second a frame
        request.limits.max_parts = 200;
        return accuracy::value_shares_of_walk(a.request.walk, std::move(request), progress);
    };
}

/// Settings of the comparison itself: the same for all walks, set by their own options.
constexpr std::array of_all = {"rasterisers", "width",   "height",   "rate_hz",         "backend",
                               "clock",       "shift_x", "shift_y",  "lift_m",          "control",
                               "screen",      "mode",    "rotation", "screen_width_cm", "eye_distance_cm"};

/// With --resource triangles, these are the same for all walks too.
constexpr std::array of_triangles = {"budget_ms", "resolution",    "filter",   "hysteresis",
                                     "reserve",   "rest_after_ms", "slice_us", "in_frame_check"};

/// A setting that is checked as an option of the command line would be.
Result<SettingArguments::Setting> setting_of(const std::string& pair, bool in_triangles) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0)
        return Error{"--with " + pair, "This is no KEY=VALUE", "Write for example --with resolution=100", ErrorKind::misuse};
    SettingArguments::Setting setting{"--with " + pair.substr(0, equals) + " =", pair.substr(0, equals), pair.substr(equals + 1)};
    const config::Schema& schema = walk::settings_schema();
    const config::Entry* entry = schema.find(setting.key);
    if (entry == nullptr) return config::unknown_key(schema, "--with", setting.key);
    if (entry->kind == config::Kind::file)
        return Error{"--with " + pair, fmt::format("{} names a file, and no way of walking", entry->key),
                     "Name it by its own option", ErrorKind::misuse};
    const bool fixed = in_triangles && std::find(of_triangles.begin(), of_triangles.end(), entry->key) != of_triangles.end();
    if (fixed || std::find(of_all.begin(), of_all.end(), entry->key) != of_all.end())
        return Error{
            "--with " + pair,
            fmt::format("{} is the same for all walks of {}", entry->key, fixed ? "--resource triangles" : "a comparison"),
            fixed ? "Remove it" : "Set it by its own option, and compare twice", ErrorKind::misuse};
    return setting;
}

/// The walk with the settings that `text` adds to those of all.
Result<walk::WalkRequest> walk_with(const CompareArguments& a, const std::string& text) {
    SettingArguments settings = *a.settings;
    if (settings.no_fifo) settings.values.push_back({"--no-fifo", "fifo", "false"});  // so that --with comes last
    settings.no_fifo = false;
    for (const std::string_view pair : split(text, ",")) {
        if (pair.empty()) continue;
        auto setting = setting_of(std::string(pair), a.request.in_triangles);
        if (!setting) return setting.error();
        settings.values.push_back(std::move(*setting));
    }
    auto read = read_settings(settings);
    if (!read) return read.error();
    if (auto ok = config::check(*read); !ok) return ok.error();
    walk::WalkRequest request = a.request.walk;
    walk::apply_settings(*read, request);
    if (auto ok = walk::check_request(request); !ok) return ok.error();
    return request;
}

/// --budget is a number of triangles: the time that these are given replaces it.
Result<void> take_triangles(CompareArguments& a) {
    constexpr std::uint32_t max_triangles = 999'999;
    if (a.value_frames_given && a.value_frames > 0)
        return Error{"--value-frames", "Values are weighed against time, not against triangles",
                     "Remove --value-frames, or --resource triangles", ErrorKind::misuse};
    a.value_frames = 0;
    auto& values = a.settings->values;
    const auto given = [&](std::string_view key) {
        return std::find_if(values.begin(), values.end(), [key](const auto& s) { return s.key == key; });
    };
    if (const auto clock = given("clock"); clock != values.end() && clock->text == rt::name_of(rt::ClockKind::real))
        return Error{"--clock real", "Triangles are counted on the virtual clock", "Remove --clock, or --resource triangles",
                     ErrorKind::misuse};
    const auto budget = given("budget_ms");
    const auto number = budget == values.end() ? std::nullopt : number_in<std::uint32_t>(budget->text);
    if (!number || *number < 1 || *number > max_triangles)
        return Error{"--resource triangles", "The budget is no number of triangles",
                     fmt::format("Add --budget N, with a whole number from 1 to {}", max_triangles), ErrorKind::misuse};
    budget->text = fmt::format("{:.4f}", accuracy::triangle_budget_ms(*number));
    if (given("late") == values.end()) values.push_back({"--late", "late", "float"});  // no frame is too short for its triangles
    return {};
}

/// Selectors at full resolution; or the walk as it is set, and with each of --with.
Result<void> fill_request(CompareArguments& a) {
    if (a.request.walk.frames > 0 && a.request.walk.seconds > 0)
        return Error{"--seconds", "--seconds and --frames both set the length", "Remove one of them", ErrorKind::misuse};
    a.request.in_triangles = a.resource == resources[1];
    if (a.request.in_triangles)
        if (auto ok = take_triangles(a); !ok) return ok;
    auto base = walk_with(a, {});
    if (!base) return base.error();
    if (!a.with.empty()) a.request.settings.push_back({"as set", *base});
    for (const std::string& text : a.with) {
        auto walk = walk_with(a, text);
        if (!walk) return walk.error();
        a.request.settings.push_back({text, std::move(*walk)});
    }
    a.request.walk = std::move(*base);
    if (a.with.empty()) a.request.walk.resolution_pct = 100;  // forms are compared
    std::vector<std::string> selectors = a.request.selectors;
    if (!a.with.empty()) {
        selectors.clear();
        for (const accuracy::NamedWalk& named : a.request.settings) selectors.push_back(named.walk.selector);
    }
    if (auto ok = check_benefit(a.request.walk.benefit, selectors); !ok) return ok;
    if (!a.request.in_triangles) return {};
    for (accuracy::NamedWalk& named : a.request.settings) accuracy::spend_triangles(named.walk);
    accuracy::spend_triangles(a.request.walk);
    return {};
}

int run_compare_command(CompareArguments& a, const Context& context) {
    if (auto ok = fill_request(a); !ok) return misuse(ok.error());
    if (!a.out.empty())
        if (auto ok = accuracy::probe_compare_page(a.out); !ok) return fail(ok.error());
    walk::prepare_process(a.request.walk);
    auto comparison = accuracy::compare_selectors(
        a.request, [](const walk::WalkRequest& one, const Progress& progress) { return walk::run_walk(one, progress, {}); },
        find_shares(a), terminal_progress(context));
    end_progress(context);
    if (!comparison) return fail(comparison.error());
    if (!a.out.empty())
        if (auto w = accuracy::write_compare_page(a.out, *comparison); !w) return fail(w.error());
    if (!comparison->uncalibrated.empty()) notify("The figures are uncalibrated: " + comparison->uncalibrated + ".");
    fmt::print("{}", a.json ? accuracy::compare_json(*comparison) : accuracy::compare_table(*comparison));
    return exit_success;
}

void add_resource(CLI::App* c, const std::shared_ptr<CompareArguments>& a) {
    c->add_option("--resource", a->resource,
                  "What --budget is of: time, or triangles. With triangles the walk is on the virtual clock, and its budget is a "
                  "number of triangles. Each frame is prepared for its own pose alone then")
        ->check(one_of(resources))
        ->capture_default_str();
}

/// Settings of all walks of the comparison.
void add_settings_of_all(CLI::App* c, const std::shared_ptr<SettingArguments>& settings) {
    for (const auto& [flag, key] :
         std::initializer_list<std::pair<const char*, const char*>>{{"--lift", "lift_m"},
                                                                    {"--rate", "rate_hz"},
                                                                    {"--budget", "budget_ms"},
                                                                    {"--late", "late"},
                                                                    {"--sky", "sky"},
                                                                    {"--screen-width", "screen_width_cm"},
                                                                    {"--eye-distance", "eye_distance_cm"},
                                                                    {"--acuity", "acuity_arcmin"},
                                                                    {"--clock", "clock"},
                                                                    {"--workers", "workers"},
                                                                    {"--rasterisers", "rasterisers"}})
        add_setting(c, settings, flag, key);
}

}  // namespace

void add_compare(CLI::App& app, Context& context) {
    auto a = std::make_shared<CompareArguments>();
    CLI::App* c = add_command(
        app, "compare", "Compare selectors or settings by the pictures and times of one walk",
        "surefoot compare town.walk --seconds 20 --rounds 3\n"
        "surefoot compare town.walk --with resolution=100 --with hysteresis=1,reserve=0\n\n"
        "Selectors walk in turns, at full resolution. After each walk, frames are drawn again and in full detail: PSNR is pooled "
        "over\n"
        "them, SSIM and FLIP are means. `popped` and `pops` compare one pose by a frame's cut and by the cut before it:\n"
        "the share of pixels that change visibly, and PSNR. `unused` is the mean time left, in ms, where the value\n"
        "is below 0.99 or not known. `coarse` counts frames with coarser slices. `floor` counts frames that fell to the\n"
        "floor although the cut before would have fitted. `value` is the share of the greatest value that the budget buys,\n"
        "found off line on frames of the path at full resolution. >= says that some optimum is not proven: the share is\n"
        "of an upper bound then.\n"
        "With --with, settings walk in turns instead, at the resolution that each chooses; no value is shared.",
        a->json);
    walk::WalkRequest& r = a->request.walk;
    r.pictures = 7;
    a->request.selectors = accuracy::compared_selectors();
    c->add_option("model", r.model_file, "The .walk model")->required();
    c->add_option("--path", r.path_file, "CSV file of poses over time (else MODEL.path.csv, else a tour)");
    c->add_option("--selector", a->request.selectors, "Selectors to compare")
        ->check(one_of(select::compared_names()))
        ->capture_default_str();
    add_benefit(c, a->request.walk.benefit);
    c->add_option("--with", a->with,
                  "Compare settings, not selectors: one walk as it is set, and one with each KEY=VALUE, or KEY=VALUE,KEY=VALUE. "
                  "Keys are those of surefoot config")
        ->type_name("KEY=VALUE")
        ->excludes("--selector");
    add_resource(c, a);
    c->add_option("-o,--out", a->out, "Folder for a page of every compared picture, pictures.csv and pictures.svg")
        ->check(names_something());
    c->add_option("--seconds", r.seconds, "Length of each walk in seconds (else as the path is long)")
        ->check(number_within(0.001, 1e6, "s"));
    c->add_option("--frames", r.frames, "Length of each walk in frames, instead of --seconds")
        ->check(whole_number_within(1, 4'000'000));
    c->add_option("--pictures", r.pictures, "Number of frames of a walk that are compared with full detail, evenly spread")
        ->check(whole_number_within(1, 100))
        ->capture_default_str();
    c->add_option("--rounds", a->request.rounds, "Number of walks by each selector, in turns; medians are printed")
        ->check(whole_number_within(1, 100))
        ->capture_default_str();
    c->add_option("--value-frames", a->value_frames,
                  "Number of frames whose best cut is searched for, evenly spread; 0: none. Of a budget of time only")
        ->check(whole_number_within(0, 1000))
        ->capture_default_str();
    c->add_option("--size", a->settings->size, "Size of the picture in pixels [1280x720]");
    add_settings_of_all(c, a->settings);
    c->add_flag("--no-fifo", a->settings->no_fifo, "Ordinary scheduling (the figures are marked)");
    c->add_option_function<std::string>(
         "--backend",
         [settings = a->settings](const std::string& text) {
             settings->values.push_back({"--backend", "backend", text});
         },
         "Backend that draws: " + gl::drawing_backends() + " [" + std::string(gl::usual_backend) + "]")
        ->check(drawing_backend());
    c->add_option("--state", r.state_dir, "Folder of the calibrated cost table");
    c->callback([&context, a, c] {
        a->value_frames_given = c->count("--value-frames") > 0;
        context.run = [a, &context] { return run_compare_command(*a, context); };
    });
}

}  // namespace surefoot::cli
