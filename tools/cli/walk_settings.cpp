// Settings of a walk, from file and command line.
#include "tools/cli/walk_settings.hpp"

#include <fmt/format.h>

#include "config/values.hpp"
#include "tools/cli/options.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::cli {

namespace {

/// Sets a value of the command line through the schema. An error names the option as the user wrote it.
Result<void> put_setting(config::Configuration& c, const std::string& flag, const std::string& key, const std::string& text) {
    if (config::set_value(c, key, text)) return {};
    const config::Entry& entry = *c.schema->find(key);
    return refused_value(flag + " " + text, config::absent_because(entry, text), config::allowed(entry));
}

}  // namespace

void add_setting(CLI::App* c, const std::shared_ptr<SettingArguments>& a, const std::string& flag, const std::string& key,
                 std::string help) {
    const config::Schema& schema = walk::settings_schema();
    const config::Entry* entry = schema.find(key);
    if (help.empty()) help = entry->help;
    help += " Allowed: " + config::allowed(*entry) + " [" + config::value_text(schema.defaults(), *entry) + "]";
    for (const Named& choice : entry->choices) help += fmt::format("\n  {:<17} {}", choice.name, choice.help);
    c->add_option_function<std::string>(
        flag,
        [a, flag, key](const std::string& text) {
            a->values.push_back({flag, key, text});
        },
        help);
}

void add_settings(CLI::App* command, const std::shared_ptr<SettingArguments>& a, FlagsAndKeys more, FlagsAndKeys last) {
    command->add_option("--size", a->size, "Size of the picture in pixels [1280x720]");
    const auto add = [&](FlagsAndKeys settings) {
        for (const auto& [flag, key] : settings) add_setting(command, a, flag, key);
    };
    add({{"--lift", "lift_m"}, {"--rate", "rate_hz"}, {"--budget", "budget_ms"}});
    add(more);
    add({{"--selector", "selector"},
         {"--late", "late"},
         {"--backend", "backend"},
         {"--screen", "screen"},
         {"--mode", "mode"},
         {"--rotation", "rotation"},
         {"--shift-x", "shift_x"},
         {"--shift-y", "shift_y"},
         {"--screen-width", "screen_width_cm"},
         {"--eye-distance", "eye_distance_cm"},
         {"--acuity", "acuity_arcmin"},
         {"--clock", "clock"},
         {"--workers", "workers"},
         {"--rasterisers", "rasterisers"},
         {"--frame-core", "frame_core"}});
    add(last);
    command->add_flag("--no-fifo", a->no_fifo, "Ordinary scheduling (the figures are marked)");
    command->add_option("--config", a->config_file, "Settings in TOML; the command line wins");
    command->add_option("--profile", a->profile, "A [profile.NAME] of the settings file");
}

Result<config::Configuration> read_settings(const SettingArguments& a) {
    config::Configuration c(walk::settings_schema());
    if (!a.profile.empty() && a.config_file.empty()) {
        return Error{"--profile " + a.profile, "A profile is a part of a settings file, and no file is named",
                     "Add --config FILE.toml with a [profile." + a.profile + "]", ErrorKind::misuse};
    }
    if (!a.config_file.empty()) {
        if (auto ok = config::load_file(c, a.config_file, a.profile); !ok) return ok.error();
    }
    for (const auto& [flag, key, text] : a.values) {
        if (auto ok = put_setting(c, flag, key, text); !ok) return ok.error();
    }
    if (!a.size.empty()) {
        const auto size = parse_size(a.size);
        if (!size) return size.error();
        c.values.width = size->width;
        c.values.height = size->height;
    }
    if (a.no_fifo) c.values.fifo = false;
    if (a.no_check) c.values.in_frame_check = false;
    if (a.no_occlusion) c.values.occlusion = false;
    if (a.no_motion) c.values.motion = false;
    if (a.buy_effects) c.values.buy_effects = true;
    if (!a.cache.empty()) {
        const bool alone = a.cache == "true", none = a.cache == "false";
        const auto named = alone ? rt::name_of(rt::ImageCache::view) : none ? rt::name_of(rt::ImageCache::off) : a.cache;
        if (auto ok = put_setting(c, "--cache", "cache", std::string(named)); !ok) return ok.error();
    }
    for (std::size_t i = 0; i < rt::switch_count; ++i)
        if (a.no_light[i]) c.values.*rt::light_switches[i].on = false;
    return c;
}

}  // namespace surefoot::cli
