// The town: where streets, blocks, houses, trees and lamps go, and the walk through it.
#include "tools/scenes/town.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "rt/base/random.hpp"
#include "tools/scenes/path_maker.hpp"
#include "tools/scenes/textures.hpp"

namespace surefoot::scenes {
namespace {

using importer::none;

constexpr double block = 38, road = 6, pitch = block + road, pavement = 2;
constexpr double kerb = 0.12;  ///< height of pavements, squares and house floors
constexpr int houses_a_row = 4;
constexpr double eye = 1.7 + kerb;
constexpr int visited_plot = 2;  ///< of the south row of the block at 0, 0: the house that the path enters

/// Of a lit town, linear RGB: the warm white of its lamps, and the light of what glows.
constexpr vec3 warm(1.0F, 0.72F, 0.42F);
constexpr float lamp_glow = 4.0F, window_glow = 2.0F;

TownStuff make_town_stuff(SceneMaker& maker, std::uint64_t seed, bool lit) {
    TownStuff t;
    t.stuff = make_stuff(maker, seed);
    const auto textured = [&](const char* name, image::Image image) {
        return maker.material(name, {255, 255, 255, 255}, maker.image(std::move(image)));
    };
    t.brick = textured("brick", brick(seed + 50, rgb(168, 92, 70)));
    t.plaster = textured("plaster", plaster(seed + 51, rgb(252, 250, 246)));
    t.tiles = textured("roof tiles", roof_tiles(seed + 52, rgb(250, 244, 240)));
    t.floor = textured("floor boards", planks(seed + 53, rgb(196, 152, 106)));
    t.paving = textured("paving", paving(seed + 54, rgb(176, 172, 164)));
    t.cobbles = textured("cobbles", cobbles(seed + 55, rgb(158, 148, 138)));
    t.asphalt = textured("asphalt", speckle(seed + 56, rgb(70, 72, 76), rgb(96, 98, 102), "asphalt"));
    t.grass = textured("grass", speckle(seed + 57, rgb(74, 112, 46), rgb(128, 156, 74), "grass"));
    t.water = maker.material("water", {255, 255, 255, 170}, none, model::AlphaMode::blend, true);
    t.plants = {maker.material("bark"), t.stuff.leaves};
    t.lamp_glass = lit ? maker.glowing("lamp glass", t.stuff.plain, lamp_glow * warm) : t.stuff.plain;
    if (lit) t.lit_glass = maker.glowing("lit glass", t.stuff.glass, window_glow * warm);
    return t;
}

/// Flat, at height y, cut into squares of about 10 m so that no triangle is huge.
void lay(MeshMaker& maker, double x0, double z0, double x1, double z1, double y) {
    const int columns = std::max(1, static_cast<int>(std::lround((x1 - x0) / 10))),
              rows = std::max(1, static_cast<int>(std::lround((z1 - z0) / 10)));
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            const double a = x0 + (x1 - x0) * c / columns, b = x0 + (x1 - x0) * (c + 1) / columns;
            const double p = z0 + (z1 - z0) * r / rows, q = z0 + (z1 - z0) * (r + 1) / rows;
            maker.quad({a, y, q}, {b, y, q}, {b, y, p}, {a, y, p});
        }
    }
}

void kerbs(MeshMaker& maker, const TownStuff& t) {
    maker.brush = {t.stuff.plain, rgb(150, 148, 142), dmat4(1.0), 1.0};
    constexpr double s = 0.15;
    maker.box({0, -0.05, 0}, {block, kerb + 0.005, s});
    maker.box({0, -0.05, block - s}, {block, kerb + 0.005, block});
    maker.box({0, -0.05, s}, {s, kerb + 0.005, block - s});
    maker.box({block - s, -0.05, s}, {block, kerb + 0.005, block - s});
}

importer::Mesh block_ground(const TownStuff& t) {
    MeshMaker maker("block");
    kerbs(maker, t);
    const double a = pavement, b = block - pavement;
    maker.brush = {t.paving, {255, 255, 255, 255}, dmat4(1.0), 0.5};
    lay(maker, 0.15, 0.15, block - 0.15, a, kerb);
    lay(maker, 0.15, b, block - 0.15, block - 0.15, kerb);
    lay(maker, 0.15, a, a, b, kerb);
    lay(maker, b, a, block - 0.15, b, kerb);
    maker.brush = {t.grass, {255, 255, 255, 255}, dmat4(1.0), 0.4};
    lay(maker, a, a, b, b, kerb - 0.03);
    return maker.take();
}

