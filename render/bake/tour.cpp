// Chooses where to walk, joins the places into a way, smooths it, and looks along it.
#include "render/bake/tour.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <queue>
#include <set>

#include "render/bake/free_space.hpp"
#include "render/bake/seen_detail.hpp"
#include "render/bake/stage.hpp"
#include "render/model/ground/near.hpp"

namespace surefoot::bake {

namespace {

constexpr double fine_cell_m = 0.25, window_m = 60, min_window_m = 7.5, wide_m = 2000, max_places = 250'000;
constexpr std::size_t coarse_cells = 10'000, sample_cells = 1000,
                      min_places = 60;  // fewer fine places than 4 m2 are no space to walk in
constexpr std::size_t max_weighed_places = 1500;
constexpr double min_block_m = 0.5, max_block_m = 2, indoors_weight = 2, view_m = 60;
constexpr double look_ahead_m = 2.5, smooth_m = 1.5, max_off_floor_m = 0.12;
constexpr double loop_share = 0.06;  // radius of a flight's loop, of the narrower side

dvec3 level(const dvec3& v) { return {v.x, 0, v.z}; }

dquat looking_along(const dvec3& way) {
    const double yaw = std::atan2(-way.x, -way.z), pitch = std::atan2(way.y, std::hypot(way.x, way.z));
    return glm::normalize(glm::angleAxis(yaw, dvec3(0, 1, 0)) * glm::angleAxis(pitch, dvec3(1, 0, 0)));
}

// ---- where to walk ----

/// use(box, blocks): of each block that stands once, and of each instance.
template <class Use>
void for_boxes(const model::Ground& ground, const Use& use) {
    if (ground.meshes.empty()) return;
    const model::GroundMesh& mesh = ground.meshes[0];
    const dvec3 low(mesh.min[0], mesh.min[1], mesh.min[2]);
    const dvec3 unit = (dvec3(mesh.max[0], mesh.max[1], mesh.max[2]) - low) / 65535.0;
    std::uint32_t leaf = 0;  // the node that was asked last
    model::ground_tree::for_leaves(
        mesh.block_count, [&](std::uint32_t node) { return leaf = node, true; },
        [&](std::uint32_t /*block*/) {
            const model::GroundBox& b = ground.boxes[mesh.first_node + leaf];
            use(Box{mesh.origin + mesh.step_m * (low + unit * dvec3(b.min[0], b.min[1], b.min[2])),
                    mesh.origin + mesh.step_m * (low + unit * dvec3(b.max[0], b.max[1], b.max[2]))},
                1.0);
        });
    for (const model::GroundInstance& instance : ground.instances)
        use(model::box_of(ground, instance), static_cast<double>(ground.meshes[instance.mesh].block_count));
}

/// Where nine tenths of what blocks are, so that skies and far hills do not count.
Box crowded_box(const model::Ground& ground, const Box& box) {
    std::array<std::vector<double>, 3> at;
    for_boxes(ground, [&](const Box& b, double /*blocks*/) {
        for (int axis = 0; axis < 3; ++axis)
            for (const double p : {b.min[axis], b.max[axis]}) at[static_cast<std::size_t>(axis)].push_back(p);
    });
    Box crowded = box;
    for (int axis = 0; axis < 3; axis += 2) {
        std::vector<double>& values = at[static_cast<std::size_t>(axis)];
        if (values.size() < 40) continue;
        std::sort(values.begin(), values.end());
        crowded.min[axis] = std::max(box.min[axis], values[values.size() / 20] - 2);
        crowded.max[axis] = std::min(box.max[axis], values[values.size() - 1 - values.size() / 20] + 2);
    }
    return crowded;
}

/// How much a place is worth a visit: by what is seen from it, indoors first.
double worth(const model::Ground& ground, const StandingPlace& place) {
    const std::size_t seen = blocks_seen(ground, place.feet + dvec3(0, model::Body{}.eye_m, 0), view_m);
    return static_cast<double>(seen) * (place.indoors ? indoors_weight : 1);
}

/// One of so many places, and what it is worth.
std::vector<std::pair<std::uint32_t, double>> weighed_places(const model::Ground& ground,
                                                             const std::vector<StandingPlace>& places, const ForEach& for_each) {
    const std::size_t stride = places.size() / max_weighed_places + 1;
    std::vector<std::pair<std::uint32_t, double>> weighed((places.size() + stride - 1) / stride);
    for_each(weighed.size(), [&](std::size_t i) {
        // Not every stride-th: where two floors lie above each other, every second place is on one of them.
        const std::size_t shift = (i * 2654435761U >> 8U) % stride, place = std::min(i * stride + shift, places.size() - 1);
        weighed[i] = {static_cast<std::uint32_t>(place), worth(ground, places[place])};
    });
    return weighed;
}

/// The square of `side_m` of a box with the most to walk through and to see, of `floors` above each other.
Box best_window(const model::Ground& ground, const Box& box, double side_m, double floors, const ForEach& for_each) {
    const dvec3 sides = box.max - box.min;
    if (sides.x <= side_m && sides.z <= side_m) return box;
    const double cell = std::max(fine_cell_m, std::sqrt(sides.x * sides.z * floors / static_cast<double>(coarse_cells)));
    const std::vector<StandingPlace> places = find_places(ground, {}, box, cell, for_each);
    std::map<std::pair<int, int>, double> weights;  // by quarters of a window
    const double quarter = side_m / 4;
    for (const auto& [place, weight] : weighed_places(ground, places, for_each)) {
        const dvec3& feet = places[place].feet;
        weights[{static_cast<int>(std::floor((feet.x - box.min.x) / quarter)),
                 static_cast<int>(std::floor((feet.z - box.min.z) / quarter))}] += weight;
    }
    std::pair<int, int> best{0, 0};
    double max_weight = -1;
    for (const auto& [corner, unused] : weights) {
        double sum = 0;
        for (int dx = 0; dx < 4; ++dx) {
            for (int dz = 0; dz < 4; ++dz) {
                const auto found = weights.find({corner.first + dx, corner.second + dz});
                sum += found == weights.end() ? 0 : found->second;
            }
        }
        if (sum > max_weight) max_weight = sum, best = corner;
    }
    Box window = box;
    window.min.x = box.min.x + best.first * quarter, window.max.x = std::min(box.max.x, window.min.x + side_m);
    window.min.z = box.min.z + best.second * quarter, window.max.z = std::min(box.max.z, window.min.z + side_m);
    return window;
}

/// How many places are above each other, on average over the box.
double floors_in(const model::Ground& ground, const Box& box, const ForEach& for_each) {
    const dvec3 sides = box.max - box.min;
    const double cell = std::max(fine_cell_m, std::sqrt(sides.x * sides.z / static_cast<double>(sample_cells)));
    const double cells = std::max(1.0, std::ceil(sides.x / cell)) * std::max(1.0, std::ceil(sides.z / cell));
    return std::max(1.0, static_cast<double>(find_places(ground, {}, box, cell, for_each).size()) / cells);
}

/// The best window with no more places than are looked at in seconds: towers of many floors have a smaller one.
Box window_to_walk(const model::Ground& ground, const Box& box, const ForEach& for_each) {
    Box window = best_window(ground, box, window_m, floors_in(ground, box, for_each), for_each);
    for (double side = window_m / 2; side >= min_window_m; side /= 2) {
        const dvec3 sides = window.max - window.min;
        const double floors = floors_in(ground, window, for_each), cells = sides.x * sides.z / (fine_cell_m * fine_cell_m);
        if (floors * cells <= max_places) break;
        window = best_window(ground, window, side, floors, for_each);
    }
    return window;
}

/// The region with the most to see, large or rich; no_place: none is large enough, or shows anything.
std::uint32_t best_region(const model::Ground& ground, const FreeSpace& space, const ForEach& for_each) {
    std::vector<double> weights(space.regions, 0);
    std::vector<std::size_t> counts(space.regions, 0);
    for (const StandingPlace& place : space.places) ++counts[place.region];
    for (const auto& [place, weight] : weighed_places(ground, space.places, for_each))
        weights[space.places[place].region] += weight;
    std::uint32_t best = no_place;
    for (std::uint32_t r = 0; r < space.regions; ++r)
        if (counts[r] >= min_places && weights[r] > (best == no_place ? 0 : weights[best])) best = r;
    return best;
}

/// Shortest ways from one place, dearer near walls.
struct Ways {
    std::vector<double> cost, length_m;
    std::vector<std::uint32_t> from;
};
Ways ways_from(const FreeSpace& space, std::uint32_t start) {
    const double infinity = std::numeric_limits<double>::infinity();
    Ways ways{std::vector<double>(space.places.size(), infinity), std::vector<double>(space.places.size(), infinity),
              std::vector<std::uint32_t>(space.places.size(), no_place)};
    std::priority_queue<std::pair<double, std::uint32_t>, std::vector<std::pair<double, std::uint32_t>>, std::greater<>> open;
    ways.cost[start] = ways.length_m[start] = 0;
    open.emplace(0, start);
    while (!open.empty()) {
        const auto [cost, p] = open.top();
        open.pop();
        if (cost > ways.cost[p]) continue;
        for (const std::uint32_t q : space.places[p].next) {
            if (q == no_place) continue;
            const double step = glm::length(space.places[q].feet - space.places[p].feet);
            const double dear = cost + step * (1 + 0.6 / (0.1 + static_cast<double>(space.places[q].clear_m)));
            if (dear >= ways.cost[q]) continue;
            ways.cost[q] = dear;
            ways.length_m[q] = ways.length_m[p] + step;
            ways.from[q] = p;
            open.emplace(dear, q);
        }
    }
    return ways;
}

using Block = std::array<int, 3>;

/// Goes on and on to where the most that is new lies on the way, for its length.
class Explorer {
public:
    Explorer(const model::Ground& ground, const FreeSpace& space, std::uint32_t region, const ForEach& for_each) : space_(space) {
        const auto count =
            std::count_if(space.places.begin(), space.places.end(), [&](const StandingPlace& p) { return p.region == region; });
        block_m_ = std::clamp(std::sqrt(static_cast<double>(count)) * space.cell_m / 8, min_block_m, max_block_m);
        std::map<Block, std::uint32_t> widest;  // a target a block: where it is widest
        for (std::uint32_t p = 0; p < space.places.size(); ++p) {
            if (space.places[p].region != region) continue;
            const auto [it, fresh] = widest.try_emplace(block_of(space.places[p].feet), p);
            if (!fresh && space.places[p].clear_m > space.places[it->second].clear_m) it->second = p;
        }
        for (const auto& [block, place] : widest) targets_.push_back(place);
        std::vector<double> worths(targets_.size());
        for_each(worths.size(), [&](std::size_t i) { worths[i] = worth(ground, space.places[targets_[i]]); });
        for (std::size_t i = 0; i < worths.size(); ++i) weights_[block_of(space.places[targets_[i]].feet)] = worths[i];
    }

