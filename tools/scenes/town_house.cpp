// Houses of the town: walls with windows, rooms behind them, stairs between, roofs over; and what stands in the rooms.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "rt/base/hash.hpp"
#include "rt/base/random.hpp"
#include "tools/scenes/town.hpp"

namespace surefoot::scenes {
namespace {

constexpr double storey = 2.9, slab = 0.25, outer = 0.2, inner = 0.14;
constexpr double w = house_width_m, d = house_depth_m;
constexpr double hall_wall = 2.8, middle_wall = -4.7;  ///< between hall and rooms; between front and back room
/// Of the windows, those that glow; and how many choices of them each kind of house has.
constexpr double lit_share = 0.4;
constexpr int lit_choices = 4;
constexpr double stair_x0 = 0.2, stair_x1 = 1.15, stair_z0 = -3.0, stair_z1 = -7.2;

struct Kind {
    int storeys;
    bool brick, shutters, flowers;
    Colour wall, trim, door, shutter, roof;
};

constexpr std::array<Kind, house_kinds> kinds{{
    {2, true, false, true, rgb(255, 255, 255), rgb(240, 236, 226), rgb(38, 84, 66), rgb(0, 0, 0), rgb(150, 92, 72)},
    {3, false, true, false, rgb(242, 226, 190), rgb(250, 248, 240), rgb(122, 42, 38), rgb(74, 104, 84), rgb(176, 100, 70)},
    {2, false, true, true, rgb(222, 170, 116), rgb(246, 240, 226), rgb(44, 66, 104), rgb(66, 86, 120), rgb(120, 84, 76)},
    {3, false, false, false, rgb(176, 194, 204), rgb(248, 248, 244), rgb(168, 118, 48), rgb(0, 0, 0), rgb(104, 100, 104)},
}};

struct Hole {
    Opening opening;
    bool is_window;
};

/// Openings of the front and back walls of a storey; along x for both.
std::vector<Hole> front_holes(int level) {
    if (level == 0) return {{{house_door_m - 0.5, house_door_m + 0.5, 0, 2.15}, false}, {{4.0, 6.9, 0.85, 2.3}, true}};
    return {{{0.9, 2.1, 0.8, 2.3}, true}, {{3.7, 4.9, 0.8, 2.3}, true}, {{6.2, 7.4, 0.8, 2.3}, true}};
}
std::vector<Hole> back_holes(int level) {
    if (level == 0) return {{{3.6, 5.0, 1.05, 2.2}, true}, {{6.0, 7.4, 1.05, 2.2}, true}};
    return {{{1.2, 2.0, 1.0, 2.2}, true}, {{4.0, 5.2, 0.9, 2.2}, true}, {{6.2, 7.4, 0.9, 2.2}, true}};
}

std::vector<Opening> openings_of(const std::vector<Hole>& holes, bool backwards) {
    std::vector<Opening> out;
    for (const Hole& hole : holes) {
        Opening o = hole.opening;
        if (backwards) o = {w - o.to, w - o.from, o.low, o.high};
        out.push_back(o);
    }
    if (backwards) std::reverse(out.begin(), out.end());
    return out;
}

/// A floor with its ceiling below, and a hole where the stair comes up.
void floor_slab(MeshMaker& maker, const TownStuff& stuff, double y, bool hole) {
    const auto piece = [&](double x0, double x1, double z0, double z1) {
        maker.brush.material = stuff.floor;
        maker.brush.uv_per_m = 0.7;
        maker.quad({x0, y, z1}, {x1, y, z1}, {x1, y, z0}, {x0, y, z0});
        maker.brush.material = stuff.plaster;
        maker.brush.uv_per_m = 0.5;
        maker.quad({x0, y - slab, z0}, {x1, y - slab, z0}, {x1, y - slab, z1}, {x0, y - slab, z1});
    };
    maker.brush.colour = {255, 255, 255, 255};
    if (!hole) return piece(0, w, -d, 0);
    piece(stair_x1, w, -d, 0);
    piece(0, stair_x1, stair_z0, 0);
    piece(0, stair_x1, -d, stair_z1);
    maker.brush.material = stuff.plaster;
    maker.quad({stair_x1, y - slab, stair_z0}, {stair_x1, y - slab, stair_z1}, {stair_x1, y, stair_z1}, {stair_x1, y, stair_z0});
    maker.quad({stair_x0, y - slab, stair_z0}, {stair_x1, y - slab, stair_z0}, {stair_x1, y, stair_z0}, {stair_x0, y, stair_z0});
}

void storey_walls(MeshMaker& maker, const TownStuff& stuff, const Kind& kind, int level) {
    const double base = level * storey, high = storey;
    WallStyle outside{kind.brick ? stuff.brick : stuff.plaster, stuff.plaster, stuff.plaster, kind.brick ? 1.0 : 0.5, 0.5};
    outside.outer_colour = kind.wall;
    outside.inner_colour = level % 2 == 0 ? rgb(238, 230, 212) : rgb(214, 224, 226);
    const double half = 0.5 * outer;
    wall(maker, {{0, -half}, {w, -half}, base, high, outer}, openings_of(front_holes(level), false), outside);
    wall(maker, {{w, -d + half}, {0, -d + half}, base, high, outer}, openings_of(back_holes(level), true), outside);
    wall(maker, {{w - half, 0}, {w - half, -d}, base, high, outer}, {}, outside);
    wall(maker, {{half, -d}, {half, 0}, base, high, outer}, {}, outside);
    WallStyle partition{stuff.plaster, stuff.plaster, stuff.plaster, 0.5, 0.5};
    partition.outer_colour = partition.inner_colour = partition.reveal_colour = outside.inner_colour;
    const double inside_high = storey - slab;
    // From the back of the hall to its front: doors to the back room and to the front room.
    const std::array<Opening, 2> doors{Opening{2.4, 3.3, 0, 2.1}, Opening{6.3, 7.2, 0, 2.1}};
    wall(maker, {{hall_wall, -d + outer}, {hall_wall, -outer}, base, inside_high, inner}, doors, partition);
    const std::array<Opening, 1> between{Opening{0.7, 2.5, 0, 2.2}};
    wall(maker, {{hall_wall, middle_wall}, {w - outer, middle_wall}, base, inside_high, inner},
         level == 0 ? std::span<const Opening>(between) : std::span<const Opening>(), partition);
}

void roof(MeshMaker& maker, const TownStuff& stuff, const Kind& kind) {
    const double eaves = kind.storeys * storey, ridge = eaves + 3.0, over = 0.45, mid = -0.5 * d;
    const double drop = over * 3.0 / (0.5 * d);
    maker.brush = {stuff.tiles, kind.roof, dmat4(1.0), 0.5};
    for (const double lift : {0.14, 0.0}) {
        const dvec3 a(0, eaves - drop + lift, over), b(w, eaves - drop + lift, over), c(w, ridge + lift, mid),
            e(0, ridge + lift, mid);
        const dvec3 f(w, eaves - drop + lift, -d - over), g(0, eaves - drop + lift, -d - over);
        if (lift > 0) {
            maker.quad(a, b, c, e);
            maker.quad(f, g, e, c);
        } else {
            maker.brush.material = stuff.stuff.wood;
            maker.quad(b, a, e, c);
            maker.quad(g, f, c, e);
        }
    }
    maker.brush = {kind.brick ? stuff.brick : stuff.plaster, kind.wall, dmat4(1.0), kind.brick ? 1.0 : 0.5};
    maker.triangle({0, eaves, -d}, {0, eaves, 0}, {0, ridge, mid});
    maker.triangle({w, eaves, 0}, {w, eaves, -d}, {w, ridge, mid});
    maker.brush = {stuff.brick, {255, 255, 255, 255}, dmat4(1.0), 1.0};
    maker.box({6.4, eaves + 1.2, mid - 1.2}, {7.2, ridge + 0.9, mid - 0.6});
    maker.brush = {stuff.stuff.plain, rgb(168, 96, 70), dmat4(1.0), 1.0};
    for (const double x : {6.6, 7.0}) maker.rod({x, ridge + 0.85, mid - 0.9}, {x, ridge + 1.25, mid - 0.9}, 0.1, 8);
    maker.brush.colour = rgb(96, 104, 104);
    maker.tube(std::array{dvec3(0, eaves - drop, over + 0.05), dvec3(w, eaves - drop, over + 0.05)}, std::array{0.07, 0.07}, 7,
               true);
    maker.tube(std::array{dvec3(8.3, eaves - drop, over), dvec3(8.3, eaves - 0.45, 0.06), dvec3(8.3, 0.1, 0.06)},
               std::array{0.045, 0.045, 0.045}, 6, true);
}

importer::Mesh walls_mesh(const TownStuff& stuff, const Kind& kind, int number) {
    MeshMaker maker(fmt::format("house {} walls", number));
    for (int level = 0; level < kind.storeys; ++level) {
        storey_walls(maker, stuff, kind, level);
        floor_slab(maker, stuff, level * storey, level > 0);
        if (level + 1 == kind.storeys) continue;
        maker.brush = {stuff.floor, rgb(210, 170, 130),
                       move({0.5 * (stair_x0 + stair_x1), level * storey, stair_z0}) * turn_y(pi), 1.0};
        stairs(maker, stair_x1 - stair_x0, storey / 16, 0.26, 16);
        maker.brush.frame = dmat4(1.0);
    }
    floor_slab(maker, stuff, kind.storeys * storey, false);
    roof(maker, stuff, kind);
    return maker.take();
}

void shutter(MeshMaker& maker, const Stuff& stuff, const Colour& colour, double x, double y, double width, double height) {
    maker.brush.material = stuff.plain;
    maker.brush.colour = colour;
    maker.box({x, y, 0.02}, {x + width, y + height, 0.05});
    maker.brush.colour = shade(colour, 0.82);
    for (int i = 0; i < 6; ++i) {
        const double at = y + 0.08 + i * (height - 0.16) / 6;
        maker.box({x + 0.05, at, 0.05}, {x + width - 0.05, at + 0.7 * (height - 0.16) / 6, 0.062});
    }
}

void flower_box(MeshMaker& maker, const TownStuff& stuff, double x, double y, double width, Random& random) {
    static constexpr std::array<Colour, 3> blossoms{rgb(220, 60, 70), rgb(240, 190, 80), rgb(226, 120, 190)};
    maker.brush.material = stuff.stuff.plain;
    maker.brush.colour = rgb(120, 84, 58);
    maker.box({x, y - 0.22, 0.06}, {x + width, y - 0.04, 0.26});
    for (int i = 0; i < 14; ++i) {
        const dvec3 base(x + width * (i + 0.5) / 14, y - 0.06, random.range(0.1, 0.22));
        maker.brush.material = stuff.plants.leaf;
        maker.brush.colour = {255, 255, 255, 255};
        maker.leaf(base, base + any_in(random, {-0.1, 0.24, 0}, {0.1, 0.24, 0.16}), {0.11, 0, 0.03},
                   glm::normalize(dvec3(0, 0.6, 1)));
        maker.brush.material = stuff.stuff.plain;
        maker.brush.colour = blossoms[random.below(3)];
        if (i % 2 == 0) maker.ellipsoid(base + dvec3(0, random.range(0.1, 0.2), 0.06), dvec3(0.035), 5, 3);
    }
}

/// Windows, shutters, flowers, the door's lining: what a façade wears. `panes` has one entry a window: whether
/// it glows. Empty: none does.
importer::Mesh fittings_mesh(const TownStuff& stuff, const Kind& kind, const std::string& name, Random& random,
                             const std::vector<bool>& panes) {
    MeshMaker maker(name);
    Stuff lit = stuff.stuff;
    lit.glass = stuff.lit_glass;
    std::size_t windows = 0;
    for (int level = 0; level < kind.storeys; ++level) {
        for (const bool front : {true, false}) {
            for (const Hole& hole : front ? front_holes(level) : back_holes(level)) {
                const Opening& o = hole.opening;
                const double y = level * storey + o.low, width = o.to - o.from, height = o.high - o.low;
                maker.brush.frame = front ? move({o.from, y, -0.5 * outer}) : move({o.to, y, -d + 0.5 * outer}) * turn_y(pi);
                if (!hole.is_window) {
                    door_lining(maker, stuff.stuff, width, height, outer, kind.trim);
                    continue;
                }
                const bool glows = !panes.empty() && panes[windows++];
                window(maker, glows ? lit : stuff.stuff, width, height, width > 2 ? 3 : 2, 3, kind.trim);
                maker.brush.frame = maker.brush.frame * move({0, 0, 0.5 * outer});
                if (kind.shutters && width < 2) {
                    shutter(maker, stuff.stuff, kind.shutter, -0.5 * width - 0.04, 0, 0.5 * width, height);
                    shutter(maker, stuff.stuff, kind.shutter, width + 0.04, 0, 0.5 * width, height);
                }
                if (kind.flowers && front) flower_box(maker, stuff, 0, 0, width, random);
            }
        }
        maker.brush = {stuff.stuff.plain, kind.trim, dmat4(1.0), 1.0};
        if (level > 0) maker.box({0, level * storey - 0.14, 0}, {w, level * storey + 0.04, 0.05});
    }
    maker.brush.colour = rgb(150, 146, 140);
    maker.box({house_door_m - 0.75, -0.12, 0}, {house_door_m + 0.75, 0.0, 0.55});
    return maker.take();
}

/// Meshes of furniture, made once a colour, shared by all kinds of houses.
struct Furnisher {
    SceneMaker& maker;
    const TownStuff& stuff;
    Detail detail;
    House& house;
    Random& random;
    FurnitureMade& made;

