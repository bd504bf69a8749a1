// Estimates the rasterised pixels of a representation seen from a pose. Far away, its box is used. Nearby, samples of its surface
// are used, because it matters on which side of its box a wall stands. Very near, every triangle is used.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/model/model.hpp"
#include "render/model/pixels.hpp"

namespace surefoot::model {

/// A piece of a surface as a view sees it. x and y lie between -z and z in the picture; z is the depth, m.
struct SeenPiece {
    std::array<vec3, 3> at{};  ///< a triangle's corners; of a sample its place, in the first
    float pixels = 0;          ///< of a sample; 0: a triangle
    bool see_through = false;  ///< masked or blended
    std::uint32_t number = 0;  ///< of the piece in its surface: the same in every view
};

/// Keeps at most 128 of the largest triangles of every representation, and at most 128 samples of equal area for the rest.
/// Representations with the same parts share them. Every call must pass the model that this was made of.
class PixelEstimator {
public:
    static constexpr std::uint32_t max_parts = 64;  ///< limit of part_pixels()

    PixelEstimator() = default;
    /// Allocates at most 128 triangles of 40 bytes and 128 samples of 32 bytes for each different mesh (9 KiB). Passes twice
    /// over the triangles: 50 to 60 ms a million.
    explicit PixelEstimator(const Model& model);

    /// Pixels of the representation `r` of a node with box `node_box`. The sum of part_pixels() if available; else the box
    /// estimate, if farther than 3 half diagonals of the box. Nearer: 2/3 surface_pixels() + 1/3 box estimate. The box term damps
    /// noise from samples that enter or leave the view, and costs some accuracy on random poses (figures:
    /// render/model/README.md). Nearby 1 to 4 us; with part_pixels() up to 50 us.
    [[nodiscard]] float pixels(const Model& model, Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale) const;
    /// Pixels by part, every triangle clipped to the view. Samples are too coarse near the eye, where most visible pixels lie.
    /// True if the eye is nearer than 1.5 half diagonals of the box, and the node is small enough. Else false, and of_part is
    /// undefined. Small enough: each of its representations has at most 2048 triangles in at most `max_parts` parts. So all
    /// representations of a node are estimated in the same way. 22 to 35 ns a triangle.
    bool part_pixels(const Model& model, Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale,
                     std::span<float> of_part) const;
    /// Pixels from triangles clipped to the view and samples inside it; culled back faces do not count.
    /// Negative if unknown: no triangles, or a placement without an inverse.
    [[nodiscard]] float surface_pixels(Index r, const dvec3& eye, const ViewScale& scale) const;
    /// How a surface is taken to pieces.
    struct Pieces {
        bool each_triangle = false;       ///< where part_pixels() is available; else the kept triangles and the samples
        std::uint32_t max_samples = 128;  ///< of more, only every n-th, with n times its pixels
    };
    static constexpr std::size_t max_pieces = 2048;  ///< of one surface
    /// Writes the pieces that face the eye and are not beyond one side of the view to the front of `out`, as many as fit. Returns
    /// their number. Triangles may begin before the near plane. Negative: no triangles, or a placement without an inverse.
    std::ptrdiff_t pieces(const Model& model, Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale,
                          const Pieces& of, std::span<SeenPiece> out) const;

private:
    struct Triangle {
        vec3 a, b, c;
        bool both_sides, see_through;
    };
    struct Sample {
        vec3 at, area;  ///< m^2 along the normal
        float back;     ///< its weight from behind: -1 all, 0 nothing
        bool see_through;
    };
    /// Of one run of parts, in their own coordinates.
    struct Surface {
        std::uint32_t first_triangle = 0, triangles = 0, first_sample = 0, samples = 0;
        float whole_m2 = 0;   ///< larger triangles are kept whole
        float sample_m2 = 0;  ///< represented by one sample
    };
    /// Of one representation.
    struct Placed {
        std::uint32_t surface = 0, place = 0;
    };
    struct Place {
        dvec3 origin{0.0};
        mat3 linear{1.0F}, inverse{1.0F};
        float determinant = 0;  ///< 0: no inverse, so the box decides
    };
    struct LocalView;
    /// False: it faces away, or is beyond one side of the view.
    static bool project(const Triangle& triangle, const LocalView& view, SeenPiece& out);
    /// Whether each triangle may be looked at.
    [[nodiscard]] bool tests_each(const Model& model, Index r, const Box& node_box, const dvec3& eye) const;
    /// False if the placement has no inverse.
    bool look(Index r, const dvec3& eye, const ViewScale& scale, LocalView& view) const;

    /// Its counts and shares; `areas` is scratch.
    static void measure(const Model& model, const Representation& rep, std::vector<float>& areas, Surface& surface);
    void fill(const Model& model, const Representation& rep, Surface& surface);
    [[nodiscard]] static float pixels_of(const Triangle& triangle, const LocalView& view);
    [[nodiscard]] static float pixels_of(const Sample& sample, float sample_m2, const LocalView& view);

    std::vector<Triangle> triangles_;
    std::vector<Sample> samples_;
    std::vector<Surface> surfaces_;
    std::vector<Placed> placed_;  ///< [representation]
    std::vector<Place> places_;   ///< as the model's placements
    std::vector<bool> each_;      ///< [representation]: part_pixels() may test each triangle
};

}  // namespace surefoot::model
