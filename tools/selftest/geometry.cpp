// Rows: meshes that are broken or degenerate: import and bake end in a sound model or a refusal by name, and what was good is
// still there.
#include <array>
#include <cmath>
#include <limits>

#include "render/bake/geometry.hpp"
#include "render/measure/mesh_distance.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/scene_check.hpp"

namespace surefoot::selftest {

namespace {

const float nan = std::nanf("");
constexpr float infinity = std::numeric_limits<float>::infinity();

void bad_numbers(const Effort&, Outcome& out) {
    Tally tally;
    for (const float bad : {nan, infinity, -infinity, 1e38F, -3.4e38F, 1e30F}) {
        for (int axis = 0; axis < 3; ++axis) {
            vec3 corner(3, 3, 3);
            corner[axis] = bad;
            check_scene("a corner at " + std::to_string(bad), scene_of(with({{2, 0, 0}, {3, 0, 0}, corner}, {0, 1, 2})), 2, tally,
                        out);
        }
        auto normals = with({}, {});
        normals.normals.assign(4, vec3(bad, 0, bad));
        check_scene("normals of " + std::to_string(bad), scene_of(normals), 2, tally, out);
        auto uvs = with({}, {});
        uvs.uvs.assign(4, vec2(bad, 0));
        check_scene("texture coordinates of " + std::to_string(bad), scene_of(uvs), 2, tally, out);
        auto scene = scene_of(with({}, {}), scaled(dvec3(static_cast<double>(bad))));
        check_scene("a scale of " + std::to_string(bad), scene, refused, tally, out);
        scene = scene_of(with({}, {}), moved({0, static_cast<double>(bad), 0}));
        check_scene("a place at " + std::to_string(bad), scene, refused, tally, out);
    }
    check_scene("denormal corners", scene_of(with({{1e-40F, 0, 0}, {0, 1e-40F, 0}, {0, 0, 0}}, {0, 1, 2})), 3, tally, out);
    check_scene("nothing but not a number", scene_of(triangles({vec3(nan), vec3(nan), vec3(nan)}, {0, 1, 2})), refused, tally,
                out);
    report(tally, 40, out);
}

void degenerate(const Effort&, Outcome& out) {
    Tally tally;
    check_scene("no area", scene_of(with({{2, 0, 0}, {3, 0, 0}, {4, 0, 0}}, {0, 1, 2})), 2, tally, out);
    check_scene("one point", scene_of(with({vec3(5), vec3(5), vec3(5)}, {0, 1, 2})), 2, tally, out);
    check_scene("a repeated index", scene_of(with({{2, 0, 0}, {3, 0, 0}}, {0, 1, 1})), 2, tally, out);
    check_scene("an index out of range", scene_of(with({{2, 0, 0}}, {0, 70, 4'000'000})), 2, tally, out);
    check_scene("a sliver of 1e-9", scene_of(with({{2, 0, 0}, {3, 0, 0}, {2.5F, 1e-9F, 0}}, {0, 1, 2})), 3, tally, out);
    check_scene("a vertex and no triangle", scene_of(triangles({{1, 2, 3}}, {})), refused, tally, out);
    check_scene("no vertex", scene_of(triangles({}, {})), refused, tally, out);
    check_scene("one triangle", scene_of(triangles({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 1, 2})), 1, tally, out);
    std::vector<vec3> line{{2, 0, 0}};
    std::vector<std::uint32_t> fan;
    for (std::uint32_t i = 1; i < 60; ++i) {
        line.push_back({2 + static_cast<float>(i), 0, 0});
        if (i > 1) fan.insert(fan.end(), {0, i - 1, i});
    }
    check_scene("a fan along a line", scene_of(with(line, fan)), 2, tally, out);
    // A strip of slivers so thin that normals and quadrics have nothing to hold on to.
    importer::Primitive slivers = surface(200, 1, [](double u, double v) { return vec3(dvec3(u, 1e-9 * v, 0)); });
    check_scene("a strip of slivers", scene_of(slivers), 400, tally, out);
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
    check_scene("an edge of seven faces", scene_of(triangles(fin, blades)), 7, tally, out);
    const auto ball = bumpy_ball(12, 1);
    const std::uint64_t n = ball.indices.size() / 3;
    importer::Primitive twice = ball;
    twice.indices.insert(twice.indices.end(), ball.indices.begin(), ball.indices.end());
    check_scene("every face twice", scene_of(twice), 2 * n, tally, out);
    importer::Primitive inside_out = ball;
    for (std::size_t i = 0; i + 2 < inside_out.indices.size(); i += 3)
        std::swap(inside_out.indices[i], inside_out.indices[i + 1]);
    check_scene("inside out", scene_of(inside_out), n, tally, out);
    importer::Primitive both = ball;
    both.indices.insert(both.indices.end(), inside_out.indices.begin(), inside_out.indices.end());
    check_scene("every face with its opposite", scene_of(both), 2 * n, tally, out);
    const auto band = surface(60, 4, [](double u, double v) {
        const double a = 6.283185307179586 * u, w = 0.3 * (v - 0.5);
        return vec3(dvec3((1 + w * std::cos(a / 2)) * std::cos(a), (1 + w * std::cos(a / 2)) * std::sin(a), w * std::sin(a / 2)));
    });
    check_scene("a Moebius band", scene_of(band), band.indices.size() / 3, tally, out);
    const auto crossing = surface(40, 40, [](double u, double v) {  // a figure of eight, drawn out: it goes through itself
        const double a = 6.283185307179586 * u;
        return vec3(dvec3(std::sin(a), std::sin(2 * a), v));
    });
    check_scene("a surface through itself", scene_of(crossing), crossing.indices.size() / 3, tally, out);
    importer::Primitive soup = ball;  // no two triangles share a vertex
    soup.positions.clear();
    for (std::uint32_t& i : soup.indices) {
        soup.positions.push_back(ball.positions[i]);
        i = static_cast<std::uint32_t>(soup.positions.size() - 1);
    }
    check_scene("a soup", scene_of(soup), n, tally, out);
    importer::Primitive bow = triangles({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}}, {0, 1, 2, 0, 3, 4});
    check_scene("two triangles at one vertex", scene_of(bow), 2, tally, out);
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

}  // namespace

std::span<const Row> geometry_rows() {
    static constexpr std::string_view ends = "a sound model with what was good, or a refusal by name";
    static constexpr std::array<Row, 4> table = {{
        {"N1", "geometry", "not a number, infinite, 1e30, 3.4e38 and denormal in positions, normals, coordinates and transforms",
         ends, bad_numbers},
        {"N2", "geometry", "no area, slivers of 1e-9, repeated and wild indices, fans along a line, one vertex, none", ends,
         degenerate},
        {"N3", "geometry", "edges of seven faces, faces twice and opposite, inside out, Moebius, through itself, a soup", ends,
         not_manifold},
        {"N4", "geometry", "flat, creased, one triangle, a needle: singular quadrics",
         "levels in order, no spikes, no sample beyond its bound", singular_quadrics},
    }};
    return table;
}

}  // namespace surefoot::selftest
