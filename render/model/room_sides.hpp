// Parts that need no sun for some eyes: of what such an eye sees of them, no vertex sees any sky.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::model {

/// Effects that change nothing where no sky is seen.
constexpr EffectMask effects_under_sky = effect_sun | effect_shadow | effect_moving_shadow;

/// By Vertex::hidden of both sides, and by the rule of the programs. A vertex of two-sided material shows its front where its
/// normal is turned to the eye, else its back. A triangle of one-sided material shows an eye behind it nothing. Constant once
/// made; any thread may read it.
class RoomSides {
public:
    RoomSides() = default;
    explicit RoomSides(const Model& model);

    /// Whether some eye sees only closed sides of the part.
    [[nodiscard]] bool any(Index part) const { return part < runs_.size() && runs_[part].count != never; }
    /// Whether every eye does.
    [[nodiscard]] bool all(Index part) const { return any(part) && runs_[part].count == 0; }
    /// Whether this one does. eye: in the frame of the part's vertices. Not finite: no.
    [[nodiscard]] bool shows_no_sky(Index part, const vec3& eye) const;

private:
    static constexpr std::uint32_t never = 0xffffffffU;
    /// dot(normal, eye) > above
    struct HalfSpace {
        vec3 normal{0.0F};
        float above = 0;
    };
    /// The half-spaces of a part. None: all eyes see no more than closed sides.
    struct Run {
        std::uint32_t first = 0, count = never;
    };
    bool add(const Model& model, const Part& part);
    bool add_sides(const Model& model, const Part& part);
    bool add_fronts(const Model& model, const Part& part);
    bool add_half_space(std::size_t first, const vec3& normal, float above);

    std::vector<Run> runs_;  ///< by part; empty: no part has any
    std::vector<HalfSpace> half_spaces_;
};

/// An eye in the frame of what is placed, which stands at rest.
vec3 eye_in_frame(const dvec3& origin, const mat3& linear, const dvec3& eye);

}  // namespace surefoot::model
