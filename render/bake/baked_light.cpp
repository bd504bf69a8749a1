// A ray to the sun for each of its moments, and one to each lamp that reaches a vertex.
#include "render/bake/baked_light.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <iterator>
#include <utility>

#include "render/bake/lit_vertices.hpp"
#include "render/model/sun_time.hpp"

namespace surefoot::bake {

namespace {

constexpr std::size_t moments = sizeof(model::SunSeen);
constexpr double min_sun_height = 0.02;     // of the direction: a sun on the horizon is hidden by all ground
constexpr double through_leaves = 1.0 / 3;  // of the sun: some rays pass between them
constexpr float night_room_light = 0.4F;    // of rooms in a scene whose lamps are known
constexpr float max_glow = 16;              // of what glows on a dark surface
constexpr float min_base = 0.05F;           // of a colour that a glow is divided by
constexpr model::EffectMask has_light = model::effect_sun | model::effect_openness;

float encoded(float linear) { return std::pow(std::clamp(linear, 0.0F, 1.0F), 1 / 2.2F); }

/// What one range of vertices gets: from the sun, and on both sides from lamps.
struct RangeLight {
    std::vector<RayStart> starts;
    std::vector<bool> in_sun;  ///< by vertex: a part with the sun uses it
    std::vector<model::SunSeen> sun;
    std::vector<vec3> before, behind;
};

class LightMaker {
public:
    LightMaker(model::Model& model, const LightInput& input)
        : model_(model),
          input_(input),
          ranges_(lit_ranges(model, has_light)),
          light_(ranges_.size()),
          far_m_(model.nodes.empty() ? 0 : 2 * model.nodes[0].box.diagonal()) {
        directions_[0] = glm::normalize(model.sun_direction);
        const model::LightFacts& facts = model.light;
        for (std::uint32_t i = 0; i + 1 < moments; ++i)
            directions_[1 + i] =
                model::towards_sun({model::hour_of_moment(i, facts.day, facts.latitude_deg), facts.day, facts.latitude_deg});
        for (dvec3& towards : directions_) {
            towards.y = std::max(towards.y, min_sun_height);
            towards = glm::normalize(towards);
        }
    }

    [[nodiscard]] const std::vector<VertexRange>& ranges() const { return ranges_; }
    void begin(std::size_t r);
    /// After begin() of its range.
    void measure(const VertexTask& task);
    /// Vertices that lie within something take the mean of those next to them.
    void fill_unknown(std::size_t r);
    void add_glow(std::size_t r);
    /// Into the model: only what changes a picture.
    BakedLight finish();

private:
    void add_sun(const PlacedStart& from, bool two_sided, std::array<double, moments>& seen) const;
    void put_shadow(BakedLight& found);
    void put_lamps(BakedLight& found);
    /// Those of the range's parts that use such a vertex.
    template <class IsSuch>
    void mark_materials(std::size_t r, const IsSuch& is_such, std::vector<bool>& materials) const;
    void give_effect(model::EffectMask needed, model::EffectMask given, const std::vector<bool>& materials);

