// Rays from each vertex, then bytes, then materials without the sun.
#include "render/bake/openness.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <vector>

#include "render/bake/lit_vertices.hpp"

namespace surefoot::bake {

namespace {

constexpr std::size_t rays = 24;
constexpr double room_m = 3;                // what is nearer shades
constexpr std::uint8_t within_share = 230;  // of a room that is hidden: the mean ray is 0.3 m long
constexpr std::size_t min_rising = 6;       // rays that tell of the sky: of a wall, half of them
constexpr double min_up = 0.1;              // rays to the sky rise: what lies below the horizon is ground

/// Spread evenly over a hemisphere about +Z, by the cosine.
std::array<dvec3, rays> cosine_directions() {
    constexpr double turn = std::numbers::pi * (3 - 2.2360679774997896);  // the golden angle
    std::array<dvec3, rays> out;
    for (std::size_t i = 0; i < rays; ++i) {
        const double squared = (static_cast<double>(i) + 0.5) / rays, radius = std::sqrt(squared);
        const double angle = turn * static_cast<double>(i);
        out[i] = {radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - squared)};
    }
    return out;
}

/// What a side of a surface sees: shares of the sky, and of its room, summed over places.
struct Seen {
    double sky = 0, room = 0;
};

class OpennessMaker {
public:
    OpennessMaker(model::Model& model, const RayTree& opaque, std::vector<VertexRange> ranges)
        : model_(model),
          opaque_(opaque),
          ranges_(std::move(ranges)),
          starts_(ranges_.size()),
          directions_(cosine_directions()),
          far_m_(model.nodes.empty() ? 0 : 2 * model.nodes[0].box.diagonal()) {}

    void find_starts(std::size_t r) { starts_[r] = ray_starts(model_, ranges_[r]); }
    /// After find_starts() of its range.
    void measure(const VertexTask& task);
    /// Vertices that lie within something take the mean of those next to them. Says which, by vertex of the model.
    [[nodiscard]] std::vector<std::uint8_t> fill_unknown();
    /// Counts vertices, and says whether anything is hidden.
    [[nodiscard]] bool count_vertices(Openness& found) const;
    /// Gives lit materials the effect, and closed parts one without the sun.
    void change_materials(Openness& found);

private:
    static std::uint8_t hidden_byte(double seen) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(1 - seen, 0.0, 1.0)));
    }
    [[nodiscard]] bool is_closed(const model::Part& part) const;
    [[nodiscard]] std::vector<bool> closed_parts() const;
    void add_seen(const dvec3& at, const dvec3& normal, Seen& seen) const;

    model::Model& model_;
    const RayTree& opaque_;
    std::vector<VertexRange> ranges_;
    std::vector<std::vector<RayStart>> starts_;
    std::array<dvec3, rays> directions_;
    double far_m_;
};

void OpennessMaker::measure(const VertexTask& task) {
    const VertexRange& range = ranges_[task.range];
    for (std::uint32_t v = task.from; v < task.to; ++v) {
        const RayStart& start = starts_[task.range][v];
        if (!start.used) continue;
        Seen front, back;
        double places = 0;
        for (const model::Index p : range.placements) {
            const std::optional<PlacedStart> placed = placed_start(start, model_.placements[p]);
            if (!placed) continue;  // nothing is known, and nothing is hidden
            add_seen(placed->at, placed->normal, front);
            if (range.two_sided) add_seen(placed->at, -placed->normal, back);
            ++places;
        }
        if (!(places > 0)) continue;
        if (!range.two_sided) back = front;
        std::uint8_t* hidden = model_.vertices[range.first + v].hidden;
        hidden[0] = hidden_byte(front.sky / places);
        hidden[1] = hidden_byte(back.sky / places);
        hidden[2] = hidden_byte(front.room / places);
        hidden[3] = hidden_byte(back.room / places);
    }
}

void OpennessMaker::add_seen(const dvec3& at, const dvec3& normal, Seen& seen) const {
    const dvec3 other = std::abs(normal.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
    const dvec3 x = glm::normalize(glm::cross(other, normal)), y = glm::cross(normal, x);
    const dvec3 from = at + ray_lift_m * normal;
    std::array<dvec3, rays> ways;
    std::transform(directions_.begin(), directions_.end(), ways.begin(),
                   [&](const dvec3& d) { return d.x * x + d.y * y + d.z * normal; });
    const auto rises = [](const dvec3& way) { return way.y >= min_up; };
    const auto rising = static_cast<std::size_t>(std::count_if(ways.begin(), ways.end(), rises));
    const bool looks_up = rising >= min_rising;
    std::size_t open = 0;
    for (const dvec3& way : ways) {
        const double near_m = opaque_.nearest_hit_m({from, way, room_m});
        seen.room += std::min(near_m, room_m) / room_m / rays;
        const bool up = rises(way);
        if (up ? near_m < room_m : looks_up) continue;
        const dvec3 to_sky = up ? way : glm::normalize(dvec3(way.x, min_up, way.z));
        if (!opaque_.is_blocked({from, to_sky, far_m_})) ++open;
    }
    seen.sky += static_cast<double>(open) / static_cast<double>(looks_up ? rising : rays);
}

std::vector<std::uint8_t> OpennessMaker::fill_unknown() {
    std::vector<std::uint8_t> out(model_.vertices.size(), 0);
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
        const VertexRange& range = ranges_[r];
        for (std::size_t side = 0; side < 2; ++side) {
            std::vector<bool> unknown(range.count, false);
            for (std::uint32_t v = 0; v < range.count; ++v)
                unknown[v] = starts_[r][v].used && model_.vertices[range.first + v].hidden[2 + side] >= within_share;
            for (const VertexFill& fill : vertex_fills(model_, range, unknown)) {
                model::Vertex& to = model_.vertices[range.first + fill.vertex];
                out[range.first + fill.vertex] |= static_cast<std::uint8_t>(1U << side);
                for (const std::size_t what : {side, 2 + side}) {
                    std::size_t sum = 0;
                    for (const std::uint32_t from : fill.from) sum += model_.vertices[range.first + from].hidden[what];
                    to.hidden[what] = static_cast<std::uint8_t>((sum + fill.from.size() / 2) / fill.from.size());
                }
            }
        }
    }
    return out;
}

