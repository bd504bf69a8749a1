// Reads TOML tables key by key. Errors name file, line, key, the allowed values and the nearest known name. All code is in this
// header, so that only its users need toml++.
#pragma once

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rt/base/result.hpp"
#include "rt/base/text.hpp"

namespace surefoot {

/// "FILE:LINE"
inline std::string toml_place(std::string_view file, const toml::source_region& source) {
    return fmt::format("{}:{}", file, source.begin.line);
}

/// Parses the text of the file `name`. An error names the line, and writes its number to `wrong_line` where there is one.
inline Result<toml::table> parse_toml(std::string_view text, const std::string& name, std::uint32_t* wrong_line = nullptr) {
    try {
        return toml::parse(text, name);
    } catch (const toml::parse_error& error) {
        if (wrong_line != nullptr) *wrong_line = error.source().begin.line;
        return Error{toml_place(name, error.source()), fmt::format("The file is not valid TOML: {}", error.description()),
                     "See https://toml.io for the syntax", ErrorKind::damaged};
    }
}

/// Read every allowed key, then call finish(), which refuses all other keys. After the first error all calls do nothing. Values
/// that are not in the table do not change.
class TableReader {
public:
    /// `path`: the name of the table, such as "device.axis".
    TableReader(const toml::table& table, std::string file, std::string path)
        : table_(table), file_(std::move(file)), path_(std::move(path)) {}

    void number(std::string_view key, double min, double max, std::string_view unit, double& value);
    void integer(std::string_view key, std::int64_t min, std::int64_t max, std::int64_t& value);
    void flag(std::string_view key, bool& value);
    void text(std::string_view key, std::string& value);
    /// Index of the word.
    void choice(std::string_view key, std::span<const std::string_view> words, std::size_t& index);
    /// An array of so many numbers.
    void numbers(std::string_view key, std::size_t count, double min, std::vector<double>& values);
    /// Arrays of two.
    void texts(std::string_view key, std::array<std::string, 2>& values);
    void flags(std::string_view key, std::array<bool, 2>& values);
    void choices(std::string_view key, std::span<const std::string_view> words, std::array<std::size_t, 2>& indices);
    /// [path.key] and [[path.key]]; `read` gets a reader for each table and returns its finish().
    void table(std::string_view key, const std::function<Result<void>(TableReader&)>& read);
    void tables(std::string_view key, const std::function<Result<void>(TableReader&)>& read);

    [[nodiscard]] bool has(std::string_view key) const { return table_.contains(key); }
    /// An error about a key: "The key PATH.KEY `what`". Its place is the key's line, or the table's if the key is missing.
    void refuse(std::string_view key, std::string what, std::string remedy);
    [[nodiscard]] Result<void> finish();
    /// The key of the first error so far: "path.key"; empty if there is none.
    [[nodiscard]] const std::string& wrong_key() const { return wrong_key_; }

private:
    const toml::node* node(std::string_view key);
    void wrong(std::string_view key, const toml::node& node, const std::string& allowed, std::string remedy = {});
    std::optional<std::size_t> word_of(std::string_view key, const toml::node& node, std::span<const std::string_view> words);
    [[nodiscard]] std::string full(std::string_view key) const;

    const toml::table& table_;
    std::string file_, path_, wrong_key_;
    std::vector<std::string_view> known_;
    std::optional<Error> error_;
};

namespace toml_detail {

inline std::string shown(const toml::node& node) {
    if (node.is_table()) return "a table";
    if (node.is_array()) return "an array";
    std::ostringstream out;
    node.visit([&](const auto& value) {
        if constexpr (toml::is_value<decltype(value)>) out << value;
    });
    const std::string text = out.str();
    return text.size() <= 40 ? text : text.substr(0, 40) + "...";
}

inline std::string listed(std::span<const std::string_view> words) {
    std::string text;
    for (const auto word : words) text += (text.empty() ? "\"" : ", \"") + std::string(word) + "\"";
    return text;
}

inline const toml::array* pair_of(const toml::node& node) {
    const toml::array* array = node.as_array();
    return array != nullptr && array->size() == 2 ? array : nullptr;
}

}  // namespace toml_detail

inline std::string TableReader::full(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

inline const toml::node* TableReader::node(std::string_view key) {
    known_.push_back(key);
    return error_ ? nullptr : table_.get(key);
}

inline void TableReader::wrong(std::string_view key, const toml::node& node, const std::string& allowed, std::string remedy) {
    if (error_) return;
    wrong_key_ = full(key);
    error_ = Error{toml_place(file_, node.source()),
                   fmt::format("The value {} = {} is not allowed", full(key), toml_detail::shown(node)),
                   fmt::format("Use {}{}{}", allowed, remedy.empty() ? "" : ". ", remedy), ErrorKind::misuse};
}

inline void TableReader::refuse(std::string_view key, std::string what, std::string remedy) {
    if (error_) return;
    const toml::node* at = table_.get(key);
    const auto line = at != nullptr ? at->source().begin.line : table_.source().begin.line;
    wrong_key_ = full(key);
    error_ = Error{fmt::format("{}:{}", file_, line), fmt::format("The key {} {}", full(key), what), std::move(remedy),
                   ErrorKind::misuse};
}

inline void TableReader::number(std::string_view key, double min, double max, std::string_view unit, double& value) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const auto number = at->is_number() ? at->value<double>() : std::nullopt;
    if (number && *number >= min && *number <= max)
        value = *number;
    else
        wrong(key, *at, fmt::format("a number from {} to {}{}", min, max, unit.empty() ? "" : fmt::format(" ({})", unit)));
}

inline void TableReader::integer(std::string_view key, std::int64_t min, std::int64_t max, std::int64_t& value) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const auto number = at->value_exact<std::int64_t>();
    if (number && *number >= min && *number <= max)
        value = *number;
    else
        wrong(key, *at, fmt::format("a whole number from {} to {}", min, max));
}