    model::Model& model_;
    const LightInput& input_;
    std::vector<VertexRange> ranges_;
    std::vector<RangeLight> light_;
    std::array<dvec3, moments> directions_{};
    double far_m_;
};

void LightMaker::begin(std::size_t r) {
    const VertexRange& range = ranges_[r];
    RangeLight& light = light_[r];
    light.starts = ray_starts(model_, range);
    light.in_sun.assign(range.count, false);
    light.sun.assign(range.count, model::always_in_sun);
    light.before.assign(range.count, vec3(0));
    light.behind.assign(range.count, vec3(0));
    for (const model::Index p : range.parts) {
        const model::Part& part = model_.parts[p];
        if ((model_.materials[part.material].effects & model::effect_sun) == 0) continue;
        for (std::uint32_t i = 0; i < part.index_count; ++i) light.in_sun[model_.indices[part.first_index + i]] = true;
    }
}

void LightMaker::add_sun(const PlacedStart& from, bool two_sided, std::array<double, moments>& seen) const {
    for (std::size_t m = 0; m < moments; ++m) {
        const double faces = glm::dot(from.normal, directions_[m]);
        if (faces <= 0 && !two_sided) {
            seen[m] += 1;  // its own side hides it, which is no shadow
            continue;
        }
        const dvec3 at = from.at + (faces < 0 ? -ray_lift_m : ray_lift_m) * from.normal;
        if (input_.opaque.is_blocked({at, directions_[m], far_m_})) continue;
        seen[m] += input_.leaves != nullptr && input_.leaves->is_blocked({at, directions_[m], far_m_}) ? through_leaves : 1;
    }
}

void LightMaker::measure(const VertexTask& task) {
    const VertexRange& range = ranges_[task.range];
    RangeLight& light = light_[task.range];
    for (std::uint32_t v = task.from; v < task.to; ++v) {
        if (!light.starts[v].used) continue;
        std::array<double, moments> seen{};
        dvec3 before(0), behind(0);
        double places = 0;
        for (const model::Index p : range.placements) {
            const std::optional<PlacedStart> from = placed_start(light.starts[v], model_.placements[p]);
            if (!from) continue;
            ++places;
            if (light.in_sun[v]) add_sun(*from, range.two_sided, seen);
            if (input_.lamps.empty()) continue;
            before += input_.lamps.lux_at(from->at, from->normal);
            if (range.two_sided) behind += input_.lamps.lux_at(from->at, -from->normal);
        }
        if (!(places > 0)) continue;
        if (light.in_sun[v])
            for (std::size_t m = 0; m < moments; ++m)
                light.sun[v].share[m] = static_cast<std::uint8_t>(std::lround(255 * seen[m] / places));
        light.before[v] = shown_light(before / places);
        light.behind[v] = range.two_sided ? shown_light(behind / places) : light.before[v];
    }
}

void LightMaker::fill_unknown(std::size_t r) {
    const VertexRange& range = ranges_[r];
    RangeLight& light = light_[r];
    for (const unsigned side : {0U, 1U}) {
        std::vector<bool> unknown(range.count, false);
        for (std::uint32_t v = 0; v < range.count; ++v)
            unknown[v] = range.first + v < input_.within.size() && (input_.within[range.first + v] >> side & 1U) != 0;
        std::vector<vec3>& lamps = side == 0 ? light.before : light.behind;
        for (const VertexFill& fill : vertex_fills(model_, range, unknown)) {
            const auto count = static_cast<float>(fill.from.size());
            std::array<float, moments> sun{};
            vec3 sum(0);
            for (const std::uint32_t from : fill.from) {
                for (std::size_t m = 0; m < moments; ++m) sun[m] += light.sun[from].share[m];
                sum += lamps[from];
            }
            lamps[fill.vertex] = sum / count;
            if (side == 0)
                for (std::size_t m = 0; m < moments; ++m)
                    light.sun[fill.vertex].share[m] = static_cast<std::uint8_t>(std::lround(sun[m] / count));
        }
    }
}

/// Vertices show their colour times light: a glow is divided by that colour. Levels of detail share vertices, which glow once.
void LightMaker::add_glow(std::size_t r) {
    std::vector<vec3> glow;
    for (const model::Index p : ranges_[r].parts) {
        const model::Part& part = model_.parts[p];
        const vec3 sent = part.material < input_.emission.size() ? input_.emission[part.material] : vec3(0);
        if (!(std::max({sent.r, sent.g, sent.b}) > 0)) continue;
        const model::Material& material = model_.materials[part.material];
        vec3 light(0);
        for (int c = 0; c < 3; ++c)
            light[c] = std::min(encoded(sent[c]) / std::max(material.colour[static_cast<std::size_t>(c)], min_base), max_glow);
        glow.resize(ranges_[r].count, vec3(0));
        for (std::uint32_t i = 0; i < part.index_count; ++i) {
            vec3& here = glow[model_.indices[part.first_index + i]];
            here = glm::max(here, light);
        }
    }
    for (std::size_t v = 0; v < glow.size(); ++v) {
        light_[r].before[v] += glow[v];
        light_[r].behind[v] += glow[v];
    }
}

template <class IsSuch>
void LightMaker::mark_materials(std::size_t r, const IsSuch& is_such, std::vector<bool>& materials) const {
    for (const model::Index p : ranges_[r].parts) {
        const model::Part& part = model_.parts[p];
        const std::uint32_t* first = model_.indices.data() + part.first_index;
        if (!materials[part.material]) materials[part.material] = std::any_of(first, first + part.index_count, is_such);
    }
}

void LightMaker::give_effect(model::EffectMask needed, model::EffectMask given, const std::vector<bool>& materials) {
    for (std::size_t m = 0; m < materials.size(); ++m)
        if (materials[m] && (model_.materials[m].effects & needed) != 0) model_.materials[m].effects |= given;
}

void LightMaker::put_shadow(BakedLight& found) {
    const model::SunSeen& all = model::always_in_sun;
    std::vector<bool> shaded(model_.materials.size(), false);
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
        const RangeLight& light = light_[r];
        const auto in_shadow = [&](std::uint32_t v) {
            return light.in_sun[v] && !std::equal(std::begin(all.share), std::end(all.share), std::begin(light.sun[v].share));
        };
        std::uint64_t here = 0;
        for (std::uint32_t v = 0; v < ranges_[r].count; ++v) {
            found.vertices += light.in_sun[v] ? 1 : 0;
            here += in_shadow(v) ? 1 : 0;
        }
        if (here > 0) mark_materials(r, in_shadow, shaded);
        found.in_shadow += here;
    }
    if (found.in_shadow == 0) return;
    model_.sun_seen.assign(model_.vertices.size(), all);
    for (std::size_t r = 0; r < ranges_.size(); ++r)
        std::copy(light_[r].sun.begin(), light_[r].sun.end(), model_.sun_seen.begin() + ranges_[r].first);
    give_effect(model::effect_sun, model::effect_shadow, shaded);
}

void LightMaker::put_lamps(BakedLight& found) {
    std::vector<bool> lit(model_.materials.size(), false);
    float max_light = 0;
    for (std::size_t r = 0; r < ranges_.size(); ++r) {
        const auto light_of = [&](std::uint32_t v) {
            const vec3 brighter = glm::max(light_[r].before[v], light_[r].behind[v]);
            return std::max({brighter.r, brighter.g, brighter.b});
        };
        std::uint64_t here = 0;
        for (std::uint32_t v = 0; v < ranges_[r].count; ++v) {
            here += light_of(v) > 0 ? 1 : 0;
            max_light = std::max(max_light, light_of(v));
        }
        if (here > 0)
            mark_materials(
                r, [&](std::uint32_t v) { return light_of(v) > 0; }, lit);
        found.lit += here;
    }
    if (found.lit == 0) return;
    model_.light.max_lamp_light = max_light;
    if (!input_.lamps.empty()) model_.light.night_room_light = night_room_light;
    model_.lamp_light.assign(model_.vertices.size(), model::LampLight{});
    const auto byte = [&](float light) { return static_cast<std::uint8_t>(std::lround(255 * std::sqrt(light / max_light))); };
    for (std::size_t r = 0; r < ranges_.size(); ++r)
        for (std::uint32_t v = 0; v < ranges_[r].count; ++v)
            for (std::size_t c = 0; c < 3; ++c) {
                model::LampLight& to = model_.lamp_light[ranges_[r].first + v];
                to.before[c] = byte(light_[r].before[v][static_cast<int>(c)]);
                to.behind[c] = byte(light_[r].behind[v][static_cast<int>(c)]);
            }
    give_effect(has_light, model::effect_lamps, lit);
}

BakedLight LightMaker::finish() {
    BakedLight found;
    put_shadow(found);
    put_lamps(found);
    for (model::Representation& rep : model_.reps) {
        rep.effects = 0;
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            rep.effects |= model_.materials[model_.parts[p].material].effects;
    }
    return found;
}

}  // namespace

