// The small things that make a room lived in: lamps, crockery, plants, pictures, curtains.
#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"
#include "tools/scenes/furniture.hpp"

namespace surefoot::scenes {
namespace {

constexpr Colour brass = rgb(190, 156, 84), china = rgb(242, 240, 234), dark_wood = rgb(96, 66, 46);

/// Profile points along a curve given by its radius at f in 0..1.
template <class Radius>
std::vector<dvec2> curve(double height, int rings, const Radius& radius) {
    std::vector<dvec2> out;
    for (int i = 0; i <= rings; ++i) {
        const double f = static_cast<double>(i) / rings;
        out.emplace_back(radius(f), height * f);
    }
    return out;
}

void shade_cone(MeshMaker& maker, const Stuff& stuff, double y, double low, double high, double height, const Detail& detail) {
    const dmat4 frame = maker.brush.frame;
    maker.brush.material = stuff.thin;
    maker.brush.colour = rgb(244, 226, 184);
    maker.brush.frame = frame * move({0, y, 0});
    maker.lathe(curve(height, detail.cut(6, 2), [&](double f) { return low + (high - low) * f; }), detail.cut(36, 10));
    maker.brush.material = stuff.plain;
    maker.brush.frame = frame * move({0, y + 0.45 * height, 0});
    maker.brush.colour = rgb(255, 248, 220);
    maker.ellipsoid(dvec3(0), {0.03, 0.045, 0.03}, detail.cut(14, 6), detail.cut(10, 4));
    maker.brush.frame = frame;
}

void stem(MeshMaker& maker, double height, double foot, double thin, const Detail& detail) {
    maker.lathe(std::array{dvec2(0, 0), dvec2(foot, 0), dvec2(foot, 0), dvec2(foot, 0.02), dvec2(0.7 * foot, 0.035),
                           dvec2(thin * 1.6, 0.06), dvec2(thin, 0.12), dvec2(thin, 0.5 * height),
                           dvec2(thin * 1.7, 0.53 * height), dvec2(thin, 0.56 * height), dvec2(thin, height)},
                detail.cut(24, 8));
}

/// Inside and outside of a thin vessel of revolution.
void vessel(MeshMaker& maker, const std::vector<dvec2>& outside, double wall, int sides) {
    std::vector<dvec2> profile = outside;
    for (std::size_t i = outside.size(); i-- > 1;)
        profile.emplace_back(std::max(outside[i].x - wall, 0.0), outside[i].y + (i + 1 == outside.size() ? 0.0 : wall));
    profile.emplace_back(0.0, outside[0].y + wall);
    maker.lathe(profile, sides);
}

}  // namespace

importer::Mesh floor_lamp(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("floor lamp");
    maker.brush = {stuff.plain, brass, dmat4(1.0), 1.0};
    stem(maker, 1.5, 0.15, 0.012, detail);
    shade_cone(maker, stuff, 1.36, 0.24, 0.14, 0.3, detail);
    return maker.take();
}

importer::Mesh table_lamp(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("table lamp");
    maker.brush = {stuff.plain, rgb(62, 104, 112), dmat4(1.0), 1.0};
    maker.lathe(curve(0.26, detail.cut(20, 7),
                      [](double f) { return f >= 1 ? 0.0 : 0.02 + 0.06 * std::pow(std::sin(pi * (0.12 + 0.8 * f)), 2); }),
                detail.cut(28, 8));
    maker.brush.colour = brass;
    maker.rod({0, 0.24, 0}, {0, 0.36, 0}, 0.008, detail.cut(10));
    shade_cone(maker, stuff, 0.3, 0.15, 0.09, 0.19, detail);
    return maker.take();
}

importer::Mesh pendant_lamp(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("pendant lamp");
    maker.brush = {stuff.plain, rgb(40, 40, 42), dmat4(1.0), 1.0};
    maker.rod({0, -0.78, 0}, {0, 0, 0}, 0.006, detail.cut(8));
    maker.brush.frame = move({0, -0.03, 0});
    maker.lathe(std::array{dvec2(0, -0.03), dvec2(0.06, -0.015), dvec2(0.06, 0.03)}, detail.cut(16, 6));
    maker.brush.frame = move({0, -1.0, 0});
    maker.brush.material = stuff.thin;
    maker.brush.colour = rgb(52, 78, 72);
    maker.lathe(curve(0.24, detail.cut(12, 4), [](double f) { return 0.025 + 0.215 * std::sqrt(std::max(0.0, 1 - f * f)); }),
                detail.cut(36, 10));
    maker.brush.material = stuff.plain;
    maker.brush.colour = rgb(255, 248, 220);
    maker.ellipsoid({0, 0.06, 0}, dvec3(0.05), detail.cut(16, 6), detail.cut(10, 4));
    return maker.take();
}

importer::Mesh picture(const Stuff& stuff, int which, double width, double height) {
    MeshMaker maker("picture");
    const double x = 0.5 * width, y = 0.5 * height, rim = 0.045;
    maker.brush = {stuff.plain, which % 2 == 0 ? brass : dark_wood, dmat4(1.0), 1.0};
    maker.box({-x - rim, y, 0}, {x + rim, y + rim, 0.03});
    maker.box({-x - rim, -y - rim, 0}, {x + rim, -y, 0.03});
    maker.box({-x - rim, -y, 0}, {-x, y, 0.03});
    maker.box({x, -y, 0}, {x + rim, y, 0.03});
    maker.brush.material = stuff.paintings[static_cast<std::size_t>(which) % stuff.paintings.size()];
    maker.brush.colour = {255, 255, 255, 255};
    maker.picture({-x, -y, 0.012}, {x, -y, 0.012}, {x, y, 0.012}, {-x, y, 0.012});
    return maker.take();
}

importer::Mesh curtain(const Stuff& stuff, const Detail& detail, double width, double height, const Colour& colour) {
    MeshMaker maker("curtain");
    maker.brush = {stuff.thin, colour, dmat4(1.0), 1.0};
    maker.surface(detail.cut(56, 12), detail.cut(12, 3), [&](double u, double v) {
        const double swing = 0.045 * std::sin(u * 2 * pi * 7) * (0.6 + 0.4 * (1 - v)) + 0.02 * std::sin(u * 9 + v * 5);
        return dvec3((u - 0.5) * width * (0.92 + 0.08 * v), height * v, swing);
    });
    maker.brush = {stuff.plain, dark_wood, dmat4(1.0), 1.0};
    maker.rod({-0.55 * width, height + 0.02, 0}, {0.55 * width, height + 0.02, 0}, 0.014, detail.cut(10));
    for (const double x : {-0.55 * width, 0.55 * width})
        maker.ellipsoid({x, height + 0.02, 0}, dvec3(0.03), detail.cut(12, 6), detail.cut(8, 4));
    return maker.take();
}

importer::Mesh potted_plant(const Stuff& stuff, const Detail& detail, std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker("potted plant");
    maker.brush = {stuff.plain, rgb(176, 96, 62), dmat4(1.0), 1.0};
    vessel(maker, curve(0.32, detail.cut(8, 4), [](double f) { return 0.13 + 0.06 * f + (f > 0.85 ? 0.015 : 0.0); }), 0.012,
           detail.cut(32, 9));
    maker.brush.colour = rgb(62, 46, 34);
    maker.brush.frame = move({0, 0.27, 0});
    maker.lathe(std::array{dvec2(0.17, 0), dvec2(0, 0.015)}, detail.cut(20, 8));
    maker.brush.frame = dmat4(1.0);
    const int stems = detail.cut(26, 9);
    for (int i = 0; i < stems; ++i) {
        const double angle = i * 2.39996, reach = random.range(0.18, 0.5), rise = random.range(0.35, 1.0);
        const dvec3 out(std::cos(angle), 0, std::sin(angle)), side = dvec3(-out.z, 0, out.x);
        maker.brush.material = stuff.thin;
        maker.brush.colour = mix(rgb(36, 84, 40), rgb(112, 158, 68), random.unit());
        maker.surface(detail.cut(4, 2), detail.cut(10, 3), [&](double u, double v) {
            const double w = 0.055 * std::sin(pi * std::clamp(0.08 + 0.92 * v, 0.0, 1.0)) * (u - 0.5) * 2;
            return dvec3(0, 0.28, 0) + out * (reach * v) + dvec3(0, rise * v - 0.9 * rise * v * v * v * 0.6, 0) + side * w +
                   dvec3(0, 0.3 * std::abs(w), 0);
        });
    }
    return maker.take();
}

importer::Mesh vase_of_flowers(const Stuff& stuff, const Detail& detail, std::uint64_t seed) {
    static constexpr std::array<Colour, 4> petals{rgb(214, 66, 58), rgb(240, 196, 70), rgb(232, 232, 240), rgb(190, 100, 170)};
    Random random(seed);
    MeshMaker maker("vase of flowers");
    maker.brush = {stuff.plain, rgb(70, 110, 150), dmat4(1.0), 1.0};
    vessel(maker,
           curve(0.24, detail.cut(18, 7),
                 [](double f) { return 0.035 + 0.045 * std::pow(std::sin(pi * (0.1 + 0.75 * f)), 2) + 0.02 * f * f; }),
           0.006, detail.cut(28, 8));
    const int flowers = detail.cut(14, 5);
    for (int i = 0; i < flowers; ++i) {
        const double angle = i * 2.39996;
        const dvec3 out(std::cos(angle), 0, std::sin(angle));
        const double high = random.range(0.34, 0.5), aside = random.range(0.03, 0.16);
        const dvec3 tip = out * aside + dvec3(0, high, 0);
        maker.brush.colour = rgb(70, 116, 52);
        maker.tube(std::array{dvec3(0, 0.12, 0), 0.5 * tip + dvec3(0, 0.1, 0) + out * 0.01, tip}, std::array{0.003, 0.003, 0.003},
                   5, false);
        maker.brush.colour = petals[random.below(4)];
        maker.cushion(tip, {0.03, 0.022, 0.03}, 0.8, detail.cut(10, 6), detail.cut(6, 4));
        maker.brush.colour = rgb(236, 200, 60);
        maker.ellipsoid(tip + dvec3(0, 0.018, 0), dvec3(0.011), detail.cut(8, 5), detail.cut(6, 4));
    }
    return maker.take();
}

importer::Mesh bowl_of_fruit(const Stuff& stuff, const Detail& detail) {
    static constexpr std::array<Colour, 4> skins{rgb(196, 44, 36), rgb(232, 140, 38), rgb(150, 176, 60), rgb(222, 196, 70)};
    MeshMaker maker("bowl of fruit");
    maker.brush = {stuff.plain, rgb(84, 128, 120), dmat4(1.0), 1.0};
    vessel(maker, curve(0.09, detail.cut(10, 4), [](double f) { return 0.05 + 0.11 * std::sqrt(f); }), 0.006, detail.cut(36, 10));
    for (int i = 0; i < 7; ++i) {
        const double angle = i * 1.0472, ring = i == 6 ? 0.0 : 0.075;
        maker.brush.colour = skins[static_cast<std::size_t>(i) % 4];
        maker.ellipsoid({ring * std::cos(angle), i == 6 ? 0.13 : 0.085, ring * std::sin(angle)}, {0.042, 0.039, 0.042},
                        detail.cut(20, 7), detail.cut(14, 5));
    }
    return maker.take();
}

importer::Mesh teapot(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("teapot");
    maker.brush = {stuff.plain, china, dmat4(1.0), 1.0};
    maker.lathe(curve(0.14, detail.cut(18, 7),
                      [](double f) { return f >= 1 ? 0.0 : 0.04 + 0.055 * std::pow(std::sin(pi * (0.1 + 0.72 * f)), 1.0); }),
                detail.cut(32, 9));
    maker.brush.colour = rgb(60, 84, 140);
    maker.ellipsoid({0, 0.15, 0}, dvec3(0.014), detail.cut(12, 6), detail.cut(8, 4));
    maker.brush.colour = china;
    maker.tube(std::array{dvec3(0.07, 0.05, 0), dvec3(0.12, 0.065, 0), dvec3(0.14, 0.1, 0), dvec3(0.165, 0.125, 0)},
               std::array{0.024, 0.017, 0.013, 0.01}, detail.cut(14, 6), false);
    std::vector<dvec3> handle;
    std::vector<double> radii;
    for (int i = 0; i <= detail.cut(12, 5); ++i) {
        const double a = pi * (0.5 + static_cast<double>(i) / detail.cut(12, 5));
        handle.emplace_back(-0.075 + 0.055 * std::cos(a), 0.075 + 0.045 * std::sin(a), 0);
        radii.push_back(0.009);
    }
    maker.tube(handle, radii, detail.cut(10, 5), false);
    return maker.take();
}

importer::Mesh cup(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("cup");
    maker.brush = {stuff.plain, china, dmat4(1.0), 1.0};
    maker.lathe(
        std::array{dvec2(0, 0), dvec2(0.04, 0), dvec2(0.075, 0.012), dvec2(0.075, 0.015), dvec2(0.04, 0.006), dvec2(0, 0.006)},
        detail.cut(28, 8));
    maker.brush.frame = move({0, 0.006, 0});
    vessel(maker, curve(0.065, detail.cut(8, 4), [](double f) { return 0.022 + 0.02 * std::sqrt(f); }), 0.003, detail.cut(28, 8));
    maker.tube(std::array{dvec3(0.036, 0.05, 0), dvec3(0.06, 0.05, 0), dvec3(0.06, 0.022, 0), dvec3(0.034, 0.018, 0)},
               std::array{0.004, 0.004, 0.004, 0.004}, detail.cut(8, 4), false);
    return maker.take();
}

importer::Mesh plate(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("plate");
    maker.brush = {stuff.plain, china, dmat4(1.0), 1.0};
    maker.lathe(std::array{dvec2(0, 0), dvec2(0.07, 0), dvec2(0.09, 0.006), dvec2(0.13, 0.018), dvec2(0.131, 0.021),
                           dvec2(0.09, 0.01), dvec2(0.07, 0.005), dvec2(0, 0.005)},
                detail.cut(36, 10));
    maker.brush.colour = rgb(60, 84, 140);
    maker.lathe(std::array{dvec2(0.1, 0.0135), dvec2(0.112, 0.0165)}, detail.cut(36, 10));
    return maker.take();
}

importer::Mesh candlestick(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("candlestick");
    maker.brush = {stuff.plain, brass, dmat4(1.0), 1.0};
    stem(maker, 0.22, 0.05, 0.008, detail);
    maker.brush.colour = rgb(240, 232, 210);
    maker.rod({0, 0.22, 0}, {0, 0.42, 0}, 0.011, detail.cut(12, 6));
    return maker.take();
}

importer::Mesh radiator(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("radiator");
    maker.brush = {stuff.plain, rgb(236, 234, 228), dmat4(1.0), 1.0};
    for (int i = 0; i < 16; ++i) {
        const double x = -0.56 + 0.075 * i;
        const std::array<dvec3, 6> rib{dvec3(x, 0.12, 0.06), dvec3(x, 0.1, 0.1),  dvec3(x, 0.14, 0.13),
                                       dvec3(x, 0.62, 0.13), dvec3(x, 0.66, 0.1), dvec3(x, 0.64, 0.06)};
        maker.tube(rib, std::array{0.024, 0.028, 0.03, 0.03, 0.028, 0.024}, detail.cut(8, 4), true);
    }
    for (const double y : {0.14, 0.62}) maker.rod({-0.6, y, 0.1}, {0.62, y, 0.1}, 0.022, detail.cut(10));
    maker.rod({0.6, 0, 0.1}, {0.6, 0.62, 0.1}, 0.012, detail.cut(8));
    return maker.take();
}

importer::Mesh wall_clock(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("wall clock");
    maker.brush = {stuff.plain, dark_wood, turn(pi / 2, dvec3(1, 0, 0)), 1.0};
    maker.lathe(std::array{dvec2(0.17, 0), dvec2(0.17, 0.03), dvec2(0.155, 0.045), dvec2(0.14, 0.04), dvec2(0.14, 0.03)},
                detail.cut(40, 12));
    maker.brush.colour = rgb(246, 242, 230);
    maker.lathe(std::array{dvec2(0.142, 0.03), dvec2(0, 0.03)}, detail.cut(40, 12));
    maker.brush = {stuff.plain, rgb(30, 28, 28), dmat4(1.0), 1.0};
    for (int i = 0; i < 12; ++i) {
        maker.brush.frame = turn(i * pi / 6, dvec3(0, 0, 1));
        maker.box({-0.004, 0.112, 0.03}, {0.004, 0.132, 0.033});
    }
    maker.brush.frame = turn(-1.1, dvec3(0, 0, 1));
    maker.box({-0.005, -0.02, 0.034}, {0.005, 0.08, 0.037});
    maker.brush.frame = turn(0.7, dvec3(0, 0, 1));
    maker.box({-0.0035, -0.02, 0.038}, {0.0035, 0.115, 0.041});
    return maker.take();
}

}  // namespace surefoot::scenes
