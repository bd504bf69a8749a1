// The pixel loops of occlusion, where most of its time goes: fills the pixels of a surface, and erodes them along its borders.
#include <algorithm>
#include <cmath>
#include <limits>

#include "render/prepare/occlusion.hpp"

namespace surefoot::prepare {

namespace {

/// Tangents in a row at which from + slope * tangent >= 0 may hold, for all that were kept.
struct Span {
    float low, high;
    void keep(float from, float slope) {
        if (slope > 0)
            low = std::max(low, -from / slope);
        else if (slope < 0)
            high = std::min(high, -from / slope);
        else if (from < 0)
            high = -std::numeric_limits<float>::max();
    }
};

/// Columns of a row whose middles' tangents the span holds, one more on either side for rounding.
struct Columns {
    int first, last;
    Columns(const Span& span, float wide, float half_column, int x0, int x1) : first(0), last(-1) {
        if (!(span.low <= span.high)) return;
        const float low = (std::max(span.low, -wide) + wide) / (2.0F * half_column) - 1.0F;
        const float high = (std::min(span.high, wide) + wide) / (2.0F * half_column) + 1.0F;
        first = std::max(x0, static_cast<int>(std::max(low, 0.0F)));
        last = std::min(x1, static_cast<int>(high));
    }
};

// By value, so that the compiler sees no branch in loops over pixels.
float min_of(float a, float b) { return a < b ? a : b; }
float max_of(float a, float b) { return a > b ? a : b; }

}  // namespace

Occlusion::Turn Occlusion::Turn::of_sine(float sine) { return {sine, std::sqrt(std::max(0.0F, 1.0F - sine * sine))}; }

Occlusion::Turn Occlusion::Turn::of_tangent(float tangent) {
    const float cosine = 1.0F / std::sqrt(1.0F + tangent * tangent);
    return {tangent * cosine, cosine};
}

Occlusion::Turn Occlusion::Turn::plus(const Turn& more) const {
    const Turn sum{sine * more.cosine + cosine * more.sine, cosine * more.cosine - sine * more.sine};
    return sum.sine >= 0.0F ? sum : Turn{0.0F, -1.0F};
}

/// Tangents between which two directions lie that are widened by a turn; front and side are their parts in a plane. What is
/// turned out of the front half has none: its side before the turn says over which end it left.
struct Occlusion::Tangents {
    float low = beyond, high = -beyond;
    void take(float side, float front, const Turn& turn) {
        const float left = side * turn.cosine - front * turn.sine, left_front = front * turn.cosine + side * turn.sine;
        const float right = side * turn.cosine + front * turn.sine, right_front = front * turn.cosine - side * turn.sine;
        const bool behind_right = side > 0 && left > 0, behind_left = side < 0 && right < 0;
        low = std::min(low, before(left, left_front) ? left / left_front : behind_right ? beyond : -beyond);
        high = std::max(high, before(right, right_front) ? right / right_front : behind_left ? -beyond : beyond);
    }
    static bool before(float side, float front) { return front > 1e-3F * std::abs(side); }
};

void Occlusion::begin_surface(const Rect& rect) {
    const int width = rect.x1 - rect.x0 + 1;
    const auto count = static_cast<std::size_t>(width);
    for (int y = rect.y0; y <= rect.y1; ++y) {
        const std::size_t at = static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(rect.x0);
        std::fill_n(&covered_[at], count, 0.0F);
        std::fill_n(&crossed_[at], count, beyond);
        std::fill_n(&eroded_[at], count, -1.0F);
    }
}

/// A pixel hides if the surface covers it and no border is near. Of several surfaces in a pixel, the nearest counts.
void Occlusion::end_surface(const Rect& rect) {
    for (int y = rect.y0; y <= rect.y1; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * columns;
        const float* __restrict covered = &covered_[row];
        const float* __restrict crossed = &crossed_[row];
        const float* __restrict eroded = &eroded_[row];
        float* __restrict depth = &depth_[row];
        for (int x = rect.x0; x <= rect.x1; ++x) {
            const float partly = crossed[x] < beyond ? crossed[x] : 0.0F, found = max_of(covered[x], partly);
            depth[x] = max_of(depth[x], eroded[x] < 0.0F ? found : 0.0F);
        }
    }
    for (int ty = rect.y0 / tile; ty <= rect.y1 / tile; ++ty) {
        for (int tx = rect.x0 / tile; tx <= rect.x1 / tile; ++tx) {
            std::array<float, tile> tile_min;
            tile_min.fill(beyond);
            for (int y = ty * tile; y < (ty + 1) * tile; ++y) {
                const float* row = &depth_[pixel(tx * tile, y)];
                for (std::size_t x = 0; x < tile; ++x) tile_min[x] = std::min(tile_min[x], row[x]);
            }
            tiles_[tile_at(tx, ty)] = *std::min_element(tile_min.begin(), tile_min.end());
        }
    }
}

/// Which pixels it fills wholly or in part: half planes through the eye and its edges, so that nothing needs to be clipped.
void Occlusion::fill(const Drawn& triangle, const Rect& rect) {
    std::array<vec3, 3> edge;
    for (std::size_t k = 0; k < 3; ++k) {
        edge[k] = glm::cross(triangle.at[k], triangle.at[(k + 1) % 3]);
        const float half = std::abs(edge[k].x) * half_column_ + std::abs(edge[k].y) * half_row_;
        edge[k] = half > 0 ? edge[k] / half : vec3(0.0F);  // 1: a pixel just inside. An edge end on crosses every pixel
    }
    const vec3 w = triangle.inverse_depth;
    const float slack = std::abs(w.x) * half_column_ + std::abs(w.y) * half_row_;
    const float full = 1.0F + edge_slack, farthest = triangle.farthest;
    const float half_column = half_column_, wide = wide_;
    const std::array<float, 3> across = {edge[0].x, edge[1].x, edge[2].x};
    for (int y = rect.y0; y <= rect.y1; ++y) {
        const float ty = static_cast<float>(2 * y + 1) * half_row_ - high_;
        const float e0 = edge[0].y * ty + edge[0].z, e1 = edge[1].y * ty + edge[1].z, e2 = edge[2].y * ty + edge[2].z;
        const float w0 = w.y * ty + w.z - slack;
        const std::size_t row = static_cast<std::size_t>(y) * columns;
        float* __restrict covered = &covered_[row];
        float* __restrict crossed = &crossed_[row];
        Span span{-wide_, wide_};
        span.keep(e0 + full, edge[0].x);
        span.keep(e1 + full, edge[1].x);
        span.keep(e2 + full, edge[2].x);
        const Columns in(span, wide_, half_column_, rect.x0, rect.x1);
        work_ += static_cast<std::size_t>(std::max(0, in.last - in.first + 1));
        for (int x = in.first; x <= in.last; ++x) {
            const float tx = static_cast<float>(2 * x + 1) * half_column - wide;
            const float inside = min_of(min_of(across[0] * tx + e0, across[1] * tx + e1), across[2] * tx + e2);
            const float depth = max_of(farthest, w.x * tx + w0);
            const float filled = inside >= full ? depth : 0.0F, touched = inside > -full ? depth : beyond;
            covered[x] = max_of(covered[x], filled);
            crossed[x] = min_of(crossed[x], inside >= full ? beyond : touched);
        }
    }
}

/// Around a border: in pieces whose distances hardly differ, where that matters.
void Occlusion::erode(const vec3& from, const vec3& to, const Rect& rect) {
    struct Piece {
        vec3 from, to;
    };
    std::array<Piece, 24> stack;
    std::size_t top = 0;
    stack[top++] = {from, to};
    while (top > 0) {
        const Piece piece = stack[--top];
        const vec3 along = piece.to - piece.from;
        const float square = glm::dot(along, along);
        const float nearest = square > 0 ? std::clamp(-glm::dot(piece.from, along) / square, 0.0F, 1.0F) : 0.0F;
        const float distance = glm::length(piece.from + nearest * along);
        if (square > distance * distance && radius_m_ > 0.5F * pixel_rad_ * distance && top + 2 <= stack.size()) {
            const vec3 middle = 0.5F * (piece.from + piece.to);
            stack[top++] = {piece.from, middle};
            stack[top++] = {middle, piece.to};
            continue;
        }
        erode_piece(piece.from, piece.to, distance > radius_m_ ? radius_m_ / distance : 1.0F, rect);
    }
}

void Occlusion::erode_piece(const vec3& from, const vec3& to, float sine, const Rect& rect) {
    const vec3 a = glm::normalize(from), b = glm::normalize(to);
    const float cosine = std::clamp(glm::dot(a, b), -1.0F, 1.0F);
    const Turn half{std::sqrt(0.5F - 0.5F * cosine), std::sqrt(0.5F + 0.5F * cosine)};
    const Turn reach = Turn::of_sine(sine).plus(pixel_turn_), round = half.plus(reach);
    const bool all_round = reach.cosine < 0.07F || half.cosine < 0.07F;
    const vec3 middle = all_round ? vec3(0.0F) : glm::normalize(a + b);            // ends that are opposite have no middle
    if (!all_round && middle.z < round.plus(corner_turn_).cosine - 1e-5F) return;  // all of it beside the buffer
    const float s = all_round ? 1.0F : reach.sine;
    // The columns and rows that the piece may touch: along it, no point is farther off the plane than its ends by 1 / cos(half).
    const auto range = [&](float a_side, float a_off, float b_side, float b_off) {
        const float off = std::max(std::abs(a_off), std::abs(b_off)) / half.cosine;
        const float flat = std::sqrt(std::max(0.0F, 1.0F - off * off));
        if (!(flat > s)) return Tangents{-beyond, beyond};
        Tangents tangents;
        const Turn turn = Turn::of_sine(s / flat);
        tangents.take(a_side, a.z, turn);
        tangents.take(b_side, b.z, turn);
        return tangents;
    };
    Rect touched{0, columns - 1, 0, rows - 1};
    if (!all_round) {
        const Tangents x = range(a.x, a.y, b.x, b.y), y = range(a.y, a.x, b.y, b.x);
        touched = pixels(x.low - 2 * half_column_, x.high + 2 * half_column_, y.low - 2 * half_row_, y.high + 2 * half_row_);
    }
    touched = {std::max(touched.x0, rect.x0), std::min(touched.x1, rect.x1), std::max(touched.y0, rect.y0),
               std::min(touched.y1, rect.y1)};
    // Within `reach` of the great circle through both ends, not beyond either end, not on the other side of the sphere.
    vec3 pole = glm::cross(a, b);
    const float pole_length = glm::length(pole);
    pole = pole_length < 1e-3F ? vec3(0.0F) : pole / pole_length;
    const vec3 onward = glm::cross(pole, a), back = glm::cross(b, pole);
    const float ahead = all_round || round.cosine < 0.07F ? -1.0F : round.cosine - 1e-6F;
    const float half_column = half_column_, wide = wide_;
    const float pole_x = pole.x, onward_x = onward.x, back_x = back.x, middle_x = middle.x;
    for (int y = touched.y0; y <= touched.y1; ++y) {
        const float ty = static_cast<float>(2 * y + 1) * half_row_ - high_;
        const float p = pole.y * ty + pole.z, f = onward.y * ty + onward.z, g = back.y * ty + back.z,
                    m = middle.y * ty + middle.z;
        const std::size_t row = static_cast<std::size_t>(y) * columns;
        float* __restrict eroded = &eroded_[row];
        const float* __restrict length = &length_[row];
        Span span{-wide_, wide_};
        const float longest =
            s * std::max(length[touched.x0], length[touched.x1]);  // of a row, the length is the greatest at an end
        span.keep(longest + p, pole.x);
        span.keep(longest - p, -pole.x);
        span.keep(longest + f, onward.x);
        span.keep(longest + g, back.x);
        const Columns in(span, wide_, half_column_, touched.x0, touched.x1);
        work_ += static_cast<std::size_t>(std::max(0, in.last - in.first + 1));
        for (int x = in.first; x <= in.last; ++x) {
            const float tx = static_cast<float>(2 * x + 1) * half_column - wide;
            const float l = s * length[x];
            const float aside = l - std::abs(pole_x * tx + p);
            const float ends = min_of(onward_x * tx + f, back_x * tx + g) + l;
            const float near = middle_x * tx + m - ahead * length[x];
            eroded[x] = max_of(eroded[x], min_of(min_of(aside, ends), near));
        }
    }
}

}  // namespace surefoot::prepare
