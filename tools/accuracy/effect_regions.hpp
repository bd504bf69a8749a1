// The main regions of a model's hierarchy: which effects each calls for, what only its coarse forms need, and why.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::accuracy {

constexpr std::size_t max_regions = 12;

/// One effect in one region.
struct RegionEffect {
    std::string name;
    bool called_for = false;   ///< by full detail
    bool coarse_only = false;  ///< else by coarse forms alone
    bool of_model = false;     ///< the model calls for it somewhere
    std::uint64_t triangles = 0;
    std::string reason;
};

/// A node of the hierarchy with all below it.
struct EffectRegion {
    model::Index node = 0;
    std::string name;  ///< of its largest object, how many others there are, and its size
    Box box;
    std::uint32_t leaves = 0;
    std::uint64_t triangles = 0;
    std::vector<RegionEffect> effects;  ///< all, in the order of application
};

/// At most max_regions, those with most triangles first. Together they hold each leaf once.
std::vector<EffectRegion> regions_of(const model::Model& model);
/// Its effects in words: those called for, then those that coarse forms alone need.
std::string effects_in_words(const EffectRegion& region);
/// Why the sun is called for there, or why not.
std::string reasons_in_words(const EffectRegion& region);
/// The same of each effect that the model calls for: "sun: no vertex sees any sky".
std::vector<std::string> reason_lines(const EffectRegion& region);

}  // namespace surefoot::accuracy
