// Options that are settings: read from a file and from the command line, through the same schema and limits for every command.
#pragma once

#include <array>
#include <initializer_list>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "config/settings.hpp"
#include "tools/cli/command.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::cli {

struct SettingArguments {
    std::string config_file, profile, size;
    struct Setting {
        std::string flag, key, text;
    };
    std::vector<Setting> values;  ///< in the order given
    bool no_fifo = false, no_check = false, no_occlusion = false, no_motion = false, buy_effects = false;
    std::string cache;                              ///< "true": the option alone
    std::array<bool, rt::switch_count> no_light{};  ///< by switch
};

using FlagsAndKeys = std::initializer_list<std::pair<const char*, const char*>>;

/// An option that is checked and stored by the settings' schema under `key`. help: whole sentences, instead of the key's own.
void add_setting(CLI::App* command, const std::shared_ptr<SettingArguments>& arguments, const std::string& flag,
                 const std::string& key, std::string help = {});
/// Adds --config, --profile, --size, --no-fifo, and an option for each setting that every walk has. `more` and `last` are options
/// of this command alone: `more` stands in --help behind the budget, `last` at the end.
void add_settings(CLI::App* command, const std::shared_ptr<SettingArguments>& arguments, FlagsAndKeys more = {},
                  FlagsAndKeys last = {});
/// The file, then the command line; what is refused is named as the user wrote it.
Result<config::Configuration> read_settings(const SettingArguments& arguments);

}  // namespace surefoot::cli
