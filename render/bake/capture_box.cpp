// Six orthographic captures by a small depth-buffered rasteriser: deterministic, and on any core.
#include "render/bake/capture_box.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::bake {

namespace {

struct Canvas {
    std::uint32_t pixels;
    float deepest;
    std::vector<float> depth;
    std::vector<std::uint8_t> rgba;
};

float edge(const vec2& a, const vec2& b, const vec2& p) { return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x); }

/// 0..1, other for every pixel and triangle: layers of leaves fill each other's holes, as they do in sight.
float scattered(std::size_t pixel, std::size_t triangle) {
    std::uint64_t x = (static_cast<std::uint64_t>(triangle) << 24U) + pixel + 1;
    x = (x ^ (x >> 30U)) * 0xbf58476d1ce4e5b9ULL;  // splitmix64
    x = (x ^ (x >> 27U)) * 0x94d049bb133111ebULL;
    return static_cast<float>((x ^ (x >> 31U)) >> 40U) / static_cast<float>(1U << 24U);
}

/// p: corners in pixels and depth behind the face.
void fill(Canvas& canvas, std::array<vec3, 3> p, const ColouredTriangle& triangle, std::size_t number) {
    const std::array<std::array<std::uint8_t, 4>, 3>& colours = triangle.colours;
    const vec2 a(p[0]), b(p[1]), c(p[2]);
    const float area = edge(a, b, c);
    if (std::abs(area) < 1e-12F) return;
    const float last = static_cast<float>(canvas.pixels - 1);
    const auto lo = [&](float u, float v, float w) {
        return static_cast<std::uint32_t>(std::clamp(std::floor(std::min({u, v, w})), 0.0F, last));
    };
    const auto hi = [&](float u, float v, float w) {
        return static_cast<std::uint32_t>(std::clamp(std::ceil(std::max({u, v, w})), 0.0F, last));
    };
    const std::uint32_t x0 = lo(a.x, b.x, c.x), x1 = hi(a.x, b.x, c.x), y1 = hi(a.y, b.y, c.y);
    for (std::uint32_t y = lo(a.y, b.y, c.y); y <= y1; ++y) {
        for (std::uint32_t x = x0; x <= x1; ++x) {
            const vec2 at(static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F);
            const float wa = edge(b, c, at) / area, wb = edge(c, a, at) / area, wc = 1 - wa - wb;
            if (wa < 0 || wb < 0 || wc < 0) continue;
            const float depth = wa * p[0].z + wb * p[1].z + wc * p[2].z;
            const std::size_t pixel = y * canvas.pixels + x;
            if (depth >= canvas.depth[pixel] || depth > canvas.deepest) continue;
            if (triangle.shown < 1 && scattered(pixel, number) >= triangle.shown) continue;
            canvas.depth[pixel] = depth;
            for (std::size_t k = 0; k < 3; ++k) {
                const float value = wa * static_cast<float>(colours[0][k]) + wb * static_cast<float>(colours[1][k]) +
                                    wc * static_cast<float>(colours[2][k]);
                canvas.rgba[pixel * 4 + k] = static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F));
            }
            canvas.rgba[pixel * 4 + 3] = 255;
        }
    }
}

FaceCapture capture_face(std::span<const ColouredTriangle> triangles, const vec3& half, std::uint32_t pixels, int face) {
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const float side = face % 2 == 1 ? 1.0F : -1.0F;
    // Only the near half: the far one is on the opposite face, seen through the holes of this. It halves the parallax.
    Canvas canvas{pixels, half[axis] * 1.001F, std::vector<float>(pixels * pixels, 1e30F),
                  std::vector<std::uint8_t>(pixels * pixels * 4, 0)};
    const auto project = [&](const vec3& p) {
        const float n = static_cast<float>(pixels);
        return vec3((p[u] + half[u]) / std::max(2 * half[u], 1e-9F) * n, (p[v] + half[v]) / std::max(2 * half[v], 1e-9F) * n,
                    half[axis] - side * p[axis]);
    };
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const ColouredTriangle& t = triangles[i];
        fill(canvas, {project(t.corners[0]), project(t.corners[1]), project(t.corners[2])}, t, i);
    }
    FaceCapture out;
    std::array<std::uint64_t, 3> sum{};
    std::uint64_t covered = 0;
    for (std::size_t i = 0; i < canvas.depth.size(); ++i) {
        if (canvas.rgba[i * 4 + 3] == 0) continue;
        ++covered;
        out.depth_m = std::max(out.depth_m, canvas.depth[i]);
        for (std::size_t k = 0; k < 3; ++k) sum[k] += canvas.rgba[i * 4 + k];
    }
    for (std::size_t k = 0; k < 3; ++k) out.mean[k] = static_cast<std::uint8_t>(covered == 0 ? 0 : sum[k] / covered);
    out.mean[3] = covered == 0 ? 0 : 255;
    out.covered = static_cast<float>(covered) / static_cast<float>(canvas.depth.size());
    // Transparent texels take the mean colour: filtering must not mix in black at the edges.
    for (std::size_t i = 0; i < canvas.depth.size(); ++i) {
        if (canvas.rgba[i * 4 + 3] == 0)
            std::copy_n(out.mean.begin(), 3, canvas.rgba.begin() + static_cast<std::ptrdiff_t>(i * 4));
    }
    out.rgba = std::move(canvas.rgba);
    return out;
}

}  // namespace

std::array<FaceCapture, 6> capture_faces(std::span<const ColouredTriangle> triangles, const vec3& half, std::uint32_t pixels) {
    std::array<FaceCapture, 6> faces;
    for (int face = 0; face < 6; ++face) faces[static_cast<std::size_t>(face)] = capture_face(triangles, half, pixels, face);
    return faces;
}

}  // namespace surefoot::bake
