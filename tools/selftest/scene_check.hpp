// Scenes through import and bake: whether each ends as it must, in a sound model or a refusal by name.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/selftest/hard.hpp"
#include "tools/selftest/shapes.hpp"

namespace surefoot::selftest {

constexpr std::uint64_t refused = 0;

/// Over the cases of a row.
struct Tally {
    std::uint64_t wrong = 0, cases = 0, kept = 0;
    std::string first;  ///< of what is wrong, in words
    void complain(const std::string& what) {
        if (wrong++ == 0) first = what;
    }
};

/// Imports and bakes the scene and looks at the model from four places. wanted: triangles that must be left, or `refused`.
void check_scene(const std::string& name, importer::Scene scene, std::uint64_t wanted, Tally& tally, Outcome& out);
/// The figures of a row of at least `min_cases` cases.
void report(const Tally& tally, std::size_t min_cases, Outcome& out);

/// A good square metre, and beside it more; indices are of `more`.
importer::Primitive with(const std::vector<vec3>& more, std::vector<std::uint32_t> indices);

}  // namespace surefoot::selftest