    Index shared(importer::Mesh mesh) const {
        std::uint64_t key = fnv_start;
        for (const importer::Primitive& p : mesh.primitives) {
            key = hash_bytes(std::as_bytes(std::span(p.positions)), fnv1a(key, p.material));
            key = hash_bytes(std::as_bytes(std::span(p.colours)), key);
        }
        const auto found = made.find(key);
        return found != made.end() ? found->second : made[key] = maker.mesh(std::move(mesh));
    }
    void put(const char* name, importer::Mesh mesh, const dvec3& at, double angle = 0) const {
        house.parts.push_back({name, shared(std::move(mesh)), move(at) * turn_y(angle)});
    }
    double about(double value, double spread) const { return value + random.range(-spread, spread); }
};

void furnish_living_room(const Furnisher& f, int kind) {
    static constexpr std::array<Colour, house_kinds> cloths{rgb(96, 116, 132), rgb(150, 88, 70), rgb(120, 132, 96),
                                                            rgb(168, 140, 100)};
    const Stuff& s = f.stuff.stuff;
    const auto k = static_cast<std::size_t>(kind);
    f.put("sofa", sofa(s, f.detail, cloths[k]), {w - 0.25, 0, -2.3}, -pi / 2);
    f.put("armchair", armchair(s, f.detail, cloths[(k + 1) % house_kinds]), {5.4, 0, -4.5}, f.about(0, 0.1));
    f.put("rug", rug(s, f.detail, 2.2, 1.7), {6.0, 0, -2.5}, pi / 2);
    f.put("coffee table", coffee_table(s, f.detail), {6.3, 0, -2.4}, pi / 2);
    if (kind % 2 == 1) f.put("bowl of fruit", bowl_of_fruit(s, f.detail), {6.3, 0.43, -2.3});
    f.put("cup", cup(s, f.detail), {6.35, 0.43, -2.75}, 1.0);
    f.put("floor lamp", floor_lamp(s, f.detail), {8.0, 0, -0.6});
    f.put("bookshelf", bookshelf(s, 1.2, 2.0, 5), {7.4, 0, middle_wall + 0.075});
    for (int row = 1; row < 4; ++row)
        f.put("books", row_of_books(s, 1.05, false, 400 + static_cast<std::uint64_t>((row + kind) % 3)),
              {7.4, 0.085 + (2.0 - 0.085) * row / 5, middle_wall + 0.075});
    f.put("potted plant", potted_plant(s, f.detail, 5), {3.3, 0, -0.6}, f.about(1, 1));
    f.put("picture", picture(s, kind, 0.8, 0.6), {w - 0.205, 1.6, -2.3}, -pi / 2);
    for (const double x : {3.85, 7.05}) f.put("curtain", curtain(s, f.detail, 0.5, 1.9, rgb(186, 150, 110)), {x, 0.5, -0.32});
}

void furnish_kitchen(const Furnisher& f, int kind) {
    static constexpr std::array<Colour, house_kinds> seats{rgb(150, 60, 50), rgb(70, 100, 130), rgb(190, 150, 70),
                                                           rgb(90, 120, 90)};
    const Stuff& s = f.stuff.stuff;
    f.put("kitchen", kitchen(s, f.detail), {7.0, 0, -d + 0.205});
    f.put("dining table", dining_table(s, f.detail), {6.6, 0, -6.4});
    for (const auto& [x, z, angle] :
         {std::array{6.2, -5.95, pi}, std::array{7.05, -5.95, pi}, std::array{6.2, -6.85, 0.0}, std::array{7.05, -6.85, 0.0}}) {
        f.put("chair", chair(s, f.detail, seats[static_cast<std::size_t>(kind)]), {x, 0, z}, f.about(angle, 0.1));
        if (x > 6.5) f.put("plate", plate(s, f.detail), {x, 0.752, z < -6.4 ? z + 0.2 : z - 0.2});
    }
    f.put("teapot", teapot(s, f.detail), {6.75, 0.752, -6.4}, 0.7);
    f.put("pendant lamp", pendant_lamp(s, f.detail), kitchen_lamp_m);
    if (kind % 2 == 0) f.put("vase of flowers", vase_of_flowers(s, f.detail, 6), {6.3, 0.752, -6.38});
    f.put("picture", picture(s, kind + 1, 0.56, 0.42), {w - 0.205, 1.6, -6.2}, -pi / 2);
}

void furnish_upstairs(const Furnisher& f, int kind, int level) {
    static constexpr std::array<Colour, house_kinds> blankets{rgb(60, 90, 130), rgb(170, 70, 60), rgb(110, 140, 110),
                                                              rgb(200, 170, 110)};
    const Stuff& s = f.stuff.stuff;
    const double y = level * storey;
    for (const double z : {-0.35, middle_wall - 0.25}) {
        const bool front = z > middle_wall;
        f.put("bed", bed(s, f.detail, blankets[static_cast<std::size_t>(kind + level + (front ? 0 : 1)) % house_kinds]),
              {w - 0.25, y, z - 1.6}, -pi / 2);
        f.put("wardrobe", wardrobe(s, f.detail), {4.6, y, front ? middle_wall + 0.075 : middle_wall - 0.075}, front ? 0.0 : pi);
        if (front) f.put("table lamp", table_lamp(s, f.detail), {7.8, y + 0.857, z - 0.1});
        if (front) f.put("sideboard", sideboard(s, f.detail), {7.4, y, -0.2}, pi);
        f.put("rug", rug(s, f.detail, 1.6, 1.1), {5.2, y, z - 1.7}, 0.1);
        if (front) f.put("pendant lamp", pendant_lamp(s, f.detail), {5.4, y + storey - slab, z - 2.0});
    }
    f.put("picture", picture(s, kind + level, 0.8, 0.6), {hall_wall - 0.072, y + 1.5, -4.2}, -pi / 2);
}

/// Whether each window of a house glows: always the same share of them, at random places.
std::vector<bool> lit_panes(const Kind& kind, Random& random) {
    std::size_t windows = 0;
    for (int level = 0; level < kind.storeys; ++level) {
        for (const auto& holes : {front_holes(level), back_holes(level)})
            windows +=
                static_cast<std::size_t>(std::count_if(holes.begin(), holes.end(), [](const Hole& h) { return h.is_window; }));
    }
    std::vector<bool> panes(windows, false);
    std::fill_n(panes.begin(), std::lround(lit_share * static_cast<double>(windows)), true);
    for (std::size_t i = windows; i-- > 1;) {  // Fisher and Yates
        const std::size_t other = random.below(static_cast<std::uint32_t>(i + 1));
        const bool kept = panes[i];
        panes[i] = panes[other];
        panes[other] = kept;
    }
    return panes;
}

/// The same flowers in each choice of lit windows, and the same random numbers behind it as without them.
void add_windows(SceneMaker& maker, const TownStuff& stuff, House& house, int kind, std::uint64_t seed, Random& random) {
    const Kind& k = kinds[static_cast<std::size_t>(kind)];
    const std::string name = fmt::format("house {} windows", kind);
    const Random flowers = random;
    if (stuff.lit_glass == importer::none) {
        house.parts.push_back({"windows", maker.mesh(fittings_mesh(stuff, k, name, random, {})), dmat4(1.0)});
        return;
    }
    Random places(hash_bytes(std::as_bytes(std::span(name)), fnv1a(fnv_start, seed)));
    for (int choice = 0; choice < lit_choices; ++choice) {
        random = flowers;
        importer::Mesh mesh = fittings_mesh(stuff, k, fmt::format("{}, lit {}", name, choice), random, lit_panes(k, places));
        house.lit_windows.push_back(maker.mesh(std::move(mesh)));
    }
    house.parts.push_back({"windows", house.lit_windows.front(), dmat4(1.0)});
}

}  // namespace

House make_house(SceneMaker& maker, const TownStuff& stuff, const Detail& detail, int kind, std::uint64_t seed,
                 FurnitureMade& made) {
    const Kind& k = kinds[static_cast<std::size_t>(kind)];
    Random random(seed + static_cast<std::uint64_t>(kind));
    House house;
    house.parts.push_back({"walls", maker.mesh(walls_mesh(stuff, k, kind)), dmat4(1.0)});
    add_windows(maker, stuff, house, kind, seed, random);
    // Hinged in the doorway, standing wide open into the hall, along its west side.
    house.parts.push_back({"door", maker.mesh(door_leaf(stuff.stuff, 0.96, 2.12, k.door, detail)),
                           move({house_door_m - 0.48, 0, -outer}) * turn_y(0.5 * pi - 0.08)});
    const Furnisher furnisher{maker, stuff, detail, house, random, made};
    furnish_living_room(furnisher, kind);
    furnish_kitchen(furnisher, kind);
    for (int level = 1; level < k.storeys; ++level) furnish_upstairs(furnisher, kind, level);
    return house;
}

}  // namespace surefoot::scenes
