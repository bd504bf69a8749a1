// Where this machine's figures live: the state folder and the calibrated cost table in it.
#include "tools/walk/state.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include <fmt/format.h>

#include "render/measure/calibrate.hpp"

namespace surefoot::walk {

namespace {
std::string environment(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? std::string() : std::string(value);
}
}  // namespace

std::string state_directory(const std::string& requested) {
    if (!requested.empty()) return requested;
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
        note = "no cost table in " + state_dir + ", so built-in figures are used. Run `surefoot calibrate`";
        return model::default_costs();
    }
    auto costs = measure::read_costs(file, "");
    if (!costs) return costs.error();
    if (!machine.empty() && costs->machine != machine) {
        note = "the cost table " + file + " was measured on \"" + costs->machine + "\", but this is \"" + machine +
               "\", so built-in figures are used. Run `surefoot calibrate`";
        return model::default_costs();
    }
    return costs;
}

std::string model_costs_file(const std::string& state_dir, const model::CostModel& table, const FitConditions& c) {
    return fmt::format("{}/models/{:016x}-{:016x}-{}x{}-{}.toml", state_dir, c.model_hash, measure::hash_of(table), c.width,
                       c.height, c.backend);
}

std::size_t drop_old_fits(const std::string& state_dir, const model::CostModel& table) {
    const std::string of_this = fmt::format("-{:016x}-", measure::hash_of(table));
    std::error_code ignored;
    std::vector<std::filesystem::path> old;
    for (const auto& entry : std::filesystem::directory_iterator(state_dir + "/models", ignored)) {
        const std::string name = entry.path().filename().string();
        // 16 digits of the model, 16 of the table: what is not named so is not ours.
        const bool a_fit = name.ends_with(".toml") && name.size() > 34 && name[16] == '-' && name[33] == '-';
        if (a_fit && name.compare(16, of_this.size(), of_this) != 0) old.push_back(entry.path());
    }
    return static_cast<std::size_t>(
        std::count_if(old.begin(), old.end(), [&](const auto& file) { return std::filesystem::remove(file, ignored); }));
}

Result<model::CostModel> fitted_costs(const std::string& state_dir, const model::CostModel& table,
                                      const FitConditions& conditions) {
    if (!table.calibrated) return table;
    const std::string file = model_costs_file(state_dir, table, conditions);
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) return table;
    return measure::read_costs(file, table.machine);
}

}  // namespace surefoot::walk
