// Rows: meshes and transforms that are broken, degenerate, tiny, huge or too many: import and bake end in a sound model or a
// refusal by name, and what was good is still there.
#include <array>
#include <cmath>
#include <limits>

#include "render/bake/geometry.hpp"
#include "render/measure/mesh_distance.hpp"
#include "rt/base/hash.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/fixtures.hpp"
#include "tools/selftest/look.hpp"
#include "tools/selftest/shapes.hpp"

namespace surefoot::selftest {

namespace {

const float nan = std::nanf("");
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::uint64_t refused = 0;

struct Tally {
    std::uint64_t wrong = 0, cases = 0, kept = 0;
    std::string first;  ///< of what is wrong, in words
    void complain(const std::string& what) {
        if (wrong++ == 0) first = what;
    }
};

/// Seen from four places, numbers must be finite and cuts legal.
std::uint64_t unsound_views(const model::Model& model, std::uint64_t& cut_hash) {
    std::uint64_t bad = 0;
    Look look(model);
    const Box& box = model.nodes[0].box;
    const double size = std::max(box.diagonal(), 1e-30);
    for (const dvec3& at : {box.centre(), box.centre() + dvec3(0, 0, 1) * size, box.centre() + dvec3(3, 2, 5) * size, box.max}) {
        Pose pose;
        pose.position = at;
        const prepare::PreparedFrame& frame = look.prepare({pose, 0, 0});
        bad += unsound(frame, look.costs());
        const select::Cut& cut = look.select("two-stage", 2500);
        bad += illegal(frame, cut);
        cut_hash = fnv1a(cut_hash, cut.hash);
    }
    for (const model::Representation& r : model.reps) bad += std::isfinite(r.error_m) ? 0 : 1;
    return bad;
}

/// wanted: triangles that must be left, or `refused`.
void judge(const std::string& name, importer::Scene scene, std::uint64_t wanted, Tally& tally, Outcome& out) {
    ++tally.cases;
    const auto model = import_and_bake(std::move(scene));
    if (!model) {
        if (wanted != refused) tally.complain(name + " is refused: " + model.error().text());
        if (model.error().place.empty() || model.error().what.empty()) tally.complain(name + " is refused without a word");
        out.digest_of(refused);
        return;
    }
    tally.kept += model->triangles();
    if (model->triangles() != wanted)
        tally.complain(name + " has " + std::to_string(model->triangles()) + " triangles, not " + std::to_string(wanted));
    std::uint64_t hash = out.cut_hash;
    if (unsound_views(*model, hash) > 0) tally.complain(name + " has unsound numbers or cuts");
    for (const model::Vertex& v : model->vertices) {
        const double length = glm::length(dvec3(v.normal[0], v.normal[1], v.normal[2]));
        if (length < 120 || length > 130) {
            tally.complain(name + " has a normal of no length");
            break;
        }
    }
    out.cut_hash = hash;
    out.digest_of(model->triangles());
    out.digest_of(hash);
}

void report(const Tally& tally, std::size_t least, Outcome& out) {
    out.none_of("cases that do not end as they must" + (tally.first.empty() ? "" : " (" + tally.first + ")"), tally.wrong);
    out.at_least("cases", static_cast<double>(tally.cases), static_cast<double>(least));
    out.triangles = tally.kept;
}

/// A good square metre, and beside it what `spoil` adds.
importer::Primitive with(std::vector<vec3> more, std::vector<std::uint32_t> indices) {
    importer::Primitive p = triangles({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 1, 2, 0, 2, 3});
    for (std::uint32_t& i : indices) i += 4;
    p.positions.insert(p.positions.end(), more.begin(), more.end());
    p.indices.insert(p.indices.end(), indices.begin(), indices.end());
    return p;
}

void bad_numbers(const Effort&, Outcome& out) {
    Tally tally;
    for (const float bad : {nan, infinity, -infinity, 1e38F, -3.4e38F, 1e30F}) {
        for (int axis = 0; axis < 3; ++axis) {
            vec3 corner(3, 3, 3);
            corner[axis] = bad;
            judge("a corner at " + std::to_string(bad), scene_of(with({{2, 0, 0}, {3, 0, 0}, corner}, {0, 1, 2})), 2, tally, out);
        }
        auto normals = with({}, {});
        normals.normals.assign(4, vec3(bad, 0, bad));
        judge("normals of " + std::to_string(bad), scene_of(normals), 2, tally, out);
        auto uvs = with({}, {});
        uvs.uvs.assign(4, vec2(bad, 0));
        judge("texture coordinates of " + std::to_string(bad), scene_of(uvs), 2, tally, out);
        auto scene = scene_of(with({}, {}), scaled(dvec3(static_cast<double>(bad))));
        judge("a scale of " + std::to_string(bad), scene, refused, tally, out);
        scene = scene_of(with({}, {}), moved({0, static_cast<double>(bad), 0}));
        judge("a place at " + std::to_string(bad), scene, refused, tally, out);
    }
    judge("denormal corners", scene_of(with({{1e-40F, 0, 0}, {0, 1e-40F, 0}, {0, 0, 0}}, {0, 1, 2})), 3, tally, out);
    judge("nothing but not a number", scene_of(triangles({vec3(nan), vec3(nan), vec3(nan)}, {0, 1, 2})), refused, tally, out);
    report(tally, 40, out);
}

void degenerate(const Effort&, Outcome& out) {
    Tally tally;
    judge("no area", scene_of(with({{2, 0, 0}, {3, 0, 0}, {4, 0, 0}}, {0, 1, 2})), 2, tally, out);
    judge("one point", scene_of(with({vec3(5), vec3(5), vec3(5)}, {0, 1, 2})), 2, tally, out);
    judge("a repeated index", scene_of(with({{2, 0, 0}, {3, 0, 0}}, {0, 1, 1})), 2, tally, out);
    judge("an index out of range", scene_of(with({{2, 0, 0}}, {0, 70, 4'000'000})), 2, tally, out);
    judge("a sliver of 1e-9", scene_of(with({{2, 0, 0}, {3, 0, 0}, {2.5F, 1e-9F, 0}}, {0, 1, 2})), 3, tally, out);
    judge("a vertex and no triangle", scene_of(triangles({{1, 2, 3}}, {})), refused, tally, out);
    judge("no vertex", scene_of(triangles({}, {})), refused, tally, out);
    judge("one triangle", scene_of(triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2})), 1, tally, out);
    std::vector<vec3> line{{2, 0, 0}};
    std::vector<std::uint32_t> fan;
    for (std::uint32_t i = 1; i < 60; ++i) {
        line.push_back({2 + static_cast<float>(i), 0, 0});
        if (i > 1) fan.insert(fan.end(), {0, i - 1, i});
    }
    judge("a fan along a line", scene_of(with(line, fan)), 2, tally, out);
    // A strip of slivers so thin that normals and quadrics have nothing to hold on to.
    importer::Primitive slivers = surface(200, 1, [](double u, double v) { return vec3(dvec3(u, 1e-9 * v, 0)); });
    judge("a strip of slivers", scene_of(slivers), 400, tally, out);
    report(tally, 10, out);
}

