// Choice of a generated scene by name, and writing it with its path.
#include "tools/scenes/scenes.hpp"

#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "render/import/formats.hpp"
#include "render/import/ostf.hpp"
#include "rt/base/named.hpp"
#include "tools/scenes/forest.hpp"
#include "tools/scenes/gallery.hpp"
#include "tools/scenes/garden.hpp"
#include "tools/scenes/room.hpp"
#include "tools/scenes/town.hpp"

namespace surefoot::scenes {
namespace {

struct Maker {
    std::string_view name;
    GeneratedScene (*make)(double scale, std::uint64_t seed);
    GeneratedScene (*make_lit)(double scale, std::uint64_t seed) = nullptr;  ///< with lamps; null: it has none
};

constexpr std::array makers{Maker{"forest", make_forest}, Maker{"room", make_room},
                            Maker{town_name, [](double scale, std::uint64_t seed) { return make_town(scale, seed, false); },
                                  [](double scale, std::uint64_t seed) { return make_town(scale, seed, true); }},
                            Maker{"garden", make_garden},
                            Maker{gallery_name, [](double scale, std::uint64_t seed) { return make_gallery(scale, seed, {}); }}};

struct Writer {
    std::string_view name;  ///< the ending of its files
    Result<void> (*write)(const std::string& file, const importer::Scene& scene);
    bool holds_lamps;
};

constexpr std::array writers{
    Writer{importer::glb_ending, write_glb, true},
    Writer{importer::ostf_ending,
           [](const std::string& file, const importer::Scene& scene) { return importer::write_ostf(file, scene, {}); }, false},
};

}  // namespace

std::vector<std::string> scene_names() {
    std::vector<std::string> names;
    names.reserve(std::size(makers));
    for (const Maker& maker : makers) names.emplace_back(maker.name);
    return names;
}

Result<GeneratedScene> generate(std::string_view name, double scale, std::uint64_t seed, bool lamps) {
    if (!(scale >= min_scale && scale <= max_scale))
        return Error{std::string(name), fmt::format("The scale {} is out of range", scale),
                     fmt::format("Choose {} to {}", min_scale, max_scale), ErrorKind::misuse};
    for (const Maker& maker : makers) {
        if (name != maker.name) continue;
        if (lamps && maker.make_lit == nullptr)
            return Error{std::string(name), "The scene has no lamps", fmt::format("Choose {}", town_name), ErrorKind::misuse};
        GeneratedScene made = lamps ? maker.make_lit(scale, seed) : maker.make(scale, seed);
        made.scene.sources.push_back(
            fmt::format("generated: {} at scale {}, seed {}{}", name, scale, seed, lamps ? ", with lamps" : ""));
        return made;
    }
    return Error{std::string(name), "There is no scene of this name", "Choose one of " + names_in_words(makers),
                 ErrorKind::not_found};
}

Result<GeneratedScene> generate_gallery(double scale, std::uint64_t seed, const std::string& statue_file,
                                        const Progress& progress) {
    auto statue = importer::import_files({statue_file}, progress);
    if (!statue) return statue.error();
    if (!(scale >= min_scale && scale <= max_scale))
        return Error{std::string(gallery_name), fmt::format("The scale {} is out of range", scale),
                     fmt::format("Choose {} to {}", min_scale, max_scale), ErrorKind::misuse};
    GeneratedScene made = make_gallery(scale, seed, std::move(*statue));
    made.scene.sources.push_back(
        fmt::format("generated: {} at scale {}, seed {}, with {}", gallery_name, scale, seed, statue_file));
    return made;
}

std::string written_endings() { return names_in_words(writers); }

Result<void> check_ending(const std::string& out, bool lamps) {
    const std::string ending = importer::ending_of(out);
    const Writer* const writer = find_named(writers, ending);
    if (writer != nullptr && lamps && !writer->holds_lamps)
        return Error{out, fmt::format("A file with the ending '{}' holds no lamps", ending),
                     fmt::format("Choose {}", importer::glb_ending), ErrorKind::unsupported};
    if (writer != nullptr) return {};
    const std::string remedy = "Choose one of " + written_endings();
    if (importer::format_of(out) != nullptr)
        return Error{out, fmt::format("Scenes are not written as {}: this format is only read", ending), remedy,
                     ErrorKind::unsupported};
    return Error{out, fmt::format("A scene with the ending '{}' cannot be written", ending), remedy, ErrorKind::unsupported};
}

Result<void> write_scene(const std::string& out, const GeneratedScene& generated) {
    if (auto ok = check_ending(out, false); !ok) return ok;
    if (auto written = find_named(writers, importer::ending_of(out))->write(out, generated.scene); !written) return written;
    return write_path(std::filesystem::path(out).replace_extension(".path.csv").string(), generated.path);
}

}  // namespace surefoot::scenes
