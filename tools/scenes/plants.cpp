// Trees, bushes and undergrowth, grown from a few numbers to a wanted number of triangles.
#include "tools/scenes/plants.hpp"

#include <algorithm>
#include <cmath>

#include "rt/base/random.hpp"

namespace surefoot::scenes {
namespace {

dvec3 on_sphere(Random& random) {
    const double y = random.range(-1, 1), angle = random.range(0, 2 * pi), r = std::sqrt(std::max(0.0, 1 - y * y));
    return {r * std::cos(angle), y, r * std::sin(angle)};
}

dvec3 across(const dvec3& along, const dvec3& hint) {
    const dvec3 side = glm::cross(along, hint);
    return glm::length(side) > 1e-9 ? glm::normalize(side) : dvec3(1, 0, 0);
}

struct Clump {
    dvec3 centre;
    double radius;
};

/// Where the branches end: the crown grows about these.
std::vector<Clump> grow_wood(MeshMaker& maker, const TreeShape& s, Random& random) {
    std::vector<dvec3> trunk;
    std::vector<double> radii;
    constexpr int rings = 6;
    dvec3 bend = any_in(random, {-0.25, 0, -0.25}, {0.25, 0, 0.25});
    for (int i = 0; i <= rings; ++i) {
        const double f = static_cast<double>(i) / rings;
        trunk.push_back(dvec3(0, f * 0.9 * s.height - 0.3, 0) + bend * std::sin(f * 2.2) * (0.04 * s.height));
        radii.push_back(s.trunk_radius * (i == 0 ? 1.5 : 1.05 - 0.85 * f));
    }
    maker.brush.colour = s.bark;
    maker.tube(trunk, radii, 8, false);
    std::vector<Clump> clumps{{trunk.back() + dvec3(0, 0.2, 0), s.clump_radius}};
    for (int b = 0; b < s.branches; ++b) {
        const double f = (b + 0.5) / s.branches;
        const double from_y = s.crown_base + (0.8 * s.height - s.crown_base) * f;
        const double angle = b * 2.39996 + random.range(-0.3, 0.3);
        const double reach =
            s.crown_radius * std::sqrt(std::max(0.1, 1 - std::pow(f - 0.25, 2))) * random.range(0.7, 1.0) * (1 - 0.45 * f);
        const double at = std::clamp((from_y + 0.3) / (0.9 * s.height) * rings, 0.0, rings - 1e-3);
        const auto i = static_cast<std::size_t>(at);
        const dvec3 start = glm::mix(trunk[i], trunk[i + 1], at - static_cast<double>(i));
        const dvec3 out(std::cos(angle), 0, std::sin(angle));
        const double rise = random.range(0.25, 0.6) * reach;
        const std::array<dvec3, 4> line{start, start + out * (0.35 * reach) + dvec3(0, 0.15 * rise, 0),
                                        start + out * (0.7 * reach) + dvec3(0, 0.5 * rise, 0),
                                        start + out * reach + dvec3(0, rise, 0)};
        const double r = s.trunk_radius * (0.5 - 0.25 * f);
        maker.tube(line, std::array{r, 0.75 * r, 0.5 * r, 0.2 * r}, 4, false);
        clumps.push_back({line[3], s.clump_radius * random.range(0.8, 1.15)});
        clumps.push_back({glm::mix(line[1], line[2], 0.7) + dvec3(0, 0.35 * s.clump_radius, 0), 0.85 * s.clump_radius});
    }
    return clumps;
}

/// Rhombi about the clumps: tangent for leaves, radial for needles; lighter outside and above.
void grow_leaves(MeshMaker& maker, const std::vector<Clump>& clumps, const TreeShape& s, std::size_t count, Random& random) {
    const dvec3 middle(0, 0.5 * (s.crown_base + s.height), 0);
    for (std::size_t n = 0; n < count; ++n) {
        const Clump& clump = clumps[n % clumps.size()];
        dvec3 out = on_sphere(random);
        out.y = 0.75 * out.y + 0.15;
        out = glm::normalize(out);
        const dvec3 place = clump.centre + out * clump.radius * random.range(0.55, 1.0);
        const dvec3 crown_out = glm::normalize(place - middle + dvec3(0, 0.3, 0));
        const dvec3 normal = glm::normalize(0.6 * out + 0.8 * crown_out + dvec3(0, 0.35, 0));
        const dvec3 hang = s.needles ? glm::normalize(out + 0.4 * on_sphere(random))
                                     : glm::normalize(across(out, on_sphere(random)) + dvec3(0, -0.45, 0));
        const double wide = random.range(0.8, 1.2);
        const dvec3 side = across(hang, s.needles ? on_sphere(random) : out) * s.leaf_width * wide;
        const double length = s.leaf_length * random.range(0.7, 1.25);
        const double light = 0.15 + 0.45 * (crown_out.y * 0.5 + 0.5) + 0.25 * (out.y * 0.5 + 0.5) + random.range(-0.12, 0.22);
        maker.brush.colour = mix(s.dark, s.light, light);
        const dvec3 base = s.needles ? place - hang * (0.4 * length) : place - hang * (0.5 * length);
        maker.leaf(base, base + hang * length, side, normal);
    }
}

/// Dark marks on white bark, lighter bark towards the light above, moss below.
void weather_bark(importer::Primitive& bark, const TreeShape& s, Random& random) {
    for (std::size_t i = 0; i < bark.positions.size(); ++i) {
        const double h = bark.positions[i].y / s.height;
        Colour c = shade(bark.colours[i], random.range(0.85, 1.12) * (0.9 + 0.25 * h));
        if (s.bark_marks && random.unit() < 0.3) c = mix(c, rgb(48, 44, 42), random.range(0.4, 0.9));
        if (bark.positions[i].y < 0.6F) c = mix(c, rgb(70, 84, 42), 0.45);
        bark.colours[i] = c;
    }
}

}  // namespace

importer::Mesh broad_tree(const std::string& name, const PlantMaterials& materials, const TreeShape& shape, std::size_t triangles,
                          std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker(name);
    maker.brush.material = materials.bark;
    const std::vector<Clump> clumps = grow_wood(maker, shape, random);
    const std::size_t wood = maker.triangles();
    maker.brush.material = materials.leaf;
    grow_leaves(maker, clumps, shape, triangles > wood ? (triangles - wood) / 2 : 0, random);
    importer::Mesh mesh = maker.take();
    weather_bark(mesh.primitives[0], shape, random);
    return mesh;
}

importer::Mesh spruce(const std::string& name, const PlantMaterials& materials, double height, double radius,
                      std::size_t triangles, std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker(name);
    maker.brush.material = materials.bark;
    maker.brush.colour = rgb(84, 62, 46);
    maker.tube(std::array{dvec3(0, -0.3, 0), dvec3(0, 0.35 * height, 0), dvec3(0, 0.7 * height, 0), dvec3(0, height, 0)},
               std::array{0.02 * height, 0.014 * height, 0.008 * height, 0.002 * height}, 6, false);
    const std::size_t boughs = (triangles - maker.triangles()) / 4;
    maker.brush.material = materials.leaf;
    for (std::size_t i = 0; i < boughs; ++i) {
        const double f = (static_cast<double>(i) + 0.5) / static_cast<double>(boughs);
        const double level = std::floor(std::pow(f, 1.25) * 17.0) / 17.0;  // boughs stand in whorls
        const double angle = static_cast<double>(i) * 2.39996 + random.range(-0.2, 0.2);
        const double reach = radius * (1 - 0.93 * level) * random.range(0.82, 1.08);
        const double y = height * (0.1 + 0.89 * level);
        const dvec3 out(std::cos(angle), 0, std::sin(angle));
        const dvec3 base(0, y, 0), tip = base + out * reach + dvec3(0, -0.30 * reach + 0.1, 0);
        const dvec3 side = across(out, dvec3(0, 1, 0)) * (0.24 * reach + 0.08);
        const dvec3 normal = glm::normalize(out * 0.8 + dvec3(0, 0.75, 0));
        maker.brush.colour = mix(rgb(22, 48, 30), rgb(74, 112, 62), 0.2 + 0.35 * level + random.range(-0.1, 0.35));
        maker.leaf(base, tip, side, normal);
        maker.brush.colour = shade(maker.brush.colour, 0.8);
        maker.leaf(base + out * (0.1 * reach), tip + dvec3(0, -0.12 * reach, 0), dvec3(0, -0.16 * reach - 0.05, 0),
                   glm::normalize(out + dvec3(0, 0.2, 0)));
    }
    return maker.take();
}

importer::Mesh fern(const PlantMaterials& materials, std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker("fern");
    maker.brush.material = materials.leaf;
    for (int i = 0; i < 10; ++i) {
        const double angle = i * 0.62832 + random.range(-0.2, 0.2), length = random.range(0.45, 0.7);
        const dvec3 out(std::cos(angle), 0, std::sin(angle));
        const dvec3 bow = out * (0.5 * length) + dvec3(0, 0.75 * length, 0),
                    tip = out * (1.15 * length) + dvec3(0, 0.55 * length, 0);
        const dvec3 side = across(out, dvec3(0, 1, 0)) * 0.09;
        maker.brush.colour = mix(rgb(44, 86, 30), rgb(110, 156, 58), random.range(0.1, 0.9));
        maker.leaf(dvec3(0), bow, side * 0.7, glm::normalize(dvec3(0, 1, 0) - 0.4 * out));
        maker.leaf(bow, tip, side, glm::normalize(dvec3(0, 1, 0) + 0.5 * out));
    }
    return maker.take();
}

importer::Mesh grass_tuft(const PlantMaterials& materials, std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker("grass");
    maker.brush.material = materials.leaf;
    for (int i = 0; i < 10; ++i) {
        const double angle = random.range(0, 2 * pi), height = random.range(0.2, 0.5);
        const dvec3 out(std::cos(angle), 0, std::sin(angle));
        maker.brush.colour = mix(rgb(78, 110, 40), rgb(164, 178, 84), random.unit());
        maker.blade(out * 0.05, out * random.range(0.1, 0.3) + dvec3(0, height, 0), across(out, dvec3(0, 1, 0)) * 0.018,
                    dvec3(0, 1, 0));
    }
    return maker.take();
}

importer::Mesh rock(const PlantMaterials& materials, std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker("rock");
    maker.brush.material = materials.bark;
    maker.brush.colour = mix(rgb(112, 110, 104), rgb(140, 134, 122), random.unit());
    const dmat4 size = stretch({random.range(0.4, 0.8), random.range(0.25, 0.45), random.range(0.4, 0.7)});
    maker.brush.frame = turn(random.range(-0.4, 0.4), dvec3(1, 0, 0)) * size;
    maker.lathe(std::array{dvec2(0, -0.6), dvec2(0.95, -0.2), dvec2(0.8, 0.55), dvec2(0, 0.9)}, 5);
    return maker.take();
}

importer::Mesh fallen_log(const PlantMaterials& materials, std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker("fallen log");
    maker.brush.material = materials.bark;
    maker.brush.colour = rgb(98, 80, 60);
    maker.tube(std::array{dvec3(-2.1, 0.18, 0), dvec3(0.1, 0.24, random.range(-0.15, 0.15)), dvec3(2.3, 0.2, 0)},
               std::array{0.26, 0.23, 0.18}, 10, true);
    importer::Mesh mesh = maker.take();
    for (std::size_t i = 0; i < mesh.primitives[0].positions.size(); ++i) {
        if (mesh.primitives[0].normals[i].y > 0.4F)
            mesh.primitives[0].colours[i] = mix(mesh.primitives[0].colours[i], rgb(88, 112, 46), random.range(0.3, 0.8));
    }
    return mesh;
}

importer::Mesh bush(const std::string& name, const PlantMaterials& materials, double radius, std::size_t triangles,
                    const Colour& dark, const Colour& light, std::uint64_t seed) {
    Random random(seed);
    MeshMaker maker(name);
    maker.brush.material = materials.leaf;
    TreeShape shape;
    shape.height = 1.6 * radius;
    shape.crown_base = 0;
    shape.leaf_length = 0.35 * radius;
    shape.leaf_width = 0.14 * radius;
    shape.dark = dark;
    shape.light = light;
    std::vector<Clump> clumps;
    clumps.reserve(7);
    for (int i = 0; i < 7; ++i) clumps.push_back({any_in(random, {-0.4, 0.5, -0.4}, {0.4, 0.95, 0.4}) * radius, 0.5 * radius});
    grow_leaves(maker, clumps, shape, triangles / 2, random);
    return maker.take();
}

}  // namespace surefoot::scenes
