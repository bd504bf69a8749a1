// What a .walk model can count: its records and the draw commands made from them name each other by 32-bit numbers.
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

/// What emitting all of it adds up to, every box with all its faces: no less than what the model will hold.
Counts counts_of(const ProxyInput& input, std::span<const BoxForm> object_boxes);

/// Error "out of limits" at `place`, with the first that is too many.
Result<void> check_limits(const Counts& counts, const std::string& place);

}  // namespace surefoot::bake