void not_manifold(const Effort&, Outcome& out) {
    Tally tally;
    std::vector<vec3> fin{{0, 0, 0}, {0, 1, 0}};
    std::vector<std::uint32_t> blades;
    for (std::uint32_t i = 0; i < 7; ++i) {
        const double a = 0.9 * i;
        fin.push_back(vec3(dvec3(std::cos(a), 0.5, std::sin(a))));
        blades.insert(blades.end(), {0, 1, i + 2});
    }
    judge("an edge of seven faces", scene_of(triangles(fin, blades)), 7, tally, out);
    const auto ball = bumpy_ball(12, 1);
    const std::uint64_t n = ball.indices.size() / 3;
    importer::Primitive twice = ball;
    twice.indices.insert(twice.indices.end(), ball.indices.begin(), ball.indices.end());
    judge("every face twice", scene_of(twice), 2 * n, tally, out);
    importer::Primitive inside_out = ball;
    for (std::size_t i = 0; i + 2 < inside_out.indices.size(); i += 3)
        std::swap(inside_out.indices[i], inside_out.indices[i + 1]);
    judge("inside out", scene_of(inside_out), n, tally, out);
    importer::Primitive both = ball;
    both.indices.insert(both.indices.end(), inside_out.indices.begin(), inside_out.indices.end());
    judge("every face with its opposite", scene_of(both), 2 * n, tally, out);
    const auto band = surface(60, 4, [](double u, double v) {
        const double a = 6.283185307179586 * u, w = 0.3 * (v - 0.5);
        return vec3(dvec3((1 + w * std::cos(a / 2)) * std::cos(a), (1 + w * std::cos(a / 2)) * std::sin(a), w * std::sin(a / 2)));
    });
    judge("a Moebius band", scene_of(band), band.indices.size() / 3, tally, out);
    const auto crossing = surface(40, 40, [](double u, double v) {  // a figure of eight, drawn out: it goes through itself
        const double a = 6.283185307179586 * u;
        return vec3(dvec3(std::sin(a), std::sin(2 * a), v));
    });
    judge("a surface through itself", scene_of(crossing), crossing.indices.size() / 3, tally, out);
    importer::Primitive soup = ball;  // no two triangles share a vertex
    soup.positions.clear();
    for (std::uint32_t& i : soup.indices) {
        soup.positions.push_back(ball.positions[i]);
        i = static_cast<std::uint32_t>(soup.positions.size() - 1);
    }
    judge("a soup", scene_of(soup), n, tally, out);
    importer::Primitive bow = triangles({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {0, 1, 2, 0, 3, 4});
    judge("two triangles at one vertex", scene_of(bow), 2, tally, out);
    report(tally, 8, out);
}

bake::Geometry geometry_of(importer::Primitive primitive) {
    std::vector<std::string> ignored;
    importer::clean(primitive, "shape", ignored);
    bake::Geometry g;
    for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
        model::Vertex v{};
        for (int axis = 0; axis < 3; ++axis) {
            v.position[axis] = primitive.positions[i][axis];
            v.normal[axis] = static_cast<std::int8_t>(std::lround(127 * primitive.normals[i][axis]));
        }
        g.vertices.push_back(v);
        g.baked.push_back({255, 255, 255, 255});
    }
    g.parts.push_back({0, primitive.indices});
    return g;
}