    std::vector<std::uint32_t> run() {
        std::uint32_t at = targets_[0];
        for (const std::uint32_t t : targets_)
            if (rank(t) > rank(at)) at = t;
        std::vector<std::uint32_t> way{at};
        double left_m = max_tour_m;
        see(at);
        while (left_m > 1) {
            const Ways ways = ways_from(space_, at);
            std::uint32_t best = no_place;
            double best_gain = 0;
            for (const std::uint32_t t : targets_) {
                if (!(ways.length_m[t] <= left_m) || t == at) continue;
                const double gain = news_on(ways, t) / (ways.length_m[t] + 2);
                if (gain > best_gain) best_gain = gain, best = t;
            }
            if (best == no_place) break;
            std::vector<std::uint32_t> leg;
            for (std::uint32_t p = best; p != at; p = ways.from[p]) leg.push_back(p);
            for (auto p = leg.rbegin(); p != leg.rend(); ++p) way.push_back(*p), see(*p);
            left_m -= ways.length_m[best];
            at = best;
        }
        return way;
    }

private:
    [[nodiscard]] Block block_of(const dvec3& p) const {
        return {static_cast<int>(std::floor(p.x / block_m_)), static_cast<int>(std::floor(p.y / max_block_m)),
                static_cast<int>(std::floor(p.z / block_m_))};
    }
    [[nodiscard]] double rank(std::uint32_t p) const {
        return weights_.at(block_of(space_.places[p].feet)) * static_cast<double>(space_.places[p].clear_m);
    }
    void see(std::uint32_t p) {
        const Block b = block_of(space_.places[p].feet);
        for (int dx = -1; dx <= 1; ++dx)
            for (int dz = -1; dz <= 1; ++dz) seen_.insert({b[0] + dx, b[1], b[2] + dz});
    }
    [[nodiscard]] double news_on(const Ways& ways, std::uint32_t target) const {
        double sum = 0;
        std::set<Block> counted;
        for (std::uint32_t p = target; p != no_place; p = ways.from[p]) {
            const Block b = block_of(space_.places[p].feet);
            if (seen_.contains(b) || !counted.insert(b).second) continue;
            const auto weight = weights_.find(b);
            sum += weight == weights_.end() ? 0 : weight->second;
        }
        return sum;
    }