importer::Mesh square_ground(const TownStuff& t) {
    MeshMaker maker("square");
    kerbs(maker, t);
    maker.brush = {t.cobbles, {255, 255, 255, 255}, dmat4(1.0), 0.5};
    lay(maker, 0.15, 0.15, block - 0.15, block - 0.15, kerb);
    return maker.take();
}

/// Roadway south and east of a block, with the crossing; lines in the middle.
importer::Mesh roads(const TownStuff& t) {
    MeshMaker maker("road");
    maker.brush = {t.asphalt, {255, 255, 255, 255}, dmat4(1.0), 0.35};
    lay(maker, 0, block, pitch, pitch, 0);
    lay(maker, block, 0, pitch, block, 0);
    maker.brush = {t.stuff.plain, rgb(226, 226, 220), dmat4(1.0), 1.0};
    for (double s = 2; s + 2 < block; s += 4) {
        maker.quad({s, 0.012, block + 3.06}, {s + 2, 0.012, block + 3.06}, {s + 2, 0.012, block + 2.94},
                   {s, 0.012, block + 2.94});
        maker.quad({block + 2.94, 0.012, s + 2}, {block + 3.06, 0.012, s + 2}, {block + 3.06, 0.012, s},
                   {block + 2.94, 0.012, s});
    }
    for (int i = 0; i < 5; ++i) {  // a crossing for those on foot
        const double z = block + 0.7 + 1.05 * i;
        maker.quad({block - 2.6, 0.012, z + 0.5}, {block - 0.4, 0.012, z + 0.5}, {block - 0.4, 0.012, z},
                   {block - 2.6, 0.012, z});
    }
    return maker.take();
}

struct Town {
    SceneMaker& maker;
    TownStuff stuff;
    Detail detail;
    Random random;
    std::uint64_t seed;
    bool lit = false;
    Random choice;       ///< of lit windows: the layout is the same without them
    double built = 1.0;  ///< share of the plots that have a house: below the smallest town of four blocks
    std::vector<House> houses{};
    std::vector<Index> trees{};
    Index lamp = none, bench = none, hedge = none, road = none, ground = none, bush = none;

    double about(double value, double spread) { return value + random.range(-spread, spread); }
};

void make_meshes(Town& town) {
    FurnitureMade made;
    for (int kind = 0; kind < house_kinds; ++kind)
        town.houses.push_back(make_house(town.maker, town.stuff, town.detail, kind, town.seed, made));
    TreeShape shape{.height = 8.5,
                    .crown_base = 3.0,
                    .crown_radius = 2.6,
                    .trunk_radius = 0.19,
                    .branches = 9,
                    .leaf_length = 1.25,
                    .leaf_width = 0.55,
                    .clump_radius = 1.05,
                    .dark = rgb(190, 200, 180),
                    .light = rgb(255, 255, 240)};
    town.trees.push_back(town.maker.mesh(broad_tree("lime tree", town.stuff.plants, shape, 840, town.seed + 1)));
    shape.height = 10.5;
    shape.crown_radius = 3.3;
    shape.dark = rgb(180, 190, 150);
    shape.light = rgb(240, 246, 200);
    town.trees.push_back(town.maker.mesh(broad_tree("maple", town.stuff.plants, shape, 960, town.seed + 2)));
    shape.height = 5.2;
    shape.crown_base = 1.7;
    shape.crown_radius = 1.9;
    shape.light = rgb(255, 250, 200);
    town.trees.push_back(town.maker.mesh(broad_tree("apple tree", town.stuff.plants, shape, 720, town.seed + 3)));
    town.lamp = town.maker.mesh(street_lamp(town.stuff, town.detail));
    town.bench = town.maker.mesh(bench(town.stuff, town.detail));
    town.hedge = town.maker.mesh(hedge(town.stuff, 8.0, town.seed + 4));
    town.bush =
        town.maker.mesh(bush("rose bush", town.stuff.plants, 0.9, 160, rgb(200, 205, 190), rgb(255, 250, 235), town.seed + 5));
    town.road = town.maker.mesh(roads(town.stuff));
    town.ground = town.maker.mesh(block_ground(town.stuff));
}

