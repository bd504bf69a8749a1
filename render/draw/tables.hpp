// Flat tables of parts, representations and placements for drawing, built once at load.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/draw/coincidence.hpp"
#include "render/draw/texture_arrays.hpp"
#include "render/model/model.hpp"
#include "render/model/room_sides.hpp"

namespace surefoot::draw {

enum class Culling : std::uint8_t { back, front_flipped, none };

/// A part, as a draw command needs it.
struct DrawPart {
    std::uint32_t first_index, index_count;
    std::int32_t base_vertex;
    std::uint32_t texture;  ///< array of TextureLayout, or none
    std::array<std::uint8_t, 4> colour;
    float alpha_cutoff;
    float texture_layer;
    vec3 centre;            ///< of a blended one's box, in the mesh's frame; for sorting only
    std::uint16_t program;  ///< in the list of masks
    bool two_sided, blended;
    bool captured;                        ///< a picture that holds the light of the bake
    std::uint32_t in_room = model::none;  ///< the same without the sun, in DrawTables::parts; none: no eye sees it so
};

/// A representation: its placement and its range of parts.
struct DrawRep {
    std::uint32_t placement, first_part, part_count, triangles;
    std::uint32_t node;  ///< the node that it belongs to
};

/// A placement: origin in double, linear part in float.
struct Placed {
    dvec3 origin;
    std::array<float, 9> rows;  ///< linear part, row-major
    bool mirrored;
    bool moves;  ///< DrawTables::motions says how
};

/// All tables that drawing reads. Made once from a model; constant after that.
struct DrawTables {
    TextureLayout textures;
    std::vector<model::EffectMask> masks;  ///< state classes of the model's parts, ascending
    std::vector<DrawPart> parts;           ///< those of the model, then those that DrawPart::in_room names
    std::vector<std::uint32_t> part_of;    ///< of the latter: what each is without the sun
    model::RoomSides closed;               ///< whether an eye sees a part so
    std::vector<DrawRep> reps;
    std::vector<Placed> placements;
    std::vector<std::uint32_t> motions;  ///< of the model, by placement; empty where nothing moves
    DepthBiasRanks depth_bias;
    std::vector<vec4> centres;  ///< of a node's box, relative to `middle`; for sorting only
    dvec3 middle{0.0};

    /// The part of the model that one of `parts` is.
    [[nodiscard]] std::uint32_t model_part(std::uint32_t part) const {
        const std::size_t own = parts.size() - part_of.size();
        return part < own ? part : part_of[part - own];
    }
};

DrawTables make_tables(const model::Model& model);

/// A placement as it stands in a pose.
Placed moved(const Placed& placed, const model::RigidPose& pose);

/// The eye-relative rows of a placement. The origin is made relative in double: floats lose millimetres far from 0.
void eye_relative_rows(const Placed& placed, const dvec3& eye, std::array<float, 12>& rows);

/// An eye in the frame of what is placed.
vec3 eye_in_frame(const Placed& placed, const dvec3& eye);

/// From the eye to the centre of a blended part, m.
float distance_m(const DrawPart& part, const Placed& placed, const dvec3& eye);

inline Culling culling(const DrawPart& part, const Placed& placed) {
    if (part.two_sided) return Culling::none;
    return placed.mirrored ? Culling::front_flipped : Culling::back;
}

}  // namespace surefoot::draw
