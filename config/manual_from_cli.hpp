// A manual page from a CLI11 command: description, options with defaults, footer. Header only, so that only programs with CLI11
// need CLI11.
#pragma once

#include <CLI/CLI.hpp>
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

/// Options of `hidden_group` are left out. The summary is the description's first line without its full stop.
inline ManualPage manual_from_cli(const CLI::App& app, const std::string& name, int section, std::string_view hidden_group) {
    const std::string description = app.get_description();
    ManualPage page;
    page.name = name;
    page.section = section;
    page.summary = description.substr(0, description.find('\n'));
    while (page.summary.ends_with('.')) page.summary.pop_back();
    std::string words = name;
    if (const auto dash = words.find('-'); dash != std::string::npos) words[dash] = ' ';
    page.synopsis = words + (app.get_subcommands(nullptr).empty() ? "" : " COMMAND");
    ManualSection arguments{"ARGUMENTS", "", {}}, options{"OPTIONS", "", {}};
    for (const CLI::Option* option : app.get_options()) {
        if (option->get_group() == hidden_group || option->get_group().empty()) continue;
        std::string text = option->get_description() + ".";
        if (const std::string usual = option->get_default_str(); !usual.empty()) text += " Default: " + usual + ".";
        if (option->get_required()) text += " Required.";
        (option->get_positional() ? arguments : options).items.push_back({manual_term(*option), std::move(text)});
        if (option->get_positional()) page.synopsis += " " + option->get_name(true);
    }
    page.synopsis += " [OPTION]...";
    page.sections.push_back({"DESCRIPTION", description, {}});
    ManualSection commands{"COMMANDS", "", {}};
    for (const CLI::App* command : app.get_subcommands(nullptr))
        if (!command->get_name().empty() && !command->get_group().empty())
            commands.items.push_back({command->get_name(), command->get_description() + "."});
    for (ManualSection* list : {&commands, &arguments, &options})
        if (!list->items.empty()) page.sections.push_back(std::move(*list));
    if (!app.get_footer().empty()) page.sections.push_back({"NOTES", app.get_footer(), {}});
    return page;
}

}  // namespace surefoot::config
