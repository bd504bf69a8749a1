// The size limits of a .walk model: records and draw commands refer to each other by 32-bit numbers.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "render/bake/proxies.hpp"
#include "rt/base/result.hpp"

namespace surefoot::bake {

/// How many of each a model is to hold.
struct Counts {
    std::uint64_t vertices = 0, indices = 0, parts = 0, placements = 0, materials = 0, representations = 0, nodes = 0;
    std::uint64_t name_bytes = 0;
    Counts& operator+=(const Counts& more);
};

/// Upper bounds of what the model will hold: all levels emitted, and every box with all its faces.
Counts counts_of(const ProxyInput& input, std::span<const BoxForm> object_boxes);

/// Error "out of limits" at `place`, for the first count that is too large.
Result<void> check_limits(const Counts& counts, const std::string& place);

}  // namespace surefoot::bake