    const FreeSpace& space_;
    double block_m_ = max_block_m;  ///< what is seen at once: a part of a room, or of a street
    std::vector<std::uint32_t> targets_;
    std::map<Block, double> weights_;
    std::set<Block> seen_;
};

// ---- the way ----

/// A walker's straight way over the floor, in steps of a cell: free everywhere, and it rises gently. Else nothing.
std::vector<dvec3> straight_way(const model::Walker& walker, const dvec3& from, const dvec3& to) {
    const int steps = std::max(1, static_cast<int>(std::ceil(glm::length(level(to - from)) / 0.2)));
    std::vector<dvec3> way;
    dvec3 at = from;
    for (int i = 1; i <= steps; ++i) {
        dvec3 next = from + (to - from) * (static_cast<double>(i) / steps);
        next.y = walker.floor_at(next, at.y + 0.25, at.y - 0.25);
        if (!std::isfinite(next.y) || !walker.is_free(next) || !walker.passes(at, next)) return {};
        way.push_back(at = next);
    }
    if (std::abs(at.y - to.y) >= 0.3) return {};
    return way;
}

/// Leaves places out between which the straight way is free, and follows the floor there.
std::vector<dvec3> straightened(const FreeSpace& space, const model::Walker& walker, const std::vector<std::uint32_t>& way) {
    std::vector<dvec3> kept{space.places[way[0]].feet};
    for (std::size_t i = 0; i + 1 < way.size();) {
        std::size_t best = i + 1;
        std::vector<dvec3> along{space.places[way[best]].feet};
        for (std::size_t j = i + 2; j < std::min(way.size(), i + 24); ++j) {
            std::vector<dvec3> straight = straight_way(walker, space.places[way[i]].feet, space.places[way[j]].feet);
            if (!straight.empty()) best = j, along = std::move(straight);
        }
        kept.insert(kept.end(), along.begin(), along.end());
        i = best;
    }
    return kept;
}

std::vector<dvec3> resampled(const std::vector<dvec3>& way, std::size_t count) {
    std::vector<double> at{0};
    for (std::size_t i = 1; i < way.size(); ++i) at.push_back(at.back() + std::max(1e-9, glm::length(way[i] - way[i - 1])));
    std::vector<dvec3> out;
    std::size_t k = 1;
    for (std::size_t i = 0; i < count; ++i) {
        const double s = at.back() * static_cast<double>(i) / static_cast<double>(count - 1);
        while (k + 1 < at.size() && at[k] < s) ++k;
        const double share = way.size() < 2 ? 0 : std::clamp((s - at[k - 1]) / (at[k] - at[k - 1]), 0.0, 1.0);
        out.push_back(way.size() < 2 ? way[0] : way[k - 1] + share * (way[k] - way[k - 1]));
    }
    return out;
}

std::vector<dvec3> averaged(const std::vector<dvec3>& points, std::size_t reach) {
    std::vector<dvec3> out;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t r = std::min({reach, i, points.size() - 1 - i});
        dvec3 sum(0.0);
        for (std::size_t j = i - r; j <= i + r; ++j) sum += points[j];
        out.push_back(sum / static_cast<double>(2 * r + 1));
    }
    return out;
}

/// Rounds the corners where a body still fits; the feet stay on the floor.
std::vector<dvec3> rounded(const model::Walker& walker, const std::vector<dvec3>& way, double step_m) {
    const auto reach = static_cast<std::size_t>(std::ceil(smooth_m / std::max(step_m, 0.01) / 2));
    std::vector<dvec3> points = way;
    for (dvec3& point : points) {
        const double y = walker.floor_at(point, point.y + 0.26, point.y - 0.26);
        if (std::isfinite(y)) point.y = y;
    }
    for (const double strength : {1.0, 0.5}) {
        const std::vector<dvec3> wanted = averaged(points, reach);
        for (std::size_t i = 1; i + 1 < points.size(); ++i) {
            dvec3 to = points[i] + strength * (wanted[i] - points[i]);
            to.y = walker.floor_at(to, points[i].y + 0.3, points[i].y - 0.3);
            if (std::isfinite(to.y) && walker.is_free(to) && walker.passes(points[i - 1], to) && walker.passes(to, points[i + 1]))
                points[i] = to;
        }
    }
    return points;
}

/// Looks to where the way leads a few metres on; the head turns evenly, also where the way turns back.
Path path_along(const std::vector<dvec3>& eyes, double look_down) {
    std::vector<dvec3> headings;  // x: the heading, without jumps by a whole turn
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        std::size_t j = i;
        while (j + 1 < eyes.size() && glm::length(level(eyes[j] - eyes[i])) < look_ahead_m) ++j;
        const dvec3 way = level(eyes[j] - eyes[i]);
        const double before = headings.empty() ? 0.0 : headings.back().x;
        double heading = glm::length(way) < 0.05 ? before : std::atan2(-way.x, -way.z);
        if (!headings.empty()) heading = before + std::remainder(heading - before, 2 * std::numbers::pi);
        headings.emplace_back(heading, 0, 0);
    }
    for (int pass = 0; pass < 2; ++pass) headings = averaged(headings, static_cast<std::size_t>(1.5 * tour_samples_per_s));
    Path path;
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        PathSample sample;
        sample.time_s = static_cast<double>(i) / tour_samples_per_s;
        sample.pose.position = eyes[i];
        const dvec3 way(-std::sin(headings[i].x), -look_down, -std::cos(headings[i].x));
        sample.pose.orientation = looking_along(way);
        path.samples.push_back(sample);
    }
    return path;
}

