// Walls with openings, windows, doors, stairs, railings: the parts of rooms and houses.
#include "tools/scenes/building.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::scenes {
namespace {

/// Positions on a wall: along, up, and out of its middle.
struct WallFrame {
    dvec3 origin, along, out;
    [[nodiscard]] dvec3 at(double s, double y, double n) const { return origin + along * s + dvec3(0, y, 0) + out * n; }
};

struct WallBuilder {
    MeshMaker& maker;
    const WallFrame& frame;
    const WallStyle& style;
    double half;

    void piece(double s0, double s1, double y0, double y1) const {
        if (s1 - s0 < 1e-6 || y1 - y0 < 1e-6) return;
        use(style.outer, style.outer_colour, style.outer_uv);
        maker.quad(frame.at(s0, y0, half), frame.at(s1, y0, half), frame.at(s1, y1, half), frame.at(s0, y1, half));
        use(style.inner, style.inner_colour, style.inner_uv);
        maker.quad(frame.at(s1, y0, -half), frame.at(s0, y0, -half), frame.at(s0, y1, -half), frame.at(s1, y1, -half));
    }
    /// The four inner faces of an opening (no threshold where it starts at the floor).
    void reveals(const Opening& o) const {
        use(style.reveal, style.reveal_colour, style.inner_uv);
        maker.quad(frame.at(o.from, o.low, half), frame.at(o.from, o.low, -half), frame.at(o.from, o.high, -half),
                   frame.at(o.from, o.high, half));
        maker.quad(frame.at(o.to, o.low, -half), frame.at(o.to, o.low, half), frame.at(o.to, o.high, half),
                   frame.at(o.to, o.high, -half));
        maker.quad(frame.at(o.from, o.high, half), frame.at(o.from, o.high, -half), frame.at(o.to, o.high, -half),
                   frame.at(o.to, o.high, half));
        if (o.low > 0)
            maker.quad(frame.at(o.from, o.low, -half), frame.at(o.from, o.low, half), frame.at(o.to, o.low, half),
                       frame.at(o.to, o.low, -half));
    }
    void ends(double length, double height) const {
        use(style.outer, style.outer_colour, style.outer_uv);
        maker.quad(frame.at(0, 0, -half), frame.at(0, 0, half), frame.at(0, height, half), frame.at(0, height, -half));
        maker.quad(frame.at(length, 0, half), frame.at(length, 0, -half), frame.at(length, height, -half),
                   frame.at(length, height, half));
        maker.quad(frame.at(0, height, half), frame.at(length, height, half), frame.at(length, height, -half),
                   frame.at(0, height, -half));
    }
    void use(Index material, const Colour& colour, double uv) const {
        maker.brush.material = material;
        maker.brush.colour = colour;
        maker.brush.uv_per_m = uv;
    }
};

}  // namespace

void wall(MeshMaker& maker, const WallRun& run, std::span<const Opening> openings, const WallStyle& style) {
    const dvec2 along2 = run.to - run.from;
    const double length = glm::length(along2);
    const dvec3 along(along2.x / length, 0, along2.y / length);
    const WallFrame frame{{run.from.x, run.base, run.from.y}, along, glm::cross(along, dvec3(0, 1, 0))};
    const WallBuilder builder{maker, frame, style, 0.5 * run.thickness};
    double done = 0;
    for (const Opening& o : openings) {
        builder.piece(done, o.from, 0, run.height);
        builder.piece(o.from, o.to, 0, o.low);
        builder.piece(o.from, o.to, o.high, run.height);
        builder.reveals(o);
        done = o.to;
    }
    builder.piece(done, length, 0, run.height);
    builder.ends(length, run.height);
}