/// How far the sampled distance of a level lies over its bound, relative to the size; and coordinates outside the box.
void check_chain(const bake::LodChain& chain, Tally& tally, const std::string& name, double& over) {
    Box box;
    const auto mesh_of = [&](const std::vector<bake::GeometryPart>& parts, std::vector<vec3>& positions,
                             std::vector<std::uint32_t>& indices) {
        for (const model::Vertex& v : chain.full.vertices) positions.push_back(bake::position_of(v));
        for (const bake::GeometryPart& part : parts) indices.insert(indices.end(), part.indices.begin(), part.indices.end());
    };
    std::vector<vec3> full_positions;
    std::vector<std::uint32_t> full_indices;
    mesh_of(chain.levels.back().parts, full_positions, full_indices);
    for (const std::uint32_t i : full_indices) box.grow(dvec3(full_positions[i]));
    const double size = std::max(box.diagonal(), 1e-300);
    for (std::size_t k = 0; k < chain.levels.size(); ++k) {
        const bake::Level& level = chain.levels[k];
        if (!std::isfinite(level.error_m) || level.error_m < 0) return tally.complain(name + ": an error that is not finite");
        if (k > 0 && !(level.error_m < chain.levels[k - 1].error_m && level.triangles > chain.levels[k - 1].triangles))
            return tally.complain(name + ": levels out of order");
        std::vector<vec3> positions;
        std::vector<std::uint32_t> indices;
        mesh_of(level.parts, positions, indices);
        for (const std::uint32_t i : indices) {
            if (!(box.distance(dvec3(positions[i])) <= 1e-5 * size)) return tally.complain(name + ": a spike out of the box");
        }
        for (const bool back : {false, true}) {
            const measure::MeshView a{full_positions, full_indices}, b{positions, indices};
            const float seen = measure::sampled_distance(back ? b : a, measure::TriangleTree(back ? a : b), 2000, 3).largest;
            over = std::max(over, static_cast<double>(seen - level.error_m) / size);
        }
    }
}

