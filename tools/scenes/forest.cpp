// The forest: trees on rolling ground, a footpath among them, a hill to look back from.
#include "tools/scenes/forest.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "rt/base/random.hpp"
#include "tools/scenes/noise.hpp"
#include "tools/scenes/path_maker.hpp"
#include "tools/scenes/plants.hpp"
#include "tools/scenes/scatter.hpp"
#include "tools/scenes/scene_maker.hpp"

namespace surefoot::scenes {
namespace {

using importer::none;

constexpr double side_at_scale_1_m = 80.0;
constexpr double cell_m = 2.0;
constexpr int tile_cells = 8;
constexpr std::size_t triangles_a_tree = 960, triangles_in_all_a_tree = 1050;
constexpr double eye_height_m = 1.7;

/// Everything that trees, undergrowth and path agree on.
struct Land {
    double side = 80;
    std::uint64_t seed = 0;
    dvec2 hill{0};
    double hill_radius = 24, hill_height = 13;
    std::vector<Waypoint> footpath;

    Land(double scale, std::uint64_t from) : side(side_at_scale_1_m * std::sqrt(scale)), seed(from) {
        const double grow = std::pow(std::max(scale, 0.25), 0.25);
        hill_radius *= grow;
        hill_height *= grow;
        hill = dvec2(side - 0.62 * hill_radius, 0.46 * side);
        const auto at = [&](double x, double z) { footpath.push_back(Waypoint{{x, eye_height_m, z}, {}, true, 0}); };
        for (const auto& [u, v] : {std::pair{0.035, 0.56}, {0.13, 0.50}, {0.24, 0.37}, {0.37, 0.40}, {0.46, 0.56}, {0.56, 0.65}})
            at(u * side, v * side);
        const double r = hill_radius;
        at(hill.x - 0.95 * r, hill.y + 0.35 * r);
        at(hill.x - 0.55 * r, hill.y + 0.42 * r);
        at(hill.x - 0.18 * r, hill.y + 0.22 * r);
        at(hill.x, hill.y);
    }

    [[nodiscard]] double height(double x, double z) const {
        const double rolling = 3.2 * rough_noise(x / 26.0, z / 26.0, seed) - 1.6;
        const double d = std::min(1.0, std::hypot(x - hill.x, z - hill.y) / hill_radius);
        const double bump = 0.5 + 0.5 * std::cos(pi * d);
        return rolling * (1 - 0.8 * bump) + hill_height * std::pow(bump, 1.15);
    }
    [[nodiscard]] double from_hilltop(const dvec2& p) const { return glm::length(p - hill) / hill_radius; }
};

struct Tile {
    const Land& land;
    const Scatter& path;
    const Scatter& trees;

    [[nodiscard]] Colour colour(double x, double z) const {
        const double patch = rough_noise(x / 5.0, z / 5.0, land.seed + 11), broad = noise(x / 17.0, z / 17.0, land.seed + 12);
        Colour c = mix(rgb(86, 104, 46), rgb(138, 146, 70), patch);
        if (!trees.free({x, z}, 4.5)) c = mix(c, mix(rgb(92, 76, 48), rgb(120, 98, 58), patch), 0.75);
        c = mix(c, rgb(70, 92, 40), 0.5 * broad);
        if (!path.free({x, z}, 1.25)) c = mix(c, rgb(156, 136, 98), 0.85);
        return c;
    }
};

/// Coloured by the vertex; heights and normals agree across tiles because both come from the land.
importer::Mesh ground_tile(const Tile& tile, const std::string& name, Index material, int column, int row, int columns, int rows,
                           double step) {
    importer::Mesh mesh{name, {}};
    importer::Primitive p;
    p.material = material;
    const auto h = [&](double x, double z) { return tile.land.height(x, z); };
    for (int r = 0; r <= rows; ++r) {
        for (int c = 0; c <= columns; ++c) {
            const double x = (column + c) * step, z = (row + r) * step, e = 0.5 * step;
            p.positions.emplace_back(dvec3(x, h(x, z), z));
            p.normals.emplace_back(glm::normalize(dvec3(h(x - e, z) - h(x + e, z), 2 * e, h(x, z - e) - h(x, z + e))));
            p.colours.push_back(tile.colour(x, z));
        }
    }
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            const auto i = static_cast<std::uint32_t>(r * (columns + 1) + c), down = i + static_cast<std::uint32_t>(columns) + 1;
            p.indices.insert(p.indices.end(), {i, down, down + 1, i, down + 1, i + 1});
        }
    }
    mesh.primitives.push_back(std::move(p));
    return mesh;
}

