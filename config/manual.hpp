// Manual pages as troff text, generated from --help and the schema, so that they always match the program.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "config/settings.hpp"

namespace surefoot::config {

/// A name and what it means: one option, key, signal or file.
struct ManualItem {
    std::string term, text;
};

/// A section of a manual page, in the order of the page.
struct ManualSection {
    std::string title;  ///< as it is shown: "OPTIONS"
    std::string text;   ///< paragraphs are separated by an empty line; lines that begin with two spaces stay as they are
    std::vector<ManualItem> items;  ///< after the text
};

/// A manual page, before it is written as troff.
struct ManualPage {
    std::string name;  ///< as a user asks `man` for it: "surefoot-walk"
    int section = 1;
    std::string summary;   ///< one line after the name
    std::string synopsis;  ///< may be empty
    std::vector<ManualSection> sections;
};

/// The text with a full stop, if it does not end in a mark.
std::string sentence(std::string_view text);

/// The page for `man`. Text is escaped, so that nothing in it is a troff request.
/// version: shown in the footer; may be empty.
std::string troff(const ManualPage& page, std::string_view version = {});

/// surefoot.toml(5): every key of the schema with its meaning, limits, choices and default.
ManualPage settings_manual(const Schema& schema);

}  // namespace surefoot::config
