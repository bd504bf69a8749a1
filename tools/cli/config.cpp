// surefoot config: a settings file checked, and the values that would hold with where each came from.
#include <fmt/format.h>

#include <numbers>

#include "config/seat.hpp"
#include "config/settings.hpp"
#include "config/values.hpp"
#include "tools/cli/command.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::cli {

namespace {

using nlohmann::ordered_json;

struct ConfigArguments {
    std::string file, profile;
    std::vector<std::string> set;
    bool check = false, print = false, defaults = false, json = false;
};

ordered_json to_json(const config::Problem& p) {
    ordered_json object = {{"place", p.error.place}, {"what", p.error.what}, {"remedy", p.error.remedy}, {"file", p.file}};
    object["line"] = p.line > 0 ? ordered_json(p.line) : ordered_json(nullptr);
    for (const auto& [name, part] :
         {std::pair{"key", &p.key}, {"found", &p.found}, {"allowed", &p.allowed}, {"nearest", &p.nearest}})
        object[name] = part->empty() ? ordered_json(nullptr) : ordered_json(*part);
    return object;
}

int run_check(const ConfigArguments& a) {
    const auto problems = config::problems_in_file(walk::settings_schema(), a.file);
    if (a.json) {
        ordered_json errors = ordered_json::array();
        for (const config::Problem& problem : problems) errors.push_back(to_json(problem));
        print_json({{"file", a.file}, {"ok", problems.empty()}, {"errors", errors}});
    }
    for (const config::Problem& problem : problems) notify(problem.error.text());
    if (!problems.empty()) return exit_failure;
    if (!a.json) fmt::print("{}: OK\n", a.file);
    return exit_success;
}

ordered_json value_json(const config::Settings& settings, const config::Entry& entry) {
    if (entry.kind == config::Kind::choice) return std::string(config::choice_of(settings, entry));
    return std::visit([&](auto member) { return ordered_json(settings.*member); }, entry.member);
}

ordered_json to_json(const config::Configuration& c, const config::Entry& entry) {
    ordered_json object = {{"key", std::string(entry.key)}, {"value", value_json(c.values, entry)}};
    object["unit"] = entry.unit.empty() ? ordered_json(nullptr) : ordered_json(std::string(entry.unit));
    if (entry.kind == config::Kind::number || entry.kind == config::Kind::integer) {
        object["min"] = entry.min;
        object["max"] = entry.max;
    }
    if (entry.kind == config::Kind::choice)
        for (const Named& choice : entry.choices) object["choices"].push_back(std::string(choice.name));
    object["allowed"] = config::allowed(entry);
    object["default"] = value_json(c.schema->defaults(), entry);
    const config::Origin origin = c.origin(entry.key);
    object["origin"] = origin.text();
    object["line"] = origin.line > 0 ? ordered_json(origin.line) : ordered_json(nullptr);
    object["help"] = std::string(entry.help);
    return object;
}

/// Null where no seat is given.
ordered_json seat_json(const config::Settings& settings) {
    const auto seat = config::seat_of(settings);
    if (!seat) return nullptr;
    constexpr double degrees = 180 / std::numbers::pi;
    return {{"fov_x_deg", seat->fov_x_rad * degrees}, {"fov_y_deg", seat->fov_y_rad * degrees}};
}

int run_print(const ConfigArguments& a) {
    config::Configuration c(walk::settings_schema());
    if (!a.file.empty()) {
        if (auto loaded = config::load_file(c, a.file, a.profile); !loaded) return fail(loaded.error());
    }
    for (const std::string& assignment : a.set) {
        const auto equals = assignment.find('=');
        if (equals == std::string::npos)
            return misuse(
                {"--set " + assignment, "This is not KEY=VALUE", "Write for example --set rate_hz=60", ErrorKind::misuse});
        if (auto set = config::set_value(c, assignment.substr(0, equals), assignment.substr(equals + 1)); !set)
            return misuse({"--set " + assignment, set.error().what, set.error().remedy, set.error().kind});
    }
    if (auto ok = config::check(c); !ok) return fail(ok.error());
    if (!a.json) return fmt::print("{}", config::explain(c)), exit_success;
    ordered_json settings = ordered_json::array();
    for (const config::Entry& entry : c.schema->entries()) settings.push_back(to_json(c, entry));
    ordered_json object;
    object["file"] = a.file.empty() ? ordered_json(nullptr) : ordered_json(a.file);
    object["profile"] = a.profile.empty() ? ordered_json(nullptr) : ordered_json(a.profile);
    object["settings"] = std::move(settings);
    object["seat"] = seat_json(c.values);
    print_json(object);
    return exit_success;
}

int run_config(const ConfigArguments& a) {
    if (a.check && (a.print || a.defaults))
        return misuse({"--check", "A check prints no values", "Remove --print and --defaults", ErrorKind::misuse});
    if (a.check && a.file.empty())
        return misuse({"--check", "A check needs a file", "Run: surefoot config FILE --check", ErrorKind::misuse});
    if (a.check && (!a.profile.empty() || !a.set.empty()))
        return misuse({"--check", "A check reads the file with every profile", "Remove --profile and --set, or use --print",
                       ErrorKind::misuse});
    if (a.check) return run_check(a);
    if (!a.profile.empty() && a.file.empty())
        return misuse({"--profile " + a.profile, "A profile is a part of a settings file, and no file is named",
                       "Name the file too", ErrorKind::misuse});
    if (!a.defaults) return run_print(a);
    if (!a.file.empty() || !a.set.empty() || a.json)
        return misuse({"--defaults", "This option writes a settings file in which nothing is changed",
                       "Remove the file, --set and --json", ErrorKind::misuse});
    fmt::print("{}", config::commented_defaults(walk::settings_schema()));
    return exit_success;
}

}  // namespace

void add_config(CLI::App& app, Context& context) {
    auto a = std::make_shared<ConfigArguments>();
    CLI::App* c = add_command(
        app, "config", "Check a settings file, or print every setting and its origin",
        "surefoot config --print --defaults > surefoot.toml\n  surefoot config surefoot.toml --check\n  surefoot config "
        "surefoot.toml --profile kiosk --print",
        a->json);
    c->add_option("FILE", a->file, "Settings file (TOML); without it the defaults are shown");
    c->add_flag("--check", a->check, "Check the file: print OK, or each error with line, key, value and what is allowed");
    c->add_flag("--print", a->print, "Print every setting: value, unit, origin and what is allowed (the default)");
    c->add_flag("--defaults", a->defaults, "With --print: print a settings file in which every key is commented out");
    c->add_option("--profile", a->profile, "Apply the table [profile.NAME] of the file");
    c->add_option("--set", a->set, "Set a key, over the file; may be repeated")->type_name("KEY=VALUE");
    c->callback([&context, a] { context.run = [a] { return run_config(*a); }; });
}

}  // namespace surefoot::cli
