// The size of a model before it is emitted, to be checked against the limits of render/model/limits.hpp.
#pragma once

#include <span>

#include "render/bake/proxies.hpp"
#include "render/model/limits.hpp"

namespace surefoot::bake {

using model::check_limits;
using model::Counts;

/// Upper bounds of what the model will hold: all levels emitted, and so many boxes with all their faces.
Counts counts_of(const ProxyInput& input, std::size_t boxes);

}  // namespace surefoot::bake
