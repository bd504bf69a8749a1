// Plants of masked cards, and fences.
#include "tools/scenes/garden_plants.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"
#include "tools/scenes/textures.hpp"

namespace surefoot::scenes {
namespace {

/// A square card about `middle`, turned at random; `upright`: its edges stay level.
void card(MeshMaker& maker, const dvec3& middle, double half, bool upright, Random& random) {
    const double about = random.range(0, 2 * pi), lean = upright ? 0.0 : random.range(-0.9, 0.9);
    const dvec3 along(std::cos(about), 0, std::sin(about));
    const dvec3 out(-std::sin(about), 0, std::cos(about));
    const dvec3 up = dvec3(0, std::cos(lean), 0) + out * std::sin(lean);
    maker.picture(middle - half * (along + up), middle + half * (along - up), middle + half * (along + up),
                  middle - half * (along - up));
}

/// Cards in the outer part of an ellipsoid.
void crown(MeshMaker& maker, const dvec3& centre, const dvec3& radii, int cards, double half, Random& random) {
    for (int i = 0; i < cards; ++i) {
        const double y = random.range(-1, 1), angle = random.range(0, 2 * pi), r = std::sqrt(std::max(0.0, 1 - y * y));
        const double depth = std::sqrt(random.range(0.25, 1.0));
        maker.brush.colour = shade(rgb(255, 255, 255), 0.55 + 0.4 * depth * (0.6 + 0.4 * y));
        card(maker, centre + depth * radii * dvec3(r * std::cos(angle), y, r * std::sin(angle)), half, false, random);
    }
}

constexpr double post_m = 1.6, wire_mesh_m = 1.5;

}  // namespace

GardenMaterials garden_materials(SceneMaker& maker, std::uint64_t seed) {
    const auto masked = [&](const char* name, image::Image picture) {
        return maker.material(name, {255, 255, 255, 255}, maker.image(std::move(picture)), model::AlphaMode::mask, true);
    };
    GardenMaterials m;
    m.bark = maker.material("bark");
    m.wood = maker.material("painted wood");
    m.sprays = masked("leaves", leaves(seed + 1, rgb(40, 84, 30), rgb(132, 168, 66)));
    m.fronds = masked("leaves of ferns", frond(seed + 2, rgb(44, 96, 44), rgb(120, 172, 84)));
    m.blades = masked("leaves of grass", blades(seed + 3, rgb(58, 92, 34), rgb(150, 176, 84)));
    m.petals = masked("leaves of flowers", petals(seed + 4, rgb(196, 34, 60), rgb(250, 150, 160)));
    m.wire_mesh = masked("wire mesh", wire_mesh(rgb(150, 156, 158)));
    return m;
}

importer::Mesh apple_tree(const GardenMaterials& materials, std::uint64_t seed) {
    MeshMaker maker("apple tree");
    Random random(seed);
    maker.brush.material = materials.bark;
    maker.brush.colour = rgb(104, 84, 66);
    const std::array<dvec3, 4> trunk{dvec3(0, -0.3, 0), dvec3(0.05, 0.8, 0.03), dvec3(-0.04, 1.7, 0.06), dvec3(0.03, 2.6, 0)};
    maker.tube(trunk, std::array{0.17, 0.13, 0.11, 0.07}, 8, false);
    constexpr int branches = 8;
    for (int b = 0; b < branches; ++b) {
        const double angle = b * 2.39996 + random.range(-0.3, 0.3), reach = random.range(1.2, 1.9);
        const dvec3 out(std::cos(angle), 0, std::sin(angle));
        const dvec3 start = trunk[2] + dvec3(0, 0.1 * b - 0.3, 0);
        const dvec3 end = start + out * reach + dvec3(0, random.range(0.6, 1.6), 0);
        const dvec3 middle = glm::mix(start, end, 0.5) + dvec3(0, -0.15, 0);
        maker.tube(std::array{start, middle, end}, std::array{0.07, 0.045, 0.015}, 5, false);
    }
    maker.brush.material = materials.sprays;
    crown(maker, {0, 3.4, 0}, {2.2, 1.6, 2.2}, 380, 0.34, random);
    return maker.take();
}

importer::Mesh hedge(const GardenMaterials& materials, std::uint64_t seed) {
    MeshMaker maker("hedge");
    Random random(seed);
    maker.brush.material = materials.sprays;
    for (int i = 0; i < 150; ++i) {
        const dvec3 at = any_in(random, {0.1, 0.1, -0.32}, {1.4, 1.0, 0.32});
        maker.brush.colour = shade(rgb(225, 240, 215), 0.45 + 0.5 * at.y);
        card(maker, at, 0.19, false, random);
    }
    return maker.take();
}

importer::Mesh fern_of_fronds(const GardenMaterials& materials, std::uint64_t seed) {
    MeshMaker maker("fern");
    Random random(seed);
    maker.brush.material = materials.fronds;
    constexpr int fronds = 14;
    for (int f = 0; f < fronds; ++f) {
        const double angle = f * 2.39996 + random.range(-0.2, 0.2), length = random.range(0.55, 0.95);
        const dvec3 out(std::cos(angle), 0, std::sin(angle)), side = 0.13 * dvec3(-out.z, 0, out.x);
        maker.brush.colour = shade(rgb(255, 255, 255), random.range(0.7, 1.0));
        // One picture from the root to the tip, bent in the middle: rows go up its length.
        const auto at = [&](double t) {
            const double lean = 0.45 + 0.75 * t;
            return dvec3(0, 0.05, 0) + length * t * (out * std::sin(lean) + dvec3(0, std::cos(lean), 0));
        };
        maker.surface(1, 3, [&](double u, double v) { return at(v) + side * (2 * u - 1); });
    }
    return maker.take();
}

importer::Mesh rose(const GardenMaterials& materials, std::uint64_t seed) {
    MeshMaker maker("rose");
    Random random(seed);
    constexpr int stems = 9;
    for (int s = 0; s < stems; ++s) {
        const double angle = s * 2.39996, lean = random.range(0.08, 0.4), height = random.range(0.8, 1.3);
        const dvec3 out(std::cos(angle), 0, std::sin(angle));
        const dvec3 middle = out * (0.25 * lean) + dvec3(0, 0.55 * height, 0), top = out * lean + dvec3(0, height, 0);
        maker.brush.material = materials.bark;
        maker.brush.colour = rgb(76, 96, 52);
        maker.tube(std::array{dvec3(0, -0.05, 0), middle, top}, std::array{0.006, 0.005, 0.004}, 4, false);
        maker.brush.material = materials.sprays;
        for (int k = 0; k < 4; ++k) {
            maker.brush.colour = shade(rgb(235, 255, 235), random.range(0.6, 0.95));
            card(maker, glm::mix(middle, top, 0.25 * k) + any_in(random, dvec3(-0.06), dvec3(0.06)), 0.1, false, random);
        }
        maker.brush.material = materials.petals;
        maker.brush.colour = shade(rgb(255, 255, 255), random.range(0.85, 1.0));
        for (int k = 0; k < 2; ++k) card(maker, top + dvec3(0, 0.04, 0), 0.075, false, random);
    }
    return maker.take();
}

importer::Mesh tuft_of_blades(const GardenMaterials& materials, std::uint64_t seed) {
    MeshMaker maker("tuft");
    Random random(seed);
    maker.brush.material = materials.blades;
    for (int i = 0; i < 4; ++i) {
        const double half = random.range(0.14, 0.22);
        maker.brush.colour = shade(rgb(255, 255, 255), random.range(0.75, 1.0));
        card(maker, any_in(random, {-0.08, half - 0.02, -0.08}, {0.08, half - 0.02, 0.08}), half, true, random);
    }
    return maker.take();
}

importer::Mesh picket_panel(const GardenMaterials& materials) {
    MeshMaker maker("picket fence");
    maker.brush.material = materials.wood;
    maker.brush.colour = rgb(232, 230, 222);
    for (const double y : {0.3, 0.85}) maker.box({0, y, -0.03}, {panel_m, y + 0.07, 0});
    constexpr int pickets = 16;
    for (int i = 0; i < pickets; ++i) {
        const double x = (i + 0.5) * panel_m / pickets, half = 0.035, low = 0.05, high = 1.05, tip = 1.13;
        maker.box({x - half, low, 0}, {x + half, high, 0.02});
        maker.triangle({x - half, high, 0.02}, {x + half, high, 0.02}, {x, tip, 0.01});
        maker.triangle({x + half, high, 0}, {x - half, high, 0}, {x, tip, 0.01});
        maker.triangle({x + half, high, 0.02}, {x + half, high, 0}, {x, tip, 0.01});
        maker.triangle({x - half, high, 0}, {x - half, high, 0.02}, {x, tip, 0.01});
    }
    return maker.take();
}

importer::Mesh wire_panel(const GardenMaterials& materials) {
    MeshMaker maker("wire fence");
    maker.brush.material = materials.wood;
    maker.brush.colour = rgb(96, 108, 96);
    maker.rod({0, -0.2, 0}, {0, post_m, 0}, 0.025, 8);
    for (const double y : {0.05, wire_mesh_m}) maker.rod({0, y, 0}, {panel_m, y, 0}, 0.003, 3);
    maker.brush.material = materials.wire_mesh;
    maker.brush.colour = rgb(255, 255, 255);
    maker.brush.uv_per_m = 4;  // 16 meshes a metre
    maker.quad({0, 0.05, 0}, {panel_m, 0.05, 0}, {panel_m, wire_mesh_m, 0}, {0, wire_mesh_m, 0});
    return maker.take();
}

}  // namespace surefoot::scenes
