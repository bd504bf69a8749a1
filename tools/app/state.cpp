// Where this machine's figures live: the state folder and the calibrated cost table in it.
#include "tools/app/state.hpp"

#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "render/measure/calibrate.hpp"

namespace surefoot::app {

namespace {
std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? std::string() : std::string(value);
}
}  // namespace

std::string state_directory(const std::string& asked) {
    if (!asked.empty()) return asked;
    // systemd gives a list separated by ':' where a unit names several; the first is ours.
    if (const std::string s = environment("STATE_DIRECTORY"); !s.empty()) return s.substr(0, s.find(':'));
    if (const std::string s = environment("XDG_STATE_HOME"); !s.empty()) return s + "/surefoot";
    if (const std::string s = environment("HOME"); !s.empty()) return s + "/.local/state/surefoot";
    return "/var/lib/surefoot";
}

std::string stop_file(const std::string& state_dir) { return state_dir + "/emergency-stop"; }

std::string cost_table_file(const std::string& state_dir) { return state_dir + "/costs.toml"; }

Result<model::CostModel> load_costs(const std::string& state_dir, const std::string& machine, std::string& note) {
    const std::string file = cost_table_file(state_dir);
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
        note = "no cost table in " + state_dir + ": built-in figures are used; run `surefoot calibrate`";
        return model::default_costs();
    }
    auto costs = measure::read_costs(file, "");
    if (!costs) return costs.error();
    if (!machine.empty() && costs->machine != machine) {
        note = "the cost table " + file + " was measured on \"" + costs->machine + "\", this is \"" + machine +
               "\": built-in figures are used; run `surefoot calibrate`";
        return model::default_costs();
    }
    return costs;
}

std::string model_costs_file(const std::string& state_dir, const model::CostModel& table, std::uint64_t model_hash) {
    return fmt::format("{}/models/{:016x}-{:016x}.toml", state_dir, model_hash, measure::hash_of(table));
}

Result<model::CostModel> fitted_costs(const std::string& state_dir, const model::CostModel& table, std::uint64_t model_hash) {
    if (!table.calibrated) return table;
    const std::string file = model_costs_file(state_dir, table, model_hash);
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return table;
    return measure::read_costs(file, table.machine);
}

}  // namespace surefoot::app
