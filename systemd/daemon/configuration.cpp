// Reading and checking.
#include "systemd/daemon/configuration.hpp"

#include <fmt/format.h>

#include "systemd/daemon/monitoring.hpp"
#include "tools/monitor/address.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot::daemon {

namespace {

/// Keys that are for single walks, or say nothing alone.
std::vector<Error> own_rules(const config::Configuration& c, const std::string& file) {
    const config::Settings& s = c.values;
    std::vector<Error> problems;
    const auto wrong = [&](std::string_view key, std::string what, std::string remedy) {
        const config::Origin origin = c.origin(key);
        const std::string place = origin.text() == "default" ? file : origin.text();
        problems.push_back({place, fmt::format("{} {}", key, what), std::move(remedy)});
    };
    if (s.model_file.empty())
        wrong("model", "is not set", "name the .walk file that `surefoot bake` made: model = \"lobby.walk\"");
    if (s.control) wrong("control", "= true is for `surefoot walk`: every other two seconds show no frames", "take it out");
    if (s.clock != rt::ClockKind::real)
        wrong("clock", fmt::format("= \"{}\" has no real time", rt::name_of(s.clock)), "take it out");
    if (!s.steering_file.empty() && s.input_file.empty())
        wrong("steering", "says how an input steers, and there is none", "add input = \"devices\", or take it out");
    if (!s.monitor.empty() && s.monitor != no_monitor) {
        if (const auto address = monitor::parse_address(s.monitor); !address)
            wrong("monitor", address.error().what, address.error().remedy);
    }
    return problems;
}

Result<void> apply_set(config::Configuration& c, const std::string& assignment) {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos) return Error{"--set " + assignment, "is no KEY=VALUE", "e.g. --set rate_hz=60"};
    auto set = config::set_value(c, assignment.substr(0, equals), assignment.substr(equals + 1));
    if (set) return {};
    return Error{"--set " + assignment, set.error().what, set.error().remedy};
}

}  // namespace

Loaded load(const Options& options) {
    Loaded loaded;
    for (const config::Problem& problem : config::problems_in_file(walk::settings_schema(), options.config_file))
        loaded.problems.push_back(problem.error);
    if (!loaded.problems.empty()) return loaded;
    config::Configuration c(walk::settings_schema());
    if (auto ok = config::load_file(c, options.config_file, options.profile); !ok) {
        loaded.problems.push_back(ok.error());
        return loaded;
    }
    for (const std::string& assignment : options.set) {
        if (auto ok = apply_set(c, assignment); !ok) {
            loaded.problems.push_back(ok.error());
            loaded.misuse = true;
        }
    }
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
    return request;
}

std::string in_short(const config::Settings& s) {
    return fmt::format("{} Hz, {}x{}, {}", s.rate_hz, s.width, s.height, s.backend);
}

}  // namespace surefoot::daemon
