// Rows: geometry that is tiny, huge, turned inside out by its transform, deep in a graph, or too much in one place.
#include <array>
#include <cmath>

#include "tools/selftest/families.hpp"
#include "tools/selftest/fixtures.hpp"
#include "tools/selftest/scene_check.hpp"

namespace surefoot::selftest {

namespace {

/// Whole coordinates, so that the move loses nothing; scales are powers of two.
void other_scales(const Effort&, Outcome& out) {
    Tally tally;
    const auto hills = [](double scale, double by) {
        return surface(32, 32, [=](double u, double v) {
            return vec3(dvec3(std::round(64 * u), std::round(8 + 8 * std::sin(9 * u) * std::cos(7 * v)), std::round(64 * v)) *
                            scale +
                        dvec3(by));
        });
    };
    const auto levels_of = [](const model::Model& model) {
        std::vector<std::uint32_t> levels;
        for (const model::Node& node : model.nodes) {
            for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
                if (model.reps[r].kind == model::RepKind::mesh) levels.push_back(model.reps[r].triangles);
            }
        }
        return levels;
    };
    const auto here = import_and_bake(scene_of(hills(1, 0)));
    if (!here) return out.none_of("bakes refused (" + here.error().text() + ")", 1);
    const auto want = levels_of(*here);
    std::uint64_t other = 0;
    const auto compare = [&](const std::string& name, const importer::Scene& scene) {
        check_scene(name, scene, here->triangles(), tally, out);
        const auto there = import_and_bake(scene);
        if (there && levels_of(*there) != want) {
            ++other;
            tally.complain(name + " has other levels");
        }
    };
    for (const int exponent : {-30, -20, 20, 33})
        compare("scale 2^" + std::to_string(exponent), scene_of(hills(std::ldexp(1.0, exponent), 0)));
    compare("10 000 km away in the vertices", scene_of(hills(1, 8388608)));
    for (const int exponent : {-29, 30}) {
        const double scale = std::ldexp(1.0, exponent);
        compare("a transform of 2^" + std::to_string(exponent), scene_of(hills(1, 0), scaled(dvec3(scale))));
        // Its cluster's mesh is another: that is made in the world.
        check_scene("a mirroring one of 2^" + std::to_string(exponent),
                    scene_of(hills(1, 0), scaled(dvec3(-scale, scale, scale))), here->triangles(), tally, out);
    }
    // What nobody could see, and what is no place: refused by name, and nothing beside it is lost.
    for (const int exponent : {-140, -100, -66}) {
        const double scale = std::ldexp(1.0, exponent);
        const std::string name = "2^" + std::to_string(exponent);
        check_scene(name, scene_of(hills(scale, 0)), refused, tally, out);
        for (const double mirrored : {1.0, -1.0}) {
            importer::Scene scene = scene_of(hills(1, 0), scaled(scale * dvec3(mirrored, 1, 1)));
            check_scene("a transform of " + name, scene, refused, tally, out);
            place(scene, hills(1, 0), "good", dmat4(1.0));
            check_scene("a good one beside it", scene, here->triangles(), tally, out);
        }
    }
    check_scene("2^33 times 2^33", scene_of(hills(std::ldexp(1.0, 33), 0), scaled(dvec3(std::ldexp(1.0, 33)))), refused, tally,
                out);
    out.none_of("scales at which the levels are others than at the origin", other);
    report(tally, 24, out);
}

void transforms(const Effort&, Outcome& out) {
    Tally tally;
    const auto ball = bumpy_ball(12, 1);
    const std::uint64_t n = ball.indices.size() / 3;
    dmat4 shear(1.0);
    shear[1][0] = 50;
    const auto good = [&](const std::string& name, const dmat4& world) {
        check_scene(name, scene_of(ball, world), n, tally, out);
    };
    good("mirrored", scaled({-1, 1, 1}));
    good("mirrored thrice", scaled({-1, -1, -1}));
    good("flattened a million times", scaled({1, 1e-6, 1}));
    good("drawn out a million times", scaled({1e6, 1, 1}));
    good("sheared by 50", shear);
    good("sheared and mirrored", shear * scaled({1, -2, 0.1}));
    const auto bad = [&](const std::string& name, const dmat4& world) {
        check_scene(name, scene_of(ball, world), refused, tally, out);
    };
    bad("a scale of 0", scaled({1, 0, 1}));
    bad("all zeros", dmat4(0.0));
    dmat4 rank_one(1.0);
    rank_one[0] = {1, 2, 3, 0};
    rank_one[1] = {2, 4, 6, 0};
    bad("two axes alike", rank_one);
    dmat4 two = dmat4(1.0);  // one good object beside one that is none
    importer::Scene scene = scene_of(ball, two);
    place(scene, ball, "flat", rank_one);
    check_scene("one good beside one singular", scene, n, tally, out);
    report(tally, 10, out);
}

/// A chain of nodes in glTF; cycle: the last holds the first.
Bytes chain_gltf(int nodes, double scale, bool cycle) {
    std::string text =
        R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
        R"("accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5123,)"
        R"("count":3,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],)"
        R"("buffers":[{"byteLength":42,"uri":"data:application/octet-stream;base64,)"
        R"(AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}],"nodes":[)";
    for (int i = 0; i < nodes; ++i) {
        text += (i > 0 ? "," : "") + std::string(R"({"mesh":0,"scale":[)") + std::to_string(scale) + "," + std::to_string(scale) +
                "," + std::to_string(scale) + R"(],"translation":[0.1,0,0])";
        if (i + 1 < nodes || cycle) text += R"(,"children":[)" + std::to_string((i + 1) % nodes) + "]";
        text += "}";
    }
    return bytes_of(text + "]}");
}

