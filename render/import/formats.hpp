// The registry of formats, by file ending. To add one: its reader, and an entry in formats.cpp. Help texts and remedies follow.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// The registry entry of a format.
struct Format {
    std::string_view name, help;
    std::span<const std::string_view> endings;  ///< lower case, with their point
    Result<Scene> (*read)(const std::string& file, const Progress& progress) = nullptr;
};

constexpr std::string_view glb_ending = ".glb", ostf_ending = ".ostf";  ///< of the two formats that are also written

std::span<const Format> formats();
/// A file name's ending in lower case, with its point; empty where it has none.
std::string ending_of(const std::string& file);
/// Null for an ending that no format has.
const Format* format_of(const std::string& file);
/// ".gltf, .glb, .obj, .ostf".
std::string endings_in_words();

}  // namespace surefoot::importer