struct Kind {
    Index mesh = none;
    const char* name = "";
    double clearance_m = 1.5;  ///< between trunk and footpath: low boughs stay out of the walker's face
};

TreeShape oak_shape() {
    return {.height = 12,
            .crown_base = 3.6,
            .crown_radius = 4.0,
            .trunk_radius = 0.30,
            .branches = 10,
            .leaf_length = 1.25,
            .leaf_width = 0.40,
            .clump_radius = 1.45};
}

TreeShape old_oak_shape() {
    TreeShape shape = oak_shape();
    shape.height = 10;
    shape.crown_base = 3.2;
    shape.crown_radius = 4.4;
    shape.dark = rgb(62, 92, 28);
    shape.light = rgb(150, 168, 58);
    return shape;
}

TreeShape birch_shape() {
    return {.height = 13,
            .crown_base = 4.4,
            .crown_radius = 2.5,
            .trunk_radius = 0.15,
            .branches = 10,
            .leaf_length = 0.95,
            .leaf_width = 0.30,
            .clump_radius = 1.1,
            .bark = rgb(222, 218, 206),
            .dark = rgb(84, 122, 44),
            .light = rgb(178, 196, 84),
            .bark_marks = true};
}

TreeShape beech_shape() {
    return {.height = 15,
            .crown_base = 4.6,
            .crown_radius = 3.6,
            .trunk_radius = 0.27,
            .branches = 9,
            .leaf_length = 1.2,
            .leaf_width = 0.38,
            .clump_radius = 1.5,
            .bark = rgb(132, 126, 116),
            .dark = rgb(112, 68, 30),
            .light = rgb(206, 138, 56)};
}

TreeShape pine_shape() {
    return {.height = 16,
            .crown_base = 8.5,
            .crown_radius = 2.6,
            .trunk_radius = 0.22,
            .branches = 8,
            .leaf_length = 1.05,
            .leaf_width = 0.17,
            .clump_radius = 0.9,
            .needles = true,
            .bark = rgb(150, 92, 58),
            .dark = rgb(30, 62, 40),
            .light = rgb(92, 128, 74)};
}

std::vector<Kind> tree_kinds(SceneMaker& maker, const PlantMaterials& plants, std::uint64_t seed) {
    std::vector<Kind> kinds;
    const auto broad = [&](const char* name, const TreeShape& shape, double clearance) {
        kinds.push_back(
            {maker.mesh(broad_tree(name, plants, shape, triangles_a_tree, seed + kinds.size() * 77)), name, clearance});
    };
    broad("oak", oak_shape(), 1.6);
    broad("old oak", old_oak_shape(), 1.7);
    broad("birch", birch_shape(), 1.4);
    broad("beech", beech_shape(), 1.6);
    broad("pine", pine_shape(), 1.4);
    kinds.push_back({maker.mesh(spruce("spruce", plants, 14.0, 2.7, triangles_a_tree, seed + 900)), "spruce", 3.6});
    kinds.push_back({maker.mesh(spruce("young spruce", plants, 8.0, 2.0, triangles_a_tree, seed + 901)), "young spruce", 3.0});
    return kinds;
}

