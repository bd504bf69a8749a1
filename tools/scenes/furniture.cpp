// Furniture to sit at, lie on and put things into.
#include "tools/scenes/furniture.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"
#include "tools/scenes/textures.hpp"

namespace surefoot::scenes {
namespace {

constexpr Colour oak = rgb(214, 178, 132), walnut = rgb(150, 104, 70), white = rgb(238, 236, 230);

/// A leg turned on a lathe: foot, bulb, ring and square shoulder.
void turned_leg(MeshMaker& maker, const dvec3& at, double height, double radius, const Detail& detail) {
    if (detail.coarse())
        return maker.box(at + dvec3(-0.7 * radius, 0, -0.7 * radius), at + dvec3(0.7 * radius, height, 0.7 * radius));
    const dmat4 frame = maker.brush.frame;
    maker.brush.frame = frame * move(at);
    std::vector<dvec2> profile{{0, 0}, {0.7 * radius, 0}, {0.7 * radius, 0}};
    const int rings = detail.cut(16, 5);
    for (int i = 1; i < rings; ++i) {
        const double f = static_cast<double>(i) / rings;
        const double bulge = 0.62 + 0.3 * std::exp(-std::pow((f - 0.62) / 0.18, 2)) + 0.1 * std::sin(f * 9) * (f < 0.5 ? 1 : 0.2);
        profile.emplace_back(radius * bulge, height * f);
    }
    profile.emplace_back(radius, height);
    maker.lathe(profile, detail.cut(16, 6));
    maker.brush.frame = frame;
}

/// A board with round edges.
void board(MeshMaker& maker, const dvec3& centre, const dvec3& half, const Detail& detail) {
    if (detail.coarse()) return maker.box(centre - half, centre + half);
    maker.cushion(centre, half, 0.12, detail.cut(24, 8), detail.cut(8, 4));
}

void cushioned(MeshMaker& maker, const Stuff& stuff, const Colour& cloth, const dvec3& centre, const dvec3& half,
               const Detail& detail) {
    maker.brush.material = stuff.cloth;
    maker.brush.colour = cloth;
    maker.cushion(centre, half, 0.35, detail.cut(24, 8), detail.cut(12, 5));
}

void seat_body(MeshMaker& maker, const Stuff& stuff, const Detail& detail, const Colour& cloth, double width, int places) {
    const double half = 0.5 * width;
    cushioned(maker, stuff, shade(cloth, 0.9), {0, 0.24, 0.42}, {half, 0.15, 0.40}, detail);
    cushioned(maker, stuff, shade(cloth, 0.95), {0, 0.5, 0.13}, {half - 0.02, 0.37, 0.13}, detail);
    for (const double side : {-1.0, 1.0})
        cushioned(maker, stuff, cloth, {side * (half - 0.1), 0.38, 0.42}, {0.12, 0.24, 0.41}, detail);
    const double place = (width - 0.4) / places;
    for (int i = 0; i < places; ++i) {
        const double x = -half + 0.2 + (i + 0.5) * place;
        cushioned(maker, stuff, shade(cloth, 1.05), {x, 0.43, 0.47}, {0.51 * place, 0.1, 0.35},
                  detail);  // wider than its place: cushions press into each other
        maker.brush.frame = move({x, 0.66, 0.25}) * turn(-0.22, dvec3(1, 0, 0));
        cushioned(maker, stuff, shade(cloth, 1.1), dvec3(0), {0.5 * place, 0.22, 0.1}, detail);
        maker.brush.frame = dmat4(1.0);
    }
    maker.brush.material = stuff.wood;
    maker.brush.colour = walnut;
    for (const double x : {-half + 0.1, half - 0.1}) {
        for (const double z : {0.1, 0.74}) turned_leg(maker, {x, 0, z}, 0.14, 0.035, detail);
    }
}

}  // namespace

int Detail::cut(int n, int min) const { return std::max(min, static_cast<int>(std::lround(n * factor))); }

Stuff make_stuff(SceneMaker& maker, std::uint64_t seed) {
    const auto textured = [&](const char* name, image::Image image, model::AlphaMode alpha = model::AlphaMode::opaque,
                              bool two_sided = false) {
        return maker.material(name, {255, 255, 255, 255}, maker.image(std::move(image)), alpha, two_sided);
    };
    Stuff stuff;
    stuff.plain = maker.material("plain");
    stuff.thin = maker.material("thin", {255, 255, 255, 255}, importer::none, model::AlphaMode::opaque, true);
    stuff.wood = textured("wood", wood_grain(seed + 1, rgb(236, 224, 208)));
    stuff.cloth = textured("cloth", speckle(seed + 2, rgb(206, 206, 206), rgb(255, 255, 255), "cloth"));
    stuff.glass = textured("glass", glass(), model::AlphaMode::blend, true);
    stuff.spines = textured("book spines", book_spines(seed + 3));
    stuff.leaves = textured("leaf spray", leaves(seed + 4, rgb(46, 88, 34), rgb(122, 168, 70)), model::AlphaMode::mask, true);
    stuff.rug = textured("rug", rug(seed + 5, rgb(142, 42, 40), rgb(34, 48, 92)));
    for (int i = 0; i < 4; ++i)
        stuff.paintings[static_cast<std::size_t>(i)] =
            textured("painting", painting(seed + 10 + static_cast<std::uint64_t>(i), i));
    return stuff;
}

importer::Mesh dining_table(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("dining table");
    maker.brush = {stuff.wood, oak, dmat4(1.0), 1.0};
    board(maker, {0, 0.73, 0}, {0.95, 0.022, 0.475}, detail);
    maker.brush.colour = shade(oak, 0.9);
    for (const double z : {-0.38, 0.38}) maker.box({-0.82, 0.62, z - 0.012}, {0.82, 0.715, z + 0.012});
    for (const double x : {-0.82, 0.82}) maker.box({x - 0.012, 0.62, -0.38}, {x + 0.012, 0.715, 0.38});
    for (const double x : {-0.82, 0.82}) {
        for (const double z : {-0.38, 0.38}) turned_leg(maker, {x, 0, z}, 0.715, 0.05, detail);
    }
    return maker.take();
}

importer::Mesh chair(const Stuff& stuff, const Detail& detail, const Colour& seat) {
    MeshMaker maker("chair");
    maker.brush = {stuff.wood, walnut, dmat4(1.0), 1.0};
    board(maker, {0, 0.44, 0}, {0.22, 0.02, 0.21}, detail);
    for (const double x : {-0.18, 0.18}) {
        turned_leg(maker, {x, 0, 0.17}, 0.43, 0.026, detail);
        const std::array<dvec3, 5> post{dvec3(x, 0, -0.2), dvec3(x, 0.22, -0.185), dvec3(x, 0.44, -0.185), dvec3(x, 0.7, -0.21),
                                        dvec3(x, 0.97, -0.27)};
        maker.tube(post, std::array{0.018, 0.022, 0.024, 0.02, 0.016}, detail.cut(12, 6), true);
        maker.rod({x, 0.17, -0.18}, {x, 0.17, 0.165}, 0.011, detail.cut(8));
    }
    maker.rod({-0.18, 0.17, 0}, {0.18, 0.17, 0}, 0.011, detail.cut(8));
    maker.surface(detail.cut(14, 6), detail.cut(5, 2), [](double u, double v) {
        return dvec3((u - 0.5) * 0.4, 0.84 + 0.13 * v, -0.235 - 0.035 * v - 0.05 * std::cos((u - 0.5) * pi));
    });
    maker.surface(detail.cut(14, 6), detail.cut(5, 2), [](double u, double v) {
        return dvec3((0.5 - u) * 0.4, 0.84 + 0.13 * v, -0.255 - 0.035 * v - 0.05 * std::cos((u - 0.5) * pi));
    });
    for (int i = 0; i < 5; i += detail.coarse() ? 2 : 1) {
        const double x = -0.12 + 0.06 * i;
        maker.tube(std::array{dvec3(x, 0.45, -0.185), dvec3(x, 0.66, -0.235), dvec3(x, 0.88, -0.29)},
                   std::array{0.008, 0.011, 0.008}, detail.cut(8), false);
    }
    cushioned(maker, stuff, seat, {0, 0.475, 0.005}, {0.205, 0.03, 0.2}, detail);
    return maker.take();
}

importer::Mesh sofa(const Stuff& stuff, const Detail& detail, const Colour& cloth) {
    MeshMaker maker("sofa");
    maker.brush.uv_per_m = 2.0;
    seat_body(maker, stuff, detail, cloth, 2.1, 3);
    const std::array<Colour, 3> loose{rgb(206, 150, 52), rgb(60, 92, 108), rgb(180, 70, 52)};
    for (std::size_t i = 0; i < loose.size(); ++i) {
        maker.brush.frame = move({-0.7 + 0.62 * static_cast<double>(i), 0.68, 0.42}) *
                            turn(0.3 * static_cast<double>(i) - 0.3, dvec3(0, 0, 1)) * turn(-0.4, dvec3(1, 0, 0));
        cushioned(maker, stuff, loose[i], dvec3(0), {0.21, 0.21, 0.08}, detail);
    }
    return maker.take();
}

importer::Mesh armchair(const Stuff& stuff, const Detail& detail, const Colour& cloth) {
    MeshMaker maker("armchair");
    maker.brush.uv_per_m = 2.0;
    seat_body(maker, stuff, detail, cloth, 0.95, 1);
    return maker.take();
}

importer::Mesh coffee_table(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("coffee table");
    maker.brush = {stuff.wood, walnut, dmat4(1.0), 1.0};
    maker.cushion({0, 0.41, 0}, {0.55, 0.02, 0.3}, 1.0, detail.cut(40, 12), detail.cut(8, 4));
    maker.cushion({0, 0.16, 0}, {0.44, 0.012, 0.23}, 1.0, detail.cut(32, 12), detail.cut(6, 4));
    for (const double x : {-0.3, 0.3}) {
        for (const double z : {-0.14, 0.14}) turned_leg(maker, {x, 0, z}, 0.41, 0.026, detail);
    }
    return maker.take();
}

importer::Mesh bookshelf(const Stuff& stuff, double width, double height, int shelves) {
    MeshMaker maker("bookshelf");
    maker.brush = {stuff.wood, shade(oak, 0.82), dmat4(1.0), 1.0};
    const double half = 0.5 * width;
    for (const double x : {-half, half - 0.025}) maker.box({x, 0, 0}, {x + 0.025, height, 0.3});
    for (int i = 0; i <= shelves; ++i) {
        const double y = 0.06 + (height - 0.085) * i / shelves;
        maker.box({-half, y, 0}, {half, y + 0.025, 0.295});
    }
    maker.box({-half, 0, 0}, {half, height, 0.012});
    return maker.take();
}

importer::Mesh row_of_books(const Stuff& stuff, double width, bool fine, std::uint64_t seed) {
    static constexpr std::array<Colour, 9> covers{rgb(120, 34, 30),  rgb(28, 58, 92), rgb(40, 84, 52),
                                                  rgb(196, 160, 84), rgb(82, 52, 38), rgb(200, 190, 170),
                                                  rgb(96, 40, 84),   rgb(40, 40, 44), rgb(188, 92, 40)};
    Random random(seed);
    MeshMaker maker("books");
    maker.brush.uv_per_m = 1.0;
    for (double x = -0.5 * width; x < 0.5 * width - 0.05;) {
        const double thick = random.range(0.016, 0.05), tall = random.range(0.17, 0.26), deep = random.range(0.13, 0.21);
        const double lean = random.unit() < 0.12 ? random.range(0.05, 0.18) : 0.0;
        maker.brush.frame = move({x + tall * std::sin(lean), -0.002, 0.25}) *
                            turn(lean, dvec3(0, 0, 1));  // sunk by 2 mm: books press into the board
        maker.brush.material = stuff.spines;
        maker.brush.colour = covers[random.below(static_cast<std::uint32_t>(covers.size()))];
        maker.surface(fine ? 4 : 1, 1, [&](double u, double v) {
            return dvec3(thick * u, tall * v, 0.012 * std::sin(pi * std::clamp(u, 0.0, 1.0)));
        });
        maker.brush.material = stuff.plain;
        if (fine) {
            maker.box({0, 0, -deep}, {0.0025, tall, 0});
            maker.box({thick - 0.0025, 0, -deep}, {thick, tall, 0});
            maker.brush.colour = rgb(232, 224, 204);
            maker.box({0.0025, 0.003, 0.004 - deep}, {thick - 0.0025, tall - 0.004, -0.002});
        } else {
            maker.box({0, 0, -deep}, {thick, tall, -0.001});
        }
        x += thick * 0.985 + tall * std::sin(lean) * 1.1;  // covers touch and a little more
        if (random.unit() < 0.05) x += random.range(0.04, 0.12);
    }
    return maker.take();
}

importer::Mesh sideboard(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("sideboard");
    maker.brush = {stuff.wood, walnut, dmat4(1.0), 1.0};
    maker.box({-0.8, 0.12, 0}, {0.8, 0.83, 0.43});
    board(maker, {0, 0.84, 0.22}, {0.83, 0.018, 0.235}, detail);
    for (int i = 0; i < 3; ++i) {
        const double x = -0.53 + 0.53 * i;
        for (const auto& [low, high] : {std::pair{0.16, 0.58}, std::pair{0.61, 0.79}}) {
            maker.brush.colour = shade(walnut, 1.12);
            maker.box({x - 0.25, low, 0.42}, {x + 0.25, high, 0.445});
            if (detail.coarse()) continue;
            maker.brush.colour = rgb(196, 164, 92);
            maker.ellipsoid({x, 0.5 * (low + high), 0.46}, dvec3(0.016), detail.cut(12, 6), detail.cut(8, 4));
        }
    }
    maker.brush.colour = walnut;
    for (const double x : {-0.74, 0.74}) {
        for (const double z : {0.05, 0.38}) turned_leg(maker, {x, 0, z}, 0.13, 0.03, detail);
    }
    return maker.take();
}

importer::Mesh bed(const Stuff& stuff, const Detail& detail, const Colour& blanket) {
    MeshMaker maker("bed");
    maker.brush = {stuff.wood, oak, dmat4(1.0), 2.0};
    board(maker, {0, 0.55, 0.03}, {0.72, 0.5, 0.03}, detail);
    board(maker, {0, 0.36, 2.03}, {0.72, 0.28, 0.025}, detail);
    maker.box({-0.7, 0.2, 0.05}, {0.7, 0.3, 2.0});
    cushioned(maker, stuff, white, {0, 0.4, 1.03}, {0.69, 0.14, 0.97}, detail);
    for (const double x : {-0.34, 0.34}) cushioned(maker, stuff, rgb(250, 248, 240), {x, 0.57, 0.28}, {0.3, 0.09, 0.2}, detail);
    cushioned(maker, stuff, blanket, {0, 0.47, 1.27}, {0.75, 0.13, 0.74}, detail);
    return maker.take();
}

importer::Mesh wardrobe(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("wardrobe");
    maker.brush = {stuff.wood, shade(oak, 0.9), dmat4(1.0), 1.0};
    maker.box({-0.75, 0.06, 0}, {0.75, 2.05, 0.57});
    board(maker, {0, 2.07, 0.29}, {0.8, 0.03, 0.32}, detail);
    for (const double x : {-0.375, 0.375}) {
        maker.brush.colour = oak;
        maker.box({x - 0.36, 0.1, 0.56}, {x + 0.36, 2.02, 0.585});
        maker.brush.colour = shade(oak, 0.86);
        for (const auto& [low, high] : {std::pair{0.2, 0.95}, std::pair{1.05, 1.92}})
            maker.box({x - 0.27, low, 0.58}, {x + 0.27, high, 0.595});
        maker.brush.colour = rgb(180, 150, 90);
        maker.ellipsoid({x * 0.2, 1.05, 0.61}, dvec3(0.018), detail.cut(10, 6), detail.cut(8, 4));
    }
    return maker.take();
}

importer::Mesh kitchen(const Stuff& stuff, const Detail& detail) {
    MeshMaker maker("kitchen");
    maker.brush = {stuff.wood, white, dmat4(1.0), 1.0};
    maker.box({-1.2, 0.08, 0}, {1.2, 0.86, 0.55});
    maker.box({-1.2, 1.45, 0}, {1.2, 2.1, 0.32});
    maker.brush.colour = rgb(120, 112, 104);
    maker.box({-1.22, 0.86, 0}, {1.22, 0.9, 0.6});
    for (int i = 0; i < 4; ++i) {
        const double x = -0.9 + 0.6 * i;
        maker.brush = {stuff.wood, rgb(220, 214, 200), dmat4(1.0), 1.0};
        maker.box({x - 0.28, 0.12, 0.54}, {x + 0.28, 0.83, 0.57});
        maker.box({x - 0.28, 1.48, 0.31}, {x + 0.28, 2.07, 0.335});
        maker.brush.material = stuff.plain;
        maker.brush.colour = rgb(150, 150, 154);
        maker.rod({x - 0.1, 0.76, 0.59}, {x + 0.1, 0.76, 0.59}, 0.008, detail.cut(8));
        maker.rod({x - 0.1, 1.54, 0.355}, {x + 0.1, 1.54, 0.355}, 0.008, detail.cut(8));
    }
    maker.brush.colour = rgb(188, 190, 194);
    const std::array<dvec3, 5> tap{dvec3(-0.3, 0.9, 0.12), dvec3(-0.3, 1.12, 0.12), dvec3(-0.3, 1.18, 0.18),
                                   dvec3(-0.3, 1.18, 0.26), dvec3(-0.3, 1.12, 0.3)};
    maker.tube(tap, std::array{0.014, 0.012, 0.012, 0.012, 0.011}, detail.cut(10, 6), true);
    for (const double x : {0.45, 0.75}) {
        for (const double z : {0.18, 0.42}) {
            maker.brush.frame = move({x, 0.9, z});
            maker.brush.colour = rgb(30, 30, 32);
            maker.lathe(std::array{dvec2(0.1, 0), dvec2(0.1, 0.012), dvec2(0.1, 0.012), dvec2(0.075, 0.012), dvec2(0, 0.012)},
                        detail.cut(20, 8));
        }
    }
    return maker.take();
}

importer::Mesh rug(const Stuff& stuff, const Detail& detail, double width, double depth) {
    MeshMaker maker("rug");
    maker.brush.material = stuff.rug;
    // Not quite flat: a rug that lies.
    maker.surface(detail.cut(24, 4), detail.cut(16, 4), [&](double u, double v) {
        return dvec3((u - 0.5) * width, 0.012 + 0.004 * std::sin(u * 13) * std::sin(v * 9), (0.5 - v) * depth);
    });
    maker.brush.material = stuff.plain;
    maker.brush.colour = rgb(214, 196, 150);
    const int tassels = detail.cut(48, 8);
    for (int i = 0; i < tassels; ++i) {
        const double z = depth * ((i + 0.5) / tassels - 0.5);
        for (const double side : {-1.0, 1.0}) {
            const double x = side * 0.5 * width;
            maker.blade({x, 0.012, z}, {x + side * 0.06, 0.004, z + 0.01 * std::sin(i * 7.0)}, {0, 0, 0.008}, {0, 1, 0});
        }
    }
    return maker.take();
}

}  // namespace surefoot::scenes
