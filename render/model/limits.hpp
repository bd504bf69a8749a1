// The size limits of a model: records and draw commands refer to each other by 32-bit numbers.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

#include "render/model/model.hpp"
#include "rt/base/result.hpp"

namespace surefoot::model {

/// How many of each a model holds, or is to hold.
struct Counts {
    std::uint64_t vertices = 0, indices = 0, parts = 0, placements = 0, materials = 0, representations = 0, nodes = 0;
    std::uint64_t name_bytes = 0;
    std::uint64_t textures = 0;
    std::uint64_t drawn_parts = 0;  ///< summed over representations: they may share parts, and drawing ranks every one
    Counts& operator+=(const Counts& more);
};

/// A draw command's base vertex is signed; the last number of an Index says `none`.
constexpr Counts max_counts{std::numeric_limits<std::int32_t>::max(), none, none, none, none, none, none, none, none, none};

Counts counts_of(const Model& model);

/// Error "out of limits" at `place`, for the first count that is too large.
Result<void> check_limits(const Counts& counts, const std::string& place, const Counts& max = max_counts);

}  // namespace surefoot::model
