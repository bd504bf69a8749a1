// A cursor over text in memory: words and numbers of a line, line counting; shared by the text readers (OBJ, MTL, OSTF).
#pragma once

#include <charconv>
#include <cstdint>
#include <string_view>

namespace surefoot::importer {

/// Reads numbers and words of a text, line by line. Never reads past its end.
class TextCursor {
public:
    explicit TextCursor(std::string_view text) : at_(text.data()), end_(text.data() + text.size()) {}

    [[nodiscard]] bool done() const { return at_ == end_; }
    [[nodiscard]] std::uint64_t line() const { return line_; }
    [[nodiscard]] std::string_view rest() const { return {at_, static_cast<std::size_t>(end_ - at_)}; }

    /// Blanks, and a backslash that continues the line.
    void skip_blanks() {
        while (at_ != end_) {
            if (*at_ == ' ' || *at_ == '\t' || *at_ == '\r') {
                ++at_;
            } else if (*at_ == '\\' && continues()) {
                ++line_;
            } else {
                return;
            }
        }
    }
    [[nodiscard]] bool at_line_end() {
        skip_blanks();
        return at_ == end_ || *at_ == '\n' || *at_ == '#';
    }
    void next_line() {
        while (at_ != end_ && *at_ != '\n') {
            if (*at_ == '\\' && continues()) {
                ++line_;
                continue;
            }
            ++at_;
        }
        if (at_ != end_) {
            ++at_;
            ++line_;
        }
    }
    /// Up to the next blank; empty at the end of the line.
    std::string_view word() {
        skip_blanks();
        const char* first = at_;
        while (at_ != end_ && *at_ != ' ' && *at_ != '\t' && *at_ != '\n' && *at_ != '\r') ++at_;
        return {first, static_cast<std::size_t>(at_ - first)};
    }
    /// The rest of the line, blanks at both ends off.
    std::string_view line_text() {
        skip_blanks();
        const char* first = at_;
        while (at_ != end_ && *at_ != '\n') ++at_;
        const char* last = at_;
        while (last != first && (last[-1] == ' ' || last[-1] == '\t' || last[-1] == '\r')) --last;
        return {first, static_cast<std::size_t>(last - first)};
    }
    /// A number that ends at a blank or the line's end ("nan" and "inf" are numbers). False: none, and nothing is consumed.
    template <class T>
    bool number(T& value) {
        skip_blanks();
        const char* first = at_ != end_ && *at_ == '+' ? at_ + 1 : at_;
        const auto [last, code] = std::from_chars(first, end_, value);
        const bool whole = last == end_ || *last == ' ' || *last == '\t' || *last == '\n' || *last == '\r';
        if (last == first || !whole || code == std::errc::invalid_argument) return false;
        if (code == std::errc::result_out_of_range) value = T{};
        at_ = last;
        return true;
    }
    /// An integer that may be followed by anything; and one expected character.
    bool integer(std::int64_t& value) {
        const auto [last, code] = std::from_chars(at_, end_, value);
        if (code != std::errc{}) return false;
        at_ = last;
        return true;
    }
    [[nodiscard]] bool at_word_end() const { return at_ == end_ || *at_ == ' ' || *at_ == '\t' || *at_ == '\n' || *at_ == '\r'; }
    bool take(char c) {
        if (at_ == end_ || *at_ != c) return false;
        ++at_;
        return true;
    }

private:
    bool continues() {
        const char* p = at_ + 1;
        if (p != end_ && *p == '\r') ++p;
        if (p == end_ || *p != '\n') return false;
        at_ = p + 1;
        return true;
    }
    const char* at_;
    const char* end_;
    std::uint64_t line_ = 1;
};

}  // namespace surefoot::importer