Index place_house(Town& town, Index parent, int kind, int number, const dmat4& where) {
    const House& house = town.houses[static_cast<std::size_t>(kind)];
    const Index group = town.maker.node(fmt::format("house {}", number), parent, none, where);
    for (const House::HousePart& part : house.parts) {
        Index mesh = part.mesh;
        if (!house.lit_windows.empty() && part.name == std::string_view("windows"))
            mesh = house.lit_windows[town.choice.below(static_cast<std::uint32_t>(house.lit_windows.size()))];
        town.maker.node(part.name, group, mesh, part.where);
    }
    return group;
}

/// The light falls down and aside, not on the lamp's own hood.
void place_street_lamp(Town& town, Index parent, const dmat4& where) {
    const Index node = town.maker.node("street lamp", parent, town.lamp, where);
    if (!town.lit) return;
    importer::Lamp lamp{.name = "street lamp", .colour = warm, .candela = 60, .range_m = 16};
    lamp.at = dvec3(town.maker.scene.nodes[node].world * dvec4(street_lamp_light_m, 1.0));
    lamp.cos_inner = 0.64;  // about 50 and 80 degrees
    lamp.cos_outer = 0.17;
    town.maker.scene.lamps.push_back(std::move(lamp));
}

/// A bulb that glows in the shade of the kitchen's pendant lamp, and its light a little below.
void light_kitchen(Town& town, Index house) {
    MeshMaker maker("bulb");
    maker.brush = {town.stuff.lamp_glass, rgb(255, 248, 220), dmat4(1.0), 1.0};
    maker.ellipsoid({0, 0, 0}, dvec3(0.056), 12, 8);
    const Index mesh = town.maker.mesh(maker.take());
    const Index node = town.maker.node("bulb", house, mesh, move(kitchen_lamp_m - dvec3(0, 0.94, 0)));
    importer::Lamp lamp{.name = "kitchen lamp", .colour = warm, .candela = 40, .range_m = 12};
    lamp.at = dvec3(town.maker.scene.nodes[node].world * dvec4(0, -0.12, 0, 1));
    town.maker.scene.lamps.push_back(std::move(lamp));
}

void plant(Town& town, Index parent, std::size_t tree, double x, double z) {
    const double size = town.random.range(0.85, 1.15), about = town.random.range(0, 2 * pi);
    town.maker.node("tree", parent, town.trees[tree], move({x, kerb - 0.05, z}) * turn_y(about) * stretch(dvec3(size)));
}

/// Lamps and trees along the kerbs, none in front of the doors' middle.
void line_streets(Town& town, Index parent) {
    const double in = 0.7, out = block - 0.7;
    for (const double s : {6.0, 19.0, 32.0}) {
        const std::array<std::array<double, 3>, 4> sides{{{s, in, pi}, {s, out, 0}, {in, s, -pi / 2}, {out, s, pi / 2}}};
        for (const auto& [x, z, angle] : sides) {
            if (s == 19.0) {
                plant(town, parent, 0, x + (std::abs(angle) == pi / 2 ? 0 : 3.6), z);
            } else {
                place_street_lamp(town, parent, move({x, kerb, z}) * turn_y(angle));
            }
        }
    }
}

void garden(Town& town, Index parent) {
    const double low = pavement + house_depth_m + 1.5, high = block - low;
    for (int plot = 0; plot < houses_a_row; ++plot) {
        const double x = pavement + house_width_m * (plot + 0.5);
        if (town.random.unit() >= town.built) continue;
        for (const double z : {town.about(low + 2.6, 0.8), town.about(high - 2.6, 0.8)}) {
            const double tree_x = town.about(x, 2);
            plant(town, parent, town.random.below(3) == 0 ? 1 : 2, tree_x, z);
            for (int i = 0; i < 2; ++i) {
                const dmat4 turned = turn_y(town.random.range(0, 6));
                town.maker.node("rose bush", parent, town.bush, move({town.about(x, 3.2), kerb, town.about(z, 2.0)}) * turned);
            }
        }
        town.maker.node("hedge", parent, town.hedge, move({x - 4, kerb, 0.5 * block}));
        if (plot > 0)
            town.maker.node("hedge", parent, town.hedge,
                            move({x - 0.5 * house_width_m, kerb, 0.5 * block - 0.2}) * turn_y(pi / 2));
        if (plot > 0) town.maker.node("hedge", parent, town.hedge, move({x - 0.5 * house_width_m, kerb, high}) * turn_y(pi / 2));
    }
    const dmat4 turned = turn_y(town.about(pi, 0.4));
    town.maker.node("bench", parent, town.bench, move({town.about(0.5 * block, 6), kerb, low + 1}) * turned);
}

