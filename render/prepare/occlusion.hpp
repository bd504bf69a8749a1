// Occlusion for a region of eyes: what is hidden from every one of them by what is in front of it.
//
// Occluders are drawn from the region's middle into a small buffer of depths. An eye that moves by r sees past an edge at
// distance d by at most asin(r / d): that far around every edge at which a joined surface ends, the surface does not count.
// What is left hides from all eyes at once what is behind it from the middle: while the eye moves, the point in which the line
// of sight crosses the surface moves too, at most that far, and it can only vanish over such an edge. Shrinking occluders is
// Wonka, Wimmer & Schmalstieg 2000; a joined surface shrinks at its border alone. All rounding is towards "not hidden".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/model/view.hpp"
#include "render/prepare/occluders.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

class Occlusion {
public:
    /// `occluders` outlives this. All memory is taken here.
    explicit Occlusion(const Occluders& occluders);
    Occlusion(const Occlusion&) = delete;
    Occlusion& operator=(const Occlusion&) = delete;

    /// Draws the occluders that matter most to the region, at most 320, the nearest surfaces first; nothing where its view is
    /// wider than 160 degrees. 0.3 to 0.6 ms, at most about 2. Bit-equal for equal input.
    void draw(const Region& region, model::Viewport viewport);

    /// False: something in the box may be seen from somewhere in the region. True: nothing. 0.1 to 1 us. Any thread.
    [[nodiscard]] bool hides(const Box& box) const;
    [[nodiscard]] bool empty() const { return empty_; }  ///< nothing hides

private:
    static constexpr int columns = 128, rows = 72, tile = 8;
    static constexpr std::size_t most_drawn = 320;
    static constexpr std::size_t most_work = 3'000'000;  ///< pixels of triangles and borders: about 2 ms
    static constexpr float edge_slack = 0.01F;           ///< of a pixel, for rounding
    static constexpr float beyond = 1e9F;                ///< any tangent, any 1/z

    struct Facing {
        float solid_angle;
        std::uint32_t triangle;
        bool from_behind;
    };
    /// One in view, in the middle's frame: x right, y up, z forward, m.
    struct Drawn {
        std::array<vec3, 3> at;               ///< seen counter-clockwise
        std::array<std::uint32_t, 3> corner;  ///< whose numbers tell the direction of an edge
        std::array<std::uint32_t, 3> edge;
        vec3 inverse_depth;               ///< 1/z = dot(this, (x/z, y/z, 1))
        float nearest = 0, farthest = 0;  ///< 1/z of its corners
        std::uint32_t surface = 0;        ///< union-find over what is joined
    };
    struct Rect {
        int x0 = columns, x1 = -1, y0 = rows, y1 = -1;  ///< inclusive
        [[nodiscard]] bool empty() const { return x1 < x0 || y1 < y0; }
        void grow(const Rect& r);
    };

    /// An angle of 0 to pi by its sine and cosine: no function of the library for each of thousands of pieces of border.
    struct Turn {
        float sine = 0, cosine = 1;
        static Turn of_sine(float sine);                  ///< below a right angle
        static Turn of_tangent(float tangent);            ///< >= 0
        [[nodiscard]] Turn plus(const Turn& more) const;  ///< pi where that is more
    };
    struct Tangents;
    enum class Hidden : std::uint8_t { yes, no, in_parts };

    bool aim(const Region& region, model::Viewport viewport);
    void choose();
    void place(const Facing& facing);
    void join();
    void draw_surface(std::span<const std::uint32_t> members);
    void begin_surface(const Rect& rect);
    void end_surface(const Rect& rect);
    void fill(const Drawn& triangle, const Rect& rect);
    void erode(const vec3& from, const vec3& to, const Rect& rect);
    void erode_piece(const vec3& from, const vec3& to, float sine, const Rect& rect);
    [[nodiscard]] std::uint32_t surface_of(std::uint32_t drawn);
    [[nodiscard]] Rect rect_of(const Drawn& triangle) const;
    [[nodiscard]] Rect pixels(float x0, float x1, float y0, float y1) const;
    [[nodiscard]] vec3 to_view(const dvec3& world) const;
    [[nodiscard]] Hidden look(const Box& box) const;
    [[nodiscard]] bool nearer_than(float inverse_depth, const Rect& rect) const;

    const Occluders& occluders_;
    dvec3 eye_{0.0}, right_{1, 0, 0}, up_{0, 1, 0}, forward_{0, 0, -1};
    model::Frustum frustum_{};                  ///< of the region
    float radius_m_ = 0, wide_ = 0, high_ = 0;  ///< tangents of the half angles
    float half_column_ = 0, half_row_ = 0;      ///< half a pixel, as tangents
    float pixel_rad_ = 0;                       ///< half a pixel's diagonal
    Turn pixel_turn_, corner_turn_;
    float clamp_from_m_ = 0;  ///< what is at least this far may reach out of the buffer
    bool empty_ = true;
    std::size_t work_ = 0;

    std::vector<float> depth_;    ///< 1/z of the farthest point that hides in a pixel; 0: none. The larger, the nearer
    std::vector<float> tiles_;    ///< the least of tile x tile pixels
    std::vector<float> covered_;  ///< of one surface: by triangles that fill the pixel
    std::vector<float> crossed_;  ///< by triangles that fill a part of it
    std::vector<float> eroded_;   ///< >= 0: near one of its borders
    std::vector<float> length_;   ///< of (x/z, y/z, 1) in a pixel's middle
    std::vector<Facing> facing_;
    std::vector<Drawn> drawn_;
    std::vector<std::uint32_t> order_, first_at_edge_;
    std::vector<float> surface_nearest_;
    std::vector<std::uint8_t> edge_sides_;  ///< bit 0: a triangle on its left, bit 1: on its right, as seen
};

}  // namespace surefoot::prepare
