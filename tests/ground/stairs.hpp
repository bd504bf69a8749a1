// Stairs of a scene, found by the exact judge's floors alone, and a scripted walk up and down each.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "render/model/ground/walker.hpp"
#include "tests/ground/exact_ground.hpp"
#include "tests/ground/grounds.hpp"

namespace surefoot::test {

/// A straight flight: at least min_steps rises of much the same height, a tread's length from each other.
struct Flight {
    dvec3 bottom{0.0}, top{0.0};  ///< on the floor before the first rise, and on the last tread
    dvec3 ahead{0.0};             ///< level, of length 1
    std::vector<dvec3> treads;    ///< their middles
};

constexpr int min_steps = 4;
constexpr double march_m = 0.02, seed_m = 0.2, min_rise_m = 0.08, max_rise_m = 0.251, min_tread_m = 0.15, max_tread_m = 0.6;
constexpr double max_half_width_m = 4;  // of stairs
constexpr double tread_up = 0.999;      // of a normal

/// The highest floor at (x, z) between two heights; nothing where there is none.
inline bool floor_between(const exact::ExactGround& judge, double x, double z, double low, double high, double& found) {
    bool any = false;
    for (const double y : judge.floors_at(x, z, tread_up))
        if (y >= low && y <= high) found = y, any = true;  // sorted
    return any;
}

/// The flight that begins at a place on a floor; without treads: none does.
inline Flight flight_from(const exact::ExactGround& judge, const dvec3& from, const dvec3& ahead) {
    Flight flight{from, from, ahead, {}};
    double y = from.y, tread_begins = 0, last_rise = 0;
    for (double along = march_m; along < 40; along += march_m) {
        const dvec3 at = from + along * ahead;
        double next = 0;
        if (along - tread_begins > max_tread_m || !floor_between(judge, at.x, at.z, y - 0.03, y + max_rise_m, next)) break;
        const double rise = next - y;
        if (rise > min_rise_m) {
            if (!flight.treads.empty() && (along - tread_begins < min_tread_m || std::abs(rise - last_rise) > 0.03)) break;
            if (!flight.treads.empty()) flight.treads.back() = from + (0.5 * (tread_begins + along)) * ahead;
            if (!flight.treads.empty()) flight.treads.back().y = y;
            flight.treads.push_back({at.x, next, at.z});
            tread_begins = along, last_rise = rise;
        } else if (std::abs(rise) > 0.01) {
            break;
        }
        y = next;
    }
    if (flight.treads.size() < min_steps) return {};
    flight.top = flight.treads.back() += 0.12 * ahead;
    return flight;
}

/// Whether b runs up the same treads, perhaps slantwise.
inline bool same_flight(const Flight& a, const Flight& b) {
    const dvec3 way = a.top - a.bottom;
    const auto off = [&](const dvec3& at) {
        const double share = std::clamp(glm::dot(way, at - a.bottom) / glm::dot(way, way), 0.0, 1.0);
        return glm::length(at - a.bottom - share * way);
    };
    if (!(glm::dot(a.ahead, b.ahead) > 0)) return false;
    if (off(b.bottom) < 1.5 && off(b.top) < 1.5) return true;
    // Beside it, on wide stairs: part of the same heights.
    const bool as_high = b.bottom.y > a.bottom.y - 0.05 && b.top.y < a.top.y + 0.05;
    return as_high && glm::dot(a.ahead, b.ahead) > 0.9 && off(b.bottom) < max_half_width_m && off(b.top) < max_half_width_m;
}

/// Floors of a lattice of upright lines, each height once.
class FloorLattice {
public:
    FloorLattice(const exact::ExactGround& judge, const Box& box)
        : columns_(static_cast<int>((box.max.x - box.min.x) / seed_m) + 1),
          rows_(static_cast<int>((box.max.z - box.min.z) / seed_m) + 1),
          floors_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_)) {
        for (int row = 0; row < rows_; ++row)
            for (int column = 0; column < columns_; ++column) {
                auto& to = floors_[number(column, row)];
                for (const double y : judge.floors_at(box.min.x + column * seed_m, box.min.z + row * seed_m, tread_up))
                    if (to.empty() || y - to.back() > 0.01) to.push_back(y);
            }
    }
    [[nodiscard]] int columns() const { return columns_; }
    [[nodiscard]] int rows() const { return rows_; }
    [[nodiscard]] const std::vector<double>& at(int column, int row) const { return floors_[number(column, row)]; }
    /// Whether another floor lies so close above that nobody stands on this one.
    [[nodiscard]] bool covered(int column, int row, double y) const {
        const auto& floors = at(column, row);
        return std::any_of(floors.begin(), floors.end(), [&](double next) { return next > y && next <= y + max_rise_m; });
    }
    /// Whether a step up from there leads to one of the eight lines around.
    [[nodiscard]] bool rises(int column, int row, double y) const {
        for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
            for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c)
                for (const double next : at(c, r))
                    if (next >= y + min_rise_m && next <= y + max_rise_m) return true;
        return false;
    }

