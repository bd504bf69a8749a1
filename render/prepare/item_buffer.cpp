// The raster of the item buffer: triangles by their edges, samples as squares.
#include "render/prepare/item_buffer.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::prepare {

namespace {

constexpr float min_inverse = 1e-12F;  // of a depth: the slack must not turn it round
constexpr float slack = -1e-4F;        // two triangles leave no point on their common edge
constexpr float masked_share = 0.5F;   // that passes the alpha test, about
constexpr float min_depth_m = static_cast<float>(model::near_plane_m);

/// 0..1, evenly; depends on its arguments alone.
float chance(std::uint32_t item, std::uint32_t piece, std::uint32_t point) {
    std::uint32_t h = item * 2654435761U ^ piece * 83492791U ^ point * 73856093U;
    h = (h ^ h >> 15U) * 0x2c1b3c6dU;
    h = (h ^ h >> 12U) * 0x297a2d39U;
    return static_cast<float>(h >> 8U) * 0x1p-24F;
}

/// From -1..1 to columns or rows.
float scaled(float x, int count) { return 0.5F * (x + 1.0F) * static_cast<float>(count); }

/// The first point whose middle is at or beyond `x`, and the last one before or at it, within the picture. No number: its ends.
int first_point(float x) { return static_cast<int>(std::ceil((x > 0.0F ? std::min(x, 1e4F) : 0.0F) - 0.5F)); }
int last_point(float x, int count) {
    const auto end = static_cast<float>(count);
    return static_cast<int>(std::floor((x < end ? std::max(x, -1.0F) : end) - 0.5F));
}

vec3 projected(const vec3& v) {
    return {scaled(v.x / v.z, ItemBuffer::columns), scaled(v.y / v.z, ItemBuffer::rows), 1.0F / v.z};
}

}  // namespace

void ItemBuffer::clear() { std::fill(points_.begin(), points_.end(), Point{}); }

void ItemBuffer::take(int x, int y, float depth, const Fill& fill) {
    const auto at = static_cast<std::uint32_t>(y * columns + x);
    Point& point = points_[at];
    if (!(depth < point.depth) || (fill.masked && chance(fill.item, fill.piece, at) >= masked_share)) return;
    point = {depth, fill.item};
}

void ItemBuffer::fill_triangle(const Corner& a, const Corner& b, const Corner& c, const Fill& fill) {
    const int x0 = first_point(std::min({a.x, b.x, c.x})),
              x1 = std::min(columns - 1, last_point(std::max({a.x, b.x, c.x}), columns));
    const int y0 = first_point(std::min({a.y, b.y, c.y})), y1 = std::min(rows - 1, last_point(std::max({a.y, b.y, c.y}), rows));
    const float doubled = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    if (x1 < x0 || y1 < y0 || !(std::abs(doubled) > 0.0F)) return;
    const float share = 1.0F / doubled, a_step = (b.y - c.y) * share, b_step = (c.y - a.y) * share;
    const float px = static_cast<float>(x0) + 0.5F;
    for (int y = y0; y <= y1; ++y) {
        const float py = static_cast<float>(y) + 0.5F;
        float of_a = ((b.x - px) * (c.y - py) - (b.y - py) * (c.x - px)) * share;
        float of_b = ((c.x - px) * (a.y - py) - (c.y - py) * (a.x - px)) * share;
        for (int x = x0; x <= x1; ++x, of_a += a_step, of_b += b_step) {
            const float of_c = 1.0F - of_a - of_b;
            if (of_a >= slack && of_b >= slack && of_c >= slack)
                take(x, y, 1.0F / std::max(of_a * a.z + of_b * b.z + of_c * c.z, min_inverse), fill);
        }
    }
}

/// Cut at the near plane: what is left has three or four corners.
void ItemBuffer::draw_triangle(const std::array<vec3, 3>& at, const Fill& fill) {
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
    for (std::size_t k = 1; k + 1 < count; ++k) fill_triangle(corners[0], corners[k], corners[k + 1], fill);
}

void ItemBuffer::draw_sample(const vec3& at, float points, const Fill& fill) {
    if (!(at.z >= min_depth_m) || (points < 1.0F && chance(fill.item, fill.piece, columns * rows) >= points)) return;
    const Corner middle = projected(at);
    const float half = 0.5F * std::sqrt(std::max(points, 1.0F));
    const int x0 = first_point(middle.x - half), x1 = std::min(columns - 1, last_point(middle.x + half, columns));
    const int y0 = first_point(middle.y - half), y1 = std::min(rows - 1, last_point(middle.y + half, rows));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) take(x, y, at.z, fill);
}

void ItemBuffer::draw(std::uint32_t item, std::span<const model::SeenPiece> pieces, float point_px) {
    for (std::uint32_t i = 0; i < pieces.size(); ++i) {
        const model::SeenPiece& piece = pieces[i];
        const Fill fill{item, i, piece.masked};
        if (piece.pixels > 0.0F) {
            draw_sample(piece.at[0], piece.pixels / point_px, fill);
        } else {
            draw_triangle(piece.at, fill);
        }
    }
}

}  // namespace surefoot::prepare
