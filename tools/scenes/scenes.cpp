// Choice of a generated scene by name, and writing it with its path.
#include "tools/scenes/scenes.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "render/import/ostf.hpp"
#include "tools/scenes/forest.hpp"
#include "tools/scenes/room.hpp"
#include "tools/scenes/town.hpp"
#include "tools/scenes/writers.hpp"

namespace surefoot::scenes {
namespace {

struct Maker {
    const char* name;
    GeneratedScene (*make)(double scale, std::uint64_t seed);
};

constexpr std::array makers{Maker{"forest", make_forest}, Maker{"room", make_room}, Maker{"town", make_town}};

std::string names_in_words() {
    std::string out;
    for (const Maker& maker : makers) out += (out.empty() ? "" : ", ") + std::string(maker.name);
    return out;
}

Result<void> write_model(const std::string& out, const importer::Scene& scene) {
    std::string ending = std::filesystem::path(out).extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (ending == ".glb") return write_glb(out, scene);
    if (ending == ".obj") return write_obj(out, scene);
    if (ending == ".ostf") return importer::write_ostf(out, scene, {});
    return Error{out, fmt::format("cannot write a scene with the ending '{}'", ending), "choose .glb, .obj or .ostf"};
}

}  // namespace

std::vector<std::string> scene_names() {
    std::vector<std::string> names;
    for (const Maker& maker : makers) names.emplace_back(maker.name);
    return names;
}

Result<GeneratedScene> generate(std::string_view name, double scale, std::uint64_t seed) {
    if (!(scale >= least_scale && scale <= most_scale))
        return Error{std::string(name), fmt::format("scale {} is out of range", scale),
                     fmt::format("choose {} to {}", least_scale, most_scale)};
    for (const Maker& maker : makers) {
        if (name != maker.name) continue;
        GeneratedScene made = maker.make(scale, seed);
        made.scene.sources.push_back(fmt::format("generated: {} at scale {}, seed {}", name, scale, seed));
        return made;
    }
    return Error{std::string(name), "no scene of this name", "choose one of " + names_in_words()};
}

Result<void> write_scene(const std::string& out, const GeneratedScene& generated) {
    if (auto written = write_model(out, generated.scene); !written) return written;
    return write_path(std::filesystem::path(out).replace_extension(".path.csv").string(), generated.path);
}

}  // namespace surefoot::scenes
