// baked_forest FOLDER: writes the small forest that tests walk through, and its path. One bake for the test programs of a build.
#include <fmt/format.h>

#include <cstdio>
#include <string>

#include "render/bake/bake.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/path.hpp"
#include "tools/scenes/scenes.hpp"

namespace {

int fail(const surefoot::Error& error) {
    fmt::print(stderr, "baked_forest: {}\n", error.text());
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    using namespace surefoot;
    if (argc != 2) return fail({"FOLDER", "is missing", "give one"});
    const std::string folder = argv[1];
    auto scene = scenes::generate("forest", 4, 1);
    if (!scene) return fail(scene.error());
    auto model = bake::bake(scene->scene, {}, {});
    if (!model) return fail(model.error());
    if (auto written = model::write_walk(folder + "/forest.walk", *model); !written) return fail(written.error());
    if (auto written = write_path(folder + "/forest.path.csv", scene->path); !written) return fail(written.error());
    return 0;
}
