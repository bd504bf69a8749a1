// A manual page from a CLI11 command: description, options with defaults, footer. Header only, so that only programs with CLI11
// need CLI11.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <string_view>

#include "config/manual.hpp"

namespace surefoot::config {

/// "-o,--out FILE", as --help writes it.
inline std::string manual_term(const CLI::Option& option) {
    std::string term = option.get_name(option.get_positional(), true);
    if (option.get_items_expected_max() > 0 && !option.get_type_name().empty()) term += " " + option.get_type_name();
    return term;
}

/// What an option does, its default, and whether it must be given. The lines of its choices come last.
inline std::string manual_text(const CLI::Option& option) {
    const std::string& help = option.get_description();
    const auto choices = std::min(help.find('\n'), help.size());
    std::string text = sentence(help.substr(0, choices));
    if (const std::string usual = option.get_default_str(); !usual.empty()) text += " " + sentence("Default: " + usual);
    if (option.get_required()) text += " Required.";
    return text + help.substr(choices);
}

/// An argument as a synopsis shows it: "in...", and in brackets if it may be left out.
inline std::string synopsis_of(const CLI::Option& argument) {
    const std::string name = argument.get_name(true) + (argument.get_items_expected_max() > 1 ? "..." : "");
    return argument.get_required() ? name : "[" + name + "]";
}

/// words: the command as a user types it, "surefoot devices list". Options of `hidden_group` are left out.
/// The summary is the description's first line without its full stop; a description of one line has no section of its own.
inline ManualPage manual_from_cli(const CLI::App& app, const std::string& words, int section, std::string_view hidden_group) {
    const std::string description = app.get_description();
    ManualPage page;
    page.name = words;
    std::replace(page.name.begin(), page.name.end(), ' ', '-');
    page.section = section;
    page.summary = description.substr(0, description.find('\n'));
    while (page.summary.ends_with('.')) page.summary.pop_back();
    page.synopsis = words + (app.get_subcommands(nullptr).empty() ? "" : " COMMAND");
    ManualSection arguments{"ARGUMENTS", "", {}}, options{"OPTIONS", "", {}};
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_group() == hidden_group || option->get_group().empty()) continue;
        (option->get_positional() ? arguments : options).items.push_back({manual_term(*option), manual_text(*option)});
        if (option->get_positional()) page.synopsis += " " + synopsis_of(*option);
    }
    page.synopsis += " [OPTION]...";
    if (description.find('\n') != std::string::npos) page.sections.push_back({"DESCRIPTION", description, {}});
    ManualSection commands{"COMMANDS", "", {}};
    for (const CLI::App* command : app.get_subcommands(nullptr))
        if (!command->get_name().empty() && !command->get_group().empty())
            commands.items.push_back({command->get_name(), sentence(command->get_description())});
    for (ManualSection* list : {&commands, &arguments, &options})
        if (!list->items.empty()) page.sections.push_back(std::move(*list));
    // A footer begins with its example; after an empty line come the notes.
    std::string notes = app.get_footer();
    constexpr std::string_view example = "Example:\n";
    if (notes.starts_with(example)) {
        const std::size_t end = std::min(notes.find("\n\n"), notes.size());
        page.sections.push_back({"EXAMPLES", notes.substr(example.size(), end - example.size()), {}});
        notes.erase(0, std::min(end + 2, notes.size()));
    }
    if (!notes.empty()) page.sections.push_back({"NOTES", notes, {}});
    return page;
}

}  // namespace surefoot::config
