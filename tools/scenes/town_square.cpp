// What stands on the square and along the streets: town hall, fountain, lamps, benches, stalls, hedges.
#include <array>
#include <cmath>

#include "rt/base/random.hpp"
#include "tools/scenes/town.hpp"

namespace surefoot::scenes {
namespace {

constexpr Colour stone = rgb(206, 198, 182), iron = rgb(44, 50, 50);

/// One arch of the arcade under the balcony: pillars with a round arch between, along x from x0, in the plane z.
void arch(MeshMaker& maker, double x0, double width, double spring, double top, double z, int sides) {
    for (int i = 0; i < sides; ++i) {
        const double a0 = pi * i / sides, a1 = pi * (i + 1) / sides, r = 0.5 * width - 0.25, c = x0 + 0.5 * width;
        const dvec3 p0(c - r * std::cos(a0), spring + r * std::sin(a0), z),
            p1(c - r * std::cos(a1), spring + r * std::sin(a1), z);
        maker.quad({p0.x, p0.y, z}, {p1.x, p1.y, z}, {p1.x, top, z}, {p0.x, top, z});
        maker.quad({p1.x, p1.y, z}, {p0.x, p0.y, z}, {p0.x, p0.y, z - 0.4}, {p1.x, p1.y, z - 0.4});
    }
}

void hall_walls(MeshMaker& maker, const TownStuff& stuff) {
    WallStyle style{stuff.plaster, stuff.plaster, stuff.plaster, 0.5, 0.5};
    style.outer_colour = rgb(234, 214, 172);
    std::vector<Opening> front, side;
    for (int i = 0; i < 8; ++i) front.push_back({1.4 + 3.1 * i, 2.9 + 3.1 * i, 0.9, 2.7});
    for (int level = 0; level < 3; ++level) {
        std::vector<Opening> holes = front;
        if (level == 1) {
            for (Opening& o : holes) o.low = o.from > 5.5 && o.from < 15 ? 0.05 : 0.9;  // doors to the balcony
        }
        const double base = 4.5 * level - (level == 0 ? 0.1 : 0.0), high = 4.5 + (level == 0 ? 0.1 : 0.0);
        wall(maker, {{-13, -0.15}, {13, -0.15}, base, high, 0.3}, holes, style);
        wall(maker, {{13, -9.85}, {-13, -9.85}, base, high, 0.3}, front, style);
        wall(maker, {{12.85, 0}, {12.85, -10}, base, high, 0.3}, side, style);
        wall(maker, {{-12.85, -10}, {-12.85, 0}, base, high, 0.3}, side, style);
        maker.brush = {stuff.floor, {255, 255, 255, 255}, dmat4(1.0), 0.5};
        maker.quad({-12.7, base + 0.02, -0.3}, {12.7, base + 0.02, -0.3}, {12.7, base + 0.02, -9.7}, {-12.7, base + 0.02, -9.7});
        for (const Opening& o : holes) {
            maker.brush.frame = move({o.from - 13, base + o.low, -0.15});
            window(maker, stuff.stuff, o.to - o.from, o.high - o.low, 2, 3, rgb(250, 248, 240));
        }
        maker.brush = {stuff.stuff.plain, stone, dmat4(1.0), 1.0};
        maker.box({-13.1, base + high - 0.22, -0.02}, {13.1, base + high, 0.12});
    }
}

void hall_roof(MeshMaker& maker, const TownStuff& stuff) {
    maker.brush = {stuff.tiles, rgb(150, 84, 64), dmat4(1.0), 0.5};
    const double e = 13.5, r = 17.5;
    const dvec3 a(-13.5, e, 0.5), b(13.5, e, 0.5), c(13.5, e, -10.5), f(-13.5, e, -10.5), g(-9, r, -5), h(9, r, -5);
    maker.quad(a, b, h, g);
    maker.quad(c, f, g, h);
    maker.triangle(b, c, h);
    maker.triangle(f, a, g);
    maker.brush = {stuff.plaster, rgb(240, 224, 186), dmat4(1.0), 0.5};  // a clock tower
    maker.box({-1.8, 14.5, -6.8}, {1.8, 22, -3.2});
    maker.brush = {stuff.tiles, rgb(86, 120, 108), dmat4(1.0), 0.5};
    const dvec3 top(0, 26.5, -5);
    maker.triangle({-2.1, 22, -2.9}, {2.1, 22, -2.9}, top);
    maker.triangle({2.1, 22, -2.9}, {2.1, 22, -7.1}, top);
    maker.triangle({2.1, 22, -7.1}, {-2.1, 22, -7.1}, top);
    maker.triangle({-2.1, 22, -7.1}, {-2.1, 22, -2.9}, top);
    maker.brush = {stuff.stuff.plain, rgb(250, 246, 230), move({0, 19.8, -3.2}) * turn(pi / 2, dvec3(1, 0, 0)), 1.0};
    maker.lathe(std::array{dvec2(1.2, 0), dvec2(1.2, 0.1), dvec2(1.2, 0.1), dvec2(0, 0.1)}, 32);
    maker.brush = {stuff.stuff.plain, iron, move({0, 19.8, -3.08}), 1.0};
    maker.box({-0.05, -0.1, 0}, {0.05, 0.95, 0.03});
    maker.box({-0.1, -0.06, 0}, {0.65, 0.06, 0.03});
}

}  // namespace

importer::Mesh town_hall(const TownStuff& stuff, const Detail& detail) {
    MeshMaker maker("town hall");
    hall_walls(maker, stuff);
    hall_roof(maker, stuff);
    maker.brush = {stuff.paving, {255, 255, 255, 255}, dmat4(1.0), 0.5};
    maker.box({-7, balcony_m - 0.3, 0}, {3, balcony_m, 2.4});
    maker.brush = {stuff.plaster, stone, dmat4(1.0), 0.5};
    for (int i = 0; i < 5; ++i) {
        const double x = -7 + 2.5 * i;
        if (i < 4) arch(maker, x, 2.5, 2.6, balcony_m - 0.3, 2.3, detail.cut(16, 8));
        maker.box({std::max(x - 0.25, -7.0), -0.1, 1.9}, {std::min(x + 0.25, 3.0), balcony_m - 0.3, 2.3});
    }
    constexpr int steps = 27;
    maker.brush = {stuff.paving, {255, 255, 255, 255}, move({11.1, 0, 1.0}) * turn_y(-pi / 2), 0.5};
    stairs(maker, 1.8, balcony_m / steps, 0.3, steps);
    maker.brush = {stuff.plaster, stone, dmat4(1.0), 0.5};
    balustrade(maker, {-7, balcony_m, 2.3}, {3, balcony_m, 2.3}, 0.95, 0.28, detail);
    balustrade(maker, {-6.9, balcony_m, 0.1}, {-6.9, balcony_m, 2.3}, 0.95, 0.28, detail);
    balustrade(maker, {3.0, balcony_m, 1.85}, {11.0, 0.15, 1.85}, 0.95, 0.3, detail);
    return maker.take();
}

importer::Mesh fountain(const TownStuff& stuff, const Detail& detail) {
    MeshMaker maker("fountain");
    const int sides = detail.cut(96, 24);
    maker.brush = {stuff.stuff.plain, stone, dmat4(1.0), 1.0};
    maker.lathe(std::array{dvec2(4.3, 0), dvec2(4.3, 0.2), dvec2(4.3, 0.2), dvec2(4.0, 0.2), dvec2(4.0, 0.2), dvec2(3.95, 0.45),
                           dvec2(4.1, 0.62), dvec2(4.1, 0.7), dvec2(4.1, 0.7), dvec2(3.7, 0.7), dvec2(3.7, 0.7), dvec2(3.7, 0.2)},
                sides);
    maker.lathe(
        std::array{dvec2(0.9, 0.1),  dvec2(0.6, 0.3),   dvec2(0.45, 0.9),  dvec2(0.5, 1.4),  dvec2(0.5, 1.4),  dvec2(1.2, 1.55),
                   dvec2(1.8, 1.85), dvec2(1.85, 1.95), dvec2(1.85, 1.95), dvec2(1.7, 1.92), dvec2(1.1, 1.68), dvec2(0.3, 1.62),
                   dvec2(0.3, 1.62), dvec2(0.25, 2.4),  dvec2(0.25, 2.4),  dvec2(0.7, 2.5),  dvec2(1.0, 2.7),  dvec2(1.0, 2.74),
                   dvec2(0.6, 2.62), dvec2(0.1, 2.55),  dvec2(0.12, 2.9),  dvec2(0.2, 3.0),  dvec2(0.14, 3.2), dvec2(0, 3.25)},
        detail.cut(64, 16));
    maker.brush = {stuff.water, rgb(140, 190, 206), dmat4(1.0), 1.0};
    const auto pool = [&](double radius, double y) {
        maker.surface(detail.cut(40, 12), detail.cut(8, 3), [&](double u, double v) {
            const double r = radius * (1 - 0.98 * v), a = 2 * pi * u;
            return dvec3(r * std::cos(a), y + 0.015 * std::sin(9 * r) * std::cos(3 * a), -r * std::sin(a));
        });
    };
    pool(3.7, 0.55);
    pool(1.75, 1.9);
    for (int i = 0; i < 16; ++i) {  // jets falling from bowl to basin
        const double a = 2 * pi * i / 16;
        const dvec3 out(std::cos(a), 0, std::sin(a));
        std::vector<dvec3> line;
        std::vector<double> radii;
        for (int k = 0; k <= detail.cut(10, 4); ++k) {
            const double t = static_cast<double>(k) / detail.cut(10, 4);
            line.push_back(out * (1.8 + 0.8 * t) + dvec3(0, 1.93 + 0.35 * t - 1.75 * t * t, 0));
            radii.push_back(0.02 + 0.02 * t);
        }
        maker.tube(line, radii, detail.cut(8, 4), false);
    }
    return maker.take();
}

importer::Mesh street_lamp(const TownStuff& stuff, const Detail& detail) {
    MeshMaker maker("street lamp");
    maker.brush = {stuff.stuff.plain, iron, dmat4(1.0), 1.0};
    maker.lathe(std::array{dvec2(0.16, 0), dvec2(0.16, 0.1), dvec2(0.16, 0.1), dvec2(0.11, 0.16), dvec2(0.09, 0.5),
                           dvec2(0.11, 0.62), dvec2(0.06, 0.72), dvec2(0.05, 2.4), dvec2(0.07, 2.45), dvec2(0.045, 2.5),
                           dvec2(0.04, 3.9), dvec2(0.06, 3.95), dvec2(0, 4.02)},
                detail.cut(24, 8));
    std::vector<dvec3> arm;
    std::vector<double> radii;
    for (int i = 0; i <= detail.cut(14, 6); ++i) {
        const double a = pi * i / detail.cut(14, 6);
        arm.emplace_back(0, 3.7 + 0.42 * std::sin(a), 0.35 - 0.35 * std::cos(a));
        radii.push_back(0.022);
    }
    maker.tube(arm, radii, detail.cut(10, 5), false);
    maker.brush.frame = move({0, 3.18, 0.7});
    maker.lathe(std::array{dvec2(0.2, 0.42), dvec2(0.12, 0.5), dvec2(0.03, 0.54)}, detail.cut(16, 8));
    maker.lathe(std::array{dvec2(0, -0.05), dvec2(0.1, 0), dvec2(0.12, 0.05)}, detail.cut(16, 8));
    maker.brush.material = stuff.lamp_glass;
    maker.brush.colour = rgb(255, 240, 196);
    maker.lathe(std::array{dvec2(0.1, 0.04), dvec2(0.17, 0.42)}, detail.cut(16, 8));
    return maker.take();
}

importer::Mesh bench(const TownStuff& stuff, const Detail& detail) {
    MeshMaker maker("bench");
    maker.brush = {stuff.stuff.wood, rgb(168, 120, 80), dmat4(1.0), 1.0};
    for (int i = 0; i < 4; ++i) maker.box({-0.85, 0.43, -0.2 + 0.12 * i}, {0.85, 0.46, -0.11 + 0.12 * i});
    for (int i = 0; i < 3; ++i) maker.box({-0.85, 0.54 + 0.13 * i, -0.27 - 0.02 * i}, {0.85, 0.64 + 0.13 * i, -0.24 - 0.02 * i});
    maker.brush = {stuff.stuff.plain, iron, dmat4(1.0), 1.0};
    for (const double x : {-0.7, 0.7}) {
        const std::array<dvec3, 5> side{dvec3(x, 0, 0.26), dvec3(x, 0.3, 0.2), dvec3(x, 0.42, 0.22), dvec3(x, 0.42, -0.22),
                                        dvec3(x, 0.9, -0.33)};
        maker.tube(side, std::array{0.025, 0.022, 0.022, 0.022, 0.018}, detail.cut(10, 5), true);
        maker.rod({x, 0, -0.3}, {x, 0.43, -0.2}, 0.022, detail.cut(10, 5));
    }
    return maker.take();
}

importer::Mesh market_stall(const TownStuff& stuff, const Detail& detail, const Colour& stripe) {
    static constexpr std::array<Colour, 5> goods{rgb(200, 50, 40), rgb(236, 150, 40), rgb(130, 170, 60), rgb(240, 210, 80),
                                                 rgb(120, 60, 110)};
    MeshMaker maker("market stall");
    maker.brush = {stuff.stuff.wood, rgb(176, 134, 92), dmat4(1.0), 1.0};
    for (const double x : {-1.3, 1.3}) {
        for (const double z : {-0.8, 0.8}) maker.box({x - 0.04, 0, z - 0.04}, {x + 0.04, z > 0 ? 2.1 : 2.5, z + 0.04});
    }
    maker.box({-1.35, 0.78, -0.6}, {1.35, 0.84, 0.75});
    maker.brush.material = stuff.stuff.thin;
    for (int i = 0; i < 9; ++i) {
        maker.brush.colour = i % 2 == 0 ? stripe : rgb(246, 242, 232);
        const double x = -1.53 + 0.34 * i;
        maker.surface(1, detail.cut(8, 3), [&](double u, double v) {
            return dvec3(x + 0.34 * u, 2.02 + 0.5 * v - 0.12 * std::sin(pi * v), 1.0 - 1.9 * v);
        });
        maker.surface(2, 1, [&](double u, double v) {
            return dvec3(x + 0.34 * u, 1.84 + 0.18 * v - 0.05 * std::sin(pi * u) * (1 - v), 1.0);
        });
    }
    Random random(91);
    for (int crate = 0; crate < 6; ++crate) {
        const double x = -1.1 + 0.44 * crate;
        maker.brush = {stuff.stuff.wood, rgb(196, 160, 112), dmat4(1.0), 1.0};
        maker.box({x - 0.2, 0.84, -0.2}, {x + 0.2, 0.94, 0.6});
        maker.brush.material = stuff.stuff.plain;
        for (int i = 0; i < 18; ++i) {
            maker.brush.colour = shade(goods[static_cast<std::size_t>(crate) % goods.size()], random.range(0.85, 1.1));
            const int column = i % 3, row = i / 3;
            maker.ellipsoid({x - 0.13 + 0.13 * column, 0.96, -0.12 + 0.125 * row}, dvec3(0.065), detail.cut(10, 6),
                            detail.cut(7, 4));
        }
    }
    return maker.take();
}

importer::Mesh hedge(const TownStuff& stuff, double length, std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker("hedge");
    maker.brush = {stuff.plants.leaf, {255, 255, 255, 255}, dmat4(1.0), 1.0};
    const int count = static_cast<int>(length * 14);
    for (int i = 0; i < count; ++i) {
        const dvec3 at = any_in(random, {0, 0.1, -0.25}, {length, 1.0, 0.25});
        const dvec3 up = any_in(random, {-0.2, 0.35, -0.2}, {0.2, 0.35, 0.2});
        const double side = random.range(0, 2 * pi);
        maker.brush.colour = shade(rgb(225, 235, 215), 0.6 + 0.35 * at.y);
        maker.leaf(at, at + up, dvec3(0.26 * std::cos(side), 0, 0.26 * std::sin(side)), glm::normalize(dvec3(0, 0.7, at.z * 3)));
    }
    return maker.take();
}

}  // namespace surefoot::scenes
