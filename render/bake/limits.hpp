// The size of a model before it is emitted, to be checked against the limits of render/model/limits.hpp.
#pragma once

#include <span>

#include "render/bake/proxies.hpp"
#include "render/model/limits.hpp"

namespace surefoot::bake {

using model::check_limits;
using model::Counts;

/// Upper bounds of what the model will hold: all levels emitted, and every box with all its faces.
Counts counts_of(const ProxyInput& input, std::span<const BoxForm> object_boxes);

}  // namespace surefoot::bake