void window(MeshMaker& maker, const Stuff& stuff, double width, double height, int panes_across, int panes_up,
            const Colour& frame) {
    constexpr double rim = 0.05, bar = 0.025;
    maker.brush.material = stuff.plain;
    maker.brush.colour = frame;
    maker.box({0, 0, -0.05}, {rim, height, 0.05});
    maker.box({width - rim, 0, -0.05}, {width, height, 0.05});
    maker.box({rim, 0, -0.05}, {width - rim, rim, 0.05});
    maker.box({rim, height - rim, -0.05}, {width - rim, height, 0.05});
    for (int i = 1; i < panes_across; ++i) {
        const double x = width * i / panes_across;
        maker.box({x - 0.5 * bar, rim, -0.02}, {x + 0.5 * bar, height - rim, 0.02});
    }
    for (int i = 1; i < panes_up; ++i) {
        const double y = height * i / panes_up;
        maker.box({rim, y - 0.5 * bar, -0.018}, {width - rim, y + 0.5 * bar, 0.018});
    }
    maker.box({-0.04, -0.04, 0.0}, {width + 0.04, 0, 0.16});
    maker.brush.material = stuff.glass;
    maker.brush.colour = {255, 255, 255, 255};
    maker.picture({rim, rim, 0}, {width - rim, rim, 0}, {width - rim, height - rim, 0}, {rim, height - rim, 0});
}

void door_lining(MeshMaker& maker, const Stuff& stuff, double width, double height, double depth, const Colour& colour) {
    maker.brush.material = stuff.plain;
    maker.brush.colour = colour;
    const double z = 0.5 * depth + 0.012;
    maker.box({-0.07, 0, -z}, {0.02, height + 0.07, z});
    maker.box({width - 0.02, 0, -z}, {width + 0.07, height + 0.07, z});
    maker.box({0.02, height - 0.02, -z}, {width - 0.02, height + 0.07, z});
}

importer::Mesh door_leaf(const Stuff& stuff, double width, double height, const Colour& colour, const Detail& detail) {
    MeshMaker maker("door");
    maker.brush = {stuff.wood, colour, dmat4(1.0), 1.0};
    maker.box({0, 0.01, -0.02}, {width, height, 0.02});
    for (const double side : {-1.0, 1.0}) {
        for (const auto& [low, high] : {std::pair{0.2, 0.85}, std::pair{1.0, height - 0.18}}) {
            maker.brush.colour = shade(colour, 0.88);
            maker.box({0.13, low, side > 0 ? 0.02 : -0.03}, {width - 0.13, high, side > 0 ? 0.03 : -0.02});
        }
        maker.brush.material = stuff.plain;
        maker.brush.colour = rgb(190, 160, 90);
        maker.rod({width - 0.07, 1.02, side * 0.02}, {width - 0.07, 1.02, side * 0.06}, 0.011, detail.cut(10, 6));
        maker.ellipsoid({width - 0.07, 1.02, side * 0.075}, {0.028, 0.028, 0.02}, detail.cut(14, 6), detail.cut(10, 4));
        maker.brush.material = stuff.wood;
    }
    return maker.take();
}

void stairs(MeshMaker& maker, double width, double rise, double run, int steps) {
    for (int i = 0; i < steps; ++i) {
        const double bottom = std::max(0.0, (i - 1) * rise);
        maker.box({-0.5 * width, bottom, i * run}, {0.5 * width, (i + 1) * rise, (i + 1) * run + 0.02});
    }
}

void balustrade(MeshMaker& maker, const dvec3& from, const dvec3& to, double height, double spacing, const Detail& detail) {
    const dmat4 frame = maker.brush.frame;
    const double length = glm::length(to - from);
    const int count = std::max(1, static_cast<int>(length / spacing));
    std::vector<dvec2> profile{{0.03, 0}};
    const int rings = detail.cut(10, 4);
    for (int i = 1; i < rings; ++i) {
        const double f = static_cast<double>(i) / rings;
        profile.emplace_back(0.014 + 0.022 * std::pow(std::sin(pi * std::pow(f, 0.7)), 2), (height - 0.05) * f);
    }
    profile.emplace_back(0.03, height - 0.05);
    for (int i = 0; i <= count; ++i) {
        maker.brush.frame = frame * move(glm::mix(from, to, static_cast<double>(i) / count));
        maker.lathe(profile, detail.cut(10, 5));
    }
    maker.brush.frame = frame;
    maker.tube(std::array{from + dvec3(0, height, 0), to + dvec3(0, height, 0)}, std::array{0.045, 0.045}, detail.cut(10, 6),
               true);
    maker.tube(std::array{from, to}, std::array{0.03, 0.03}, detail.cut(8, 5), true);
}

}  // namespace surefoot::scenes