/// Flat, creased, of one triangle: the quadrics of all vertices are singular.
void singular_quadrics(const Effort&, Outcome& out) {
    Tally tally;
    double over = -1;
    const std::array<std::pair<const char*, importer::Primitive>, 6> shapes{{
        {"a flat grid", surface(32, 32, [](double u, double v) { return vec3(dvec3(u, v, 0)); })},
        {"a crease", surface(32, 32, [](double u, double v) { return vec3(dvec3(u, v, std::abs(u - 0.5))); })},
        {"a tetrahedron", triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2})},
        {"a triangle", triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2})},
        {"a cylinder",
         surface(64, 16,
                 [](double u, double v) { return vec3(dvec3(std::cos(6.283185307 * u), v, std::sin(6.283185307 * u))); })},
        {"a needle", surface(16, 64,
                             [](double u, double v) {
                                 return vec3(dvec3(1e-6 * std::cos(6.283185307 * u), v, 1e-6 * std::sin(6.283185307 * u)));
                             })},
    }};
    double flat_error = 1, flat_triangles = 0;
    for (const auto& [name, primitive] : shapes) {
        ++tally.cases;
        bake::ChainOptions options;
        options.smallest = 2;
        options.proxy_material = model::none;
        const bake::LodChain chain = bake::make_chain(geometry_of(primitive), options);
        check_chain(chain, tally, name, over);
        for (const bake::Level& level : chain.levels) out.digest_of(level.triangles);
        if (tally.cases > 1) continue;
        flat_triangles = chain.levels.front().triangles;
        flat_error = chain.levels.front().error_m;
    }
    report(tally, 6, out);
    out.at_most("sampled distance over the bound, relative to the size", over, 1e-6);
    out.exactly("triangles of the flat grid's coarsest level", flat_triangles, 2);
    out.at_most("its bound, relative to the size: where bounding stops", flat_error / std::sqrt(2.0), 0.0005);
}

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
        judge(name, scene, here->triangles(), tally, out);
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
        judge("a mirroring one of 2^" + std::to_string(exponent), scene_of(hills(1, 0), scaled(dvec3(-scale, scale, scale))),
              here->triangles(), tally, out);
    }
    // What nobody could see, and what is no place: refused by name, and nothing beside it is lost.
    for (const int exponent : {-140, -100, -66}) {
        const double scale = std::ldexp(1.0, exponent);
        const std::string name = "2^" + std::to_string(exponent);
        judge(name, scene_of(hills(scale, 0)), refused, tally, out);
        for (const double mirrored : {1.0, -1.0}) {
            importer::Scene scene = scene_of(hills(1, 0), scaled(scale * dvec3(mirrored, 1, 1)));
            judge("a transform of " + name, scene, refused, tally, out);
            place(scene, hills(1, 0), "good", dmat4(1.0));
            judge("a good one beside it", scene, here->triangles(), tally, out);
        }
    }
    judge("2^33 times 2^33", scene_of(hills(std::ldexp(1.0, 33), 0), scaled(dvec3(std::ldexp(1.0, 33)))), refused, tally, out);
    out.none_of("scales at which the levels are others than at the origin", other);
    report(tally, 24, out);
}

