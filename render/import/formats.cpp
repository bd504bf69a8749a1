// The list of all formats, in the order in which people see them.
#include "render/import/formats.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>

#include "render/import/ostf.hpp"

namespace surefoot::importer {

namespace {

using std::string_view;

constexpr std::array<string_view, 2> gltf_endings = {glb_ending, ".gltf"};
constexpr std::array<string_view, 1> obj_endings = {".obj"}, ostf_endings = {ostf_ending};

constexpr std::array all = {
    Format{"glTF", "glTF 2.0, in one file or with buffers and pictures beside it", gltf_endings, import_gltf},
    Format{"OBJ", "Wavefront OBJ with its material libraries", obj_endings, import_obj},
    Format{"OSTF", "Object Separated Triangle Format, read piece by piece", ostf_endings, import_ostf},
};

}  // namespace

std::span<const Format> formats() { return all; }

std::string ending_of(const std::string& file) {
    std::string ending = std::filesystem::path(file).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return ending;
}

const Format* format_of(const std::string& file) {
    const std::string ending = ending_of(file);
    for (const Format& format : all)
        if (std::find(format.endings.begin(), format.endings.end(), ending) != format.endings.end()) return &format;
    return nullptr;
}

std::string endings_in_words() {
    std::string text;
    for (const Format& format : all)
        for (const string_view ending : format.endings) text += (text.empty() ? "" : ", ") + std::string(ending);
    return text;
}

}  // namespace surefoot::importer
