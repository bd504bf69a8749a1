// Names that were replaced by the field's standard words do not come back: as identifiers in code, as words of identifiers and
// of comments where no other meaning is possible, and as names of files. Scripts are read too: shell, awk, Python and CMake.
// String literals are not looked at: keys and messages are contracts. Neither are comments and here-documents of scripts.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "tests/house/banned_names.hpp"

namespace surefoot::house {
namespace {

namespace fs = std::filesystem;
const fs::path top_folder = SUREFOOT_SOURCE_DIR;

/// "take_put_off", "TakePutOff" and "take put off" are "_take_put_off_".
std::string words_of(std::string_view text) {
    std::string words = "_";
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        const bool after_small = i > 0 && std::islower(static_cast<unsigned char>(text[i - 1])) != 0;
        const bool begins = std::isalnum(c) == 0 || (std::isupper(c) != 0 && after_small);
        if (begins && words.back() != '_') words += '_';
        if (std::isalnum(c) != 0) words += static_cast<char>(std::tolower(c));
    }
    return words + '_';
}

/// Whether `banned` is in `words` with a '_' on either side.
bool has_words(std::string_view words, std::string_view banned) {
    for (std::size_t at = words.find(banned); at != std::string_view::npos; at = words.find(banned, at + 1)) {
        const std::size_t end = at + banned.size();
        if (at > 0 && words[at - 1] == '_' && end < words.size() && words[end] == '_') return true;
    }
    return false;
}

std::string_view looked_up(std::string_view identifier) {
    const std::string words = words_of(identifier);
    if (std::find(contracts.begin(), contracts.end(), identifier) != contracts.end()) return {};
    for (const Banned& banned : banned_names())
        if (identifier == banned.name) return banned.instead;
    for (const Banned& banned : banned_prefixes())
        if (identifier.starts_with(banned.name)) return banned.instead;
    for (const Banned& banned : banned_words())
        if (has_words(words, banned.name)) return banned.instead;
    return {};
}

/// What to say instead of an identifier; empty where it may stay.
std::string_view instead_of(std::string_view identifier) {
    static std::unordered_map<std::string, std::string_view> known;  // each stands a hundred times
    const auto [it, is_new] = known.try_emplace(std::string(identifier));
    if (is_new) it->second = looked_up(identifier);
    return it->second;
}

/// The same with the names that are banned in the product only.
std::string_view instead_in(std::string_view identifier, bool product) {
    if (product) {
        for (const Banned& banned : banned_in_product())
            if (identifier == banned.name) return banned.instead;
    }
    return instead_of(identifier);
}

struct Found {
    std::size_t line = 0;
    std::string identifier;  ///< or words of a comment, joined by '_'
};

bool begins_identifier(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_part(char c) { return begins_identifier(c) || std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Walks over C++ text and collects the banned identifiers of its code and the banned words of its comments.
class Reader {
public:
    /// `product`: the names of banned_in_product() count too.
    explicit Reader(std::string_view text, bool product = false) : text_(text), product_(product) {}

    std::vector<Found> run() {
        while (at_ < text_.size()) {
            const std::string_view rest = text_.substr(at_);
            if (rest.starts_with("//"))
                take_comment("\n", 0);
            else if (rest.starts_with("/*"))
                take_comment("*/", 2);
            else if (rest.front() == '"')
                skip_quoted('"');
            else if (rest.front() == '\'')
                skip_quoted('\'');
            else if (std::isdigit(static_cast<unsigned char>(rest.front())) != 0)
                skip_number();
            else if (begins_identifier(rest.front()))
                take_identifier();
            else
                advance(1);
        }
        return std::move(found_);
    }

private:
    void advance(std::size_t count) {
        count = std::min(count, text_.size() - at_);
        line_ += static_cast<std::size_t>(std::count(text_.begin() + static_cast<std::ptrdiff_t>(at_),
                                                     text_.begin() + static_cast<std::ptrdiff_t>(at_ + count), '\n'));
        at_ += count;
    }
    void skip_to(std::string_view end, std::size_t beyond) {
        const auto found = text_.find(end, at_ + beyond);
        advance(found == std::string_view::npos ? text_.size() : found + beyond - at_);
    }
    void take_comment(std::string_view end, std::size_t beyond) {
        const std::size_t from = at_, line = line_;
        skip_to(end, beyond);
        const std::string words = words_of(text_.substr(from, at_ - from));
        for (const Banned& banned : banned_words())
            if (banned_in_comments(banned.name) && has_words(words, banned.name))
                found_.push_back({line, std::string(banned.name)});
    }
    void skip_quoted(char quote) {
        std::size_t end = at_ + 1;
        while (end < text_.size() && text_[end] != quote) end += text_[end] == '\\' ? 2 : 1;
        advance(end + 1 - at_);
    }
    void skip_number() {  // 1'000'000 too
        std::size_t end = at_;
        while (end < text_.size() && (is_part(text_[end]) || text_[end] == '.' || text_[end] == '\'')) ++end;
        advance(end - at_);
    }
    void take_identifier() {
        std::size_t end = at_;
        while (end < text_.size() && is_part(text_[end])) ++end;
        const std::string_view identifier = text_.substr(at_, end - at_);
        if (identifier.ends_with('R') && identifier.size() <= 3 && end < text_.size() && text_[end] == '"') {
            const auto open = text_.find('(', end);
            const std::string close = ")" + std::string(text_.substr(end + 1, open - end - 1)) + "\"";
            advance(open + 1 - at_);
            skip_to(close, 0);
            advance(close.size());
            return;
        }
        if (!instead_in(identifier, product_).empty()) found_.push_back({line_, std::string(identifier)});
        advance(identifier.size());
    }

    std::string_view text_;
    bool product_;
    std::size_t at_ = 0, line_ = 1;
    std::vector<Found> found_;
};

std::string text_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The banned names that a script uses: as commands, functions and variables, also inside of double quotes ($name).
std::vector<Found> script_names(std::string_view text) {
    std::vector<Found> found;
    std::size_t line = 1;
    bool quoted = false, after_sign = false;
    std::string here_end, before;  // the word that ends a here-document; the name before
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        const std::string_view rest = text.substr(i);
        if (c == '\n') {
            ++line;
            for (++i; !here_end.empty() && i < text.size(); ++line) {
                const std::string_view now = text.substr(i, std::min(text.find('\n', i), text.size()) - i);
                i = std::min(i + now.size() + 1, text.size());
                if (now.substr(std::min(now.find_first_not_of('\t'), now.size())) == here_end) here_end.clear();
            }
            continue;
        }
        const bool begins_word = i == 0 || std::string_view(" \t\n;").find(text[i - 1]) != std::string_view::npos;
        if (c == '\\') {
            line += text.substr(i, 2).ends_with('\n') ? 1 : 0;
            i += 2;
        } else if (c == '"') {
            quoted = !quoted;
            ++i;
        } else if (c == '\'' && !quoted) {
            const std::size_t end = std::min(text.find('\'', i + 1), text.size());
            line += static_cast<std::size_t>(std::count(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(end - i), '\n'));
            i = std::min(end + 1, text.size());
        } else if (c == '#' && !quoted && begins_word) {
            i = std::min(text.find('\n', i), text.size());
        } else if (rest.starts_with("<<") && !rest.starts_with("<<<") && !quoted && (i == 0 || text[i - 1] != '<')) {
            for (i += 2; i < text.size() && std::string_view("-'\" ").find(text[i]) != std::string_view::npos; ++i) continue;
            while (i < text.size() && is_part(text[i])) here_end += text[i++];
            for (; i < text.size() && (text[i] == '\'' || text[i] == '"'); ++i) continue;
        } else if (begins_identifier(c)) {
            std::size_t end = i;
            while (end < text.size() && is_part(text[end])) ++end;
            const std::string name(text.substr(i, end - i));
            const bool of_udev = before == "udevadm";  // `udevadm settle` is another program's word
            if ((!quoted || after_sign) && !of_udev && !instead_in(name, true).empty()) found.push_back({line, name});
            before = name;
            i = end;
        } else {
            after_sign = c == '$' || (after_sign && c == '{') || (after_sign && c == '(');
            ++i;
            continue;
        }
        after_sign = false;
    }
    return found;
}

/// Shell, awk, Python and CMake: by ending, or by the first line of a file without one.
bool is_script(const fs::path& path) {
    const auto kind = path.extension();
    if (kind == ".sh" || kind == ".awk" || kind == ".cmake" || path.filename() == "CMakeLists.txt") return true;
    if (!kind.empty()) return false;
    std::ifstream stream(path, std::ios::binary);
    std::string first;
    return std::getline(stream, first) && (first.starts_with("#!") || first.starts_with("# "));
}

/// What a file should be called; empty where its name may stay. `file`: from the root, with '/'.
std::string_view other_name(std::string_view file) {
    const auto base = [](std::string_view path) { return path.substr(path.rfind('/') + 1); };
    const std::string_view name = base(file);
    for (const Banned& banned : banned_files())
        for (const std::string_view ending : {".cpp", ".hpp", ".sh", ".awk"})
            if (name == std::string(base(banned.name)) + std::string(ending)) return banned.instead;
    return {};
}

TEST(BannedNames, StandNowhereInTheSources) {
    std::size_t files = 0, scripts = 0;
    for (const auto* top : {"rt", "render", "input", "config", "systemd", "tools", "tests"}) {
        for (const auto& entry : fs::recursive_directory_iterator(top_folder / top)) {
            const auto kind = entry.path().extension();
            if (!entry.is_regular_file()) continue;
            const bool code = kind == ".cpp" || kind == ".hpp", script = !code && is_script(entry.path());
            files += code ? 1 : 0;
            scripts += script ? 1 : 0;
            const std::string file = fs::relative(entry.path(), top_folder).generic_string();
            EXPECT_EQ(other_name(file), "") << file << " has another name now";
            if (!code && !script) continue;
            const std::string text = text_of(entry.path());
            const bool product = std::string_view(top) != "tests";
            for (const Found& found : code ? Reader(text, product).run() : script_names(text))
                ADD_FAILURE() << file << ":" << found.line << ": " << found.identifier << " is called "
                              << instead_in(found.identifier, product || script);
        }
    }
    EXPECT_GT(files, 500U) << "the sources were not found";
    EXPECT_GT(scripts, 40U) << "the scripts were not found";
}

TEST(BannedNames, AreFoundInScripts) {
    const auto found = [](std::string_view text) {
        std::string all;
        for (const Found& f : script_names(text)) all += (all.empty() ? "" : " ") + std::to_string(f.line) + ":" + f.identifier;
        return all;
    };
    EXPECT_EQ(found("#!/bin/sh\nsays() { echo 1; }\nsays a b\n"), "2:says 3:says");
    EXPECT_EQ(found("x=1 # says\necho \"it says $said ${told}\" 'says' \"$(says x)\"\n"), "2:said 2:told 2:says");
    EXPECT_EQ(found("cat <<'END' | grep x\nshe says\nEND\nsay\n"), "4:say");
    EXPECT_EQ(found("grep x <<<\"$most_lines\"\nmost_lines = 1; most = 2\n"), "1:most_lines 2:most_lines 2:most");
    EXPECT_EQ(found("udevadm settle\nsettle\nat_most=1\n"), "2:settle");
    EXPECT_EQ(found("a='one\ntwo'\nsay\n"), "3:say");
}

TEST(BannedNames, AreFoundInCodeAndNowhereElse) {
    const auto found = [](std::string_view text) {
        std::string all;
        for (const Found& f : Reader(text).run()) all += (all.empty() ? "" : " ") + std::to_string(f.line) + ":" + f.identifier;
        return all;
    };
    EXPECT_EQ(found("int a;\nAttendant b;\n"), "2:Attendant");
    EXPECT_EQ(found("x->most_parts + least_m;"), "1:most_parts 1:least_m");
    EXPECT_EQ(found("at_most(1); outermost; attendants; max_parts;"), "");
    EXPECT_EQ(found("// Attended\n/* Attended\n */ tell(s);"), "3:tell");
    EXPECT_EQ(found(R"(f("say \" Attendant", '"', say);)"), "1:say");
    EXPECT_EQ(found("f(R\"x(\n\" say )\" )x\", said);"), "2:said");
    EXPECT_EQ(found("a = 1'000'000; b = 'x'; thrift(1'0);"), "1:thrift");
    EXPECT_EQ(found("#include \"input/devices/attendant.hpp\"\n"), "");
    EXPECT_EQ(found("note_loss(); note_count; notes_; most;"), "1:note_loss");
    EXPECT_EQ(Reader("most + least_m + notes_", true).run().size(), 3U) << "in the product";
}

TEST(BannedNames, AreFoundAsWordsOfIdentifiersAndComments) {
    EXPECT_NE(instead_of("take_put_off"), "");
    EXPECT_NE(instead_of("TakePutOff"), "");
    EXPECT_NE(instead_of("thrift_of"), "");
    EXPECT_NE(instead_of("FirstShot"), "");
    EXPECT_NE(instead_of("VisitTest"), "");
    EXPECT_EQ(instead_of("put_offset"), "");
    EXPECT_EQ(instead_of("output_off"), "");
    EXPECT_EQ(instead_of("Screenshot"), "");
    EXPECT_EQ(instead_of("NodeVisitTests"), "");
    std::string all;
    const std::string_view text =
        "int a;  // the black box\n// It is put off.\n/* one\n Thrift */ int b;\n// a screenshot\nf(\"a shot\");";
    for (const Found& f : Reader(text).run()) all += std::to_string(f.line) + ":" + f.identifier + " ";
    EXPECT_EQ(all, "1:black_box 3:thrift ");
}

TEST(BannedNames, OfFilesAreFound) {
    EXPECT_EQ(other_name("input/devices/attendant.hpp"), "device_router");
    EXPECT_EQ(other_name("render/select/queue.hpp"), "bucket_queue");
    EXPECT_EQ(other_name("tools/soak/queue.hpp"), "bucket_queue") << "in another folder";
    EXPECT_EQ(other_name("render/select/bucket_queue.hpp"), "");
    EXPECT_EQ(other_name("tools/walk/visit.md"), "");
}

TEST(BannedNames, HaveAnAllowedNameInstead) {
    for (const auto* list : {&banned_names(), &banned_prefixes(), &banned_words()}) {
        EXPECT_FALSE(list->empty());
        for (const Banned& banned : *list) {
            EXPECT_FALSE(banned.instead.empty()) << banned.name;
            std::size_t from = 0;
            for (std::size_t end = 0; end != std::string_view::npos; from = end + 4) {
                end = banned.instead.find(" or ", from);
                EXPECT_EQ(instead_of(banned.instead.substr(from, end - from)), "") << "in place of " << banned.name;
                if (end == std::string_view::npos) break;
            }
        }
    }
}

}  // namespace
}  // namespace surefoot::house
