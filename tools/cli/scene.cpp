// surefoot scene: writes a generated scene and its path.
#include <filesystem>
#include <limits>

#include <fmt/format.h>

#include "rt/base/file.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/options.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::cli {

namespace {
struct SceneArguments {
    std::string name, out, statue;
    double scale = 1;
    std::uint64_t seed = 1;
    bool json = false, lamps = false;
};

int run_scene(const SceneArguments& a, const Context& context) {
    if (auto ok = scenes::check_ending(a.out, a.lamps); !ok) return fail(ok.error());
    const std::string path = std::filesystem::path(a.out).replace_extension(".path.csv").string();
    for (const std::string& out : {a.out, path}) {
        if (auto ok = probe_writable(out); !ok) return fail(ok.error());
    }
    if (!a.statue.empty() && a.name != scenes::gallery_name)
        return misuse({"--cow", "Only the gallery has a place for a statue",
                       "Remove the option, or write `surefoot scene gallery`", ErrorKind::misuse});
    if (a.lamps && a.name != scenes::town_name)
        return misuse(
            {"--lamps", "Only the town has lamps", "Remove the option, or write `surefoot scene town`", ErrorKind::misuse});
    auto scene = a.statue.empty() ? scenes::generate(a.name, a.scale, a.seed, a.lamps)
                                  : scenes::generate_gallery(a.scale, a.seed, a.statue, terminal_progress(context));
    end_progress(context);
    if (!scene) return fail(scene.error());
    if (context.stop->load())
        return fail({a.out, "The work was stopped by the user, and nothing was written", "", ErrorKind::stopped});
    if (auto written = scenes::write_scene(a.out, *scene); !written) return fail(written.error());
    for (const importer::Damage& damage : scene->scene.damage) notify(damage.file + ": " + damage.what + ".");
    const std::uint64_t triangles = scene->scene.triangles();
    if (a.json) {
        print_json({{"scene", a.name},
                    {"scale", a.scale},
                    {"seed", a.seed},
                    {"file", a.out},
                    {"path", path},
                    {"triangles", triangles},
                    {"lamps", scene->scene.lamps.size()},
                    {"objects", scene->scene.nodes.size()},
                    {"path_s", scene->path.duration_s()}});
    } else {
        fmt::print("{}: {} triangles in {} nodes; path of {:.0f} s in {}\n", a.out, triangles, scene->scene.nodes.size(),
                   scene->path.duration_s(), path);
    }
    return exit_success;
}
}  // namespace

void add_scene(CLI::App& app, Context& context) {
    auto a = std::make_shared<SceneArguments>();
    CLI::App* c = add_command(app, "scene", "Generate a scene and a path through it",
                              "surefoot scene town --scale 1 --seed 1 -o town.glb", a->json);
    const std::vector<std::string> words = scenes::scene_names();
    const std::vector<std::string_view> names(words.begin(), words.end());
    c->add_option("name", a->name,
                  "Scene: forest (100 trees at scale 1), room, town (about 1 M triangles at scale 1), garden (masked plants). "
                  "Or gallery: two spheres, a cylinder and a statue")
        ->required()
        ->check(one_of(names));
    c->add_option("--cow", a->statue, "Of the gallery: model file of its statue, in place of a knot. It is made 1.2 m long")
        ->check(names_something());
    c->add_flag("--lamps", a->lamps, "Of the town: its lamps shine, and windows glow. The file must be a .glb");
    c->add_option("--scale", a->scale, "Factor on the size of the scene")
        ->check(number_within(scenes::min_scale, scenes::max_scale))
        ->capture_default_str();
    c->add_option("--seed", a->seed, "Random seed; the same seed gives the same file, bit for bit")
        ->check(whole_number_within(0, std::numeric_limits<std::uint64_t>::max()))
        ->capture_default_str();
    c->add_option("-o,--out", a->out,
                  "Output file; its ending is the format: " + scenes::written_endings() + ". The path goes to OUT.path.csv")
        ->required();
    c->callback([&context, a] { context.run = [a, &context] { return run_scene(*a, context); }; });
}

}  // namespace surefoot::cli
