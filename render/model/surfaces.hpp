// How many pixels a representation rasterises, seen from a pose. Nearby, where it matters on which side of its box a wall stands,
// by where the surface lies: thinned, and from within or close by triangle for triangle.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/model/model.hpp"
#include "render/model/pixels.hpp"

namespace surefoot::model {

/// Of every representation at most 128 of its largest triangles as they are, and at most 128 samples that stand for all the
/// others, each for the same area; once for representations that share their parts. Every call is given the model that it was
/// made of.
class Surfaces {
public:
    static constexpr std::uint32_t most_parts = 64;  ///< that part_pixels() tells apart

    Surfaces() = default;
    /// Allocates: at most 128 triangles of 40 bytes and 128 samples of 28 for each different mesh (8.5 KiB). Passes twice over
    /// the triangles, 50 to 60 ms a million.
    explicit Surfaces(const Model& model);

    /// Of the representation `r` of a node with box `node_box`. The sum of part_pixels() where these are known; else
    /// rasterised_pixels(), and nearer than three half diagonals of the box two thirds by the surface: the box's third keeps
    /// what samples enter and leave from showing from frame to frame, and costs some of what the surface gains on random poses
    /// (figures: render/model/README.md). Nearby 1 to 4 us, with part_pixels() up to 25.
    [[nodiscard]] float pixels(const Model& model, Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale) const;
    /// Of each of its parts, every triangle cut to the view: true where the eye is nearer than one and a half half diagonals and
    /// all representations of the node have at most 1024 triangles in at most `most_parts` parts (so that one and the next are
    /// counted alike). Else false, and of_part says nothing. Samples do not do there: of what is seen, most is next to the eye.
    /// 22 to 35 ns a triangle.
    bool part_pixels(const Model& model, Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale,
                     std::span<float> of_part) const;
    /// By the surface alone: triangles cut to the view, and samples that lie in it; what faces away and is culled counts nothing.
    /// Negative where that is not known: no triangles, or a placement that cannot be turned back.
    [[nodiscard]] float surface_pixels(Index r, const dvec3& eye, const ViewScale& scale) const;

private:
    struct Triangle {
        vec3 a, b, c;
        bool both_sides;
    };
    struct Sample {
        vec3 at, area;  ///< m^2 along the normal
        float back;     ///< what counts of it from behind: -1 all, 0 nothing
    };
    /// Of one run of parts, in their own coordinates.
    struct Surface {
        std::uint32_t first_triangle = 0, triangles = 0, first_sample = 0, samples = 0;
        float whole_m2 = 0;   ///< larger triangles are kept as they are
        float sample_m2 = 0;  ///< that one sample stands for
    };
    /// Of one representation.
    struct Placed {
        std::uint32_t surface = 0, place = 0;
    };
    struct Place {
        dvec3 origin{0.0};
        mat3 linear{1.0F}, inverse{1.0F};
        float determinant = 0;  ///< 0: cannot be turned back, so the box decides
    };
    struct LocalView;
    /// False where a placement cannot be turned back.
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
    std::vector<bool> each_;  ///< [representation] of a node whose representations all have few enough triangles to look at each
};

}  // namespace surefoot::model
