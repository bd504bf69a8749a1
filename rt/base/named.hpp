// The common part of all registry entries: a name and one line of help. Can be found by name, listed for people, and passed to
// rooms that do not know the entry's type.
#pragma once

#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace surefoot {

/// The name of a registry entry, with its help text.
struct Named {
    std::string_view name, help;
};

/// The entry of this name; null where there is none.
template <class Entries>
auto find_named(const Entries& entries, std::string_view name) -> decltype(std::data(entries)) {
    for (const auto& entry : entries)
        if (entry.name == name) return &entry;
    return nullptr;
}

/// Names and help only. The entries must outlive the result.
template <class Entries>
std::vector<Named> named(const Entries& entries) {
    std::vector<Named> out;
    for (const auto& entry : entries) out.push_back({entry.name, entry.help});
    return out;
}

/// "flat, distance, two-stage".
template <class Entries>
std::string names_in_words(const Entries& entries) {
    std::string text;
    for (const auto& entry : entries) text += (text.empty() ? "" : ", ") + std::string(entry.name);
    return text;
}

}  // namespace surefoot
