// Reading and checking.
#include "systemd/daemon/configuration.hpp"

#include <fmt/format.h>

#include "systemd/daemon/monitoring.hpp"
#include "tools/monitor/address.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::daemon {

namespace {

/// Rules of the service: keys that only single walks may have, and keys that need another key.
std::vector<Error> own_rules(const config::Configuration& c, const std::string& file) {
    const config::Settings& s = c.values;
    std::vector<Error> problems;
    const auto wrong = [&](std::string_view key, std::string what, std::string remedy) {
        const config::Origin origin = c.origin(key);
        const std::string place = origin.text() == "default" ? file : origin.text();
        problems.push_back({fmt::format("{}, {}", place, key), std::move(what), std::move(remedy), ErrorKind::misuse});
    };
    if (s.model_file.empty())
        wrong("model", "The model is not set", "Name the .walk file that `surefoot bake` made: model = \"lobby.walk\"");
    if (s.control)
        wrong("control", "A service cannot run with the control, which shows no frames half of the time",
              "Remove control, or use `surefoot walk`");
    if (s.clock != rt::ClockKind::real)
        wrong("clock", fmt::format("A service needs the real clock, not \"{}\"", rt::name_of(s.clock)), "Remove clock");
    if (!s.steering_file.empty() && s.input_file.empty() && s.backend != walk::window_input)
        wrong("steering", "A steering file needs an input, and none is set", "Add input = \"devices\", or remove steering");
    if (!s.monitor.empty() && s.monitor != no_monitor) {
        if (const auto address = monitor::parse_address(s.monitor); !address)
            wrong("monitor", address.error().what, address.error().remedy);
    }
    return problems;
}

Result<void> apply_set(config::Configuration& c, const std::string& assignment) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos)
        return Error{"--set " + assignment, "This is not KEY=VALUE", "Write for example --set rate_hz=60", ErrorKind::misuse};
    auto set = config::set_value(c, assignment.substr(0, equals), assignment.substr(equals + 1));
    if (set) return {};
    return Error{"--set " + assignment, set.error().what, set.error().remedy, set.error().kind};
}

/// Every --set in turn. Whether one is refused does not depend on the file.
std::vector<Error> apply_sets(config::Configuration& c, const std::vector<std::string>& assignments) {
    std::vector<Error> problems;
    for (const std::string& assignment : assignments)
        if (auto ok = apply_set(c, assignment); !ok) problems.push_back(ok.error());
    return problems;
}

}  // namespace

Loaded load(const Options& options) {
    Loaded loaded;
    config::Configuration trial(walk::settings_schema());
    loaded.problems = apply_sets(trial, options.set);
    loaded.misuse = !loaded.problems.empty();
    for (const config::Problem& problem : config::problems_in_file(walk::settings_schema(), options.config_file))
        loaded.problems.push_back(problem.error);
    if (!loaded.problems.empty()) return loaded;
    config::Configuration c(walk::settings_schema());
    if (auto ok = config::load_file(c, options.config_file, options.profile); !ok) {
        loaded.problems.push_back(ok.error());
        return loaded;
    }
    loaded.problems = apply_sets(c, options.set);
    if (auto ok = config::check(c); !ok) loaded.problems.push_back(ok.error());
    for (Error& problem : own_rules(c, options.config_file)) loaded.problems.push_back(std::move(problem));
    loaded.configuration = std::move(c);
    return loaded;
}

walk::WalkRequest request_of(const config::Configuration& configuration, const std::string& config_file) {
    walk::WalkRequest request;
    walk::apply_settings(configuration, request);
    request.config_file = config_file;
    request.endless = true;
    request.may_steer = true;
    request.may_leave = false;  // a visitor must not end the service
    return request;
}

std::string in_short(const config::Settings& s) {
    return fmt::format("{} Hz, {}x{}, {}", s.rate_hz, s.width, s.height, s.backend);
}

}  // namespace surefoot::daemon
