// What a model is to count (render/model/limits.hpp), known before it is emitted: what 32-bit numbers cannot name is refused.
#pragma once

#include <span>

#include "render/bake/proxies.hpp"
#include "render/model/limits.hpp"

namespace surefoot::bake {

using model::check_limits;
using model::Counts;

/// What emitting all of it adds up to, every box with all its faces: no less than what the model will hold.
Counts counts_of(const ProxyInput& input, std::span<const BoxForm> object_boxes);

}  // namespace surefoot::bake
