// A coarse picture of the leaves' surfaces: which leaf each point of the view shows, and how far away. Each point also has the
// range of all leaves that cover it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
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
        std::uint32_t first = none, last = 0;  ///< ranks of all items that cover the point, shown or not; first > last: none
        void cover(std::uint32_t rank) {
            first = std::min(first, rank);
            last = std::max(last, rank);
        }
    };
    /// Points, ends included. Empty: last < first.
    struct Rectangle {
        int x0 = 0, y0 = 0, x1 = columns - 1, y1 = rows - 1;
    };
    /// Whose pieces are drawn, and how.
    struct Item {
        std::uint32_t number = 0;
        std::uint32_t seed = 0;    ///< of chance: the same in all frames
        Rectangle within = {};     ///< nothing is filled outside
        float point_px = 1;        ///< pixels of the view that a point stands for
        std::uint32_t work = ~0U;  ///< points that may be tested
        std::uint32_t rank = 0;    ///< its place among all items: see Point::cover
    };

    ItemBuffer() : points_(static_cast<std::size_t>(columns) * rows) {}
    void clear();
    /// Draws the pieces of an item, until its work is done. A sample fills a square of its pixels; a sample smaller than a point
    /// fills one or none. Of a piece that lets light through, every second point is filled. Returns the tested points.
    std::uint32_t draw(const Item& item, std::span<const model::SeenPiece> pieces);
    [[nodiscard]] std::span<const Point> points() const { return points_; }  ///< rows from below
    void cover(int x, int y, std::uint32_t rank) { points_[place(x, y)].cover(rank); }
    static constexpr std::size_t place(int x, int y) {
        return static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x);
    }
    [[nodiscard]] const Point& at(int x, int y) const { return points_[place(x, y)]; }

private:
    /// Corner of a triangle: column, row and 1 / depth, linear over the picture.
    using Corner = vec3;
    /// What one piece fills the points with.
    struct Fill {
        const Item& item;
        std::uint32_t piece = 0;
        bool see_through = false;
    };
    std::uint32_t draw_triangle(const std::array<vec3, 3>& at, const Fill& fill);
    std::uint32_t fill_triangle(const Corner& a, const Corner& b, const Corner& c, const Fill& fill);
    std::uint32_t draw_sample(const vec3& at, float points, const Fill& fill);
    void take(int x, int y, float depth, const Fill& fill);

    std::vector<Point> points_;
};

}  // namespace surefoot::prepare
