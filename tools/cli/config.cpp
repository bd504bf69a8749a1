// surefoot config: a settings file checked, and the values that would hold with where each came from.
#include <fmt/format.h>

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
    for (const config::Problem& problem : problems) note(problem.error.text());
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

int run_print(const ConfigArguments& a) {
    config::Configuration c(walk::settings_schema());
    if (!a.file.empty()) {
        if (auto loaded = config::load_file(c, a.file, a.profile); !loaded) return fail(loaded.error());
    }
    for (const std::string& assignment : a.set) {
        const auto equals = assignment.find('=');
        if (equals == std::string::npos) return misuse({"--set " + assignment, "is no KEY=VALUE", "e.g. --set rate_hz=60"});
        if (auto set = config::set_value(c, assignment.substr(0, equals), assignment.substr(equals + 1)); !set)
            return misuse({"--set " + assignment, set.error().what, set.error().remedy});
    }
    if (auto ok = config::check(c); !ok) return fail(ok.error());
    if (!a.json) return fmt::print("{}", config::explain(c)), exit_success;
    ordered_json settings = ordered_json::array();
    for (const config::Entry& entry : c.schema->entries()) settings.push_back(to_json(c, entry));
    ordered_json object;
    object["file"] = a.file.empty() ? ordered_json(nullptr) : ordered_json(a.file);
    object["profile"] = a.profile.empty() ? ordered_json(nullptr) : ordered_json(a.profile);
    object["settings"] = std::move(settings);
    print_json(object);
    return exit_success;
}

int run_config(const ConfigArguments& a) {
    if (a.check && (a.print || a.defaults)) return misuse({"--check", "prints no values", "leave out --print and --defaults"});
    if (a.check && a.file.empty()) return misuse({"--check", "needs a file", "surefoot config FILE --check"});
    if (a.check && (!a.profile.empty() || !a.set.empty()))
        return misuse({"--check", "reads the file with every profile", "leave out --profile and --set, or use --print"});
    if (a.check) return run_check(a);
    if (!a.profile.empty() && a.file.empty())
        return misuse({"--profile " + a.profile, "is a part of a settings file", "name the file too"});
    if (!a.defaults) return run_print(a);
    if (!a.file.empty() || !a.set.empty() || a.json)
        return misuse({"--defaults", "writes a settings file with nothing changed", "leave out the file, --set and --json"});
    fmt::print("{}", config::commented_defaults(walk::settings_schema()));
    return exit_success;
}

}  // namespace

void add_config(CLI::App& app, Context& context) {
    auto a = std::make_shared<ConfigArguments>();
    CLI::App* c = add_command(
        app, "config", "Settings: check a file, or print the values that hold and where each came from",
        "surefoot config --print --defaults > surefoot.toml\n  surefoot config surefoot.toml --check\n  surefoot config "
        "surefoot.toml --profile kiosk --print",
        a->json);
    c->add_option("FILE", a->file, "The settings file (TOML); without one, the defaults");
    c->add_flag("--check", a->check, "Say OK, or everything that is wrong: file, line, key, what was found and what is allowed");
    c->add_flag("--print", a->print, "Every key: value, unit, where it came from, what is allowed (also without this flag)");
    c->add_flag("--defaults", a->defaults, "With --print: a settings file with every key, commented out");
    c->add_option("--profile", a->profile, "Lay [profile.NAME] of the file over the rest");
    c->add_option("--set", a->set, "KEY=VALUE, as a command line would set it; may be given more than once")
        ->type_name("KEY=VALUE");
    c->callback([&context, a] { context.run = [a] { return run_config(*a); }; });
}

}  // namespace surefoot::cli