void graphs(const Effort&, Outcome& out) {
    Tally tally;
    const auto check_file = [&](const std::string& name, const Bytes& bytes, std::uint64_t wanted) {
        MemoryFile file;
        file.set(bytes);
        auto scene = importer::import_gltf(file.name(), {});
        if (!scene) {
            ++tally.cases;
            out.digest_of(refused);
            if (wanted != refused) tally.complain(name + " is refused: " + scene.error().text());
            return;
        }
        check_scene(name, std::move(*scene), wanted, tally, out);
    };
    check_file("200 deep", chain_gltf(200, 1, false), 200);
    check_file("200 deep, each a little smaller than its parent", chain_gltf(200, 0.95, false), 200);
    check_file("200 deep, each twice its parent", chain_gltf(200, 2, false), 39);  // 2^40 is beyond a million million metres
    check_file("a node that is its own child", chain_gltf(1, 1, true), refused);
    check_file("a ring of 200", chain_gltf(200, 1, true), refused);
    report(tally, 5, out);
}

void crowds(const Effort& effort, Outcome& out) {
    Tally tally;
    const auto points = static_cast<std::uint32_t>(effort.count(10'000'000, 100'000));
    importer::Primitive point = with({}, {});
    point.positions.resize(4 + static_cast<std::size_t>(points), vec3(7));
    for (std::uint32_t i = 0; i + 2 < points; i += 3) point.indices.insert(point.indices.end(), {4 + i, 5 + i, 6 + i});
    check_scene("vertices in a point", scene_of(std::move(point)), 2, tally, out);
    const auto alike = static_cast<std::uint32_t>(effort.count(40'000, 2'000));
    importer::Primitive pile;  // triangles with an area, all in one place: a median of their centres parts none
    for (std::uint32_t i = 0; i < alike; ++i) {
        pile.positions.insert(pile.positions.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        pile.indices.insert(pile.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    }
    check_scene("triangles in one place", scene_of(std::move(pile)), alike, tally, out);
    const auto objects = static_cast<std::uint32_t>(effort.count(20'000, 1'000));
    importer::Scene crowd = scene_of(triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2}));
    while (crowd.nodes.size() < objects) crowd.nodes.push_back(crowd.nodes[0]);
    check_scene("objects in one place", std::move(crowd), objects, tally, out);
    report(tally, 3, out);
    if (points < 10'000'000) out.scaled = std::to_string(points) + " vertices of 10000000";
}

}  // namespace

std::span<const Row> transform_rows() {
    static constexpr std::array<Row, 4> table = {{
        {"N5", "transforms", "vertices at 2^23 m, sizes from 2^-140 to 2^66, by vertices and by transforms, mirrored too",
         "the same levels as at the origin, or a refusal by name where it is too small to be seen or no place on Earth",
         other_scales},
        {"N15", "transforms", "mirrored, flattened, drawn out, sheared, singular transforms",
         "a sound model with what was good, or a refusal by name", transforms},
        {"N22a", "transforms", "instances 200 deep, growing and shrinking, cycles",
         "a sound model with what was good, or a refusal by name", graphs},
        {"N22b", "transforms", "millions of vertices in a point, thousands of triangles and of objects in one place",
         "a sound model with what was good, or a refusal by name", crowds},
    }};
    return table;
}

}  // namespace surefoot::selftest
