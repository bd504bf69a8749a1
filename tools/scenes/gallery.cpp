// Spheres and cylinder of the gallery, its knot, the place of the statue, and the path of a minute past them.
#include "tools/scenes/gallery.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "rt/base/random.hpp"
#include "tools/scenes/path_maker.hpp"
#include "tools/scenes/scene_maker.hpp"

namespace surefoot::scenes {
namespace {

constexpr double eye_m = 0.6, path_s = 60, statue_length_m = 1.2;
constexpr dvec3 first_sphere(0.7, eye_m, 0.5), second_sphere(3.3, eye_m, 1.2), cylinder(0.8, eye_m, 2.1),
    statue_at(2.6, eye_m, 3.0);

/// A tube along a trefoil knot: 5760 triangles.
importer::Mesh knot() {
    MeshMaker maker("knot");
    maker.brush.colour = rgb(214, 188, 150);
    constexpr int steps = 160;
    std::vector<dvec3> centres;
    for (int i = 0; i <= steps; ++i) {
        const double t = 2 * pi * i / steps;
        centres.emplace_back(0.13 * (std::sin(t) + 2 * std::sin(2 * t)), 0.13 * (std::cos(t) - 2 * std::cos(2 * t)),
                             -0.16 * std::sin(3 * t));
    }
    maker.tube(centres, std::vector<double>(centres.size(), 0.07), 18, false);
    return maker.take();
}

importer::Mesh ball(int sides) {
    MeshMaker maker("sphere");
    maker.brush.colour = rgb(226, 226, 220);
    maker.ellipsoid(dvec3(0), dvec3(0.35), sides, sides / 2);
    return maker.take();
}

importer::Mesh drum(int sides) {
    MeshMaker maker("cylinder");
    maker.brush.colour = rgb(200, 214, 226);
    const std::array<dvec2, 6> profile{dvec2(0, -0.5),   dvec2(0.25, -0.5), dvec2(0.25, -0.5),
                                       dvec2(0.25, 0.5), dvec2(0.25, 0.5),  dvec2(0, 0.5)};
    maker.lathe(profile, sides);
    return maker.take();
}

/// Moves a scene so that its longest side is 1.2 m and its middle is where the statue stands.
void place_statue(importer::Scene& statue) {
    Box box;
    for (const importer::Node& node : statue.nodes) {
        if (node.mesh == importer::none) continue;
        for (const importer::Primitive& part : statue.meshes[node.mesh].primitives)
            for (const vec3& at : part.positions) box.grow(dvec3(node.world * dvec4(dvec3(at), 1.0)));
    }
    const dvec3 size = box.max - box.min;
    const double longest = std::max({size.x, size.y, size.z, 1e-9});
    const double factor = statue_length_m / longest;
    const dmat4 to_place = move(statue_at) * stretch(dvec3(factor)) * move(-box.centre());
    for (importer::Node& node : statue.nodes) node.world = to_place * node.world;
    for (importer::Lamp& lamp : statue.lamps) {  // so that its surfaces get as much light as before
        lamp.at = dvec3(to_place * dvec4(lamp.at, 1.0));
        lamp.range_m *= factor;
        lamp.candela *= factor * factor;
    }
}

/// Each object comes into view alone, with nothing in view between them.
Path gallery_path() {
    const std::array<Waypoint, 11> way{Waypoint{{1.9, eye_m, -0.9}, first_sphere, false, 2},
                                       Waypoint{{2.0, eye_m, -0.6}, first_sphere, false, 0.0},
                                       Waypoint{{2.0, eye_m, -0.3}, {2.0, eye_m, -3.0}, false, 0.0},
                                       Waypoint{{2.1, eye_m, 0.1}, {4.2, eye_m, 0.2}, false, 0.0},
                                       Waypoint{{2.1, eye_m, 0.5}, second_sphere, false, 2},
                                       Waypoint{{2.0, eye_m, 0.9}, second_sphere, false, 0.0},
                                       Waypoint{{1.9, eye_m, 1.2}, {2.0, eye_m, -3.0}, false, 0.0},
                                       Waypoint{{1.8, eye_m, 1.4}, cylinder, false, 2},
                                       Waypoint{{1.8, eye_m, 1.7}, cylinder, false, 0.0},
                                       Waypoint{{1.9, eye_m, 1.8}, statue_at, false, 0.0},
                                       Waypoint{{2.3, eye_m, 2.1}, statue_at, false, 3}};
    return make_path(way, path_s);
}

}  // namespace

GeneratedScene make_gallery(double scale, std::uint64_t seed, importer::Scene statue) {
    SceneMaker maker;
    const Index material = maker.material("plaster");
    const int sides = std::max(8, 4 * static_cast<int>(std::lround(16 * std::sqrt(scale))));
    const int drum_sides = std::max(12, static_cast<int>(std::lround(128 * scale)));
    Random random(seed);
    const auto placed = [&](const dvec3& at) {
        const dvec3 aside(random.range(-0.05, 0.05), 0, random.range(-0.05, 0.05));
        return move(at + aside) * turn_y(random.range(0, 2 * pi));
    };
    const Index sphere_mesh = maker.mesh(ball(sides));
    for (importer::Primitive& part : maker.scene.meshes[sphere_mesh].primitives) part.material = material;
    maker.node("first sphere", importer::none, sphere_mesh, placed(first_sphere));
    maker.node("second sphere", importer::none, sphere_mesh, placed(second_sphere));
    const Index drum_mesh = maker.mesh(drum(drum_sides));
    for (importer::Primitive& part : maker.scene.meshes[drum_mesh].primitives) part.material = material;
    maker.node("cylinder", importer::none, drum_mesh, placed(cylinder));
    if (statue.nodes.empty()) {
        const Index knot_mesh = maker.mesh(knot());
        for (importer::Primitive& part : maker.scene.meshes[knot_mesh].primitives) part.material = material;
        maker.node("knot", importer::none, knot_mesh, move(statue_at));
    }
    GeneratedScene made{std::move(maker.scene), gallery_path()};
    if (!statue.nodes.empty()) {
        place_statue(statue);
        importer::append(made.scene, std::move(statue));
    }
    return made;
}

}  // namespace surefoot::scenes
