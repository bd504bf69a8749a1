// Reads one TOML table key by key. Errors name file, line, key, the allowed values and the nearest known name.
#pragma once

#include <toml++/toml.h>

#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::input {

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

private:
    const toml::node* node(std::string_view key);
    void wrong(std::string_view key, const toml::node& node, const std::string& allowed, std::string remedy = {});
    std::optional<std::size_t> word_of(std::string_view key, const toml::node& node, std::span<const std::string_view> words);
    [[nodiscard]] std::string full(std::string_view key) const;

    const toml::table& table_;
    std::string file_, path_;
    std::vector<std::string_view> known_;
    std::optional<Error> error_;
};

}  // namespace surefoot::input
