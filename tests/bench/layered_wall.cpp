// Writes a scene whose overdraw is chosen: a wall of panels that fills the view, each of some layers behind each other. Extent,
// number of panels and distance are the same for any number of layers. The path leads along the wall, 60 m before it. What is
// opaque has colours alone, the cheapest pixels; what is masked has a texture with holes, the dearest.
// bench_layered_wall LAYERS opaque|masked OUT.glb -> also OUT.path.csv
#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "tools/scenes/scene_maker.hpp"
#include "tools/scenes/scenes.hpp"
#include "tools/scenes/textures.hpp"

namespace {

using namespace surefoot;
using namespace surefoot::scenes;

constexpr int columns = 32, rows = 16, max_layers = 64;
constexpr double panel_m = 6, gap_m = 0.02, texture_m = 3, depth_m = 4, distance_m = 60;
constexpr double from_x_m = 88, to_x_m = 104, speed_m_s = 1.4;  // the view's ends stay on the wall

/// Upright layers from the back of the panel to its front, those behind first. One alone leans, so that it is as deep.
importer::Mesh panel(int layers, Index material) {
    MeshMaker maker("panel");
    maker.brush.material = material;
    maker.brush.uv_per_m = 1 / texture_m;
    const double side = panel_m - gap_m, back = -0.5 * depth_m;
    for (int layer = 0; layer < layers; ++layer) {
        const double low = layers == 1 ? -back : back + depth_m * layer / (layers - 1), high = layers == 1 ? back : low;
        maker.brush.colour = shade(rgb(110, 140, 60), 0.6 + 0.7 * layer / layers);
        maker.quad({0, 0, low}, {side, 0, low}, {side, side, high}, {0, side, high});
    }
    return maker.take();
}

GeneratedScene wall(int layers, bool masked) {
    SceneMaker maker;
    const Index material =
        masked ? maker.material("leaves", {255, 255, 255, 255}, maker.image(leaves(1, rgb(46, 84, 30), rgb(126, 160, 62))),
                                model::AlphaMode::mask, true)
               : maker.material("paint", {255, 255, 255, 255}, importer::none, model::AlphaMode::opaque, true);
    const Index mesh = maker.mesh(panel(layers, material));
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            maker.node(fmt::format("panel {},{}", column, row), importer::none, mesh,
                       move({column * panel_m, row * panel_m, -distance_m}));
    GeneratedScene made{std::move(maker.scene), {}};
    for (const double x : {from_x_m, to_x_m}) {
        PathSample sample;
        sample.time_s = (x - from_x_m) / speed_m_s;
        sample.pose.position = {x, 0.5 * rows * panel_m, 0};
        made.path.samples.push_back(sample);
    }
    return made;
}

}  // namespace

int main(int argc, char** argv) {
    const int layers = argc > 1 ? std::atoi(argv[1]) : 0;
    const std::string surface = argc > 2 ? argv[2] : "", out = argc > 3 ? argv[3] : "";
    if (layers < 1 || layers > max_layers || (surface != "opaque" && surface != "masked") || out.empty())
        return fmt::print(stderr, "bench_layered_wall LAYERS opaque|masked OUT.glb: layers are 1 to {}\n", max_layers), 2;
    if (auto written = write_scene(out, wall(layers, surface == "masked")); !written)
        return fmt::print(stderr, "{}\n", written.error().text()), 1;
    return 0;
}
