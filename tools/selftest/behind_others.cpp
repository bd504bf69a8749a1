// Rows: what is left out because others hide it, judged by lines of sight through the full detail.
#include <array>
#include <cmath>

#include "render/model/model.hpp"
#include "render/prepare/occlusion.hpp"
#include "rt/base/random.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/shapes.hpp"

namespace surefoot::selftest {

namespace {

struct Face {
    std::array<dvec3, 3> at;
    bool two_sided = false;
};

struct Leaf {
    Box box;
    std::vector<Face> faces;
};

/// Full detail as it is drawn, from the model's arrays alone.
std::vector<Leaf> leaves_of(const model::Model& model) {
    std::vector<Leaf> leaves;
    for (const model::Node& node : model.nodes) {
        if (node.child_count > 0) continue;
        Leaf leaf{node.box, {}};
        const model::Representation& rep = model.reps[node.first_rep + node.rep_count - 1];
        const model::Placement& placement = model.placements[rep.placement];
        const bool mirrored = glm::determinant(placement.linear) < 0;
        const dmat3 linear(placement.linear);
        model::for_triangles(model, rep, [&](const model::Material& material, const vec3& a, const vec3& b, const vec3& c) {
            Face face;
            face.at = {placement.origin + linear * dvec3(a), placement.origin + linear * dvec3(b),
                       placement.origin + linear * dvec3(c)};
            if (mirrored) std::swap(face.at[1], face.at[2]);
            face.two_sided = material.two_sided;
            leaf.faces.push_back(face);
        });
        leaves.push_back(std::move(leaf));
    }
    return leaves;
}

/// Whether the face is drawn between the two. A hair's breadth beyond its edge still counts: rays meet no edge exactly.
bool blocks(const Face& face, const dvec3& eye, const dvec3& at, const dvec3& forward) {
    const dvec3 along = at - eye, a = face.at[1] - face.at[0], b = face.at[2] - face.at[0];
    const dvec3 normal = glm::cross(a, b);
    const double toward = glm::dot(normal, along);
    if (toward == 0 || (toward > 0 && !face.two_sided)) return false;  // seen from behind
    const double t = glm::dot(normal, face.at[0] - eye) / toward;
    if (!(t > 0 && t < 1) || !(t * glm::dot(along, forward) >= model::near_plane_m)) return false;
    const dvec3 p = eye + t * along - face.at[0];
    const double square = glm::dot(normal, normal);
    const double u = glm::dot(glm::cross(p, b), normal) / square, v = glm::dot(glm::cross(a, p), normal) / square;
    constexpr double hair = 1e-6;
    return u >= -hair && v >= -hair && u + v <= 1 + hair;
}

bool seen(const std::vector<Leaf>& leaves, const dvec3& eye, const dvec3& at, const dvec3& forward) {
    for (const Leaf& leaf : leaves)
        for (const Face& face : leaf.faces)
            if (blocks(face, eye, at, forward)) return false;
    return true;
}

/// A wall, floor or ceiling, of `planks` strips.
importer::Primitive room_face(std::uint32_t planks, const dvec3& from, const dvec3& right, const dvec3& up,
                              std::uint32_t material) {
    importer::Primitive p = surface(3, planks, [&](double u, double v) { return vec3(from + u * right + v * up); });
    p.material = material;
    return p;
}

/// A box of six such faces.
importer::Primitive room_body(std::uint32_t planks, const dvec3& low, const dvec3& size) {
    importer::Primitive all;
    for (int axis = 0; axis < 3; ++axis) {
        dvec3 a(0), b(0), n(0);
        n[axis] = size[axis];
        a[(axis + 1) % 3] = size[(axis + 1) % 3];
        b[(axis + 2) % 3] = size[(axis + 2) % 3];
        for (const auto& side : {room_face(planks, low + n, a, b, 0), room_face(planks, low, b, a, 0)}) {
            const auto base = static_cast<std::uint32_t>(all.positions.size());
            all.positions.insert(all.positions.end(), side.positions.begin(), side.positions.end());
            for (const std::uint32_t i : side.indices) all.indices.push_back(base + i);
        }
    }
    return all;
}

/// Two storeys of rooms with doors and gaps of every width, boxes in them; walls of one face, of two, and of a box's six.
importer::Scene rooms(Random& random, const dvec3& at, const dquat& turn, std::uint32_t planks) {
    constexpr int across = 5, storeys = 2;
    constexpr double cell = 4, high = 3;
    const dmat4 root = moved(at) * glm::mat4_cast(turn);
    importer::Scene scene;
    scene.materials.resize(2);
    scene.materials[1].two_sided = true;
    const auto face = [&](const dvec3& from, const dvec3& right, const dvec3& up, std::uint32_t material) {
        return room_face(planks, from, right, up, material);
    };
    const auto body = [&](const dvec3& low, const dvec3& size) { return room_body(planks, low, size); };
    const auto wall = [&](const dvec3& from, const dvec3& along) {
        const double length = glm::length(along), door = random.below(3) == 0 ? random.range(0.01, 0.2) : random.range(0.8, 1.2);
        const dvec3 unit = along / length;
        const double start = random.range(0, length - door);
        const std::uint32_t kind = random.below(5);
        if (kind == 0) return;  // open
        const auto piece = [&](double first, double last) {
            if (last - first < 0.05) return;
            const dvec3 low = from + first * unit, run = (last - first) * unit;
            if (kind == 1) return place(scene, face(low, run, dvec3(0, high, 0), 1), "wall", root);
            if (kind == 2) return place(scene, face(low, run, dvec3(0, high, 0), 0), "wall", root);  // one side only
            place(scene, body(low, glm::max(run, dvec3(0.1)) * dvec3(1, 0, 1) + dvec3(0, high, 0)), "wall", root);
        };
        if (random.below(2) == 0) return piece(0, length);
        piece(0, start);
        piece(start + door, length);
    };
    for (int s = 0; s < storeys; ++s) {
        const double y = s * high;
        place(scene, face({0, y, 0}, {0, 0, across * cell}, {across * cell, 0, 0}, 0), "floor", root);
        place(scene, face({0, y + high - 0.01, 0}, {across * cell, 0, 0}, {0, 0, across * cell}, 0), "ceiling", root);
        for (int i = 0; i < across; ++i) {
            for (int j = 0; j < across; ++j) {
                wall({i * cell, y, j * cell}, {cell, 0, 0});
                wall({i * cell, y, j * cell}, {0, 0, cell});
                for (int k = 0; k < 3; ++k) {
                    const dvec3 size = any_in(random, dvec3(0.05), dvec3(1.0, 1.0, 1.0));
                    place(scene, body(any_in(random, {i * cell, y, j * cell}, {i * cell + 3, y + 1.5, j * cell + 3}), size),
                          "thing", root);
                }
            }
        }
    }
    return scene;
}

dvec3 on(const Face& face, Random& random) {
    double u = random.unit(), v = random.unit();
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    return face.at[0] + u * (face.at[1] - face.at[0]) + v * (face.at[2] - face.at[0]);
}

dvec3 any_direction(Random& random) {
    while (true) {
        const dvec3 d = any_in(random, dvec3(-1), dvec3(1));
        const double square = glm::dot(d, d);
        if (square < 1 && square > 1e-4) return d / std::sqrt(square);
    }
}

/// About any axis; drawn in one order by every compiler.
dquat any_turn_up_to(double max_rad, Random& random) {
    const double angle = random.range(0, max_rad);
    const dvec3 axis = any_direction(random);
    return glm::normalize(glm::angleAxis(angle, axis));
}

bool in_picture(const Pose& pose, model::Viewport viewport, const dvec3& at) {
    const model::HalfAngles half = model::half_angles(pose, viewport);
    const dvec3 d = at - pose.position;
    const double z = glm::dot(d, pose.forward());
    return z > model::near_plane_m && std::abs(glm::dot(d, pose.right())) <= z * std::tan(half.x) &&
           std::abs(glm::dot(d, pose.up())) <= z * std::tan(half.y);
}

struct Looks {
    std::uint64_t regions = 0, in_view = 0, hidden = 0, lines = 0, broken = 0;
};

/// Looks round one building: nothing that is called hidden may be seen from an eye of its region.
void look_round(const model::Model& model, Random& random, const dmat4& root, std::uint64_t regions, const Effort& effort,
                Looks& looks) {
    const std::vector<Leaf> leaves = leaves_of(model);
    const prepare::Occluders occluders = prepare::find_occluders(model);
    prepare::Occlusion occlusion(occluders);
    constexpr std::array<double, 5> radii = {0, 0.05, 0.3, 0.8, 2.5};
    constexpr std::array<double, 4> angles = {0, 0.05, 0.15, 0.4};
    for (std::uint64_t r = 0; r < regions && !effort.stopped(); ++r, ++looks.regions) {
        prepare::Region region;
        region.centre.position = dvec3(root * dvec4(any_in(random, {0.5, 0.3, 0.5}, {19.5, 5.7, 19.5}), 1.0));
        region.centre.orientation = any_turn_up_to(6.28, random);
        region.centre.fov_y_rad = random.range(0.3, 1.6);
        region.radius_m = radii[random.below(5)];
        region.angle_rad = angles[random.below(4)];
        const model::Viewport viewport{640, static_cast<std::uint32_t>(random.range(200, 900))};
        occlusion.draw(region, viewport);
        const model::Frustum frustum = model::make_frustum(region.centre, viewport, 1000, region.radius_m, region.angle_rad);
        for (const Leaf& leaf : leaves) {
            if (!model::visible(frustum, leaf.box)) continue;
            ++looks.in_view;
            if (!occlusion.hides(leaf.box)) continue;
            ++looks.hidden;
            for (int k = 0; k < 24; ++k) {
                // Corners, from eyes moved as far as they may and across the line, see past an edge first.
                const Face& face = leaf.faces[random.below(static_cast<std::uint32_t>(leaf.faces.size()))];
                const bool corner = k % 4 != 0;
                const dvec3 at = corner ? face.at[random.below(3)] : on(face, random);
                dvec3 away = any_direction(random);
                if (corner) away = glm::normalize(glm::cross(away, at - region.centre.position) + 1e-9 * away);
                Pose pose = region.centre;
                pose.position += away * (region.radius_m * (corner ? 1.0 : random.unit()));
                if (k % 2 == 1) pose.orientation = any_turn_up_to(region.angle_rad, random) * pose.orientation;
                if (!in_picture(pose, viewport, at)) continue;
                ++looks.lines;
                looks.broken += seen(leaves, pose.position, at, pose.forward()) ? 1 : 0;
            }
        }
    }
}

void report_looks(const Looks& looks, Outcome& out) {
    out.none_of("lines of sight that reach what is called hidden", looks.broken);
    out.at_least("lines of sight that were tried", static_cast<double>(looks.lines), 100);
    out.at_least("share of the things in view that are found to be hidden",
                 100.0 * static_cast<double>(looks.hidden) / static_cast<double>(std::max<std::uint64_t>(looks.in_view, 1)), 15,
                 "%");
}

void in_buildings(std::uint64_t seed, const dvec3& at, const Effort& effort, Outcome& out) {
    Random random(seed);
    Looks looks;
    const std::uint64_t buildings = effort.count(15, 5);
    for (std::uint64_t b = 0; b < buildings && !effort.stopped(); ++b) {
        const dquat turn = b % 2 == 0 ? dquat(1, 0, 0, 0) : any_turn_up_to(3.1, random);
        auto model = import_and_bake(rooms(random, at, turn, b % 3 == 1 ? 8 : 2));
        if (!model) return out.none_of("bakes refused (" + model.error().text() + ")", 1);
        look_round(*model, random, moved(at) * glm::mat4_cast(turn), 60, effort, looks);
        out.digest_of(model->triangles());
    }
    report_looks(looks, out);
}

void near_origin(const Effort& effort, Outcome& out) { in_buildings(31, dvec3(0), effort, out); }
void far_away(const Effort& effort, Outcome& out) { in_buildings(35, dvec3(4.2e6, -1.7e5, 6.3e6), effort, out); }

}  // namespace

std::span<const Row> behind_others_rows() {
    static constexpr std::array<Row, 2> table = {{
        {"O1a", "behind_others",
         "rooms, doors and gaps of 1 cm to 1.2 m; regions of eyes up to 2.5 m and 23 degrees about any pose",
         "nothing that is left out as hidden is on any line of sight from the region; a seventh and more is left out",
         near_origin},
        {"O1b", "behind_others", "the same, 7600 km from the origin", "the same", far_away},
    }};
    return table;
}

}  // namespace surefoot::selftest
