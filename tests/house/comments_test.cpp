// Sentences in the comments of headers have at most 25 words.
// Diagrams and tables hold no sentences: lines indented by three blanks or more, with signs of a diagram or columns in them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/file.hpp"

namespace surefoot::house {
namespace {

namespace fs = std::filesystem;
const fs::path tree_of_headers = SUREFOOT_SOURCE_DIR;

constexpr std::size_t max_words_of_comment = 25;

struct Sentence {
    std::size_t line = 0, words = 0;  ///< line: where it begins, from 1
    std::string text;
};

bool is_indented(std::string_view text) { return text.starts_with("   "); }

/// A line of a diagram or of a table. `text`: behind the slashes.
bool is_diagram(std::string_view text) {
    if (!is_indented(text)) return false;
    text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    if (text.find("  ") != std::string_view::npos) return true;
    for (const std::string_view sign : {"─", "│", "┌", "┐", "└", "┘", "├", "┤", "►", "▲", "▼"})
        if (text.find(sign) != std::string_view::npos) return true;
    return false;
}

/// Collects the sentences of comments, fed line by line.
class Sentences {
public:
    /// `source`: a line of a header. A comment behind code begins a new sentence.
    void add(std::string_view source) {
        ++line_;
        const auto slashes = source.find("//");
        const bool inside_text =
            slashes != std::string_view::npos && source.substr(0, slashes).find('"') != std::string_view::npos;
        if (slashes == std::string_view::npos || inside_text) return end();
        const bool behind_code = source.substr(0, slashes).find_first_not_of(' ') != std::string_view::npos;
        source.remove_prefix(slashes + 2);
        if (behind_code || (was_behind_code_ && !source.starts_with("/<"))) end();
        was_behind_code_ = behind_code || source.starts_with("/<");
        if (source.starts_with('/')) source.remove_prefix(1);
        if (source.starts_with('<')) source.remove_prefix(1);
        if (source.find_first_not_of(' ') == std::string_view::npos || is_diagram(source) || source.starts_with(" ---"))
            return end();
        if (is_indented(source) != was_indented_) end();
        was_indented_ = is_indented(source);
        std::istringstream words{std::string(source)};
        for (std::string word; words >> word;) add_word(word);
    }
    [[nodiscard]] const std::vector<Sentence>& all() {
        end();
        return all_;
    }

private:
    void add_word(const std::string& word) {
        bool counts = false;
        for (const char c : word)
            counts = counts || std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) > 127;
        if (counts && now_.words++ == 0) now_.line = line_;
        now_.text += (now_.text.empty() ? "" : " ") + word;
        if (word.find_last_not_of("\"')`*") != std::string::npos &&
            std::string_view(".!?").find(word[word.find_last_not_of("\"')`*")]) != std::string_view::npos)
            end();
    }
    void end() {
        if (now_.words > 0) all_.push_back(now_);
        now_ = {};
    }

    std::vector<Sentence> all_;
    Sentence now_;
    std::size_t line_ = 0;
    bool was_behind_code_ = false, was_indented_ = false;
};

std::vector<Sentence> comment_sentences(const std::string& header) {
    Sentences sentences;
    std::istringstream lines(header);
    for (std::string line; std::getline(lines, line);) sentences.add(line);
    return sentences.all();
}

TEST(Comments, OfHeadersHaveSentencesOfAtMost25Words) {
    std::size_t count = 0;
    for (const auto* top : {"config", "input", "render", "rt", "tools", "systemd"}) {
        for (const auto& entry : fs::recursive_directory_iterator(tree_of_headers / top)) {
            if (!entry.is_regular_file() || entry.path().extension() != ".hpp") continue;
            const auto header = read_text(entry.path().string());
            ASSERT_TRUE(header) << entry.path();
            for (const Sentence& sentence : comment_sentences(*header)) {
                ++count;
                EXPECT_LE(sentence.words, max_words_of_comment) << fs::relative(entry.path(), tree_of_headers).generic_string()
                                                                << ":" << sentence.line << ": " << sentence.text;
            }
        }
    }
    EXPECT_GT(count, 2000U) << "the comments were not found";
}

TEST(Comments, AreReadAsSentences) {
    const auto counts = [](const std::string& header) {
        std::vector<std::size_t> words;
        for (const Sentence& sentence : comment_sentences(header)) words.push_back(sentence.words);
        return words;
    };
    using Counts = std::vector<std::size_t>;
    EXPECT_EQ(counts("/// One two three\n/// four.\nint a;\n"), Counts{4}) << "over two lines";
    EXPECT_EQ(counts("// One two. Three! Four five (six seven.)\n"), (Counts{2, 1, 4})) << "several on a line";
    EXPECT_EQ(counts("int a;  ///< one two\nint b;  ///< three\n"), (Counts{2, 1})) << "one for each member";
    EXPECT_EQ(counts("int a;  ///< one two\n        ///< three\n"), Counts{3}) << "over two lines behind code";
    EXPECT_EQ(counts("int a;  ///< one two\n/// three\nint b;\n"), (Counts{2, 1})) << "of two members";
    EXPECT_EQ(counts("/// One two\n///\n/// three\n"), (Counts{2, 1})) << "paragraphs";
    EXPECT_EQ(counts("// One\n//   a ──► b c d\n//   e    f\n// two\n"), (Counts{1, 1})) << "a diagram";
    EXPECT_EQ(counts("// One\n//   - two three\n//     four.\n// five\n"), (Counts{1, 3, 1})) << "an indented list";
    EXPECT_EQ(counts("const char* a = \"http://one two\";\nint b;\n"), Counts{}) << "no comment";
    EXPECT_EQ(counts("/// One 1.5 two - three\n"), Counts{4}) << "a point inside a number, a dash";
}

}  // namespace
}  // namespace surefoot::house
