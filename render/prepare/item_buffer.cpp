// The raster of the item buffer: triangles by their edges, samples as squares.
#include "render/prepare/item_buffer.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::prepare {

namespace {

constexpr float see_through_share = 0.5F;  // of a masked or blended surface, about
constexpr float min_depth_m = static_cast<float>(model::near_plane_m);
constexpr float max_column = 1e9F;  // a corner beyond it is no number that edges can be made of

/// 0..1, evenly; depends on its arguments alone.
float chance(std::uint32_t seed, std::uint32_t piece, std::uint32_t point) {
    std::uint32_t h = seed * 2654435761U ^ piece * 83492791U ^ point * 73856093U;
    h = (h ^ h >> 15U) * 0x2c1b3c6dU;
    h = (h ^ h >> 12U) * 0x297a2d39U;
    return static_cast<float>(h >> 8U) * 0x1p-24F;
}

/// From -1..1 to columns or rows.
float scaled(float x, int count) { return 0.5F * (x + 1.0F) * static_cast<float>(count); }

/// The first point from `from` on whose middle is at or beyond `x`, and the last one up to `to` before or at it.
int first_point(float x, int from) { return std::max(from, static_cast<int>(std::ceil(std::clamp(x, 0.0F, 1e4F) - 0.5F))); }
int last_point(float x, int to) { return std::min(to, static_cast<int>(std::floor(std::clamp(x, -1.0F, 1e4F) - 0.5F))); }

vec3 projected(const vec3& v) {
    return {scaled(v.x / v.z, ItemBuffer::columns), scaled(v.y / v.z, ItemBuffer::rows), 1.0F / v.z};
}
bool is_place(const vec3& corner) { return std::abs(corner.x) < max_column && std::abs(corner.y) < max_column; }

/// The share of a triangle's height that a hundredth of a point takes at an edge: two triangles leave no point on their common
/// one.
float slack(const vec3& from, const vec3& to, float share) {
    const float length = std::abs(to.x - from.x) + std::abs(to.y - from.y);
    return -std::min(1e-4F, std::max(2e-6F, 0.01F * length * std::abs(share)));
}

}  // namespace

void ItemBuffer::clear() { std::fill(points_.begin(), points_.end(), Point{}); }

void ItemBuffer::take(int x, int y, float depth, const Fill& fill) {
    const auto at = static_cast<std::uint32_t>(place(x, y));
    Point& point = points_[at];
    point.cover(fill.item.rank);
    if (!(depth < point.depth)) return;
    if (fill.see_through && chance(fill.item.seed, fill.piece, at) >= see_through_share) return;
    point.depth = depth;
    point.item = fill.item.number;
}

std::uint32_t ItemBuffer::fill_triangle(const Corner& a, const Corner& b, const Corner& c, const Fill& fill) {
    if (!is_place(a) || !is_place(b) || !is_place(c)) return 0;
    const Rectangle& in = fill.item.within;
    const int x0 = first_point(std::min({a.x, b.x, c.x}), in.x0), x1 = last_point(std::max({a.x, b.x, c.x}), in.x1);
    const int y0 = first_point(std::min({a.y, b.y, c.y}), in.y0), y1 = last_point(std::max({a.y, b.y, c.y}), in.y1);
    const float doubled = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (x1 < x0 || y1 < y0 || !(std::abs(doubled) > 0.0F)) return 0;
    const float share = 1.0F / doubled, a_step = (b.y - c.y) * share, b_step = (c.y - a.y) * share;
    const float min_a = slack(b, c, share), min_b = slack(c, a, share), min_c = slack(a, b, share);
    const float px = static_cast<float>(x0) + 0.5F;
    for (int y = y0; y <= y1; ++y) {
        const float py = static_cast<float>(y) + 0.5F;
        float of_a = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) * share;
        float of_b = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) * share;
        for (int x = x0; x <= x1; ++x, of_a += a_step, of_b += b_step) {
            const float of_c = 1.0F - of_a - of_b;
            if (!(of_a >= min_a && of_b >= min_b && of_c >= min_c)) continue;
            const float inverse = of_a * a.z + of_b * b.z + of_c * c.z;
            if (inverse > 0.0F) take(x, y, 1.0F / inverse, fill);
        }
    }
    return static_cast<std::uint32_t>((x1 - x0 + 1) * (y1 - y0 + 1));
}

/// Cut at the near plane: what is left has three or four corners.
std::uint32_t ItemBuffer::draw_triangle(const std::array<vec3, 3>& at, const Fill& fill) {
    std::array<Corner, 4> corners;
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        const vec3 &from = at[k], &to = at[(k + 1) % 3];
        const float f = from.z - min_depth_m, t = to.z - min_depth_m;
        if (f >= 0.0F) corners[count++] = projected(from);
        if ((f >= 0.0F) != (t >= 0.0F)) {
            vec3 cut = from + (f / (f - t)) * (to - from);
            cut.z = min_depth_m;
            corners[count++] = projected(cut);
        }
    }
    std::uint32_t work = 1;
    for (std::size_t k = 1; k + 1 < count; ++k) work += fill_triangle(corners[0], corners[k], corners[k + 1], fill);
    return work;
}

std::uint32_t ItemBuffer::draw_sample(const vec3& at, float points, const Fill& fill) {
    if (!(at.z >= min_depth_m) || (points < 1.0F && chance(fill.item.seed, fill.piece, columns * rows) >= points)) return 1;
    const Corner middle = projected(at);
    const float half = 0.5F * std::sqrt(std::clamp(points, 1.0F, 1e6F));
    if (!is_place(middle)) return 1;
    const Rectangle& in = fill.item.within;
    const int x0 = first_point(middle.x - half, in.x0), x1 = last_point(middle.x + half, in.x1);
    const int y0 = first_point(middle.y - half, in.y0), y1 = last_point(middle.y + half, in.y1);
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) take(x, y, at.z, fill);
    return static_cast<std::uint32_t>(1 + std::max(0, x1 - x0 + 1) * std::max(0, y1 - y0 + 1));
}

std::uint32_t ItemBuffer::draw(const Item& item, std::span<const model::SeenPiece> pieces) {
    std::uint32_t work = 0;
    for (const model::SeenPiece& piece : pieces) {
        if (work >= item.work) break;
        const Fill fill{item, piece.number, piece.see_through};
        work +=
            piece.pixels > 0.0F ? draw_sample(piece.at[0], piece.pixels / item.point_px, fill) : draw_triangle(piece.at, fill);
    }
    return work;
}

}  // namespace surefoot::prepare