void transforms(const Effort&, Outcome& out) {
    Tally tally;
    const auto ball = bumpy_ball(12, 1);
    const std::uint64_t n = ball.indices.size() / 3;
    dmat4 shear(1.0);
    shear[1][0] = 50;
    const auto good = [&](const std::string& name, const dmat4& world) { judge(name, scene_of(ball, world), n, tally, out); };
    good("mirrored", scaled({-1, 1, 1}));
    good("mirrored thrice", scaled({-1, -1, -1}));
    good("flattened a million times", scaled({1, 1e-6, 1}));
    good("drawn out a million times", scaled({1e6, 1, 1}));
    good("sheared by 50", shear);
    good("sheared and mirrored", shear * scaled({1, -2, 0.1}));
    const auto bad = [&](const std::string& name, const dmat4& world) {
        judge(name, scene_of(ball, world), refused, tally, out);
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
    judge("one good beside one singular", scene, n, tally, out);
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
    const auto judge_file = [&](const std::string& name, const Bytes& bytes, std::uint64_t wanted) {
        MemoryFile file;
        file.set(bytes);
        auto scene = importer::import_gltf(file.name(), {});
        if (!scene) {
            ++tally.cases;
            out.digest_of(refused);
            if (wanted != refused) tally.complain(name + " is refused: " + scene.error().text());
            return;
        }
        judge(name, std::move(*scene), wanted, tally, out);
    };
    judge_file("200 deep", chain_gltf(200, 1, false), 200);
    judge_file("200 deep, each a little smaller than its parent", chain_gltf(200, 0.95, false), 200);
    judge_file("200 deep, each twice its parent", chain_gltf(200, 2, false), 39);  // 2^40 is beyond a million million metres
    judge_file("a node that is its own child", chain_gltf(1, 1, true), refused);
    judge_file("a ring of 200", chain_gltf(200, 1, true), refused);
    report(tally, 5, out);
}

void crowds(const Effort& effort, Outcome& out) {
    Tally tally;
    const auto points = static_cast<std::uint32_t>(effort.count(10'000'000, 100'000));
    importer::Primitive point = with({}, {});
    point.positions.resize(4 + static_cast<std::size_t>(points), vec3(7));
    for (std::uint32_t i = 0; i + 2 < points; i += 3) point.indices.insert(point.indices.end(), {4 + i, 5 + i, 6 + i});
    judge("vertices in a point", scene_of(std::move(point)), 2, tally, out);
    const auto alike = static_cast<std::uint32_t>(effort.count(40'000, 2'000));
    importer::Primitive pile;  // triangles with an area, all in one place: a median of their centres parts none
    for (std::uint32_t i = 0; i < alike; ++i) {
        pile.positions.insert(pile.positions.end(), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
        pile.indices.insert(pile.indices.end(), {3 * i, 3 * i + 1, 3 * i + 2});
    }
    judge("triangles in one place", scene_of(std::move(pile)), alike, tally, out);
    const auto objects = static_cast<std::uint32_t>(effort.count(20'000, 1'000));
    importer::Scene crowd = scene_of(triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2}));
    while (crowd.nodes.size() < objects) crowd.nodes.push_back(crowd.nodes[0]);
    judge("objects in one place", std::move(crowd), objects, tally, out);
    report(tally, 3, out);
    if (points < 10'000'000) out.scaled = std::to_string(points) + " vertices of 10000000";
}

}  // namespace

std::span<const Row> geometry_rows() {
    static constexpr std::string_view ends = "a sound model with what was good, or a refusal by name";
    static constexpr std::array<Row, 8> table = {{
        {"N1", "geometry", "not a number, infinite, 1e30, 3.4e38 and denormal in positions, normals, coordinates and transforms",
         ends, bad_numbers},
        {"N2", "geometry", "no area, slivers of 1e-9, repeated and wild indices, fans along a line, one vertex, none", ends,
         degenerate},
        {"N3", "geometry", "edges of seven faces, faces twice and opposite, inside out, Moebius, through itself, a soup", ends,
         not_manifold},
        {"N4", "geometry", "flat, creased, one triangle, a needle: singular quadrics",
         "levels in order, no spikes, no sample beyond its bound", singular_quadrics},
        {"N5", "geometry", "vertices at 2^23 m, sizes from 2^-140 to 2^66, by vertices and by transforms, mirrored too",
         "the same levels as at the origin, or a refusal by name where it is too small to be seen or no place on Earth",
         other_scales},
        {"N15", "geometry", "mirrored, flattened, drawn out, sheared, singular transforms", ends, transforms},
        {"N22a", "geometry", "instances 200 deep, growing and shrinking, cycles", ends, graphs},
        {"N22b", "geometry", "millions of vertices in a point, thousands of triangles and of objects in one place", ends, crowds},
    }};
    return table;
}

}  // namespace surefoot::selftest
