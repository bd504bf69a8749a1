// One TOML table read key by key, every error with file, line, key, what is allowed and the nearest known name.
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

/// Ask for every key that may be there, then finish(), which refuses what else is in the table. After the first error every
/// further call does nothing; values that are not in the table keep what they were.
class TableReader {
public:
    /// `path` is how the table is called: "device.axis".
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
    /// An error of this table: `what` is wrong with the key (with the table where the key is not there).
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
