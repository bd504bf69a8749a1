// Floors cell by cell, then ways between neighbours, then regions and clearances.
#include "render/bake/free_space.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "render/model/ground/near.hpp"

namespace surefoot::bake {

namespace {

constexpr double ceiling_m = 8, same_floor_m = 0.1, max_clear_m = 3;
constexpr std::size_t tile_cells = 8;  // a walker goes through squares of so many by so many: what is near is near the next cell
constexpr std::array<std::array<int, 2>, 8> directions = {{{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

/// The cells of a window, row by row.
struct CellRows {
    Box window;
    double cell_m;
    std::size_t columns, rows;

    CellRows(const Box& of, double size)
        : window(of), cell_m(size), columns(count(of.max.x - of.min.x)), rows(count(of.max.z - of.min.z)) {}
    [[nodiscard]] std::size_t count(double extent) const {
        return static_cast<std::size_t>(std::max(1.0, std::ceil(extent / cell_m)));
    }
    [[nodiscard]] dvec3 middle(std::size_t i) const {
        const std::size_t column = i % columns, row = i / columns;
        return {window.min.x + (static_cast<double>(column) + 0.5) * cell_m, 0,
                window.min.z + (static_cast<double>(row) + 0.5) * cell_m};
    }
    [[nodiscard]] std::size_t size() const { return columns * rows; }
};

/// use(walker, cell) for all cells, each row of tiles with a walker of its own.
void for_cells(const model::Ground& ground, const model::Body& body, const CellRows& cells, const ForEach& for_each,
               const std::function<void(model::Walker&, std::size_t)>& use) {
    for_each((cells.rows + tile_cells - 1) / tile_cells, [&](std::size_t strip) {
        model::Walker walker(ground, body);
        const std::size_t end_row = std::min(cells.rows, (strip + 1) * tile_cells);
        for (std::size_t column = 0; column < cells.columns; column += tile_cells)
            for (std::size_t row = strip * tile_cells; row < end_row; ++row)
                for (std::size_t c = column; c < std::min(cells.columns, column + tile_cells); ++c)
                    use(walker, row * cells.columns + c);
    });
}

/// Places above the middle of one cell, from low to high.
std::vector<StandingPlace> places_above(const model::Ground& ground, model::Walker& walker, const model::Body& body,
                                        const dvec3& at, const Box& window) {
    std::vector<double> heights, floors;
    const double min_up = std::cos(body.slope_rad) - 1e-6;
    model::for_triangles_near(ground, {dvec3(at.x, window.min.y, at.z), dvec3(at.x, window.max.y, at.z)},
                              [&](const model::GroundTriangle& t) {
                                  const double y = model::height_at(t, at.x, at.z);
                                  if (!std::isfinite(y)) return;
                                  heights.push_back(y);
                                  const dvec3 n = glm::cross(t.b - t.a, t.c - t.a);
                                  if (std::abs(n.y) >= min_up * glm::length(n)) floors.push_back(y);
                              });
    if (floors.empty()) return {};
    std::sort(floors.begin(), floors.end());
    walker.gather({dvec3(at.x - body.radius_m, floors.front() - body.step_m, at.z - body.radius_m),
                   dvec3(at.x + body.radius_m, floors.back() + body.step_m + body.eye_m + model::crown_m, at.z + body.radius_m)});
    std::vector<StandingPlace> found;
    for (const double y : floors) {
        const dvec3 feet(at.x, walker.floor_at({at.x, y, at.z}, y + body.step_m, y - same_floor_m), at.z);
        if (!std::isfinite(feet.y) || (!found.empty() && feet.y < found.back().feet.y + same_floor_m)) continue;
        if (!walker.is_free(feet)) continue;
        StandingPlace place;
        place.feet = feet;
        place.next.fill(no_place);
        place.indoors = std::any_of(heights.begin(), heights.end(),
                                    [&](double h) { return h > feet.y + body.eye_m && h < feet.y + body.eye_m + ceiling_m; });
        found.push_back(place);
    }
    return found;
}

/// Whether a floor leads from one to the other, and no ledge.
bool is_slope(const model::Walker& walker, const dvec3& from, const dvec3& to) {
    const dvec3 middle = 0.5 * (from + to);
    const double y = walker.floor_at(middle, middle.y + same_floor_m, middle.y - same_floor_m);
    return std::isfinite(y);
}

double max_rise_m(const model::Body& body, double way_m) { return std::max(body.step_m, way_m * std::tan(body.slope_rad)); }

/// The ground around a place as far as its neighbours in the first half of the directions.
void gather_around(model::Walker& walker, const model::Body& body, const dvec3& feet, double cell_m) {
    const double beside = cell_m + body.radius_m, rise = max_rise_m(body, std::numbers::sqrt2 * cell_m) + same_floor_m;
    walker.gather({feet + dvec3(-beside, -rise, -body.radius_m),
                   feet + dvec3(beside, rise + body.step_m + body.eye_m + model::crown_m, beside)});
}

/// Between the places of a cell and those of its neighbours in the first half of the directions, there and back: to the lowest
/// that is reached.
void find_ways(model::Walker& walker, const model::Body& body, const CellRows& cells, const std::vector<std::uint32_t>& first,
               std::vector<StandingPlace>& places, std::size_t cell) {
    const auto x = static_cast<std::ptrdiff_t>(cell % cells.columns), z = static_cast<std::ptrdiff_t>(cell / cells.columns);
    for (std::uint32_t p = first[cell]; p < first[cell + 1]; ++p) {
        gather_around(walker, body, places[p].feet, cells.cell_m);
        for (std::size_t d = 0; d < directions.size() / 2; ++d) {
            const std::ptrdiff_t to_x = x + directions[d][0], to_z = z + directions[d][1];
            if (to_x < 0 || to_x >= static_cast<std::ptrdiff_t>(cells.columns) || to_z >= static_cast<std::ptrdiff_t>(cells.rows))
                continue;
            const std::size_t other = static_cast<std::size_t>(to_z) * cells.columns + static_cast<std::size_t>(to_x);
            const double max_rise = max_rise_m(body, cells.cell_m * std::hypot(directions[d][0], directions[d][1]));
            for (std::uint32_t q = first[other]; q < first[other + 1]; ++q) {
                const double rise = std::abs(places[p].feet.y - places[q].feet.y);
                if (rise > max_rise || (rise > body.step_m && !is_slope(walker, places[p].feet, places[q].feet))) continue;
                std::uint32_t &there = places[p].next[d], &back = places[q].next[d + directions.size() / 2];
                if (there == no_place && walker.passes(places[p].feet, places[q].feet)) there = q;
                if (back == no_place && walker.passes(places[q].feet, places[p].feet)) back = p;
            }
        }
    }
}

/// Ways that lead in one direction only are taken out.
void keep_both_ways(std::vector<StandingPlace>& places) {
    std::vector<std::array<std::uint32_t, 8>> kept(places.size());
    for (std::uint32_t p = 0; p < places.size(); ++p) {
        for (std::size_t d = 0; d < 8; ++d) {
            const std::uint32_t q = places[p].next[d];
            kept[p][d] = q != no_place && places[q].next[(d + 4) % 8] == p ? q : no_place;
        }
    }
    for (std::size_t p = 0; p < places.size(); ++p) places[p].next = kept[p];
}

void find_clearances(FreeSpace& space) {
    std::deque<std::uint32_t> open;
    for (std::uint32_t p = 0; p < space.places.size(); ++p) {
        StandingPlace& place = space.places[p];
        const bool inner = std::find(place.next.begin(), place.next.end(), no_place) == place.next.end();
        place.clear_m = inner ? static_cast<float>(max_clear_m) : 0.0F;
        if (!inner) open.push_back(p);
    }
    while (!open.empty()) {
        const std::uint32_t p = open.front();
        open.pop_front();
        for (const std::uint32_t q : space.places[p].next) {
            const float clear = space.places[p].clear_m + static_cast<float>(space.cell_m);
            if (q == no_place || space.places[q].clear_m <= clear) continue;
            space.places[q].clear_m = clear;
            open.push_back(q);
        }
    }
}

void find_regions(FreeSpace& space) {
    for (StandingPlace& place : space.places) place.region = no_place;
    for (std::uint32_t from = 0; from < space.places.size(); ++from) {
        if (space.places[from].region != no_place) continue;
        std::deque<std::uint32_t> open{from};
        space.places[from].region = space.regions;
        while (!open.empty()) {
            const std::uint32_t p = open.front();
            open.pop_front();
            for (const std::uint32_t q : space.places[p].next) {
                if (q == no_place || space.places[q].region != no_place) continue;
                space.places[q].region = space.regions;
                open.push_back(q);
            }
        }
        ++space.regions;
    }
}

/// Cell by cell, each from low to high.
std::vector<std::vector<StandingPlace>> places_by_cell(const model::Ground& ground, const model::Body& body,
                                                       const CellRows& cells, const ForEach& for_each) {
    std::vector<std::vector<StandingPlace>> by_cell(cells.size());
    for_cells(ground, body, cells, for_each, [&](model::Walker& walker, std::size_t i) {
        by_cell[i] = places_above(ground, walker, body, cells.middle(i), cells.window);
    });
    return by_cell;
}

}  // namespace

std::vector<StandingPlace> find_places(const model::Ground& ground, const model::Body& body, const Box& window, double cell_m,
                                       const ForEach& for_each) {
    std::vector<StandingPlace> places;
    for (const auto& of_cell : places_by_cell(ground, body, CellRows(window, cell_m), for_each))
        places.insert(places.end(), of_cell.begin(), of_cell.end());
    return places;
}

FreeSpace find_free_space(const model::Ground& ground, const model::Body& body, const Box& window, double cell_m,
                          const ForEach& for_each) {
    FreeSpace space;
    space.cell_m = cell_m;
    const CellRows cells(window, cell_m);
    const auto by_cell = places_by_cell(ground, body, cells, for_each);
    std::vector<std::uint32_t> first(by_cell.size() + 1, 0);
    for (std::size_t i = 0; i < by_cell.size(); ++i) {
        first[i + 1] = first[i] + static_cast<std::uint32_t>(by_cell[i].size());
        space.places.insert(space.places.end(), by_cell[i].begin(), by_cell[i].end());
    }
    for_cells(ground, body, cells, for_each,
              [&](model::Walker& walker, std::size_t i) { find_ways(walker, body, cells, first, space.places, i); });
    keep_both_ways(space.places);
    find_clearances(space);
    find_regions(space);
    return space;
}

}  // namespace surefoot::bake
