// A mesh in place of a picture's plane: triangles through its depths, decimated by error, and cut where depths jump.
// Sources: Evans, Kirkpatrick and Townsend, Right-Triangulated Irregular Networks, 2001; Decoret, Sillion, Schaufler and Dorsey,
// Multi-Layered Impostors for Accelerated Rendering, 1999, for pictures on meshes. README.md has the bound and its reason.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/cache/validity.hpp"

namespace surefoot::cache {

/// A corner of a mesh. Its place is on the ray through (x, y) of the picture's square, in texels from its lower left corner.
struct DepthCorner {
    float x = 0, y = 0;
    float inverse_depth = 0;   ///< along the picture's forward, 1/m
    float at_x = 0, at_y = 0;  ///< of the texel that is shown, in texels
};

/// How close a mesh has to be, and how large it may be.
struct DepthMeshLimits {
    float tolerance = 0;              ///< of inverse depths, 1/m; 0: as they are
    std::uint32_t max_triangles = 0;  ///< more are too dear
};

enum class DepthMeshResult : std::uint8_t { made, empty, too_dear };

/// Processor time of drawing a picture, us, as measured on llvmpipe: README.md.
struct KindPrices {
    double quad_us = 0.2, quad_ns_per_pixel = 5.6;
    double mesh_us = 0.2, mesh_ns_per_pixel = 3.9, mesh_ns_per_triangle = 350;
    [[nodiscard]] double quad(double pixels) const { return quad_us + 1e-3 * quad_ns_per_pixel * pixels; }
    /// Pixels: of covered texels alone.
    [[nodiscard]] double mesh(double pixels, double triangles) const {
        return mesh_us + 1e-3 * (mesh_ns_per_pixel * pixels + mesh_ns_per_triangle * triangles);
    }
    /// Of a mesh that costs no more than the quad; 0: none does.
    [[nodiscard]] double max_triangles(double quad_pixels, double mesh_pixels) const {
        const double left_us = quad(quad_pixels) - mesh(mesh_pixels, 0);
        return left_us > 0 ? 1e3 * left_us / mesh_ns_per_triangle : 0;
    }
};

/// The error of inverse depths that a mesh may have: a share, up to 1, of what the picture's plane has. No point of it is farther
/// from its place than on the plane.
double mesh_tolerance(const Picture& picture, double share);

/// Bound of the angle between a point of such a mesh and its true place, for an eye that has moved; as a tangent. Infinite as
/// picture_errors().
double mesh_error(const Picture& picture, double tolerance, const dvec3& eye);

/// Makes meshes. After it is made, nothing allocates. What it made is valid until the next one.
///
/// A texel is covered where its inverse depth is finite and above zero. All squares of covered texels are shown, and nothing
/// else. In the middle of each of them the mesh is within the tolerance of its depth. Neighbours whose inverse depths differ by
/// over two thirds of it are parts of two skins. A wall joins them; it shows the farther one, and cannot be seen by the
/// picture's own eye. So no triangle of a skin crosses a jump, and no hole opens.
class DepthMesher {
public:
    /// Of pictures with sides up to max_texels, a power of two.
    DepthMesher(std::uint32_t max_texels, std::uint32_t max_triangles);

    /// inverse_depths: by rows from the lowest, texels x texels; texels is a power of two.
    DepthMeshResult make(std::span<const float> inverse_depths, std::uint32_t texels, const DepthMeshLimits& limits);

    [[nodiscard]] std::span<const DepthCorner> corners() const { return corners_; }
    [[nodiscard]] std::span<const std::uint16_t> indices() const { return indices_; }  ///< three a triangle; both sides are seen
    [[nodiscard]] std::uint32_t covered() const { return covered_; }                   ///< texels
    [[nodiscard]] std::uint32_t walls() const { return walls_; }                       ///< triangles of walls, the last of all

private:
    /// A point of the lattice of texels' corners.
    struct Point {
        int x = 0, y = 0;
    };
    /// Whether the texels of a triangle are covered: nothing, all without a jump, or anything else.
    enum class Filled : std::uint8_t { nothing, all, mixed };

    [[nodiscard]] float texel(int x, int y) const {
        return x >= 0 && y >= 0 && x < side_ && y < side_ ? depths_[static_cast<std::size_t>(y) * stride_ + x] : 0.0F;
    }
    [[nodiscard]] bool joined(float a, float b) const { return a > 0 && b > 0 && (a > b ? a - b : b - a) <= max_step_; }
    [[nodiscard]] std::size_t at(Point p) const { return static_cast<std::size_t>(p.y) * (stride_ + 1) + p.x; }
    [[nodiscard]] unsigned group_of(Point p, unsigned quadrant) const;
    [[nodiscard]] float value(Point p, unsigned quadrant) const;
    void fill_values();
    void judge_edge(Point middle, int half, bool horizontal);
    void judge_square(Point middle, int half);
    [[nodiscard]] int cuts_along(Point from, Point to) const;
    bool add(Point a, Point b, Point apex);
    bool split(Point a, Point b, Point apex);
    bool add_wall(Point from, Point to, bool low_is_near, bool horizontal);
    bool add_walls();
    [[nodiscard]] std::uint16_t corner(Point p, unsigned quadrant);

    std::size_t stride_ = 0;
    int side_ = 0;
    float tolerance_ = 0, max_step_ = 0;
    std::size_t max_indices_ = 0;
    std::uint32_t covered_ = 0, walls_ = 0;
    std::vector<float> depths_;         ///< by texel; 0: nothing
    std::vector<float> values_;         ///< by point, where all its texels are joined, else below 0
    std::vector<float> errors_;         ///< by point, of the triangles whose longest side it halves; infinite: they must be split
    std::vector<Filled> covers_;        ///< of these two triangles
    std::vector<std::uint16_t> known_;  ///< by point and group: the corner, plus 1
    std::vector<DepthCorner> corners_;
    std::vector<std::uint16_t> indices_;
};

}  // namespace surefoot::cache
