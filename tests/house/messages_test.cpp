// Sentences that people read have at most 25 words: read from every string literal of the product with three words or more.
// Errors and help are read once more with what is joined to them, and every error names a remedy.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rt/base/file.hpp"

namespace surefoot::house {
namespace {

namespace fs = std::filesystem;
const fs::path source_tree = SUREFOOT_SOURCE_DIR;

constexpr std::size_t max_words = 25;

/// A construct that holds texts for people. Texts stand in its arguments from `first` to `last`, counted from 0.
struct Opener {
    std::string_view word;
    std::size_t first, last;
};

constexpr std::size_t any = 99;
constexpr std::array openers = {Opener{"Error{", 1, 2},         Opener{"fail({", 1, 2},
                                Opener{"misuse({", 1, 2},       Opener{"add_option(", 1, any},
                                Opener{"add_setting(", 4, any}, Opener{"add_flag(", 1, any},
                                Opener{"add_command(", 1, any}, Opener{"add_subcommand(", 1, any},
                                Opener{"footer(", 0, any},      Opener{"Named{", 1, 1},
                                Opener{"Backend{", 1, 1},       Opener{"Format{", 1, 1},
                                Opener{"_entry{", 1, 1}};
/// Calls of these names are helpers of the settings' schema there, and something else in other files.
constexpr std::array schema_openers = {Opener{"number(", 1, any}, Opener{"integer(", 1, any}, Opener{"flag(", 1, any},
                                       Opener{"choice(", 1, any}, Opener{"file_name(", 1, any}};

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// Where the literal (of text or of one character) that begins at `at` ends: behind its closing quote.
std::size_t end_of_literal(std::string_view text, std::size_t at) {
    const char quote = text[at];
    for (++at; at < text.size() && text[at] != quote; ++at)
        if (text[at] == '\\') ++at;
    return std::min(at + 1, text.size());
}

/// A quote that begins a literal. A digit before it makes it a separator, as in 1'000.
bool opens_literal(std::string_view text, std::size_t at) {
    return text[at] == '"' || (text[at] == '\'' && (at == 0 || !is_word(text[at - 1])));
}

/// The same length, with comments as blanks.
std::string without_comments(std::string text) {
    for (std::size_t i = 0; i < text.size();) {
        if (opens_literal(text, i)) {
            i = end_of_literal(text, i);
        } else if (text[i] == '/' && text.substr(i, 2) == "//") {
            for (; i < text.size() && text[i] != '\n'; ++i) text[i] = ' ';
        } else {
            ++i;
        }
    }
    return text;
}

/// The arguments of a bracket that is open just before `at`.
std::vector<std::string_view> arguments_at(std::string_view text, std::size_t at) {
    std::vector<std::string_view> arguments;
    std::size_t begin = at;
    for (int depth = 0; at < text.size();) {
        const char c = text[at];
        if (opens_literal(text, at)) {
            at = end_of_literal(text, at);
            continue;
        }
        if (c == '(' || c == '{' || c == '[') ++depth;
        if (c == ')' || c == '}' || c == ']') --depth;
        if (depth < 0 || (depth == 0 && c == ',')) {
            arguments.push_back(text.substr(begin, at - begin));
            begin = at + 1;
        }
        if (depth < 0) break;
        ++at;
    }
    return arguments;
}

/// The texts of an expression. Literals side by side are one text, and so are those joined by +, with a word for what is between.
/// The two ends of a choice (? :) are two texts.
std::vector<std::string> texts_in(std::string_view expression) {
    std::vector<std::string> texts;
    bool choice = true;
    for (std::size_t i = 0; i < expression.size();) {
        if (!opens_literal(expression, i)) {
            const std::string_view rest = expression.substr(i);
            choice = choice || rest[0] == '?' || rest.starts_with(" : ") || rest[0] == ',';
            if (rest[0] == '+' && !texts.empty()) texts.back() += " x ";
            ++i;
            continue;
        }
        const std::size_t end = end_of_literal(expression, i);
        if (expression[i] == '"') {
            if (choice) texts.emplace_back();
            choice = false;
            texts.back() += expression.substr(i + 1, end - i - 2);
        }
        i = end;
    }
    return texts;
}

/// The sentences of a text as it stands in a literal: they end with a full stop, a mark or a line.
std::vector<std::string> sentences_of(std::string_view text) {
    std::vector<std::string> sentences(1);
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool line = text[i] == '\\' && text.substr(i, 2) == "\\n";
        const bool mark = (text[i] == '.' || text[i] == '?' || text[i] == '!') && (i + 1 == text.size() || text[i + 1] == ' ');
        if (line || mark)
            sentences.emplace_back();
        else
            sentences.back() += text[i];
        if (line) ++i;
    }
    return sentences;
}

/// Runs between blanks that hold a letter, a digit or a value to be filled in.
std::size_t word_count(std::string_view sentence) {
    std::size_t words = 0;
    bool inside = false, counted = false;
    for (const char c : sentence) {
        if (c == ' ') {
            inside = false;
            continue;
        }
        if (!inside) counted = false;
        inside = true;
        if (!counted && (is_word(c) || c == '{' || static_cast<unsigned char>(c) > 127)) {
            counted = true;
            ++words;
        }
    }
    return words;
}

struct FoundTexts {
    std::set<std::string> too_long;  ///< each once: a literal of an error is read alone, and with what is joined to it
    std::size_t texts = 0;
    std::vector<std::string> without_remedy;  ///< what happened
};

/// The start of a literal that is no message: a recording of bytes.
constexpr std::array<std::string_view, 1> no_messages = {"# by hand"};

/// A word of prose: two letters or more, no digit or sign inside of it.
bool is_prose(std::string_view word) {
    while (!word.empty() && std::string_view("(\"'`").find(word.front()) != std::string_view::npos) word.remove_prefix(1);
    while (!word.empty() && std::string_view(".,;:?!)\"'`").find(word.back()) != std::string_view::npos) word.remove_suffix(1);
    const auto is_letter = [](char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '\'' || c == '-'; };
    return word.size() >= 2 && std::all_of(word.begin(), word.end(), is_letter);
}

bool is_text(std::string_view literal) {
    std::size_t words = 0, from = 0;
    for (std::size_t end = 0; end != std::string_view::npos; from = end + 1) {
        end = literal.find(' ', from);
        words += is_prose(literal.substr(from, end == std::string_view::npos ? end : end - from)) ? 1 : 0;
    }
    const bool allowed =
        std::any_of(no_messages.begin(), no_messages.end(), [&](auto start) { return literal.starts_with(start); });
    return words >= 3 && !allowed;
}

/// Every literal, with those that follow it across blanks and lines only. Raw strings are programs and pages, no sentences.
std::vector<std::string> literals_of(std::string_view source) {
    std::vector<std::string> literals;
    bool joined = false;
    for (std::size_t i = 0; i < source.size();) {
        const char c = source[i];
        if (source.substr(i, 2) == "R\"" && (i == 0 || !is_word(source[i - 1]))) {
            const auto open = source.find('(', i);
            const std::string close = ")" + std::string(source.substr(i + 2, open - i - 2)) + "\"";
            i = std::min(source.find(close, open), source.size() - close.size()) + close.size();
            joined = false;
        } else if (opens_literal(source, i)) {
            const std::size_t end = end_of_literal(source, i);
            if (c == '"') {
                if (!joined) literals.emplace_back();
                literals.back() += source.substr(i + 1, end - i - 2);
            }
            joined = c == '"';
            i = end;
        } else {
            joined = joined && (c == ' ' || c == '\n');
            ++i;
        }
    }
    return literals;
}

void find_long_literals(std::string_view source, FoundTexts& found) {
    for (const std::string& literal : literals_of(source)) {
        if (!is_text(literal)) continue;
        ++found.texts;
        for (const std::string& sentence : sentences_of(literal))
            if (word_count(sentence) > max_words) found.too_long.insert(sentence);
    }
}

std::string_view trimmed(std::string_view text) {
    const auto from = text.find_first_not_of(" \n");
    if (from == std::string_view::npos) return {};
    return text.substr(from, text.find_last_not_of(" \n") - from + 1);
}

/// Errors without a remedy. Two may have none: work that the user stopped, and a text that holds all three parts already.
void find_missing_remedies(std::string_view source, FoundTexts& found) {
    for (const std::string_view opener : {"Error{", "fail({", "misuse({"}) {
        for (auto at = source.find(opener); at != std::string_view::npos; at = source.find(opener, at + 1)) {
            if (at > 0 && is_word(source[at - 1])) continue;
            const auto arguments = arguments_at(source, at + opener.size());
            if (arguments.size() < 3) continue;
            const std::string_view what = trimmed(arguments[1]), remedy = trimmed(arguments[2]);
            const bool stopped = arguments.size() > 3 && arguments[3].find("ErrorKind::stopped") != std::string_view::npos;
            if ((remedy == "\"\"" || remedy == "{}") && what != "\"\"" && !stopped) found.without_remedy.emplace_back(what);
        }
    }
}

template <class Openers>
void find_texts(std::string_view source, const Openers& of, FoundTexts& found) {
    for (const Opener& opener : of) {
        for (auto at = source.find(opener.word); at != std::string_view::npos; at = source.find(opener.word, at + 1)) {
            if (at > 0 && opener.word[0] != '_' && is_word(source[at - 1])) continue;
            const auto arguments = arguments_at(source, at + opener.word.size());
            for (std::size_t i = opener.first; i <= opener.last && i < arguments.size(); ++i) {
                for (const std::string& text : texts_in(arguments[i])) {
                    ++found.texts;
                    for (const std::string& sentence : sentences_of(text))
                        if (word_count(sentence) > max_words) found.too_long.insert(sentence);
                }
            }
        }
    }
}

FoundTexts texts_of(const std::string& file, std::string source) {
    source = without_comments(std::move(source));
    FoundTexts found;
    find_long_literals(source, found);
    find_texts(source, openers, found);
    if (file == "config/schema.cpp") find_texts(source, schema_openers, found);
    find_missing_remedies(source, found);
    return found;
}

std::string words(std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += i == 0 ? "Word" : " word";
    return text;
}

TEST(Messages, HaveSentencesOfAtMost25Words) {
    std::size_t texts = 0;
    for (const auto* top : {"config", "input", "render", "rt", "tools", "systemd"}) {
        for (const auto& entry : fs::recursive_directory_iterator(source_tree / top)) {
            const auto kind = entry.path().extension();
            if (!entry.is_regular_file() || (kind != ".cpp" && kind != ".hpp")) continue;
            const std::string file = fs::relative(entry.path(), source_tree).generic_string();
            const auto source = read_text(entry.path().string());
            ASSERT_TRUE(source) << file;
            const FoundTexts found = texts_of(file, *source);
            texts += found.texts;
            for (const std::string& sentence : found.too_long)
                ADD_FAILURE() << file << ": " << word_count(sentence) << " words: " << sentence;
            for (const std::string& what : found.without_remedy) ADD_FAILURE() << file << ": names no remedy: " << what;
        }
    }
    EXPECT_GT(texts, 2000U) << "texts are no longer found: have their helpers got other names?";
}

TEST(Messages, ALongSentenceIsFoundWhereverItStands) {
    const std::string good = words(25), bad = words(26);
    const auto count = [](const std::string& source, const std::string& file = "x.cpp") {
        return texts_of(file, source).too_long.size();
    };
    for (const std::string head :
         {"return Error{\"place\", \"", "return fail({place, \"", "return misuse({\"a\" + b, \"",
          "app.add_option(\"--size\", size, \"", "c->add_flag(\"--quick\", a, \"", "add_command(app, \"walk\", \"",
          "c->footer(\"", "Named{\"lock\", \"", "const SelectorEntry flat_entry{\"flat\", \""}) {
        EXPECT_EQ(count(head + bad + "\", \"Do it\"})"), 1U) << head;
        EXPECT_EQ(count(head + good + "\", \"Do it\"})"), 0U) << head;
    }
    EXPECT_EQ(count("Error{\"p\", \"What\", \"" + bad + "\"}"), 1U) << "in the remedy";
    EXPECT_EQ(count("Error{\"p\", \"" + words(20) + " \"\n    \"" + words(6) + "\", \"\"}"), 1U) << "in two lines";
    EXPECT_EQ(count("Error{\"p\", \"" + words(20) + " \" + name + \" " + words(5) + "\", \"\"}"), 1U) << "with a name between";
    EXPECT_EQ(count("Error{\"p\", fmt::format(\"" + bad + "\", 1), \"\"}"), 1U) << "in a call";
    EXPECT_EQ(count("Error{\"p\", \"" + words(20) + ". " + words(20) + "\", \"\"}"), 0U) << "two sentences";
    EXPECT_EQ(count("Error{\"p\", a ? \"" + words(20) + "\" : \"" + words(20) + "\", \"\"}"), 0U) << "one or the other";
    EXPECT_EQ(count("// Error{\"p\", \"" + bad + "\"}"), 0U) << "in a comment";
    EXPECT_EQ(count("log(\"" + bad + "\")"), 1U) << "in any literal";
    EXPECT_EQ(count("log(\"" + words(20) + " \"\n    \"" + words(6) + "\")"), 1U) << "of any literal in two lines";
    EXPECT_EQ(count("log(R\"(" + bad + ")\", \"" + good + "\")"), 0U) << "in a raw string";
    EXPECT_EQ(count("number(\"key\", \"ms\", 0, 1, \"" + bad + "\", &S::a)", "config/schema.cpp"), 1U) << "a setting";
}

TEST(Messages, AnErrorWithoutARemedyIsFound) {
    const auto count = [](const std::string& source) { return texts_of("x.cpp", source).without_remedy.size(); };
    EXPECT_EQ(count("Error{\"p\", \"It is bad\", \"\", ErrorKind::failed}"), 1U);
    EXPECT_EQ(count("fail({\"p\", fmt::format(\"It is {}\", a), {}})"), 1U);
    EXPECT_EQ(count("Error{\"p\", \"It is bad\", \"Do it\", ErrorKind::failed}"), 0U);
    EXPECT_EQ(count("Error{\"p\", \"It was stopped\", \"\", ErrorKind::stopped}"), 0U);
    EXPECT_EQ(count("Error{text, \"\", \"\", ErrorKind::misuse}"), 0U) << "all three parts in one text";
}

}  // namespace
}  // namespace surefoot::house
