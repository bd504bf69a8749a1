// Names of registry entries stand in the registry's folder alone: what others print or ask for, they take from there. Names of
// scenes stand nowhere in what bakes, draws or walks: no choice goes by them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/backends.hpp"
#include "render/import/formats.hpp"
#include "render/model/model.hpp"
#include "render/select/registry.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::house {
namespace {

namespace fs = std::filesystem;
const fs::path tree = SUREFOOT_SOURCE_DIR;

struct Known {
    std::string_view name, folder;
};

std::vector<Known> known_names() {
    std::vector<Known> all;
    const auto add = [&](const auto& entries, std::string_view folder) {
        for (const auto& entry : entries) all.push_back({entry.name, folder});
    };
    add(select::selectors(), "render/select");
    add(gl::backends(), "render/gl");
    add(effects::all_effects(), "render/effects");
    add(model::forms, "render/model");
    for (const importer::Format& format : importer::formats())
        for (const std::string_view ending : format.endings) all.push_back({ending, "render/import"});
    return all;
}

/// Words that mean other things too: only a literal that is nothing else counts.
bool is_common(std::string_view name) {
    constexpr std::string_view common[] = {"flat", "distance", "device", "window", "null", "texture", "sun", "blend", "mesh"};
    return std::find(std::begin(common), std::end(common), name) != std::end(common);
}

bool holds_word(std::string_view text, std::string_view word) {
    const auto part = [](char c) { return (std::isalnum(static_cast<unsigned char>(c)) != 0) || c == '-' || c == '_'; };
    for (auto at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const bool begins = at == 0 || !part(text[at - 1]);
        const std::size_t end = at + word.size();
        if (begins && (end == text.size() || !part(text[end]))) return true;
    }
    return false;
}

/// The string literals of a line, comments left out.
std::vector<std::string> literals_in(std::string_view line) {
    std::vector<std::string> out;
    bool inside = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const char c = line[i];
        if (!inside && line.substr(i).starts_with("//")) break;
        if (!inside && line.substr(i).starts_with("'\"'")) {
            i += 2;
        } else if (c == '"') {
            inside = !inside;
            if (inside) out.emplace_back();
        } else if (inside) {
            if (c == '\\' && i + 1 < line.size()) {
                out.back() += ' ';  // what is escaped is no letter of a name
                ++i;
            } else {
                out.back() += c;
            }
        }
    }
    return out;
}

/// The name that a literal repeats; empty for none. An ending counts alone or beside another: a file's name may have one.
std::string_view repeated(std::string_view file, std::string_view literal, const std::vector<Known>& names) {
    std::string_view ending;
    for (const Known& known : names) {
        if (file.starts_with(known.folder) && file.size() > known.folder.size() && file[known.folder.size()] == '/') continue;
        if (literal == known.name) return known.name;
        if (known.name.starts_with('.')) {
            if (literal.find(known.name) == std::string_view::npos) continue;
            if (!ending.empty()) return known.name;
            ending = known.name;
        } else if (!is_common(known.name) && holds_word(literal, known.name)) {
            return known.name;
        }
    }
    return {};
}

/// Each for its reason.
bool is_meant(std::string_view file, std::string_view name) {
    using Pair = std::pair<std::string_view, std::string_view>;
    static const std::vector<Pair> meant = {
        {"tools/cli/bake.cpp", ".obj"},                // an example of use: two files
        {"tools/cli/replay.cpp", "best-first"},        // an example of use
        {"systemd/daemon/options.cpp", "osmesa"},      // an example of use
        {"tools/cli/devices_watch.cpp", "device"},     // what is plugged in
        {"tools/cli/devices_map.cpp", "device"},       // the same
        {"tools/cli/devices_list.cpp", "device"},      // the same
        {"tools/cli/devices_record.cpp", "device"},    // the same
        {"render/gl/program.cpp", "vertex_colour"},    // an attribute of the shaders
        {"tools/scenes/write_glb.cpp", "mesh"},        // glTF's word
        {"tools/selftest/transforms.cpp", "flat"},     // the name of an object in a scene
        {"render/import/gltf_material.cpp", "flat"},   // how a surface is lit
        {"tools/selftest/fixtures.cpp", "two-stage"},  // a settings file as a user writes it
        // A study of a plain.
        {"tools/cache_study/study_scenes.cpp", "flat"},
    };
    return std::find(meant.begin(), meant.end(), Pair{file, name}) != meant.end();
}