constexpr auto sample_count = static_cast<std::size_t>(tour_s * tour_samples_per_s) + 1;

/// Nothing: there is no free space worth walking in.
Path walk_through(const model::Ground& ground, const Box& box, const ForEach& for_each) {
    const Box window = window_to_walk(ground, box, for_each);
    const FreeSpace space = find_free_space(ground, {}, window, fine_cell_m, for_each);
    const std::uint32_t region = best_region(ground, space, for_each);
    if (region == no_place) return {};
    const model::Walker walker(ground, {});
    const std::vector<std::uint32_t> way = Explorer(ground, space, region, for_each).run();
    if (way.size() < 4) return {};
    const std::vector<dvec3> line = straightened(space, walker, way);
    double length = 0;
    for (std::size_t i = 1; i < line.size(); ++i) length += glm::length(line[i] - line[i - 1]);
    std::vector<dvec3> eyes = rounded(walker, resampled(line, sample_count), length / static_cast<double>(sample_count));
    std::vector<dvec3> heights = averaged(eyes, 8);
    for (std::size_t i = 0; i < eyes.size(); ++i)  // up and down stairs evenly, but not into them
        eyes[i].y = std::clamp(heights[i].y, eyes[i].y - max_off_floor_m, eyes[i].y + max_off_floor_m) + model::Body{}.eye_m;
    return path_along(eyes, 0.05);
}