/// Groves: neighbours are mostly of one kind.
const Kind& kind_at(const std::vector<Kind>& kinds, const dvec2& p, std::uint64_t seed, Random& random) {
    const double grove = noise(p.x / 15.0, p.y / 15.0, seed + 5) * 0.75 + random.unit() * 0.25;
    const double spread = std::clamp((grove - 0.18) / 0.64, 0.0, 0.9999);
    return kinds[static_cast<std::size_t>(spread * static_cast<double>(kinds.size()))];
}

dmat4 upright(const Land& land, const dvec2& p, double size, Random& random) {
    const double sideways = random.range(-0.035, 0.035), forward = random.range(-0.035, 0.035);
    const double tall = random.range(0.92, 1.1), about = random.range(0, 2 * pi);
    return move({p.x, land.height(p.x, p.y), p.y}) * turn(forward, dvec3(1, 0, 0)) * turn(sideways, dvec3(0, 0, 1)) *
           turn_y(about) * stretch(dvec3(size, size * tall, size));
}

void plant_trees(SceneMaker& maker, const Land& land, const PlantMaterials& plants, const Scatter& path, std::size_t count,
                 Scatter& trees, Random& random) {
    const std::vector<Kind> kinds = tree_kinds(maker, plants, land.seed);
    const Index group = maker.node("trees", none, none, dmat4(1.0));
    double apart = 4.4;
    std::size_t refused = 0;
    for (std::size_t planted = 0; planted < count;) {
        const double z = random.range(0.015 * land.side, 0.985 * land.side),
                     x = random.range(0.13 * land.side, 0.985 * land.side);
        const dvec2 p(x, z);
        const Kind& kind = kind_at(kinds, p, land.seed, random);
        const bool fits = land.from_hilltop(p) > 0.42 && path.free(p, kind.clearance_m) && trees.free(p, apart);
        if (!fits) {
            if (++refused % 400 == 0) apart *= 0.95;
            continue;
        }
        trees.add(p);
        maker.node(fmt::format("{} {}", kind.name, planted), group, kind.mesh, upright(land, p, random.range(0.8, 1.2), random));
        ++planted;
    }
}

/// Ferns under trees, grass in the open, rocks and logs here and there: exactly as many triangles as are left.
void plant_undergrowth(SceneMaker& maker, const Land& land, const PlantMaterials& plants, const Scatter& path,
                       const Scatter& trees, std::size_t triangles, Random& random) {
    const Index group = maker.node("undergrowth", none, none, dmat4(1.0));
    const std::array<Index, 2> ferns{maker.mesh(fern(plants, land.seed + 31)), maker.mesh(fern(plants, land.seed + 32))};
    const std::array<Index, 2> tufts{maker.mesh(grass_tuft(plants, land.seed + 33)),
                                     maker.mesh(grass_tuft(plants, land.seed + 34))};
    const std::array<Index, 2> rocks{maker.mesh(rock(plants, land.seed + 35)), maker.mesh(rock(plants, land.seed + 36))};
    const Index log = maker.mesh(fallen_log(plants, land.seed + 37));
    std::size_t number = 0;
    const auto place = [&](const char* name, Index mesh, const dvec2& p, double size) {
        const dmat4 where =
            move({p.x, land.height(p.x, p.y) - 0.02, p.y}) * turn_y(random.range(0, 2 * pi)) * stretch(dvec3(size));
        maker.node(fmt::format("{} {}", name, number++), group, mesh, where);
    };
    while (triangles >= 10) {
        const double z = random.range(0.02, 0.98) * land.side, x = random.range(0.02, 0.98) * land.side;
        const dvec2 p(x, z);
        if (!path.free(p, 0.9) || !trees.free(p, 0.5)) continue;
        const bool shady = !trees.free(p, 4.0), beside_path = !path.free(p, 5.0);
        if (!beside_path && random.unit() < 0.6) continue;  // more where the walker sees it
        const double dice = random.unit();
        const std::size_t which = random.below(2);
        if (dice < 0.02 && triangles >= 60 && path.free(p, 3.2)) {
            place("log", log, p, random.range(0.8, 1.2));
            triangles -= 60;
        } else if (dice < 0.14 && triangles >= 20) {
            place("rock", rocks[which], p, random.range(0.4, 1.1));
            triangles -= 20;
        } else if (shady && dice < 0.75 && triangles >= 40) {
            place("fern", ferns[which], p, random.range(0.8, 1.5));
            triangles -= 40;
        } else {
            place("grass", tufts[which], p, random.range(0.8, 1.6));
            triangles -= 10;
        }
    }
}

