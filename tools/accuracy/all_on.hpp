// A model as one program for all would draw it: each material with every effect that leaves its picture as it is.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::accuracy {

/// Triangles that use an effect, in bit order.
using TrianglesByEffect = std::array<std::uint64_t, model::effect_count>;

/// One for each representation.
std::vector<TrianglesByEffect> triangles_of_reps(const model::Model& model);
/// Of the full detail of all leaves. Returns their triangles with each effect; `all` gets the number of all.
TrianglesByEffect triangles_of_full_detail(const model::Model& model, std::uint64_t& all);
/// How many programs the model needs, where the effects of `off` are left out.
std::uint32_t programs_of(const model::Model& model, model::EffectMask off = 0);

/// How far an effect was spread over the full detail of a model.
struct SpreadEffect {
    std::string name;
    std::uint64_t triangles = 0, all_on_triangles = 0;  ///< that use it: as called for, and with all on
    std::string why_not;                                ///< why not all triangles use it; empty: all do
};

/// What turn_all_on() changed.
struct AllOn {
    std::uint64_t triangles = 0;        ///< of full detail
    std::vector<SpreadEffect> effects;  ///< that the model's materials use, in the order of application
};

/// Gives each material every effect that any part of the model uses, where the data allow it and no picture changes. Textures are
/// white, cutoffs are 0, and the sun shines on what sees none of it. Unlit materials stay unlit, and nothing more is blended.
AllOn turn_all_on(model::Model& model);

}  // namespace surefoot::accuracy
