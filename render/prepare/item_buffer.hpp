// A coarse picture of the leaves' surfaces: which leaf each point of the view shows, and how far away.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "render/model/pixel_estimator.hpp"

namespace surefoot::prepare {

/// A depth buffer with the number of the leaf that each point shows. Source: item buffers, Weghorst, Hooper and Greenberg 1984.
class ItemBuffer {
public:
    static constexpr int columns = 160, rows = 90;
    static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

    /// One point of the picture.
    struct Point {
        float depth = std::numeric_limits<float>::max();  ///< m along the view's direction
        std::uint32_t item = none;
    };

    ItemBuffer() : points_(static_cast<std::size_t>(columns) * rows) {}
    void clear();
    /// Draws the pieces of an item. A sample fills a square of its pixels; a sample smaller than a point fills one or none. Of a
    /// masked piece every second point is filled. Chance depends on item, piece and point alone. point_px: pixels of the view in
    /// a point.
    void draw(std::uint32_t item, std::span<const model::SeenPiece> pieces, float point_px);
    [[nodiscard]] std::span<const Point> points() const { return points_; }  ///< rows from below
    [[nodiscard]] const Point& at(int x, int y) const { return points_[static_cast<std::size_t>(y * columns + x)]; }

private:
    /// Corner of a triangle: column, row and 1 / depth, linear over the picture.
    using Corner = vec3;
    /// What one piece fills the points with.
    struct Fill {
        std::uint32_t item = 0, piece = 0;
        bool masked = false;
    };
    void draw_triangle(const std::array<vec3, 3>& at, const Fill& fill);
    void fill_triangle(const Corner& a, const Corner& b, const Corner& c, const Fill& fill);
    void draw_sample(const vec3& at, float points, const Fill& fill);
    void take(int x, int y, float depth, const Fill& fill);

    std::vector<Point> points_;
};

}  // namespace surefoot::prepare