std::size_t lay_ground(SceneMaker& maker, const Land& land, Index earth, const Scatter& path, const Scatter& trees) {
    const int cells = std::max(4, static_cast<int>(std::lround(land.side / cell_m)));
    const double step = land.side / cells;
    const Index group = maker.node("ground", none, none, dmat4(1.0));
    const Tile tile{land, path, trees};
    std::size_t triangles = 0;
    for (int row = 0; row < cells; row += tile_cells) {
        for (int column = 0; column < cells; column += tile_cells) {
            const int columns = std::min(tile_cells, cells - column), rows = std::min(tile_cells, cells - row);
            const std::string name = fmt::format("ground {},{}", column / tile_cells, row / tile_cells);
            maker.node(name, group, maker.mesh(ground_tile(tile, name, earth, column, row, columns, rows, step)), dmat4(1.0));
            triangles += static_cast<std::size_t>(columns * rows) * 2;
        }
    }
    return triangles;
}

/// In among the trees, glances at them, up the hill, round, and a long look back over it all.
Path walk_through(const Land& land, double scale) {
    std::vector<Waypoint> way = land.footpath;
    const double top = land.height(land.hill.x, land.hill.y) + eye_height_m;
    const auto glance = [&](std::size_t i, const dvec3& at, double pause_s) {
        way[i].ahead = false;
        way[i].look = at;
        way[i].pause_s = pause_s;
    };
    const auto beside = [&](std::size_t i, double dx, double up, double dz) {
        const double x = way[i].eye.x + dx, z = way[i].eye.z + dz;
        return dvec3(x, land.height(x, z) + up, z);
    };
    glance(2, beside(2, 8, 4.0, -5), 0);
    glance(4, beside(4, -2.5, 0.2, 2.5), 1.0);
    const std::size_t last = way.size() - 1;
    glance(last - 1, {0.5 * land.side, 6.0, 0.9 * land.side}, 0);
    glance(last, {0.25 * land.side, top - 7.0, 0.35 * land.side}, 5.0);
    const double duration_s = std::clamp(60.0 * std::sqrt(scale), 20.0, 240.0);
    return make_path(way, duration_s, [&](double x, double z) { return land.height(x, z); });
}

}  // namespace

GeneratedScene make_forest(double scale, std::uint64_t seed) {
    Random random(seed);
    const Land land(scale, seed);
    SceneMaker maker;
    const Index earth = maker.material("earth");
    const PlantMaterials plants{maker.material("bark"),
                                maker.material("leaves", {255, 255, 255, 255}, none, model::AlphaMode::opaque, true)};
    Scatter path(2.0), trees(5.0);
    for (const dvec3& p : curve_points(land.footpath, 0.4)) path.add({p.x, p.z});
    const auto count = std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(100.0 * scale)));
    plant_trees(maker, land, plants, path, count, trees, random);
    const std::size_t ground = lay_ground(maker, land, earth, path, trees);
    const std::size_t used = count * triangles_a_tree + ground, wanted = count * triangles_in_all_a_tree;
    plant_undergrowth(maker, land, plants, path, trees, wanted > used ? wanted - used : 0, random);
    return {std::move(maker.scene), walk_through(land, scale)};
}

}  // namespace surefoot::scenes