void block_of_houses(Town& town, Index parent, bool first_block, int& number) {
    town.maker.node("ground", parent, town.ground, dmat4(1.0));
    for (int i = 0; i < houses_a_row; ++i) {
        const double x = pavement + house_width_m * i;
        const std::array<dmat4, 2> plots{move({x, kerb, block - pavement}),
                                         move({x + house_width_m, kerb, pavement}) * turn_y(pi)};
        for (std::size_t side = 0; side < plots.size(); ++side) {
            const bool visited = first_block && side == 0 && i == visited_plot;
            if (visited || town.random.unit() < town.built) {
                const int kind = static_cast<int>(town.random.below(house_kinds));
                const Index house = place_house(town, parent, kind, number, plots[side]);
                if (visited && town.lit) light_kitchen(town, house);
            }
            ++number;
        }
    }
    garden(town, parent);
    line_streets(town, parent);
}

void square(Town& town, Index parent) {
    SceneMaker& m = town.maker;
    const Detail fine{std::min(1.0, 1.6 * town.detail.factor)};
    m.node("ground", parent, m.mesh(square_ground(town.stuff)), dmat4(1.0));
    m.node("town hall", parent, m.mesh(town_hall(town.stuff, fine)), move({19, kerb, 26}) * turn_y(pi));
    const double cx = 19, cz = 13;
    m.node("fountain", parent, m.mesh(fountain(town.stuff, fine)), move({cx, kerb, cz}));
    const std::array<Index, 2> stalls{m.mesh(market_stall(town.stuff, town.detail, rgb(190, 50, 46))),
                                      m.mesh(market_stall(town.stuff, town.detail, rgb(50, 96, 150)))};
    for (int i = 0; i < 4; ++i)
        m.node("market stall", parent, stalls[static_cast<std::size_t>(i) % 2],
               move({30.5, kerb, 4.0 + 4.2 * i}) * turn_y(town.about(-pi / 2, 0.08)));
    for (int i = 0; i < 8; ++i) {
        const double a = (i + 0.5) * pi / 4;
        m.node("bench", parent, town.bench, move({cx + 6.3 * std::cos(a), kerb, cz + 6.3 * std::sin(a)}) * turn_y(-a - pi / 2));
    }
    for (const double z : {5.0, 11.5, 18.0}) plant(town, parent, 1, 35.2, z);
    for (const double x : {9.0, 14.5, 24.0, 29.0}) plant(town, parent, 0, x, 2.6);
    for (const double z : {10.0, 16.5}) plant(town, parent, 0, 3.0, z);
    for (const auto& [x, z] : {std::pair{11.5, 7.0}, {26.5, 7.0}, {11.5, 19.5}, {26.5, 19.5}})
        place_street_lamp(town, parent, move({x, kerb, z}) * turn_y(town.random.range(0, 6)));
}

/// Fields and trees around, so that streets do not end in nothing.
void outskirts(Town& town, int first, int count) {
    const Index parent = town.maker.node("outskirts", none, none, dmat4(1.0));
    const double low = first * pitch - road, high = (first + count) * pitch, margin = 36;
    MeshMaker maker("fields");
    maker.brush = {town.stuff.grass, {255, 255, 255, 255}, dmat4(1.0), 0.2};
    for (const auto& [x0, z0, x1, z1] : {std::array{low - margin, low - margin, high + margin, low},
                                         std::array{low - margin, high, high + margin, high + margin},
                                         std::array{low - margin, low, low, high}, std::array{high, low, high + margin, high}}) {
        lay(maker, x0, z0, x1, z1, -0.03);
    }
    maker.brush = {town.stuff.asphalt, {255, 255, 255, 255}, dmat4(1.0), 0.35};
    lay(maker, low, low, low + road, high, 0);
    lay(maker, low + road, low, high, low + road, 0);
    town.maker.node("fields", parent, town.maker.mesh(maker.take()), dmat4(1.0));
    const int trees = static_cast<int>(14 * count * town.built);
    for (int i = 0; i < trees; ++i) {
        const double along = town.random.range(low - margin + 3, high + margin - 3), off = town.random.range(5, margin - 3);
        const std::array<dvec2, 4> places{dvec2(along, low - off), dvec2(along, high + off), dvec2(low - off, along),
                                          dvec2(high + off, along)};
        const dvec2& p = places[static_cast<std::size_t>(i) % 4];
        plant(town, parent, town.random.below(2), p.x, p.y);
    }
}