// ---- terrain, and single things ----

double highest_near(const model::Ground& ground, const dvec3& at, double reach, double otherwise) {
    double y = otherwise;
    model::for_triangles_near(ground, {dvec3(at.x - reach, -1e9, at.z - reach), dvec3(at.x + reach, 1e9, at.z + reach)},
                              [&](const model::GroundTriangle& t) {
                                  y = std::max({y, std::min({t.a.y, t.b.y, t.c.y}), model::height_at(t, at.x, at.z)});
                                  for (const dvec3& p : {t.a, t.b, t.c})
                                      if (std::abs(p.x - at.x) <= reach && std::abs(p.z - at.z) <= reach) y = std::max(y, p.y);
                              });
    return y;
}

/// The middle of the most crowded square of `cell_m`, by blocks of triangles.
dvec3 crowded_middle(const model::Ground& ground, const Box& box, double cell_m) {
    std::map<std::pair<int, int>, std::pair<double, dvec3>> squares;
    const auto add = [&](const dvec3& p, double blocks) {
        if (p.x < box.min.x || p.x > box.max.x || p.z < box.min.z || p.z > box.max.z) return;
        auto& square = squares[{static_cast<int>(std::floor(p.x / cell_m)), static_cast<int>(std::floor(p.z / cell_m))}];
        square.first += blocks;
        square.second += blocks * p;
    };
    for_boxes(ground, [&](const Box& b, double blocks) { add(b.centre(), blocks); });
    double max_blocks = 0;
    for (const auto& [key, square] : squares) max_blocks = std::max(max_blocks, square.first);
    dvec3 best = box.centre();
    double nearest_m = std::numeric_limits<double>::infinity();  // of those that are about as crowded: on plain land all are
    for (const auto& [key, square] : squares) {
        const dvec3 at = square.second / square.first;
        const double off_m = glm::length(level(at - box.centre()));
        if (square.first >= 0.8 * max_blocks && off_m < nearest_m) nearest_m = off_m, best = at;
    }
    return best;
}

