// Rays from each vertex, then bytes, then materials without the sun.
#include "render/bake/openness.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <optional>
#include <vector>

#include "render/bake/lit_vertices.hpp"
#include "render/bake/sky_rays.hpp"

namespace surefoot::bake {

namespace {

class OpennessMaker {
public:
    OpennessMaker(model::Model& model, const RayTree& opaque, std::vector<VertexRange> ranges, const ClosedVertices& closed)
        : model_(model),
          rays_(opaque, model.nodes.empty() ? 0 : 2 * model.nodes[0].box.diagonal()),
          ranges_(std::move(ranges)),
          starts_(ranges_.size()) {
        for (const VertexRange& range : ranges_)
            known_closed_.push_back(std::binary_search(closed.begin(), closed.end(), range.first));
    }

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
    [[nodiscard]] bool is_closed(const model::Part& part) const;
    [[nodiscard]] std::vector<bool> closed_parts() const;

    model::Model& model_;
    SkyRays rays_;
    std::vector<VertexRange> ranges_;
    std::vector<bool> known_closed_;  ///< by range: it sees no sky, whatever rays from its coarse forms find
    std::vector<std::vector<RayStart>> starts_;
};

void OpennessMaker::measure(const VertexTask& task) {
    const VertexRange& range = ranges_[task.range];
    for (std::uint32_t v = task.from; v < task.to; ++v) {
        const RayStart& start = starts_[task.range][v];
        if (!start.used) continue;
        SideSees front, back;
        const bool closed = known_closed_[task.range];
        const auto look_from = [&](const PlacedStart& from, const dvec3& normal, SideSees& seen) {
            closed ? rays_.add_room(from.at, normal, seen) : rays_.add_seen(from.at, normal, seen);
        };
        double places = 0;
        for (const model::Index p : range.placements) {
            const std::optional<PlacedStart> placed = placed_start(start, model_.placements[p]);
            if (!placed) continue;  // nothing is known, and nothing is hidden
            look_from(*placed, placed->normal, front);
            if (range.two_sided) look_from(*placed, -placed->normal, back);
            ++places;
        }
        if (!(places > 0)) continue;
        if (!range.two_sided) back = front;
        std::uint8_t* hidden = model_.vertices[range.first + v].hidden;
        hidden[0] = SkyRays::hidden_byte(front.sky / places);
        hidden[1] = SkyRays::hidden_byte(back.sky / places);
        hidden[2] = SkyRays::hidden_byte(front.room / places);
        hidden[3] = SkyRays::hidden_byte(back.room / places);
    }
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
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
        const VertexRange& range = ranges_[r];
        if (!range.all_places && !known_closed_[r]) continue;
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

Openness measure_openness(model::Model& model, const RayTree& opaque, const ClosedVertices& closed, const ForAll& for_all,
                          const std::function<bool()>& step) {
    Openness found;
    std::vector<VertexRange> ranges = lit_ranges(model, model::effect_sun);
    const std::vector<VertexTask> tasks = vertex_tasks(ranges);
    const std::size_t count = ranges.size();
    OpennessMaker maker(model, opaque, std::move(ranges), closed);
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

void add_to_findings(const Openness& openness, std::vector<model::EffectFinding>& findings) {
    if (!openness.measured) return;
    for (model::EffectFinding& f : findings) {
        if (f.bit == model::effect_openness) {
            f.called_for = true;
            f.triangles = openness.triangles;
            f.reason = fmt::format("what {} lit vertices see of sky and room was measured", openness.vertices);
        } else if (f.bit == model::effect_sun) {
            f.triangles = openness.triangles - openness.closed;
            if (openness.closed == openness.triangles)
                f.reason = fmt::format("none of {} lit triangles sees any sky{}", openness.triangles,
                                       f.called_for ? "; baked forms of several objects do" : "");
            else if (openness.closed > 0)
                f.reason += fmt::format("; {} of {} lit triangles see no sky and are drawn without it", openness.closed,
                                        openness.triangles);
        }
    }
}

}  // namespace surefoot::bake
