// Places that keep their distance from each other: found through a grid of cells.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "rt/base/geometry.hpp"

namespace surefoot::scenes {

/// Places on a plane, in metres.
class Scatter {
public:
    explicit Scatter(double cell_m) : cell_(cell_m) {}

    void add(const dvec2& p) { cells_[key(cell_of(p.x), cell_of(p.y))].push_back(p); }
    /// Nothing added so far within `distance_m` of p.
    [[nodiscard]] bool free(const dvec2& p, double distance_m) const {
        const auto reach = static_cast<std::int64_t>(std::ceil(distance_m / cell_));
        for (std::int64_t x = cell_of(p.x) - reach; x <= cell_of(p.x) + reach; ++x) {
            for (std::int64_t y = cell_of(p.y) - reach; y <= cell_of(p.y) + reach; ++y) {
                const auto found = cells_.find(key(x, y));
                if (found == cells_.end()) continue;
                for (const dvec2& other : found->second) {
                    if (glm::length(other - p) < distance_m) return false;
                }
            }
        }
        return true;
    }

private:
    [[nodiscard]] std::int64_t cell_of(double v) const { return static_cast<std::int64_t>(std::floor(v / cell_)); }
    static std::int64_t key(std::int64_t x, std::int64_t y) { return x * 0x100000 + y; }
    double cell_;
    std::unordered_map<std::int64_t, std::vector<dvec2>> cells_;
};

}  // namespace surefoot::scenes
