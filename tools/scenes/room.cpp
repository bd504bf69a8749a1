// The room: chairs pushed under a laid table, books pressed into shelves, cushions into each other. At larger scales a row
// of such rooms, door after door.
#include "tools/scenes/room.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "rt/base/random.hpp"
#include "tools/scenes/building.hpp"
#include "tools/scenes/path_maker.hpp"
#include "tools/scenes/textures.hpp"

namespace surefoot::scenes {
namespace {

using importer::none;

/// A room spans x 0..room_width, z 0..room_depth; doors in the west and east walls lie on one line.
constexpr double room_width = 7.2, room_depth = 5.6, room_height = 2.8, wall_thickness = 0.2;
constexpr double room_pitch = room_width + wall_thickness;
constexpr double door_from = 4.0, door_to = 4.95, door_height = 2.15, lane = 4.475;
constexpr double room_eye = 1.68;

/// Meshes made once and placed in every room.
struct Pieces {
    Index table, chair, sofa, armchair, coffee, shelf, sideboard, rug, floor_lamp, table_lamp, pendant, radiator, clock;
    Index plant, vase, fruit, teapot, cup, plate, candle, curtain, door;
    std::array<Index, 6> books{};
    std::array<Index, 4> pictures{};
};

Pieces make_pieces(SceneMaker& maker, const Stuff& stuff, const Detail& detail, std::uint64_t seed) {
    Pieces p{};
    p.table = maker.mesh(dining_table(stuff, detail));
    p.chair = maker.mesh(chair(stuff, detail, rgb(166, 60, 48)));
    p.sofa = maker.mesh(sofa(stuff, detail, rgb(112, 128, 118)));
    p.armchair = maker.mesh(armchair(stuff, detail, rgb(176, 130, 72)));
    p.coffee = maker.mesh(coffee_table(stuff, detail));
    p.shelf = maker.mesh(bookshelf(stuff, 2.4, 2.2, 6));
    p.sideboard = maker.mesh(sideboard(stuff, detail));
    p.rug = maker.mesh(rug(stuff, detail, 2.5, 1.8));
    p.floor_lamp = maker.mesh(floor_lamp(stuff, detail));
    p.table_lamp = maker.mesh(table_lamp(stuff, detail));
    p.pendant = maker.mesh(pendant_lamp(stuff, detail));
    p.radiator = maker.mesh(radiator(stuff, detail));
    p.clock = maker.mesh(wall_clock(stuff, detail));
    p.plant = maker.mesh(potted_plant(stuff, detail, seed + 1));
    p.vase = maker.mesh(vase_of_flowers(stuff, detail, seed + 2));
    p.fruit = maker.mesh(bowl_of_fruit(stuff, detail));
    p.teapot = maker.mesh(teapot(stuff, detail));
    p.cup = maker.mesh(cup(stuff, detail));
    p.plate = maker.mesh(plate(stuff, detail));
    p.candle = maker.mesh(candlestick(stuff, detail));
    p.curtain = maker.mesh(curtain(stuff, detail, 0.7, 2.2, rgb(120, 58, 50)));
    p.door = maker.mesh(door_leaf(stuff, door_to - door_from - 0.04, door_height - 0.03, rgb(236, 232, 222), detail));
    for (std::size_t i = 0; i < p.books.size(); ++i) p.books[i] = maker.mesh(row_of_books(stuff, 1.12, true, seed + 20 + i));
    for (int i = 0; i < 4; ++i)
        p.pictures[static_cast<std::size_t>(i)] = maker.mesh(picture(stuff, i, i % 2 == 0 ? 0.8 : 0.56, i % 2 == 0 ? 0.6 : 0.42));
    return p;
}

struct WallSurfaces {
    Index paper, floor, ceiling;
};

WallStyle style_of(const WallSurfaces& surfaces) { return {surfaces.ceiling, surfaces.paper, surfaces.ceiling, 0.5, 1.0}; }

/// Walls, floor, ceiling, window, skirting, door lining. Open to the east: the next room's west wall stands there.
importer::Mesh shell(const Stuff& stuff, const WallSurfaces& surfaces, bool open_east) {
    MeshMaker maker("room");
    const WallStyle style = style_of(surfaces);
    const double t = 0.5 * wall_thickness, w = room_width, d = room_depth;
    const std::array<Opening, 1> window_hole{Opening{w - 3.8, w - 1.9, 0.85, 2.35}};
    // Around with the outside to the right of the way: +z wall eastwards, east wall northwards, and so on.
    wall(maker, {{0, d + t}, {w, d + t}, 0, room_height, wall_thickness}, {}, style);
    if (!open_east) wall(maker, {{w + t, d}, {w + t, 0}, 0, room_height, wall_thickness}, {}, style);
    wall(maker, {{w, -t}, {0, -t}, 0, room_height, wall_thickness}, window_hole, style);
    const std::array<Opening, 1> west_door{Opening{door_from, door_to, 0, door_height}};
    wall(maker, {{-t, 0}, {-t, d}, 0, room_height, wall_thickness}, west_door, style);
    maker.brush = {surfaces.floor, {255, 255, 255, 255}, dmat4(1.0), 0.7};
    maker.quad({-wall_thickness, 0, d}, {w, 0, d}, {w, 0, 0}, {-wall_thickness, 0, 0});
    maker.brush = {surfaces.ceiling, {255, 255, 255, 255}, dmat4(1.0), 0.5};
    maker.quad({0, room_height, 0}, {w, room_height, 0}, {w, room_height, d}, {0, room_height, d});
    maker.brush = {stuff.plain, rgb(240, 238, 230), dmat4(1.0), 1.0};
    maker.box({0, 0, 0}, {w, 0.09, 0.018});
    maker.box({0, 0, d - 0.018}, {w, 0.09, d});
    maker.box({0, 0, 0}, {0.018, 0.09, door_from - 0.07});
    maker.box({0, 0, door_to + 0.07}, {0.018, 0.09, d});
    maker.brush.frame = move({1.9, 0.85, -t});
    window(maker, stuff, 1.9, 1.5, 3, 2, rgb(244, 242, 236));
    maker.brush.frame = move({-t, 0, door_to}) * turn_y(pi / 2);
    door_lining(maker, stuff, door_to - door_from, door_height, wall_thickness, rgb(240, 238, 230));
    return maker.take();
}

/// Before the first door: a short corridor to come from.
importer::Mesh corridor(const WallSurfaces& surfaces) {
    MeshMaker maker("corridor");
    const WallStyle style = style_of(surfaces);
    const double t = wall_thickness, x0 = -4.0, x1 = -t, z0 = 3.4, z1 = 5.6;
    wall(maker, {{x0, z1 + 0.5 * t}, {x1, z1 + 0.5 * t}, 0, room_height, t}, {}, style);
    wall(maker, {{x1, z0 - 0.5 * t}, {x0, z0 - 0.5 * t}, 0, room_height, t}, {}, style);
    wall(maker, {{x0 - 0.5 * t, z0}, {x0 - 0.5 * t, z1}, 0, room_height, t}, {}, style);
    maker.brush = {surfaces.floor, {255, 255, 255, 255}, dmat4(1.0), 0.7};
    maker.quad({x0, 0, z1}, {x1, 0, z1}, {x1, 0, z0}, {x0, 0, z0});
    maker.brush = {surfaces.ceiling, {255, 255, 255, 255}, dmat4(1.0), 0.5};
    maker.quad({x0, room_height, z0}, {x1, room_height, z0}, {x1, room_height, z1}, {x0, room_height, z1});
    return maker.take();
}

struct Placer {
    SceneMaker& maker;
    Index parent;
    Random& random;

