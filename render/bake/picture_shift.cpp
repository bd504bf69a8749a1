// Comparing texture coordinates (picture_shift.hpp).
#include "render/bake/picture_shift.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "render/measure/mesh_distance.hpp"

namespace surefoot::bake {

namespace {

struct Place {
    vec3 p;
    vec2 uv;
};
using Triangle = std::array<Place, 3>;

Triangle triangle_of(const std::vector<model::Vertex>& vertices, std::span<const std::uint32_t> three) {
    Triangle t;
    for (std::size_t k = 0; k < 3; ++k) {
        const model::Vertex& v = vertices[three[k]];
        t[k] = {position_of(v), vec2(v.uv[0], v.uv[1])};
    }
    return t;
}

/// Texture coordinates of the place of `t` that is nearest to p, or near it: what lies outside is drawn to the rim.
vec2 uv_near(const Triangle& t, const vec3& p) {
    const vec3 a = t[1].p - t[0].p, b = t[2].p - t[0].p, d = p - t[0].p;
    const float aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b), da = glm::dot(d, a), db = glm::dot(d, b);
    const float det = aa * bb - ab * ab;
    if (!(det > 0)) return t[0].uv;
    const float u = std::max(0.0F, (bb * da - ab * db) / det), v = std::max(0.0F, (aa * db - ab * da) / det);
    const float over = std::max(1.0F, u + v);
    return t[0].uv + (t[1].uv - t[0].uv) * (u / over) + (t[2].uv - t[0].uv) * (v / over);
}

/// Metres that a step in texture coordinates is on the triangle; 0 where its picture has no extent.
float metres(const Triangle& t, const vec2& step) {
    const vec2 a = t[1].uv - t[0].uv, b = t[2].uv - t[0].uv;
    const float det = a.x * b.y - a.y * b.x;
    if (!(std::abs(det) > 1e-12F)) return 0;
    const float i = (step.x * b.y - step.y * b.x) / det, j = (a.x * step.y - a.y * step.x) / det;
    return glm::length((t[1].p - t[0].p) * i + (t[2].p - t[0].p) * j);
}

struct Sample {
    float shift_m, area;
};

}  // namespace

struct PictureReference::Surface {
    model::Index material;
    bool repeats;
    std::vector<std::uint32_t> indices;
    measure::TriangleTree tree;

    Surface(model::Index of, bool repeating, const std::vector<vec3>& positions, std::vector<std::uint32_t> triangles)
        : material(of), repeats(repeating), indices(std::move(triangles)), tree({positions, indices}) {}
};

PictureReference::PictureReference(const Geometry& full, const std::vector<Picture>& pictures) : full_(full) {
    std::vector<vec3> positions;
    positions.reserve(full.vertices.size());
    for (const model::Vertex& v : full.vertices) positions.push_back(position_of(v));
    for (std::size_t m = 0; m < pictures.size(); ++m) {
        if (pictures[m] == Picture::none) continue;
        std::vector<std::uint32_t> indices;
        for (const GeometryPart& p : full.parts) {
            if (p.material == m) indices.insert(indices.end(), p.indices.begin(), p.indices.end());
        }
        if (indices.empty()) continue;
        surfaces_.push_back(std::make_unique<Surface>(static_cast<model::Index>(m), pictures[m] == Picture::repeats, positions,
                                                      std::move(indices)));
    }
}

PictureReference::~PictureReference() = default;

float PictureReference::shift_m(const Level& level) const {
    std::vector<Sample> samples;
    constexpr std::array<vec3, 4> places = {vec3(1.0F / 3), vec3(0.6F, 0.2F, 0.2F), vec3(0.2F, 0.6F, 0.2F),
                                            vec3(0.2F, 0.2F, 0.6F)};
    for (const GeometryPart& part : level.parts) {
        const auto own =
            std::find_if(surfaces_.begin(), surfaces_.end(), [&](const auto& s) { return s->material == part.material; });
        if (own == surfaces_.end()) continue;
        const Surface& surface = **own;
        std::uint32_t hint = 0xffffffffU;
        for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
            const Triangle coarse = triangle_of(full_.vertices, std::span(part.indices).subspan(i, 3));
            const float area = 0.5F * glm::length(glm::cross(coarse[1].p - coarse[0].p, coarse[2].p - coarse[0].p));
            if (!(area > 0)) continue;
            for (const vec3& at : places) {
                const vec3 p = coarse[0].p * at.x + coarse[1].p * at.y + coarse[2].p * at.z;
                const vec2 uv = coarse[0].uv * at.x + coarse[1].uv * at.y + coarse[2].uv * at.z;
                hint = surface.tree.nearest(p, hint).triangle;
                const Triangle fine =
                    triangle_of(full_.vertices, std::span(surface.indices).subspan(3 * surface.tree.in_mesh(hint), 3));
                vec2 step = uv - uv_near(fine, p);
                if (surface.repeats) step -= glm::round(step);
                const float shift = metres(fine, step);
                samples.push_back({std::isfinite(shift) ? shift : 0.0F, area});
            }
        }
    }
    std::sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) { return a.shift_m < b.shift_m; });
    double area = 0, below = 0;
    for (const Sample& s : samples) area += static_cast<double>(s.area);
    for (const Sample& s : samples) {
        below += static_cast<double>(s.area);
        if (below >= 0.9 * area) return s.shift_m;
    }
    return 0;
}

}  // namespace surefoot::bake
