// Turns CLI11's errors into this project's: plain sentences about a wrong command line. Header only, so that only programs
// with CLI11 need CLI11.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/settings.hpp"
#include "rt/base/text.hpp"

namespace surefoot::config {

namespace command_line {

/// A command, and the words after the program's name that lead to it: "devices list". The program itself has none.
struct Command {
    const CLI::App* app = nullptr;
    std::string words;
};

/// The program and the commands that were named, outermost first.
inline std::vector<Command> named_commands(const CLI::App& program) {
    std::vector<Command> all{{&program, ""}};
    while (!all.back().app->get_subcommands().empty()) {
        const CLI::App* next = all.back().app->get_subcommands().front();
        all.push_back({next, all.back().words + (all.back().words.empty() ? "" : " ") + next->get_name()});
    }
    return all;
}

/// A remedy: where the options and arguments of the command are listed.
inline std::string see_help(const CLI::App& program, const Command& command) {
    return fmt::format("See `{}{}{} --help`", program.get_name(), command.words.empty() ? "" : " ", command.words);
}

/// "-" and "-5" are arguments.
inline bool is_option(std::string_view word) {
    return word.size() > 1 && word[0] == '-' && (word[1] < '0' || word[1] > '9') && word[1] != '.';
}

inline Error unknown_option(const CLI::App& program, const Command& command, std::string_view word,
                            std::string_view hidden_group) {
    word = word.substr(0, word.find('='));
    std::vector<std::string> names;
    for (const CLI::Option* option : command.app->get_options()) {
        if (option->get_group() == hidden_group || option->get_group().empty()) continue;
        for (const std::string& name : option->get_lnames()) names.push_back(name);
    }
    const std::vector<std::string_view> known(names.begin(), names.end());
    const std::string_view nearest = nearest_word(word.substr(std::min(word.find_first_not_of('-'), word.size())), known);
    return {command.words, fmt::format("The option '{}' is unknown", word),
            nearest.empty() ? see_help(program, command) : fmt::format("Did you mean '--{}'?", nearest), ErrorKind::misuse};
}

inline std::vector<std::string> commands_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands(nullptr))
        if (!command->get_name().empty() && !command->get_group().empty()) names.push_back(command->get_name());
    return names;
}

inline Error unknown_command(const CLI::App& program, const Command& command, std::string_view word) {
    const std::vector<std::string> names = commands_of(*command.app);
    const std::string_view nearest = nearest_word(word, std::vector<std::string_view>(names.begin(), names.end()));
    return {command.words, fmt::format("There is no command '{}'", word),
            nearest.empty() ? see_help(program, command) : fmt::format("Did you mean '{}'?", nearest), ErrorKind::misuse};
}

/// The first word that no command takes, if there is one. After "--", the outer commands keep what the innermost does not take.
inline std::optional<Error> superfluous_word(const CLI::App& program, const std::vector<Command>& commands,
                                             std::string_view hidden_group) {
    for (const Command& command : commands) {
        for (const std::string& word : command.app->remaining()) {
            if (word == "--") continue;
            if (is_option(word)) return unknown_option(program, command, word, hidden_group);
            const Command& innermost = commands.back();
            if (&command == &innermost && !commands_of(*command.app).empty()) return unknown_command(program, command, word);
            return Error{innermost.words, fmt::format("The argument '{}' is superfluous", word),
                         "Remove it, or s" + see_help(program, innermost).substr(1), ErrorKind::misuse};
        }
    }
    return std::nullopt;
}

inline Error missing(const CLI::App& program, const Command& command) {
    for (const CLI::Option* option : command.app->get_options()) {
        if (!option->get_required() || option->count() > 0) continue;
        return {command.words,
                fmt::format("The {} '{}' is required", option->get_positional() ? "argument" : "option", option->get_name()),
                "Add it, or s" + see_help(program, command).substr(1), ErrorKind::misuse};
    }
    std::string names;
    for (const std::string& name : commands_of(*command.app)) names += (names.empty() ? "" : ", ") + name;
    return {command.words, "No command is named",
            fmt::format("Use one of {}, or s{}", names, see_help(program, command).substr(1)), ErrorKind::misuse};
}

/// What a value of the option's type is.
inline std::string type_in_words(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    if (type.starts_with("UINT")) return "a whole number from 0";
    if (type.starts_with("INT")) return "a whole number";
    return type.starts_with("FLOAT") ? "a number" : "another value";
}

/// Errors that CLI11 words as "NAME: ..." or "Could not convert: NAME = VALUE".
inline std::optional<Error> wrong_value(const Command& command, const CLI::Error& error) {
    const std::string_view message = error.what();
    for (const CLI::Option* option : command.app->get_options()) {
        const std::string name = option->get_name();
        const bool flag = option->get_items_expected_max() == 0;
        const std::string convert = "Could not convert: " + name + " = ", begin = name + ": ";
        if (flag && (message.starts_with(convert) || (message.starts_with(begin))))
            return Error{name, "The option takes no value", fmt::format("Write {} alone", name), ErrorKind::misuse};
        if (message.starts_with(convert))
            return Error{fmt::format("{} {}", name, message.substr(convert.size())), "The value is not allowed",
                         "Use " + type_in_words(*option), ErrorKind::misuse};
        if (!message.starts_with(begin)) continue;
        // Checks of values say "VALUE: Sentence. Remedy."
        if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr)
            return Error{fmt::format("{} {}", name, message.substr(begin.size())), "", "", ErrorKind::misuse};
        if (message.find("At Most") != std::string_view::npos)
            return Error{name, fmt::format("The option is given {} times", option->count()), "Keep one of them",
                         ErrorKind::misuse};
        if (dynamic_cast<const CLI::ArgumentMismatch*>(&error) != nullptr)
            return Error{name, "The option's value is missing", fmt::format("Write it after {}", name), ErrorKind::misuse};
    }
    return std::nullopt;
}

}  // namespace command_line

/// The error of a refused command line. It names the command, then the option or argument.
/// arguments: the words after the program's name. renamed: options that earlier versions had. Options of `hidden_group` are
/// never suggested.
inline Error wrong_use(const CLI::App& program, const CLI::Error& error, std::span<const std::string_view> arguments,
                       std::span<const Renamed> renamed, std::string_view hidden_group) {
    using namespace command_line;
    for (const std::string_view argument : arguments) {
        if (!argument.starts_with("--")) continue;
        if (auto known = renamed_error(renamed, "command line", argument.substr(0, argument.find('=')))) return *known;
    }
    const std::vector<Command> commands = named_commands(program);
    const bool required = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    if (required || dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
        if (auto word = superfluous_word(program, commands, hidden_group)) return *word;
    }
    if (required) return missing(program, commands.back());
    for (const Command& command : commands)
        if (auto value = wrong_value(command, error)) return *value;
    return {commands.back().words, error.what(), see_help(program, commands.back()), ErrorKind::misuse};
}

}  // namespace surefoot::config
