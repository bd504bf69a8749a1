// Pictures of forms from a direction, without perspective: a small rasteriser with depth, textures, alpha test and sun.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/bake/geometry.hpp"
#include "render/model/model.hpp"
#include "render/model/picture_loss.hpp"

namespace surefoot::bake {

/// Where a camera without perspective looks from.
struct Direction {
    vec3 right{1, 0, 0}, up{0, 1, 0}, towards{0, 0, 1};  ///< unit; `towards` the eye
};
/// Azimuth about +Y from +Z; elevation of the eye above the horizon.
Direction direction_of(double azimuth_rad, double elevation_rad);

/// Samples on the points of a grid. All views of one direction and one middle share the grid, and their pixels are powers of two.
/// So a coarse view's samples are also samples of a finer one.
struct FormView {
    Direction direction;
    dvec3 middle{0.0};               ///< a point of the grid
    int exponent = 0;                ///< a pixel is 2^exponent m
    std::int64_t left = 0, low = 0;  ///< of the first sample, in pixels from the middle
    std::uint32_t width = 0, height = 0;
};

/// Looks at a box. Its outline fills between half of pixels x pixels and all of it, about, and a rim is left round it.
/// A box without extent has an empty picture.
FormView view_of(const Box& box, const Direction& direction, const dvec3& middle, std::uint32_t pixels);

constexpr std::size_t picture_levels = model::loss_sizes_px.size();

/// What one sample sees. By level: textures as in pixels of an eighth of the view's, of the view's, of eight times that.
struct FormSample {
    static constexpr float nothing = -std::numeric_limits<float>::infinity();
    float depth = nothing;  ///< metres from the middle towards the eye
    std::array<std::array<std::uint8_t, 3>, picture_levels> rgb{};
    model::Index owner = model::none;  ///< FormPicture::owner as it was drawn
    [[nodiscard]] bool covered() const { return depth > nothing; }
};

/// Of which vertex and material of the model a sample is. Of a triangle's three, each is chosen as often as its share says.
struct SampleSource {
    model::Index vertex = model::none;   ///< none: not of the model's own vertices
    model::Index material_and_side = 0;  ///< twice the material, and 1 where its back is seen
    [[nodiscard]] model::Index material() const { return material_and_side / 2; }
    [[nodiscard]] bool turned() const { return material_and_side % 2 == 1; }
};

/// Row 0 is the lowest.
struct FormPicture {
    FormView view;
    bool lit = true;                   ///< by sun and sky, where a material is
    model::Index owner = model::none;  ///< the leaf whose form is drawn next; a picture that is drawn brings its owners
    std::vector<FormSample> samples;
    bool keeps_sources = false;
    std::vector<SampleSource> sources;  ///< by sample, where they are kept
    void clear(const FormView& of, bool by_the_sun = true);
};

/// Draws a form over what the picture holds. Blended surfaces show in as many samples as they are opaque.
void draw_form(const model::Model& model, const model::Representation& rep, FormPicture& picture);
/// The same of parts over vertices in the world's frame. `looks`: the model with their materials and textures.
void draw_geometry(const model::Model& looks, const std::vector<model::Vertex>& vertices, const std::vector<GeometryPart>& parts,
                   FormPicture& picture);
/// Draws a picture of the same grid, with pixels that are no larger, over what the picture holds.
void draw_picture(const FormPicture& from, FormPicture& picture);

}  // namespace surefoot::bake
