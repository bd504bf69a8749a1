// Parts of what the tool shows on a terminal: colours, wrapped text, labelled rows, columns, bars. Pure functions of a
// TerminalStyle.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace surefoot::report {

/// What a terminal can show.
struct TerminalStyle {
    bool colour = false, unicode = false;
    std::size_t width = 80, height = 24;  ///< places and lines
};

/// Of the terminal on stdout as it is now. width: where stdout is no terminal.
TerminalStyle terminal_style(bool colour, std::size_t width = 80);
/// stdout is a terminal, and the user has not set NO_COLOR.
bool colour_wanted();

/// good, warn and bad are green, yellow and red; strong ones are bold, too.
enum class Ink { plain, bold, dim, good, warn, bad, hint, strong_good, strong_warn, strong_bad };
std::string inked(const TerminalStyle& style, Ink ink, std::string_view text);
/// The bold one of good, warn and bad; others as they are.
Ink strong(Ink ink);

/// Returns to the start of the line and clears it.
constexpr const char* clear_line = "\r\033[K";

/// How many places of the screen a line takes: code points; escape sequences take none.
std::size_t places(std::string_view line);
/// Cut to `width` places of the screen; escape sequences end with the line.
std::string cut_to(std::string_view line, std::size_t width);
/// Words in lines of at most `width` places; a longer word has a line of its own. At least one line.
std::vector<std::string> wrapped(std::string_view text, std::size_t width);

/// `share` 0..1 of `width` places.
std::string share_bar(const TerminalStyle& style, double share, std::size_t width);
/// '#' from the middle to `at` (0..1 of `width` places), '-' elsewhere, and '|' at the middle.
std::string deflection_bar(double at, std::size_t width);
/// "bake                   [######                  ]  25 %  3 s left"
std::string progress_line(std::string_view stage, double done, std::string_view left);

/// A column of a table for people.
struct TextColumn {
    std::string_view heading;
    int width = 0;        ///< places; negative: its cells end at its right edge
    std::size_t gap = 1;  ///< spaces between it and the column before
};

/// Rows below a heading. A cell that is too long moves the rest of its row; cells at the end may be left out.
class Columns {
public:
    Columns(std::initializer_list<TextColumn> columns) : columns_(columns) {}
    [[nodiscard]] std::string heading() const;
    [[nodiscard]] std::string row(std::initializer_list<std::string> cells) const;

private:
    std::vector<TextColumn> columns_;
};

constexpr std::size_t max_columns = 100;
constexpr std::size_t label_columns = 16;

/// Lines that begin with a label, wrapped at 100 places.
class LabelledText {
public:
    explicit LabelledText(bool colour) : style_{.colour = colour} {}

    void raw(const std::string& line) { text_ += line + "\n"; }
    /// A label, and words that are wrapped under each other.
    void row(std::string_view label, std::string_view words, Ink ink = Ink::plain);
    [[nodiscard]] const TerminalStyle& style() const { return style_; }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    TerminalStyle style_;
    std::string text_;
};

}  // namespace surefoot::report