/// A level loop around what is most crowded, well above all that lies under it. It looks half ahead, half to the middle.
Path fly_above(const model::Ground& ground, const Box& box) {
    const dvec3 sides = box.max - box.min;
    const double radius = std::clamp(loop_share * std::min(sides.x, sides.z), 50.0, 1000.0),
                 above = std::clamp(0.2 * radius, 30.0, 150.0);
    const dvec3 centre = crowded_middle(ground, box, 2 * radius);
    std::vector<dvec3> eyes;
    for (std::size_t i = 0; i < sample_count; ++i) {
        const double angle = 1.5 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(sample_count);
        dvec3 at = centre + radius * dvec3(std::cos(angle), 0, std::sin(angle));
        at.y = highest_near(ground, at, above, box.min.y) + above;
        eyes.push_back(at);
    }
    // Up before a hill, down after it: never below what lies within three seconds.
    std::vector<double> heights;
    for (std::size_t i = 0; i < eyes.size(); ++i) {
        double y = eyes[i].y;
        for (std::size_t j = i < 30 ? 0 : i - 30; j < std::min(eyes.size(), i + 31); ++j) y = std::max(y, eyes[j].y);
        heights.push_back(y);
    }
    for (std::size_t i = 0; i < eyes.size(); ++i) eyes[i].y = heights[i];
    const std::vector<dvec3> smooth = averaged(eyes, 30);
    for (std::size_t i = 0; i < eyes.size(); ++i) eyes[i].y = smooth[i].y;
    Path path = path_along(eyes, 0.15);
    for (PathSample& sample : path.samples) {
        const dvec3 ahead = glm::normalize(level(sample.pose.forward())),
                    inwards = glm::normalize(level(centre - sample.pose.position));
        sample.pose.orientation = looking_along(ahead + inwards - dvec3(0, 0.3, 0));
    }
    return path;
}

Path go_around(const Box& box) {
    const dvec3 centre = box.centre(), half = glm::max(box.half(), dvec3(1e-3));
    const double radius = 1.9 * glm::length(half);
    Path path;
    for (std::size_t i = 0; i < sample_count; ++i) {
        const double turn = static_cast<double>(i) / static_cast<double>(sample_count - 1), angle = 2 * std::numbers::pi * turn;
        PathSample sample;
        sample.time_s = tour_s * turn;
        sample.pose.position = centre + radius * dvec3(std::sin(angle), 0.25 - 0.1 * std::cos(2 * angle), std::cos(angle));
        sample.pose.orientation = looking_along(centre - sample.pose.position);
        path.samples.push_back(sample);
    }
    return path;
}

}  // namespace

Tour make_tour(const model::Ground& ground, const Box& box, const Progress& progress) {
    Tour tour;
    std::atomic<bool> go{true};
    const ForEach for_each = [&](std::size_t count, const std::function<void(std::size_t)>& body) {
        Stage stage(progress, "tour", count);
        for_all(count, [&](std::size_t i) {
            if (!go) return;
            body(i);
            if (!stage.step()) go = false;
        });
    };
    const Box crowded = crowded_box(ground, box);
    const dvec3 sides = crowded.max - crowded.min;
    const double widest = std::max(sides.x, sides.z);
    if (widest > wide_m && !ground.empty()) {
        tour = {fly_above(ground, crowded), "above its ground"};
    } else if (widest > 2 && !ground.empty()) {
        tour = {walk_through(ground, crowded, for_each), "through its free space"};
    }
    if (!go) return {};
    if (tour.path.samples.empty()) tour = {go_around(box), "around it"};
    return tour;
}

}  // namespace surefoot::bake