TEST(Names, OfRegistryEntriesStandInTheirFolderAlone) {
    const std::vector<Known> names = known_names();
    ASSERT_GT(names.size(), 20U);
    std::size_t files = 0;
    for (const auto* top : {"config", "tools", "systemd", "rt", "render"}) {
        for (const auto& entry : fs::recursive_directory_iterator(tree / top)) {
            const auto kind = entry.path().extension();
            if (!entry.is_regular_file() || (kind != ".cpp" && kind != ".hpp")) continue;
            ++files;
            const std::string file = fs::relative(entry.path(), tree).generic_string();
            std::ifstream stream(entry.path());
            std::size_t number = 0;
            for (std::string line; std::getline(stream, line);) {
                ++number;
                if (line.starts_with("#include")) continue;
                for (const std::string& literal : literals_in(line)) {
                    const std::string_view name = repeated(file, literal, names);
                    EXPECT_TRUE(name.empty() || is_meant(file, name))
                        << file << ":" << number << " repeats '" << name << "' in \"" << literal << "\"";
                }
            }
        }
    }
    EXPECT_GT(files, 200U) << "the sources were not found";
}

/// The name of a scene that a literal has in it, in a path or a text too; empty for none. "room" is also a place in memory: it
/// counts alone, and before the ending of a file.
std::string scene_in(std::string_view literal) {
    std::string text;
    for (const char c : literal) text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    std::vector<std::string> names = scenes::scene_names();
    for (const char* const measured : {"hospital", "keflavik", "candela", "ravenbridge", "cocoa"}) names.emplace_back(measured);
    for (const std::string& name : names) {
        const auto at = text.find(name);
        if (at == std::string::npos) continue;
        const bool file = text.size() > at + name.size() + 1 && text[at + name.size()] == '.' &&
                          std::isalpha(static_cast<unsigned char>(text[at + name.size() + 1])) != 0;
        if (name != "room" || text == name || file) return name;
    }
    return {};
}

TEST(Names, OfScenesAreNowhereInWhatBakesDrawsAndWalks) {
    std::size_t literals = 0;
    for (const auto* top : {"render", "tools/walk"}) {
        for (const auto& entry : fs::recursive_directory_iterator(tree / top)) {
            const auto kind = entry.path().extension();
            if (!entry.is_regular_file() || (kind != ".cpp" && kind != ".hpp")) continue;
            std::ifstream stream(entry.path());
            std::size_t number = 0;
            for (std::string line; std::getline(stream, line);) {
                ++number;
                for (const std::string& literal : literals_in(line)) {
                    ++literals;
                    EXPECT_EQ(scene_in(literal), "") << entry.path() << ":" << number << " goes by a scene's name: " << literal;
                    EXPECT_FALSE(literal.starts_with("tools/scenes/"))
                        << entry.path() << ":" << number << " includes " << literal;
                }
            }
        }
    }
    EXPECT_GT(literals, 1000U) << "the sources were not found";
}

TEST(Names, OfScenesAreFound) {
    EXPECT_EQ(scene_in("forest"), "forest");
    EXPECT_EQ(scene_in("models/Ravenbridge.walk"), "ravenbridge");
    EXPECT_EQ(scene_in("cocoa-temple"), "cocoa");
    EXPECT_EQ(scene_in("room"), "room");
    EXPECT_EQ(scene_in("room.glb"), "room");
    EXPECT_EQ(scene_in("There is room for more."), "");
    EXPECT_EQ(scene_in("room_light"), "");
}

TEST(Names, ThatAreRepeatedAreFound) {
    const std::vector<Known> names = known_names();
    const auto found = [&](std::string_view file, std::string_view line) {
        for (const std::string& literal : literals_in(line))
            if (const auto name = repeated(file, literal, names); !name.empty()) return std::string(name);
        return std::string();
    };
    EXPECT_EQ(found("config/schema.cpp", R"(    {"flat", "distance"})"), "flat");
    EXPECT_EQ(found("tools/cli/x.cpp", R"(help("one of egl, device or window"))"), "egl");
    EXPECT_EQ(found("tools/cli/x.cpp", R"(help("by two-stage-1994"))"), "two-stage-1994");
    EXPECT_EQ(found("tools/cli/x.cpp", R"(if (request.backend == "null"))"), "null");
    EXPECT_EQ(found("tools/cli/x.cpp", R"("files: .glb or .obj")"), ".obj");
    EXPECT_EQ(found("tools/cli/x.cpp", R"(ending == ".ostf")"), ".ostf");
    EXPECT_EQ(found("tools/cli/x.cpp", R"(bit_of("alpha_mask"))"), "alpha_mask");
    EXPECT_EQ(found("render/engine.cpp", R"(c == '"' || selector == "flat")"), "flat");
    EXPECT_EQ(found("tools/cli/x.cpp", R"("surefoot bake lobby.glb")"), "");
    EXPECT_EQ(found("tools/cli/x.cpp", R"(a();  // "flat")"), "");
    EXPECT_EQ(found("tools/cli/x.cpp", R"("a flat roof", "two-stages")"), "");
    EXPECT_EQ(found("render/select/flat_distance.cpp", R"("distance")"), "");
    EXPECT_EQ(found("render/selection/fixed.cpp", R"("distance")"), "distance");
}

}  // namespace
}  // namespace surefoot::house