private:
    [[nodiscard]] std::size_t number(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    }
    int columns_, rows_;
    std::vector<std::vector<double>> floors_;
};

/// Every flight in a box, each once, along its middle.
inline std::vector<Flight> find_flights(const exact::ExactGround& judge, const Box& box) {
    const FloorLattice lattice(judge, box);
    std::vector<Flight> all;
    for (int row = 0; row < lattice.rows(); ++row)
        for (int column = 0; column < lattice.columns(); ++column)
            for (const double y : lattice.at(column, row)) {
                if (lattice.covered(column, row, y) || !lattice.rises(column, row, y)) continue;
                for (int k = 0; k < 16; ++k) {
                    const double angle = k * 0.392699081698724;
                    Flight flight = flight_from(judge, {box.min.x + column * seed_m, y, box.min.z + row * seed_m},
                                                {std::cos(angle), 0, std::sin(angle)});
                    if (!flight.treads.empty()) all.push_back(std::move(flight));
                }
            }
    const auto length = [](const Flight& f) { return std::hypot(f.top.x - f.bottom.x, f.top.z - f.bottom.z); };
    std::stable_sort(all.begin(), all.end(), [&](const Flight& a, const Flight& b) {  // whole ones first, then straight ones
        return a.treads.size() != b.treads.size() ? a.treads.size() > b.treads.size() : length(a) < length(b);
    });
    std::vector<std::vector<Flight>> groups;
    for (Flight& flight : all) {
        const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return same_flight(g[0], flight); });
        if (group == groups.end())
            groups.push_back({std::move(flight)});
        else if (flight.treads.size() == (*group)[0].treads.size() && length(flight) < length((*group)[0]) + 0.3)
            group->push_back(std::move(flight));
    }
    std::vector<Flight> flights;
    for (auto& group : groups) {
        const dvec3 side(-group[0].ahead.z, 0, group[0].ahead.x);
        std::stable_sort(group.begin(), group.end(),
                         [&](const Flight& a, const Flight& b) { return glm::dot(a.bottom, side) < glm::dot(b.bottom, side); });
        flights.push_back(group[group.size() / 2]);
    }
    return flights;
}

/// How many treads from below a body has room for, by the judge.
inline std::size_t open_treads(const exact::ExactGround& judge, const model::Walker& walker, const Flight& flight) {
    std::size_t open = 0;
    for (const dvec3& tread : flight.treads) {
        const model::Capsule body = walker.capsule_at(tread);
        if (judge.penetration(body.low, body.length, body.radius) > 0.01) break;
        ++open;
    }
    return open;
}

/// Heights that a walker got to who was pushed up the flight, and then down again.
struct Climbed {
    double up = 0, down = 0;
    std::uint64_t returns = 0;
};
inline Climbed climb(const model::Ground& ground, const Flight& flight) {
    model::Walker walker(ground, {});
    const double seconds = glm::length(flight.top - flight.bottom) / 1.0 + 2;
    dvec3 eye = flight.bottom + dvec3(0, 1.7, 0);
    Climbed climbed{flight.bottom.y, 0, 0};
    for (double t = 0; t < seconds; t += tick_s) {
        eye = walker.walk(eye, eye + 1.4 * tick_s * flight.ahead, tick_s);
        if (walker.stands()) climbed.up = std::max(climbed.up, walker.feet().y);
        if (walker.stands() && walker.feet().y >= flight.top.y - 1e-3) break;  // beyond it may be a wall or another flight
    }
    climbed.down = walker.feet().y;
    for (double t = 0; t < seconds; t += tick_s) {
        eye = walker.walk(eye, eye - 1.4 * tick_s * flight.ahead, tick_s);
        climbed.down = std::min(climbed.down, walker.feet().y);
    }
    climbed.returns = walker.returns();
    return climbed;
}

}  // namespace surefoot::test