    Index put(const char* name, Index mesh, const dvec3& at, double angle = 0, Index on = none) const {
        return maker.node(name, on == none ? parent : on, mesh, move(at) * turn_y(angle));
    }
    double about(double value, double spread) const { return value + random.range(-spread, spread); }
};

/// Six chairs pushed in so far that their seats and backs overlap the table's edge and apron; crockery for each.
void lay_table(const Placer& place, const Pieces& p, const dvec3& at) {
    const Index table = place.put("dining table", p.table, at);
    const std::array<std::array<double, 3>, 6> seats{
        {{-0.45, 0.46, pi}, {0.45, 0.46, pi}, {-0.45, -0.46, 0}, {0.45, -0.46, 0}, {-0.86, 0, pi / 2}, {0.86, 0, -pi / 2}}};
    for (const auto& [x, z, angle] : seats) {
        const double turned = place.about(angle, 0.12);
        place.put("chair", p.chair, {place.about(x, 0.03), 0, place.about(z, 0.03)}, turned, table);
        const dvec3 inwards = glm::normalize(dvec3(-x * (std::abs(z) < 0.1 ? 1 : 0), 0, -z));
        const dvec3 setting = dvec3(x, 0.752, z) + inwards * (std::abs(z) < 0.1 ? 0.14 : 0.22);
        place.put("plate", p.plate, setting, 0, table);
        const double handle = place.random.range(0, 6), cup_z = place.about(0.02, 0.04), cup_x = place.about(0.19, 0.02);
        place.put("cup", p.cup, setting + dvec3(cup_x, 0, cup_z), handle, table);
    }
    place.put("bowl of fruit", p.fruit, {0.0, 0.752, 0}, 0.4, table);
    place.put("teapot", p.teapot, {0.36, 0.752, 0.04}, place.random.range(0, 6), table);
    for (const double x : {-0.34, -0.24}) place.put("candlestick", p.candle, {x, 0.752, place.about(0, 0.05)}, 0, table);
    place.put("pendant lamp", p.pendant, at + dvec3(0, room_height, 0));
}

void fill_shelf(const Placer& place, const Pieces& p, const dvec3& at) {
    const Index shelf = place.put("bookshelf", p.shelf, at, pi);
    for (int row = 0; row < 6; ++row) {
        const double y = 0.085 + (2.2 - 0.085) * row / 6;
        for (const double x : {-0.59, 0.59}) {
            if (row == 3 && x > 0) {
                place.put("vase of flowers", p.vase, {0.3, y, 0.16}, 0, shelf);
                place.put("teapot", p.teapot, {0.75, y, 0.15}, 2.2, shelf);
                continue;
            }
            place.put("books", p.books[place.random.below(6)], {x, y, 0}, 0, shelf);
        }
    }
}

void furnish(SceneMaker& maker, const Pieces& p, Index room, Random& random) {
    const Placer place{maker, room, random};
    lay_table(place, p, {2.55, 0, 2.15});
    fill_shelf(place, p, {3.6, 0, room_depth - 0.005});
    place.put("rug", p.rug, {5.25, 0, 2.0}, place.about(0, 0.06));
    place.put("sofa", p.sofa, {room_width - 0.02, 0, 2.1}, -pi / 2);
    const double turned = place.about(0.15, 0.1);
    place.put("armchair", p.armchair, {place.about(5.0, 0.05), 0, 0.25}, turned);
    const Index coffee = place.put("coffee table", p.coffee, {5.35, 0.0, 2.1}, pi / 2);
    place.put("bowl of fruit", p.fruit, {-0.2, 0.43, 0.02}, 1.0, coffee);
    place.put("cup", p.cup, {0.2, 0.43, 0.1}, 2.0, coffee);
    place.put("cup", p.cup, {0.34, 0.43, -0.08}, 4.0, coffee);
    place.put("floor lamp", p.floor_lamp, {6.8, 0, 0.5});
    place.put("potted plant", p.plant, {0.55, 0, 0.5}, random.range(0, 6));
    place.put("potted plant", p.plant, {6.75, 0, 3.62}, random.range(0, 6));
    place.put("radiator", p.radiator, {2.85, 0, 0});
    for (const double x : {1.72, 3.98}) place.put("curtain", p.curtain, {x, 0.25, 0.14});
    const Index board = place.put("sideboard", p.sideboard, {0.0, 0, 2.3}, pi / 2);
    place.put("table lamp", p.table_lamp, {-0.5, 0.857, 0.22}, 0, board);
    place.put("vase of flowers", p.vase, {0.45, 0.857, 0.22}, random.range(0, 6), board);
    place.put("candlestick", p.candle, {0.05, 0.857, 0.18}, 0, board);
    place.put("books", p.books[0], {0.05, 0.857, -0.02}, 0, board);
    place.put("picture", p.pictures[0], {0, 1.6, 2.3}, pi / 2);
    place.put("picture", p.pictures[1], {room_width, 1.65, 1.5}, -pi / 2);
    place.put("picture", p.pictures[2], {room_width, 1.65, 2.7}, -pi / 2);
    place.put("picture", p.pictures[3], {1.2, 1.6, room_depth}, pi);
    place.put("clock", p.clock, {5.6, 1.9, room_depth}, pi);
}

/// In at the door, along the clutter of the table, the books, the seats, a look back over all, and out or to the window.
void pass_room(std::vector<Waypoint>& way, double x0, bool last) {
    const auto go = [&](double x, double z, double y = room_eye) { way.push_back({{x0 + x, y, z}, {}, true, 0}); };
    const auto look = [&](double x, double z, const dvec3& at, double pause_s, double y = room_eye) {
        way.push_back({{x0 + x, y, z}, at + dvec3(x0, 0, 0), false, pause_s});
    };
    go(-0.9, lane);
    go(0.35, lane);
    look(1.3, 4.2, {2.4, 0.7, 2.2}, 0.5);
    look(2.2, 3.62, {2.5, 0.75, 2.1}, 1.5, 1.3);
    look(3.35, 4.25, {3.9, 1.15, 5.45}, 2.0, 1.55);
    look(4.25, 3.7, {6.5, 0.8, 2.2}, 0);
    look(4.42, 2.9, {5.35, 0.45, 2.1}, 1.0, 1.5);
    look(4.3, 1.35, {1.0, 1.1, 2.6}, 1.5);
    look(4.45, 2.6, {0.6, 1.2, 4.2}, 1.0);
    look(4.8, 3.9, {6.9, 1.4, 2.2}, 0);
    if (last) {
        look(6.2, 4.5, {2.9, 1.3, 0.0}, 4.0);
    } else {
        go(6.3, lane);
    }
}

}  // namespace

GeneratedScene make_room(double scale, std::uint64_t seed) {
    SceneMaker maker;
    Random random(seed);
    const Stuff stuff = make_stuff(maker, seed);
    const WallSurfaces surfaces{
        maker.material("wallpaper", {255, 255, 255, 255},
                       maker.image(wallpaper(seed + 40, rgb(226, 214, 188), rgb(160, 150, 112)))),
        maker.material("parquet", {255, 255, 255, 255}, maker.image(planks(seed + 41, rgb(190, 146, 98)))),
        maker.material("plaster", {255, 255, 255, 255}, maker.image(plaster(seed + 42, rgb(246, 243, 236))))};
    const Detail detail{0.69 * std::clamp(std::sqrt(scale), 0.1, 1.0)};
    const Pieces pieces = make_pieces(maker, stuff, detail, seed);
    const int rooms = std::max(1, static_cast<int>(std::lround(scale)));
    const Index shell_open = rooms > 1 ? maker.mesh(shell(stuff, surfaces, true)) : none,
                shell_last = maker.mesh(shell(stuff, surfaces, false));
    const Index entry = maker.node("corridor", none, maker.mesh(corridor(surfaces)), dmat4(1.0));
    maker.node("door", entry, pieces.door, move({-0.02, 0, door_to}) * turn_y(-0.06));
    std::vector<Waypoint> way{{{-3.2, room_eye, lane}, {}, true, 0}};
    for (int i = 0; i < rooms; ++i) {
        const Index room = maker.node(fmt::format("room {}", i), none, none, move({i * room_pitch, 0, 0}));
        maker.node("shell", room, i + 1 < rooms ? shell_open : shell_last, dmat4(1.0));
        furnish(maker, pieces, room, random);
        pass_room(way, i * room_pitch, i + 1 == rooms);
    }
    return {std::move(maker.scene), make_path(way, 60.0 * rooms)};
}

}  // namespace surefoot::scenes
