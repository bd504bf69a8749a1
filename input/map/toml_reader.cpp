// TOML keys to values, with errors that say where and what instead.
#include "input/map/toml_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "rt/base/nearest.hpp"

namespace surefoot::input {

namespace {

std::string shown(const toml::node& node) {
    if (node.is_table()) return "a table";
    if (node.is_array()) return "an array";
    std::ostringstream out;
    node.visit([&](const auto& value) {
        if constexpr (toml::is_value<decltype(value)>) out << value;
    });
    const std::string text = out.str();
    return text.size() <= 40 ? text : text.substr(0, 40) + "...";
}

std::string listed(std::span<const std::string_view> words) {
    std::string text;
    for (const auto word : words) text += (text.empty() ? "\"" : ", \"") + std::string(word) + "\"";
    return text;
}

const toml::array* pair_of(const toml::node& node) {
    const toml::array* array = node.as_array();
    return array != nullptr && array->size() == 2 ? array : nullptr;
}

}  // namespace

std::string TableReader::full(std::string_view key) const {
    return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

const toml::node* TableReader::node(std::string_view key) {
    known_.push_back(key);
    return error_ ? nullptr : table_.get(key);
}

void TableReader::wrong(std::string_view key, const toml::node& node, const std::string& allowed, std::string remedy) {
    if (error_) return;
    error_ =
        Error{fmt::format("{}:{}", file_, node.source().begin.line),
              fmt::format("The value {} = {} is not {}", full(key), shown(node), allowed), std::move(remedy), ErrorKind::misuse};
}

void TableReader::refuse(std::string_view key, std::string what, std::string remedy) {
    if (error_) return;
    const toml::node* at = table_.get(key);
    const auto line = at != nullptr ? at->source().begin.line : table_.source().begin.line;
    error_ = Error{fmt::format("{}:{}", file_, line), fmt::format("The key {} {}", full(key), what), std::move(remedy),
                   ErrorKind::misuse};
}

void TableReader::number(std::string_view key, double min, double max, std::string_view unit, double& value) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const auto number = at->is_number() ? at->value<double>() : std::nullopt;
    if (number && *number >= min && *number <= max)
        value = *number;
    else
        wrong(key, *at, fmt::format("a number from {} to {}{}", min, max, unit.empty() ? "" : fmt::format(" ({})", unit)));
}

void TableReader::integer(std::string_view key, std::int64_t min, std::int64_t max, std::int64_t& value) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const auto number = at->value_exact<std::int64_t>();
    if (number && *number >= min && *number <= max)
        value = *number;
    else
        wrong(key, *at, fmt::format("a whole number from {} to {}", min, max));
}

void TableReader::flag(std::string_view key, bool& value) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    if (const auto flag = at->value_exact<bool>())
        value = *flag;
    else
        wrong(key, *at, "true or false");
}

void TableReader::text(std::string_view key, std::string& value) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    if (const auto text = at->value_exact<std::string>(); text && text->size() <= 256)
        value = *text;
    else
        wrong(key, *at, "a text of at most 256 letters");
}

std::optional<std::size_t> TableReader::word_of(std::string_view key, const toml::node& node,
                                                std::span<const std::string_view> words) {
    const auto text = node.value_exact<std::string>();
    const auto found = text ? std::find(words.begin(), words.end(), *text) : words.end();
    if (found != words.end()) return static_cast<std::size_t>(found - words.begin());
    const auto nearest = text ? nearest_word(*text, words) : std::string_view{};
    wrong(key, node, "one of " + listed(words), nearest.empty() ? "" : fmt::format("Did you mean \"{}\"?", nearest));
    return std::nullopt;
}

void TableReader::choice(std::string_view key, std::span<const std::string_view> words, std::size_t& index) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    if (const auto word = word_of(key, *at, words)) index = *word;
}

void TableReader::texts(std::string_view key, std::array<std::string, 2>& values) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* pair = pair_of(*at);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto text = pair != nullptr ? pair->get(i)->value_exact<std::string>() : std::nullopt;
        if (!text || text->size() > 256) return wrong(key, *at, "an array of two texts");
        values[i] = *text;
    }
}

void TableReader::flags(std::string_view key, std::array<bool, 2>& values) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* pair = pair_of(*at);
    for (std::size_t i = 0; i < 2; ++i) {
        const auto flag = pair != nullptr ? pair->get(i)->value_exact<bool>() : std::nullopt;
        if (!flag) return wrong(key, *at, "an array of two, each true or false");
        values[i] = *flag;
    }
}

void TableReader::choices(std::string_view key, std::span<const std::string_view> words, std::array<std::size_t, 2>& indices) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* pair = pair_of(*at);
    if (pair == nullptr) return wrong(key, *at, "an array of two of " + listed(words));
    for (std::size_t i = 0; i < 2; ++i)
        if (const auto word = word_of(key, *pair->get(i), words)) indices[i] = *word;
}

void TableReader::table(std::string_view key, const std::function<Result<void>(TableReader&)>& read) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    if (!at->is_table()) return wrong(key, *at, "a table");
    TableReader inner(*at->as_table(), file_, full(key));
    if (const auto done = read(inner); !done) error_ = done.error();
}

void TableReader::tables(std::string_view key, const std::function<Result<void>(TableReader&)>& read) {
    const toml::node* at = node(key);
    if (at == nullptr) return;
    const toml::array* array = at->as_array();
    if (array == nullptr) return wrong(key, *at, "a list of tables", fmt::format("Write [[{}]]", full(key)));
    for (const toml::node& element : *array) {
        if (!element.is_table()) return wrong(key, element, "a table", fmt::format("Write [[{}]]", full(key)));
        TableReader inner(*element.as_table(), file_, full(key));
        if (const auto done = read(inner); !done) {
            error_ = done.error();
            return;
        }
    }
}

Result<void> TableReader::finish() {
    if (error_) return *error_;
    for (const auto& [key, node] : table_) {
        if (std::find(known_.begin(), known_.end(), key.str()) != known_.end()) continue;
        const auto nearest = nearest_word(key.str(), known_);
        return Error{
            fmt::format("{}:{}", file_, key.source().begin.line), fmt::format("The key '{}' is unknown", full(key.str())),
            nearest.empty() ? "Use one of " + listed(known_) : fmt::format("Did you mean '{}'?", nearest), ErrorKind::misuse};
    }
    return {};
}

}  // namespace surefoot::input
