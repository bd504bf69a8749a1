// Occlusion culling for a region of eyes: finds boxes that are hidden from every eye of the region.
//
// Occluders are drawn from the centre of the region into a small depth buffer. An eye that moves by r sees past an edge at
// distance d by at most the angle asin(r / d). So every joined surface is eroded by this angle along its border.
// The rest hides from all eyes what it hides from the centre. Proof: while the eye moves, the point where a line of sight crosses
// the surface moves by at most that angle. It can leave the surface only over the border.
// Source: Wonka, Wimmer & Schmalstieg 2000 shrink each occluder; here a joined surface shrinks at its border only.
// All rounding is towards "not hidden".
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/model/view.hpp"
#include "render/prepare/occluders.hpp"
#include "render/prepare/prepared.hpp"

namespace surefoot::prepare {

/// The occlusion test of one region. One thread calls draw(); then any thread may call hides().
class Occlusion {
public:
    /// `occluders` must outlive this. Allocates all memory here.
    explicit Occlusion(const Occluders& occluders);
    Occlusion(const Occlusion&) = delete;
    Occlusion& operator=(const Occlusion&) = delete;

    /// Draws the at most 320 occluders of the largest solid angle, nearest surfaces first. Draws none if the view is wider than
    /// 160 degrees. 0.3 to 0.6 ms, at most about 2 ms. Equal input gives bit-equal results.
    void draw(const Region& region, model::Viewport viewport);

    /// True: no point of the box is visible from the region. False: a point may be visible. 0.1 to 1 us. Any thread.
    [[nodiscard]] bool hides(const Box& box) const;
    /// The same, with a bound of work where rooms take boxes apart: at most `parts` more tests than the usual 40. It counts down.
    [[nodiscard]] bool hides(const Box& box, std::uint32_t& parts) const;
    /// For all boxes of a set. A test takes 0.1 to 1 us.
    static constexpr std::uint32_t max_parts_a_set = 100'000;
    [[nodiscard]] bool empty() const { return empty_; }  ///< no occluder is drawn

private:
    static constexpr int columns = 128, rows = 72, tile = 8;
    static constexpr std::size_t max_drawn = 320;
    static constexpr std::size_t max_work = 3'000'000;  ///< limit on pixels of triangles and borders: about 2 ms
    static constexpr float edge_slack = 0.01F;          ///< of a pixel, for rounding
    static constexpr float beyond = 1e9F;               ///< any tangent, any 1/z

    static std::size_t pixel(int x, int y) { return static_cast<std::size_t>(y) * columns + static_cast<std::size_t>(x); }
    static std::size_t tile_at(int x, int y) {
        return static_cast<std::size_t>(y) * (columns / tile) + static_cast<std::size_t>(x);
    }

    struct Facing {
        float solid_angle;
        std::uint32_t triangle;
        bool from_behind;
    };
    /// An occluder in view, in the frame of the region's centre: x right, y up, z forward, m.
    struct Drawn {
        std::array<vec3, 3> at;               ///< seen counter-clockwise
        std::array<std::uint32_t, 3> corner;  ///< corner numbers; their order gives the direction of an edge
        std::array<std::uint32_t, 3> edge;
        vec3 inverse_depth;               ///< 1/z = dot(this, (x/z, y/z, 1))
        float nearest = 0, farthest = 0;  ///< 1/z of its corners
        std::uint32_t surface = 0;        ///< union-find over joined triangles
    };
    struct Rect {
        int x0 = columns, x1 = -1, y0 = rows, y1 = -1;  ///< inclusive
        [[nodiscard]] bool empty() const { return x1 < x0 || y1 < y0; }
        void grow(const Rect& r);
    };

    /// An angle of 0 to pi, as sine and cosine. Avoids library functions for thousands of border pieces.
    struct Turn {
        float sine = 0, cosine = 1;
        static Turn of_sine(float sine);                  ///< below a right angle
        static Turn of_tangent(float tangent);            ///< >= 0
        [[nodiscard]] Turn plus(const Turn& more) const;  ///< at most pi
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
    float clamp_from_m_ = 0;  ///< boxes at least this far may extend beyond the buffer
    bool empty_ = true;
    std::size_t work_ = 0;

    std::vector<float> depth_;    ///< 1/z of the farthest occluder point in a pixel; 0: none. Larger is nearer
    std::vector<float> tiles_;    ///< minimum of tile x tile pixels
    std::vector<float> covered_;  ///< of one surface: 1/z of triangles that fill the pixel
    std::vector<float> crossed_;  ///< 1/z of triangles that fill a part of the pixel
    std::vector<float> eroded_;   ///< > 0: near the border of the surface
    std::vector<float> length_;   ///< of (x/z, y/z, 1) in a pixel's middle
    std::vector<Facing> facing_;
    std::vector<Drawn> drawn_;
    std::vector<std::uint32_t> order_, first_at_edge_;
    std::vector<float> surface_nearest_;
    std::vector<std::uint8_t> edge_sides_;  ///< bit 0: a triangle on its left, bit 1: on its right, as seen
};

}  // namespace surefoot::prepare
