// Counts allocations of this thread, to prove that a frame makes none. Not available under sanitizers.
#pragma once

#include <cstdint>

namespace surefoot::test {

/// Calls of malloc, calloc, realloc and aligned forms by this thread since it began; 0 under sanitizers.
std::uint64_t allocations();

}  // namespace surefoot::test
