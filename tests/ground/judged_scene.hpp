// A scene with its ground as the product bakes it, and as the exact judge sees it; visitors who walk at random, and are judged.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "render/bake/ground.hpp"
#include "render/import/scene.hpp"
#include "render/model/ground/near.hpp"
#include "render/model/ground/walker.hpp"
#include "rt/base/random.hpp"
#include "tests/ground/exact_ground.hpp"
#include "tests/ground/grounds.hpp"
#include "tools/scenes/scenes.hpp"

namespace surefoot::test {

struct JudgedScene {
    importer::Scene scene;
    Path path;  ///< empty for files
    bake::BlockingTriangles blocking;
    model::Ground ground;
    std::vector<std::vector<bool>> judged;
    std::unique_ptr<exact::ExactGround> judge;

    void finish() {
        ground = bake::make_ground(scene, {}, &blocking);
        judged = exact::blocking_triangles(scene);
        judge = std::make_unique<exact::ExactGround>(scene, judged);
    }
};

inline JudgedScene generated(const std::string& name, double scale = 1) {
    auto made = scenes::generate(name, scale, 1);
    JudgedScene of;
    of.scene = std::move(made->scene);
    of.path = std::move(made->path);
    of.finish();
    return of;
}

/// A file below SUREFOOT_DATA; nothing if that is not set.
inline std::optional<JudgedScene> imported(const std::string& file) {
    const char* data = std::getenv("SUREFOOT_DATA");
    if (data == nullptr) return {};
    auto scene = importer::import_files({std::string(data) + "/" + file}, {});
    if (!scene) return {};
    JudgedScene of;
    of.scene = std::move(*scene);
    of.finish();
    return of;
}

/// Around all that is placed.
inline Box box_of_scene(const importer::Scene& scene) {
    Box box;
    for (const importer::Node& node : scene.nodes) {
        if (node.mesh == importer::none) continue;
        for (const importer::Primitive& p : scene.meshes[node.mesh].primitives)
            for (const vec3& v : p.positions) box.grow(dvec3(node.world * dvec4(dvec3(v), 1.0)));
    }
    return box;
}

/// Triangles on whose class the two do not agree; prints the nodes of the first few.
inline std::size_t disagreements(const JudgedScene& of) {
    std::size_t count = 0;
    for (std::size_t n = 0; n < of.scene.nodes.size(); ++n) {
        if (of.blocking[n].size() != of.judged[n].size()) return std::size_t(-1);
        std::size_t here = 0;
        for (std::size_t t = 0; t < of.judged[n].size(); ++t) here += of.blocking[n][t] != of.judged[n][t] ? 1 : 0;
        if (here > 0 && count < 1000)
            std::printf("  exceptions: %zu of %zu triangles of node %zu, '%s'\n", here, of.judged[n].size(), n,
                        of.scene.nodes[n].name.c_str());
        count += here;
    }
    return count;
}

using Square = std::tuple<int, int, int>;  ///< 0.25 m wide, 2 m high
inline Square square_of(const dvec3& feet) {
    return {static_cast<int>(std::floor(feet.x / 0.25)), static_cast<int>(std::floor((feet.y + 0.3) / 2)),
            static_cast<int>(std::floor(feet.z / 0.25))};
}

/// What became of a visitor.
struct Walked {
    double worst_overlap_m = 0, walked_m = 0;
    std::size_t crossings = 0;  ///< of the eye's way or of the body's axis with what blocks
    std::size_t uncarried = 0;  ///< times when nothing carried a body that did not fall
    std::uint64_t returns = 0, freed = 0;
    std::set<Square> trodden;
    dvec3 end{0.0};
};

/// A visitor who turns and changes pace at random. Judged ten times a second.
inline Walked visitor(const JudgedScene& of, const dvec3& start, std::uint64_t seed, double seconds) {
    Random random(seed);
    model::Walker walker(of.ground, {});
    Walked walked;
    dvec3 eye = start, judged_at = start;
    double heading = random.range(0, 6.28), turn = 0, speed = 1.4;
    std::uint64_t jumps = 0;
    for (int i = 0; i < seconds / tick_s; ++i) {
        if (i % 500 == 0) turn = random.range(-1.2, 1.2), speed = random.below(10) == 0 ? 0 : random.range(0.3, 4);
        heading += turn * tick_s;
        const dvec3 next = walker.walk(eye, eye + dvec3(std::cos(heading), 0, std::sin(heading)) * speed * tick_s, tick_s);
        walked.walked_m += std::hypot(next.x - eye.x, next.z - eye.z);
        eye = next;
        const bool jumped = walker.returns() + walker.freed() != jumps;
        jumps = walker.returns() + walker.freed();
        if (jumped) judged_at = eye;
        if (!walker.stands() || walker.barrier() == model::Barrier::inside) continue;
        walked.trodden.insert(square_of(walker.feet()));
        if (i % 50 != 49) continue;
        const model::Capsule body = walker.capsule_at(walker.feet());
        walked.worst_overlap_m = std::max(walked.worst_overlap_m, of.judge->penetration(body.low, body.length, body.radius));
        const dvec3 top = body.low + dvec3(0, body.length, 0);
        walked.crossings += of.judge->crosses(judged_at, eye) ? 1 : 0;
        walked.crossings += of.judge->crosses(body.low, top) ? 1 : 0;
        double off_floor =
            walker.supported() ? 9 : 0;  // the feet stand at a floor of the judge's under their disc, or a millimetre beside it
        for (int k = 0; k < 45 && off_floor > 0.002; ++k) {
            constexpr std::array<dvec2, 5> beside{{{0, 0}, {1e-3, 0}, {-1e-3, 0}, {0, 1e-3}, {0, -1e-3}}};
            const double reach = k % 9 == 0 ? 0 : 0.15, angle = (k % 9) * 0.785398163397448;
            const dvec2 off = beside[static_cast<std::size_t>(k / 9)];
            const double x = walker.feet().x + reach * std::cos(angle) + off.x,
                         z = walker.feet().z + reach * std::sin(angle) + off.y;
            for (const double y : of.judge->floors_at(x, z, 1e-3)) off_floor = std::min(off_floor, std::abs(y - walker.feet().y));
        }
        // Else its sides lie on something, as on rocks beside the foot: 3 mm thicker it touches that, and a centimetre lower more
        // so. An upright wall is not nearer then.
        const auto overlap = [&](double lower_m) {
            return of.judge->penetration(body.low - dvec3(0, lower_m, 0), body.length, body.radius + 0.003);
        };
        const bool lies = off_floor > 0.002 && overlap(0.01) > overlap(0) + 1e-5;
        walked.uncarried += off_floor > 0.002 && !lies ? 1 : 0;
        judged_at = eye;
    }
    walked.returns = walker.returns();
    walked.freed = walker.freed();
    walked.end = eye;
    return walked;
}

/// Random level, upright and slanted moves of capsules near `places`, against the judge's triangles. A contact agrees if it lies
/// between those of capsules half a millimetre thicker and thinner, or a millimetre from it; so does a deepest overlap.
/// Those that begin free count. A tenth of them must touch something.
inline std::size_t wrong_moves(const JudgedScene& of, const std::vector<dvec3>& places, std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::size_t wrong = 0, touched = 0, free = 0;
    for (std::size_t i = 0; free < count && i < 20 * count; ++i) {
        const dvec3 at = places[random.below(static_cast<std::uint32_t>(places.size()))];
        const model::Capsule body{at + any_in(random, dvec3(-2, -1, -2), dvec3(2, 1, 2)), random.range(0, 1.2),
                                  random.range(0.1, 0.4)};
        const dvec3 move = any_in(random, dvec3(-1.5), dvec3(1.5)) * (random.below(3) == 0 ? dvec3(0, 1, 0) : dvec3(1));
        const double length = glm::length(move);
        if (of.judge->penetration(body.low, body.length, body.radius + 1e-3) > 0) continue;
        ++free;
        Box box{body.low - body.radius, body.low + body.radius};
        box.max.y += body.length;
        box.grow(Box{box.min + move, box.max + move});
        double share = 2;
        model::for_triangles_near(of.ground, box, [&](const model::GroundTriangle& t) {
            share = std::min(share, model::first_contact(body, move, t).share);
        });
        const double thick = of.judge->first_contact(body.low, body.length, body.radius + 5e-4, move);
        const double thin = thick > 1 ? thick : of.judge->first_contact(body.low, body.length, body.radius - 5e-4, move);
        touched += share <= 1 ? 1 : 0;
        const double end = std::min(share, 1.0), slack = 1e-3 / length;
        const bool contact_agrees = end >= std::min(thick, 1.0) - slack && end <= std::min(thin, 1.0) + slack;
        double deepest = 0;  // along the way up to the contact, and there
        for (int k = 1; k <= 3; ++k)
            deepest = std::max(deepest, of.judge->penetration(body.low + end * (k / 3.0) * move, body.length, body.radius));
        if (contact_agrees && deepest <= 1e-3) continue;
        if (++wrong <= 5)
            std::printf("  move %zu: contact after %.5f m, judged %.5f to %.5f m; overlap %.5f m\n", i, end * length,
                        std::min(thick, 1.0) * length, std::min(thin, 1.0) * length, deepest);
    }
    std::printf("  %zu moves, %zu touched something, %zu wrong\n", free, touched, wrong);
    EXPECT_EQ(free, count);
    EXPECT_GT(10 * touched, free);
    return wrong;
}

}  // namespace surefoot::test
