// The garden: beds, hedges and an orchard on a lawn, a path through them, fences around, wires overhead.
#include "tools/scenes/garden.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "rt/base/random.hpp"
#include "tools/scenes/garden_plants.hpp"
#include "tools/scenes/noise.hpp"
#include "tools/scenes/path_maker.hpp"
#include "tools/scenes/scatter.hpp"
#include "tools/scenes/textures.hpp"

namespace surefoot::scenes {
namespace {

using importer::none;

constexpr double garden_side_m = 40.0, garden_eye_m = 1.6, edge_m = 1.5, wire_height_m = 5.75;
constexpr dvec2 shed_at(0.9, 0.88);  // of the side
constexpr int plot_cells = 10;

/// What plants, path and ground agree on.
struct Plot {
    double side = 40;
    std::uint64_t seed = 0;
    std::vector<Waypoint> way;

    Plot(double scale, std::uint64_t from) : side(garden_side_m * std::sqrt(scale)), seed(from) {
        for (const auto& [u, v] : {std::pair{0.12, 0.14},
                                   {0.32, 0.24},
                                   {0.52, 0.15},
                                   {0.78, 0.24},
                                   {0.93, 0.5},
                                   {0.62, 0.56},
                                   {0.4, 0.46},
                                   {0.2, 0.6},
                                   {0.26, 0.84},
                                   {0.55, 0.8}})
            way.push_back({{u * side, garden_eye_m, v * side}, {}, true, 0});
    }
    [[nodiscard]] double height(double x, double z) const { return 0.5 * rough_noise(x / 14.0, z / 14.0, seed) - 0.25; }
    [[nodiscard]] dmat4 upright(const dvec2& p, double about, double size) const {
        return move({p.x, height(p.x, p.y), p.y}) * turn_y(about) * stretch(dvec3(size));
    }
};

/// A part of the lawn; the path is gravel by its vertices' colours.
importer::Mesh lawn_part(const Plot& plot, const Scatter& path, Index material, const dvec2& from, double length) {
    MeshMaker maker("lawn");
    maker.brush.material = material;
    maker.brush.uv_per_m = length / 2;  // the surface has 0..1 across it: a texture is 2 m
    maker.surface(plot_cells, plot_cells, [&](double u, double v) {
        const double x = from.x + v * length, z = from.y + u * length;
        return dvec3(x, plot.height(x, z), z);
    });
    importer::Mesh mesh = maker.take();
    for (importer::Primitive& p : mesh.primitives) {
        p.colours.clear();
        for (const vec3& at : p.positions) {
            const double patch = rough_noise(at.x / 3.0, at.z / 3.0, plot.seed + 3);
            const bool gravel = !path.free({at.x, at.z}, 0.9);
            p.colours.push_back(gravel ? rgb(236, 214, 178) : mix(rgb(104, 136, 70), rgb(150, 172, 92), patch));
        }
    }
    return mesh;
}

void lay_lawn(SceneMaker& maker, const Plot& plot, const Scatter& path) {
    const Index turf = maker.material("turf", {255, 255, 255, 255},
                                      maker.image(speckle(plot.seed, rgb(150, 150, 140), rgb(255, 255, 250), "turf")));
    const Index group = maker.node("lawn", none, none, dmat4(1.0));
    const int parts = std::max(1, static_cast<int>(std::lround(plot.side / 5.0)));
    const double length = plot.side / parts;
    for (int row = 0; row < parts; ++row) {
        for (int column = 0; column < parts; ++column) {
            const Index mesh = maker.mesh(lawn_part(plot, path, turf, {column * length, row * length}, length));
            maker.node(fmt::format("lawn {},{}", column, row), group, mesh, dmat4(1.0));
        }
    }
}

/// One kind of plant: how many a square metre, how far from the path and from each other.
struct Planting {
    const char* name = "";
    importer::Mesh (*make)(const GardenMaterials&, std::uint64_t) = nullptr;
    double a_square_m = 0, clearance_m = 1, apart_m = 1;
};
constexpr std::array plantings{Planting{"apple tree", apple_tree, 0.015, 2.6, 4.5}, Planting{"hedge", hedge, 0.05, 2.2, 1.2},
                               Planting{"fern", fern_of_fronds, 0.12, 1.2, 0.8}, Planting{"rose", rose, 0.08, 1.3, 0.9},
                               Planting{"tuft", tuft_of_blades, 1.6, 1.0, 0.2}};
constexpr std::size_t varieties = 3;

void plant(SceneMaker& maker, const Plot& plot, const GardenMaterials& materials, const Scatter& path, Random& random) {
    for (std::size_t k = 0; k < plantings.size(); ++k) {
        const Planting& kind = plantings[k];
        std::array<Index, varieties> meshes{};
        for (std::size_t i = 0; i < varieties; ++i) meshes[i] = maker.mesh(kind.make(materials, plot.seed + 100 * k + i));
        const Index group = maker.node(fmt::format("{}s", kind.name), none, none, dmat4(1.0));
        const auto count = std::max(1L, std::lround(kind.a_square_m * plot.side * plot.side));
        Scatter placed(std::max(0.5, kind.apart_m));
        long number = 0;
        for (long tries = 0; number < count && tries < 40 * count; ++tries) {
            const double z = random.range(edge_m, plot.side - edge_m), x = random.range(edge_m, plot.side - edge_m);
            const double about = random.range(0, 2 * pi), size = random.range(0.85, 1.15);
            const dvec2 p(x, z);
            const bool on_shed = glm::length(p - shed_at * plot.side) < 2.8;
            if (on_shed || !path.free(p, kind.clearance_m) || !placed.free(p, kind.apart_m)) continue;
            placed.add(p);
            maker.node(fmt::format("{} {}", kind.name, number++), group, meshes[random.below(varieties)],
                       plot.upright(p, about, size));
        }
    }
}

/// Pickets on two sides, wire mesh on the others.
void fence_in(SceneMaker& maker, const Plot& plot, const GardenMaterials& materials) {
    const Index pickets = maker.mesh(picket_panel(materials)), wires = maker.mesh(wire_panel(materials));
    const Index group = maker.node("fences", none, none, dmat4(1.0));
    const int panels = std::max(2, static_cast<int>(std::floor((plot.side - edge_m) / panel_m)));
    const double low = 0.5 * (plot.side - panels * panel_m), high = plot.side - low;
    for (int i = 0; i < panels; ++i) {
        const double a = low + i * panel_m, b = a + panel_m;
        const auto place = [&](const char* name, Index mesh, const dvec2& at, double about) {
            maker.node(fmt::format("{} {}", name, i), group, mesh, plot.upright(at, about, 1.0));
        };
        place("front", pickets, {a, low}, 0);
        place("back", wires, {b, high}, pi);
        place("left", wires, {low, b}, 0.5 * pi);
        place("right", pickets, {high, a}, -0.5 * pi);
    }
    MeshMaker post("post");
    post.brush.material = materials.wood;
    post.brush.colour = rgb(96, 108, 96);
    post.rod({0, -0.2, 0}, {0, 1.6, 0}, 0.025, 8);
    const Index last_post = maker.mesh(post.take());
    for (const dvec2& at : {dvec2(low, high), dvec2(low, low)})  // where the wire mesh ends
        maker.node("post", group, last_post, plot.upright(at, 0, 1.0));
}

/// Three wires from pole to pole across the garden, and a line for clothes.
void hang_wires(SceneMaker& maker, const Plot& plot, const GardenMaterials& materials) {
    const Index group = maker.node("wires", none, none, dmat4(1.0));
    const auto wire = [&](const std::string& name, const dvec3& from, const dvec3& to, double sag_m, double radius) {
        MeshMaker made(name);
        made.brush.material = materials.wood;
        made.brush.colour = rgb(40, 40, 44);
        constexpr int parts = 16;
        std::vector<dvec3> centres;
        for (int i = 0; i <= parts; ++i) {
            const double t = static_cast<double>(i) / parts;
            centres.push_back(glm::mix(from, to, t) - dvec3(0, 4 * sag_m * t * (1 - t), 0));
        }
        made.tube(centres, std::vector<double>(centres.size(), radius), 4, false);
        maker.node(name, group, maker.mesh(made.take()), dmat4(1.0));
    };
    MeshMaker pole("pole");
    pole.brush.material = materials.bark;
    pole.brush.colour = rgb(110, 90, 70);
    pole.rod({0, -0.4, 0}, {0, 6, 0}, 0.1, 10);
    pole.box({-0.7, 5.6, -0.05}, {0.7, 5.7, 0.05});
    const Index pole_mesh = maker.mesh(pole.take());
    constexpr int poles = 4;
    const auto at = [&](int i) {
        const double x = (0.04 + 0.92 * i / (poles - 1)) * plot.side, z = 0.35 * plot.side;
        return dvec3(x, plot.height(x, z), z);
    };
    for (int i = 0; i < poles; ++i)
        maker.node(fmt::format("pole {}", i), group, pole_mesh, plot.upright({at(i).x, at(i).z}, 0.5 * pi, 1.0));
    for (int i = 0; i + 1 < poles; ++i)
        for (const double beside : {-0.6, 0.0, 0.6})
            wire(fmt::format("wire {} {}", i, beside), at(i) + dvec3(0, wire_height_m, beside),
                 at(i + 1) + dvec3(0, wire_height_m, beside), 0.6, 0.006);
    const dvec3 line(0.3 * plot.side, plot.height(0.3 * plot.side, 0.7 * plot.side) + 1.9, 0.7 * plot.side);
    wire("clothes line", line, line + dvec3(0.12 * plot.side, 0, 0.03 * plot.side), 0.15, 0.004);
}

void build_shed(SceneMaker& maker, const Plot& plot, const GardenMaterials& materials) {
    const Index boards = maker.material("boards", {255, 255, 255, 255}, maker.image(planks(plot.seed + 5, rgb(150, 116, 82))));
    const Index tiles = maker.material("tiles", {255, 255, 255, 255}, maker.image(roof_tiles(plot.seed + 6, rgb(168, 92, 66))));
    MeshMaker shed("shed");
    shed.brush.material = boards;
    shed.box({-1.6, -0.3, -1.2}, {1.6, 2.1, 1.2});
    shed.triangle({1.6, 2.1, 1.2}, {1.6, 2.1, -1.2}, {1.6, 2.9, 0});
    shed.triangle({-1.6, 2.1, -1.2}, {-1.6, 2.1, 1.2}, {-1.6, 2.9, 0});
    shed.brush.material = tiles;
    shed.brush.uv_per_m = 0.5;
    shed.quad({-1.8, 2.0, 1.4}, {1.8, 2.0, 1.4}, {1.8, 2.95, 0}, {-1.8, 2.95, 0});
    shed.quad({1.8, 2.0, -1.4}, {-1.8, 2.0, -1.4}, {-1.8, 2.95, 0}, {1.8, 2.95, 0});
    shed.brush.material = materials.wood;
    shed.brush.colour = rgb(70, 96, 84);
    shed.box({-0.45, 0, 1.2}, {0.45, 1.95, 1.24});
    maker.node("shed", none, maker.mesh(shed.take()), plot.upright(shed_at * plot.side, -2.3, 1.0));
}

Path stroll(const Plot& plot, double scale) {
    std::vector<Waypoint> way = plot.way;
    const auto look = [&](std::size_t i, double u, double up, double v, double pause_s) {
        way[i].ahead = false;
        way[i].look = {u * plot.side, up, v * plot.side};
        way[i].pause_s = pause_s;
    };
    look(0, 0.02, 0.9, 0.02, 1.0);  // to the corner of both fences
    look(3, 0.99, 0.6, 0.3, 0);     // over to the pickets
    look(6, 0.5, 4.5, 0.33, 1.0);   // up to the wires, before the sky
    look(8, 0.02, 0.8, 0.9, 1.0);   // through the wire mesh
    look(9, 0.45, 1.0, 0.35, 3.0);  // back over it all
    const double duration_s = std::clamp(60.0 * std::sqrt(scale), 20.0, 240.0);
    return make_path(way, duration_s, [&](double x, double z) { return plot.height(x, z); });
}

}  // namespace

GeneratedScene make_garden(double scale, std::uint64_t seed) {
    Random random(seed);
    const Plot plot(scale, seed);
    SceneMaker maker;
    const GardenMaterials materials = garden_materials(maker, seed);
    Scatter path(1.0);
    for (const dvec3& p : curve_points(plot.way, 0.3)) path.add({p.x, p.z});
    lay_lawn(maker, plot, path);
    plant(maker, plot, materials, path, random);
    fence_in(maker, plot, materials);
    hang_wires(maker, plot, materials);
    build_shed(maker, plot, materials);
    return {std::move(maker.scene), stroll(plot, scale)};
}

}  // namespace surefoot::scenes