std::size_t baked_light_steps(const model::Model& model) { return vertex_tasks(lit_ranges(model, has_light)).size(); }

BakedLight measure_baked_light(model::Model& model, const LightInput& input, const ForAll& for_all,
                               const std::function<bool()>& step) {
    LightMaker maker(model, input);
    const std::vector<VertexTask> tasks = vertex_tasks(maker.ranges());
    for_all(maker.ranges().size(), [&](std::size_t r) { maker.begin(r); });
    std::atomic<bool> go{true};
    for_all(tasks.size(), [&](std::size_t t) {
        if (!go) return;
        maker.measure(tasks[t]);
        if (!step()) go = false;
    });
    if (!go) return {};
    for_all(maker.ranges().size(), [&](std::size_t r) {
        maker.fill_unknown(r);
        maker.add_glow(r);
    });
    return maker.finish();
}

void add_to_findings(const BakedLight& baked, const model::LightFacts& facts, std::vector<model::EffectFinding>& findings) {
    for (model::EffectFinding& f : findings) {
        if (!f.called_for) continue;
        if (f.bit == model::effect_shadow)
            f.reason += fmt::format("; {} of {} vertices in the sun lie in shadow at some hour", baked.in_shadow, baked.vertices);
        else if (f.bit == model::effect_lamps)
            f.reason += fmt::format("; {} vertices are lit or glow", baked.lit);
        else if (f.bit == model::effect_fog)
            f.reason += fmt::format("; one sees {:.4g} m far", facts.fog_visibility_m);
    }
}

}  // namespace surefoot::bake
