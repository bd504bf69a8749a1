// Receivers of moving shadows (moving_shadow.hpp).
#include "render/bake/moving_shadow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "render/model/motion.hpp"

namespace surefoot::bake {

namespace {

using model::Index;

/// A shadow is followed to so many times the height of what casts it, where the sun stands 11 degrees high.
constexpr double max_shadow_lengths = 5;

/// Where things are that cast shadows, over all times, and how far their shadows fall.
struct ShadowReach {
    std::vector<Box> boxes;                                ///< by motion, but for those that cast nothing
    std::size_t moving = 0, casting = 0, transparent = 0;  ///< leaves

    explicit ShadowReach(const model::Model& m) {
        if (m.motions.empty()) return;
        std::vector<Box> of_motion(m.motions.size());
        for (const model::Node& node : m.nodes) {
            const Index motion = model::motion_of(m, node);
            if (node.child_count > 0 || motion == model::none) continue;
            ++moving;
            const model::Casting how = model::casting_of(m, m.reps[node.first_rep + node.rep_count - 1]);
            if (how == model::Casting::transparent) ++transparent;
            if (how != model::Casting::casts) continue;
            ++casting;
            of_motion[motion].grow(model::rest_box_of(m, node));
        }
        for (Index motion = 0; motion < of_motion.size(); ++motion)
            if (!of_motion[motion].empty()) boxes.push_back(model::reach_of(m, motion, of_motion[motion]).box);
    }
    /// Shadows are as long as what casts is higher than the bottom of the box, times a limit.
    [[nodiscard]] bool meets(const Box& box) const {
        return std::any_of(boxes.begin(), boxes.end(), [&](const Box& casts) {
            const double way_m = max_shadow_lengths * (casts.max.y - box.min.y);
            const dvec3 way(way_m, 0, way_m);
            return way_m >= 0 && glm::all(glm::lessThanEqual(casts.min - way, dvec3(box.max.x, casts.min.y, box.max.z))) &&
                   glm::all(glm::lessThanEqual(dvec3(box.min.x, casts.min.y, box.min.z), casts.max + way));
        });
    }
};

/// Parts of forms that receive, and copies of what others use too.
class Receivers {
public:
    explicit Receivers(model::Model& m) : m_(m), shared_(m.materials.size(), false) {}

    /// Before the first give(): a form that does not receive.
    void keep(const model::Representation& rep) {
        for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) shared_[m_.parts[p].material] = true;
    }
    void give(model::Representation& rep) {
        const auto [entry, fresh] = parts_.try_emplace({rep.first_part, rep.part_count}, rep.first_part);
        if (fresh) entry->second = receiving(rep);
        rep.first_part = entry->second;
        for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            rep.effects |= m_.materials[m_.parts[p].material].effects;
    }

private:
    [[nodiscard]] bool lit(Index part) const { return (m_.materials[m_.parts[part].material].effects & model::effect_sun) != 0; }
    Index receiving(const model::Representation& rep) {
        bool copies = false;
        for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            copies |= lit(p) && shared_[m_.parts[p].material];
        const Index first = copies ? static_cast<Index>(m_.parts.size()) : rep.first_part;
        for (std::uint32_t i = 0; i < rep.part_count; ++i) {
            if (copies) m_.parts.push_back(model::Part(m_.parts[rep.first_part + i]));
            if (lit(first + i)) m_.parts[first + i].material = receiving(m_.parts[first + i].material);
        }
        return first;
    }
    Index receiving(Index material) {
        if (material >= shared_.size()) return material;  // a copy
        if (shared_[material]) {
            const auto [entry, fresh] = copies_.try_emplace(material, static_cast<Index>(m_.materials.size()));
            if (fresh) m_.materials.push_back(model::Material(m_.materials[material]));
            material = entry->second;
        }
        m_.materials[material].effects |= model::effect_moving_shadow;
        return material;
    }

    model::Model& m_;
    std::vector<bool> shared_;  ///< by material: a form that does not receive has it
    std::map<std::pair<Index, Index>, Index> parts_;
    std::map<Index, Index> copies_;
};

bool is_lit_form(const model::Representation& rep) { return (rep.effects & model::effect_sun) != 0; }

std::string why_no_shadow(const model::Model& m, const ShadowReach& reach) {
    if (m.motions.empty() || reach.moving == 0) return "nothing moves";
    if (reach.transparent == reach.moving) return "all that moves is transparent";
    if (reach.casting == 0) return "all that moves is transparent or sees no sky";
    return "nothing lit stands within reach of the shadows of what moves";
}

}  // namespace

void add_moving_shadow(model::Model& m) {
    const ShadowReach reach(m);
    model::EffectFinding finding{model::effect_moving_shadow, false, 0, why_no_shadow(m, reach), true};
    std::vector<Index> receive;
    Receivers receivers(m);
    for (const model::Node& node : m.nodes) {
        const bool within = model::motion_of(m, node) == model::none && reach.meets(node.box);
        for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            if (within && is_lit_form(m.reps[r]))
                receive.push_back(r);
            else if (!reach.boxes.empty())
                receivers.keep(m.reps[r]);
        }
        const model::Representation& finest = m.reps[node.first_rep + node.rep_count - 1];
        if (within && node.child_count == 0 && is_lit_form(finest)) finding.triangles += finest.triangles;
    }
    for (const Index r : receive) receivers.give(m.reps[r]);
    finding.called_for = !receive.empty();
    if (finding.called_for)
        finding.reason = fmt::format("{} of {} things that move are opaque and within reach of what is lit and stands still",
                                     reach.casting, reach.moving);
    for (model::EffectFinding& f : m.effects)
        if (f.bit == finding.bit) f = finding;
}

}  // namespace surefoot::bake
