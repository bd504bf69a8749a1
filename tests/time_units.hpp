// Times as the tests write them, in nanoseconds.
#pragma once

#include <cstdint>

namespace surefoot {

constexpr std::int64_t ms = 1'000'000;

}  // namespace surefoot