/// Along the street, into a house and through its rooms, on to the square and round the fountain, up to the balcony.
Path walk_through() {
    const double street = block + 3, house_x = pavement + visited_plot * house_width_m, front = block - pavement;
    const double door = house_x + house_door_m;
    std::vector<Waypoint> way;
    double pace = 1.0;
    const auto go = [&](double x, double z, double y = eye) { way.push_back({{x, y, z}, {}, true, 0, pace}); };
    const auto look = [&](double x, double z, const dvec3& at, double pause_s, double y = eye) {
        way.push_back({{x, y, z}, at, false, pause_s, pace});
    };
    go(7.0, street, 1.7);
    go(13.0, street - 0.4, 1.7);
    pace = 0.62;  // rooms are small
    look(18.6, street - 1.8, {door, 1.6, front}, 0);
    go(door, front + 1.5);
    go(door + 0.08, front - 0.6);
    look(door + 0.35, front - 1.6, {house_x + 5.0, 1.1, front - 2.1}, 0);
    look(house_x + 3.2, front - 2.05, {house_x + 6.2, 0.7, front - 2.4}, 0.4);
    look(house_x + 4.25, front - 3.1, {house_x + 7.4, 1.1, front - 4.5}, 1.0);
    look(house_x + 4.4, front - 4.7, {house_x + 6.6, 0.7, front - 6.4}, 0.3);
    look(house_x + 4.35, front - 5.8, {house_x + 6.6, 0.8, front - 6.5}, 0.8);
    go(house_x + 3.4, front - 6.05);
    go(house_x + 2.05, front - 5.75);
    go(house_x + 1.95, front - 4.4);
    go(door + 0.2, front - 1.4);
    go(door, front + 0.3);
    go(door + 1.3, front + 2.1);
    pace = 1.0;
    go(31.5, street - 0.5, 1.7);
    look(42.5, street + 1.5, {63, 2.0, 57}, 0, 1.72);
    look(48.5, 47.0, {63, 2.2, 57}, 0);
    look(54.6, 53.0, {63, 1.2, 57}, 0.5);
    look(53.4, 60.0, {64, 2.0, 58}, 0);
    go(50.6, 67.0);
    go(51.6, 69.0);
    go(56.0, 69.0, eye + 0.5 * balcony_m);
    go(60.0, 69.0, eye + balcony_m);
    look(62.0, 68.9, {64, 3.0, 52}, 0, eye + balcony_m);
    look(65.0, 68.6, {60, 2.0, 41}, 3.0, eye + balcony_m);
    return make_path(way, 60.0);
}

}  // namespace

GeneratedScene make_town(double scale, std::uint64_t seed, bool lit) {
    SceneMaker maker;
    const int count = std::max(2, static_cast<int>(std::lround(3.0 * std::sqrt(scale))));
    const int first = -((count - 2) / 2);
    const Detail detail{0.2 * std::clamp(std::sqrt(scale), 0.3, 1.0)};
    Town town{maker, make_town_stuff(maker, seed, lit), detail, Random(seed), seed, lit, Random(seed + 6)};
    town.built = std::min(1.0, 9.0 * scale / 4.0);
    make_meshes(town);
    int number = 1;
    for (int j = first; j < first + count; ++j) {
        for (int i = first; i < first + count; ++i) {
            const Index group = maker.node(fmt::format("block {},{}", i, j), none, none, move({i * pitch, 0, j * pitch}));
            maker.node("road", group, town.road, dmat4(1.0));
            if (i == 1 && j == 1) {
                square(town, group);
            } else {
                block_of_houses(town, group, i == 0 && j == 0, number);
            }
        }
    }
    outskirts(town, first, count);
    return {std::move(maker.scene), walk_through()};
}

}  // namespace surefoot::scenes