bool OpennessMaker::count_vertices(Openness& found) const {
    bool any_hidden = false;
    for (std::size_t r = 0; r < ranges_.size(); ++r)
        for (std::uint32_t v = 0; v < ranges_[r].count; ++v) {
            if (!starts_[r][v].used) continue;
            ++found.vertices;
            for (const std::uint8_t share : model_.vertices[ranges_[r].first + v].hidden) any_hidden = any_hidden || share > 0;
        }
    return any_hidden;
}

bool OpennessMaker::is_closed(const model::Part& part) const {
    const bool two_sided = model_.materials[part.material].two_sided;
    for (std::uint32_t i = 0; i < part.index_count; ++i) {
        const model::Vertex& v = model_.vertices[part.first_vertex + model_.indices[part.first_index + i]];
        if (v.hidden[0] != 255 || (two_sided && v.hidden[1] != 255)) return false;
    }
    return part.index_count > 0;
}

/// By part. All parts of a chain with one material are closed, or none: what coincides is told apart by materials.
std::vector<bool> OpennessMaker::closed_parts() const {
    std::vector<bool> closed(model_.parts.size(), false);
    for (const VertexRange& range : ranges_) {
        if (!range.all_places) continue;
        std::map<model::Index, bool> by_material;
        for (const model::Index p : range.parts) {
            bool& all = by_material.try_emplace(model_.parts[p].material, true).first->second;
            all = all && is_closed(model_.parts[p]);
        }
        for (const model::Index p : range.parts) closed[p] = by_material[model_.parts[p].material];
    }
    return closed;
}

void OpennessMaker::change_materials(Openness& found) {
    const std::vector<bool> closed = closed_parts();
    for (const model::Node& node : model_.nodes) {
        if (node.child_count > 0) continue;
        const model::Representation& full = model_.reps[node.first_rep + node.rep_count - 1];
        for (model::Index p = full.first_part; p < full.first_part + full.part_count; ++p) {
            if ((model_.materials[model_.parts[p].material].effects & model::effect_sun) == 0) continue;
            found.triangles += model_.parts[p].index_count / 3;
            if (closed[p]) found.closed += model_.parts[p].index_count / 3;
        }
    }
    for (model::Material& material : model_.materials)
        if ((material.effects & model::effect_sun) != 0) material.effects |= model::effect_openness;
    std::map<model::Index, model::Index> without_sun;
    for (model::Index p = 0; p < closed.size(); ++p) {
        if (!closed[p]) continue;
        const model::Index from = model_.parts[p].material;
        const auto [copy, is_new] = without_sun.try_emplace(from, static_cast<model::Index>(model_.materials.size()));
        if (is_new) {
            model::Material material = model_.materials[from];
            material.effects &= ~model::EffectMask{model::effect_sun};
            model_.materials.push_back(material);
            found.copies.emplace_back(copy->second, from);
        }
        model_.parts[p].material = copy->second;
    }
    for (model::Representation& rep : model_.reps) {
        rep.effects = 0;
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            rep.effects |= model_.materials[model_.parts[p].material].effects;
    }
}

}  // namespace

std::size_t openness_steps(const model::Model& model) { return vertex_tasks(lit_ranges(model, model::effect_sun)).size(); }

Openness measure_openness(model::Model& model, const RayTree& opaque, const ForAll& for_all, const std::function<bool()>& step) {
    Openness found;
    std::vector<VertexRange> ranges = lit_ranges(model, model::effect_sun);
    const std::vector<VertexTask> tasks = vertex_tasks(ranges);
    const std::size_t count = ranges.size();
    OpennessMaker maker(model, opaque, std::move(ranges));
    for_all(count, [&](std::size_t r) { maker.find_starts(r); });
    std::atomic<bool> go{true};
    for_all(tasks.size(), [&](std::size_t t) {
        if (!go) return;
        maker.measure(tasks[t]);
        if (!step()) go = false;
    });
    if (!go) return found;
    found.within = maker.fill_unknown();
    if (!maker.count_vertices(found)) return found;
    found.measured = true;
    maker.change_materials(found);
    return found;
}

}  // namespace surefoot::bake
