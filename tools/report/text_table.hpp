// Labelled lines for a terminal: wrapped at 100 columns, coloured where asked to. What every table of the tool is made of.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace surefoot::report {

constexpr std::size_t max_columns = 100;
constexpr std::size_t label_columns = 16;

class TextTable {
public:
    explicit TextTable(bool colour) : colour_(colour) {}

    void raw(const std::string& line) { text_ += line + "\n"; }
    /// A label and words, wrapped under each other. code: of the colour ("1;32"); may be empty.
    void row(std::string_view label, std::string_view words, std::string_view code = {});
    [[nodiscard]] std::string coloured(std::string_view text, std::string_view code) const;
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    void put(std::string_view label, std::string line, std::string_view code);
    bool colour_;
    std::string text_;
};

}  // namespace surefoot::report