inline void TableReader::flag(std::string_view key, bool& value) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    if (const auto flag = at->value_exact<bool>())
        value = *flag;
    else
        wrong(key, *at, "true or false");
}

inline void TableReader::text(std::string_view key, std::string& value) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    if (const auto text = at->value_exact<std::string>(); text && text->size() <= 256)
        value = *text;
    else
        wrong(key, *at, "a text of at most 256 letters");
}

inline std::optional<std::size_t> TableReader::word_of(std::string_view key, const toml::node& node,
                                                       std::span<const std::string_view> words) {
    const auto text = node.value_exact<std::string>();
    const auto found = text ? std::find(words.begin(), words.end(), *text) : words.end();
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    const auto nearest = text ? nearest_word(*text, words) : std::string_view{};
    wrong(key, node, "one of " + toml_detail::listed(words), nearest.empty() ? "" : fmt::format("Did you mean \"{}\"?", nearest));
    return std::nullopt;
}

inline void TableReader::choice(std::string_view key, std::span<const std::string_view> words, std::size_t& index) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    if (const auto word = word_of(key, *at, words)) index = *word;
}

inline void TableReader::numbers(std::string_view key, std::size_t count, double min, std::vector<double>& values) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* array = at->as_array();
    std::vector<double> read;
    for (std::size_t i = 0; array != nullptr && i < array->size(); ++i) {
        const auto number = array->get(i)->is_number() ? array->get(i)->value<double>() : std::nullopt;
        if (!number || !std::isfinite(*number) || *number < min) break;
        read.push_back(*number);
    }
    if (array == nullptr || array->size() != count || read.size() != count)
        return wrong(key, *at, fmt::format("an array of {} numbers of at least {}", count, min));
    values = std::move(read);
}

inline void TableReader::texts(std::string_view key, std::array<std::string, 2>& values) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* pair = toml_detail::pair_of(*at);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto text = pair != nullptr ? pair->get(i)->value_exact<std::string>() : std::nullopt;
        if (!text || text->size() > 256) return wrong(key, *at, "an array of two texts");
        values[i] = *text;
    }
}

inline void TableReader::flags(std::string_view key, std::array<bool, 2>& values) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* pair = toml_detail::pair_of(*at);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto flag = pair != nullptr ? pair->get(i)->value_exact<bool>() : std::nullopt;
        if (!flag) return wrong(key, *at, "an array of two, each true or false");
        values[i] = *flag;
    }
}

inline void TableReader::choices(std::string_view key, std::span<const std::string_view> words,
                                 std::array<std::size_t, 2>& indices) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* pair = toml_detail::pair_of(*at);
    if (pair == nullptr) return wrong(key, *at, "an array of two of " + toml_detail::listed(words));
    for (std::size_t i = 0; i < 2; ++i)
        if (const auto word = word_of(key, *pair->get(i), words)) indices[i] = *word;
}

inline void TableReader::table(std::string_view key, const std::function<Result<void>(TableReader&)>& read) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    if (!at->is_table()) return wrong(key, *at, "a table");
    TableReader inner(*at->as_table(), file_, full(key));
    if (const auto done = read(inner); !done) {
        wrong_key_ = inner.wrong_key_;
        error_ = done.error();
    }
}

inline void TableReader::tables(std::string_view key, const std::function<Result<void>(TableReader&)>& read) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* array = at->as_array();
    if (array == nullptr) return wrong(key, *at, "a list of tables", fmt::format("Write [[{}]]", full(key)));
    for (const toml::node& element : *array) {
        if (!element.is_table()) return wrong(key, element, "a table", fmt::format("Write [[{}]]", full(key)));
        TableReader inner(*element.as_table(), file_, full(key));
        if (const auto done = read(inner); !done) {
            wrong_key_ = inner.wrong_key_;
            error_ = done.error();
            return;
        }
    }
}

inline Result<void> TableReader::finish() {
    if (error_) return *error_;
    for (const auto& [key, node] : table_) {
        if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
        const auto nearest = nearest_word(key.str(), known_);
        return Error{toml_place(file_, key.source()), fmt::format("The key '{}' is unknown", full(key.str())),
                     nearest.empty() ? "Use one of " + toml_detail::listed(known_) : fmt::format("Did you mean '{}'?", nearest),
                     ErrorKind::misuse};
    }
    return {};
}

}  // namespace surefoot
