// Manual pages: plain structs to troff, and the schema to the page of the settings file.
#include "config/manual.hpp"

#include <fmt/format.h>

#include "config/values.hpp"

namespace surefoot::config {

namespace {

/// A line of text as troff takes it literally: hyphens can be searched for, and no first letter is a request.
std::string escaped(std::string_view line) {
    std::string out;
    if (!line.empty() && (line[0] == '.' || line[0] == '\'')) out = "\\&";
    for (const char c : line) {
        if (c == '\\') {
            out += "\\e";
        } else if (c == '-') {
            out += "\\-";
        } else {
            out += c;
        }
    }
    return out;
}

/// Filled text; what begins with two spaces is shown line by line. request: what begins a paragraph; ".IP" keeps it indented
/// below an item's term.
std::string paragraphs(std::string_view text, std::string_view request = ".PP") {
    const std::string begin = std::string(request) + "\n";
    std::string out;
    bool literal = false;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view line = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        const bool indented = line.starts_with("  ");
        if (indented && !literal) out += begin + ".nf\n";
        if (!indented && literal) out += ".fi\n" + begin;
        literal = indented;
        if (line.empty()) {
            if (!literal && !out.empty() && !out.ends_with(begin)) out += begin;
            continue;
        }
        out += escaped(line) + "\n";
    }
    if (literal) out += ".fi\n";
    return out;
}

}  // namespace

std::string sentence(std::string_view text) {
    std::string whole(text);
    if (!whole.empty() && std::string_view(".?!").find(whole.back()) == std::string_view::npos) whole += '.';
    return whole;
}

std::string troff(const ManualPage& page, std::string_view version) {
    std::string title;
    for (const char c : page.name) title += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    const char* const manual = page.section == 1 ? "User commands" : page.section == 5 ? "File formats" : "System administration";
    std::string out = fmt::format(".TH \"{}\" {} \"\" \"Surefoot{}{}\" \"{}\"\n", escaped(title), page.section,
                                  version.empty() ? "" : " ", escaped(version), manual);
    out += fmt::format(".SH NAME\n{} \\- {}\n", escaped(page.name), escaped(page.summary));
    if (!page.synopsis.empty()) out += ".SH SYNOPSIS\n" + paragraphs(page.synopsis);
    for (const ManualSection& section : page.sections) {
        out += fmt::format(".SH {}\n", escaped(section.title));
        out += paragraphs(section.text);
        for (const ManualItem& item : section.items)
            out +=
                fmt::format(".TP\n\\fB{}\\fR\n{}", escaped(item.term), paragraphs(item.text.empty() ? "\n" : item.text, ".IP"));
    }
    return out;
}

ManualPage settings_manual(const Schema& schema) {
    ManualPage page{"surefoot.toml", 5, "settings of a walk and of surefootd", "", {}};
    page.sections.push_back({"DESCRIPTION",
                             "The settings file is TOML. Keys stand at the top level. A table [profile.NAME] holds other values "
                             "for the same keys, and "
                             "--profile NAME puts them in force. The command line option for a key wins over the file. "
                             "Paths are relative to the "
                             "file's folder.\n\nAn unknown key is an error. So is a value of the wrong type or outside its "
                             "limits. The message names the "
                             "line and what is allowed.",
                             {}});
    ManualSection keys{"KEYS", "", {}};
    for (const Entry& entry : schema.entries()) {
        std::string text = fmt::format("{}\nAllowed: {}. Default: {}.", sentence(entry.help), allowed(entry),
                                       value_text(schema.defaults(), entry));
        for (const Named& choice : entry.choices) text += fmt::format("\n  {:<17} {}", choice.name, choice.help);
        keys.items.push_back({std::string(entry.key), std::move(text)});
    }
    page.sections.push_back(std::move(keys));
    page.sections.push_back(
        {"EXAMPLES",
         "  model = \"/var/lib/surefoot/lobby.walk\"\n  input = \"devices\"\n  rate_hz = 60\n\n  [profile.night]\n  "
         "rate_hz = 30",
         {}});
    page.sections.push_back({"FILES", "", {{"/etc/surefoot/surefoot.toml", "What surefootd reads."}}});
    page.sections.push_back({"SEE ALSO", "surefoot(1), surefoot-config(1), surefootd(8)", {}});
    return page;
}

}  // namespace surefoot::config
