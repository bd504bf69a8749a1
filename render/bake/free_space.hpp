// Where a walker can stand in a part of a scene, and between which places it can go.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "render/model/ground/walker.hpp"

namespace surefoot::bake {

/// A place where a walker fits, above the middle of a cell.
struct StandingPlace {
    dvec3 feet{0.0};
    bool indoors = false;                 ///< something is within 8 m above the head
    float clear_m = 0;                    ///< level way to the nearest place without eight neighbours, up to 3 m
    std::array<std::uint32_t, 8> next{};  ///< places reached straight to the east, north-east ... in turn; no_place: none
    std::uint32_t region = 0;             ///< places of a region reach each other
};
constexpr std::uint32_t no_place = 0xffffffffU;

/// All places of a window, and what they have in common.
struct FreeSpace {
    double cell_m = 0;
    std::vector<StandingPlace> places;
    std::uint32_t regions = 0;
};

/// For each of a number of things; may run on many threads, and no result depends on them.
using ForEach = std::function<void(std::size_t, const std::function<void(std::size_t)>&)>;

/// Places alone, without ways between them: next, region and clear_m are not set.
std::vector<StandingPlace> find_places(const model::Ground& ground, const model::Body& body, const Box& window, double cell_m,
                                       const ForEach& for_each);

/// By cells of `cell_m` within the window, several floors above each other included.
FreeSpace find_free_space(const model::Ground& ground, const model::Body& body, const Box& window, double cell_m,
                          const ForEach& for_each);

}  // namespace surefoot::bake
