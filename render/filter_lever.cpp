// Prices of the second mip level, and the wait for it (filter_lever.hpp).
#include "render/filter_lever.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot {

namespace {

/// Raster time of a pixel by the table, us.
float pixel_us(const model::CostModel& costs, model::EffectMask effects) {
    constexpr float many = 65536;
    const model::CostGrid& grid = costs.grid_for(effects);
    return (costs.item(1, many, grid).raster_us - costs.item(1, 1, grid).raster_us) / many;
}

bool textured(const model::CostModel& costs, model::EffectMask effects) {
    return (costs.grid_for(effects).effects & model::effect_texture) != 0;
}

}  // namespace

FilterCosts::FilterCosts(const model::Model& model, const model::CostModel& costs) {
    const float growth = costs.trilinear_factor - 1.0F;
    if (!(growth > 0.0F) || !std::isfinite(growth)) return;
    // Of copies at a distance where the area in m2 is the pixels. The price of every pixel (ns_per_pixel) does not grow.
    std::vector<double> table_us(model.parts.size()), part_us(model.parts.size());
    for (model::Index p = 0; p < model.parts.size(); ++p) {
        double area = 0;
        model::for_triangles(model, p, [&](const model::Material&, const vec3& a, const vec3& b, const vec3& c) {
            area += static_cast<double>(0.5F * glm::length(glm::cross(b - a, c - a)));
        });
        table_us[p] = area * static_cast<double>(pixel_us(costs, model.materials[model.parts[p].material].effects));
        part_us[p] = table_us[p] + 1e-3 * static_cast<double>(costs.ns_per_pixel) * area;
    }
    growth_.reserve(model.reps.size());
    for (const model::Representation& rep : model.reps) {
        double all_us = 0, textured_us = 0;
        bool any_textured = false;
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            const bool with_texture = textured(costs, model.materials[model.parts[p].material].effects);
            any_textured = any_textured || with_texture;
            all_us += part_us[p];
            if (with_texture) textured_us += table_us[p];
        }
        const double share = all_us > 0 && std::isfinite(all_us) ? textured_us / all_us : any_textured ? 1.0 : 0.0;
        growth_.push_back(growth * static_cast<float>(share));
    }
}

float FilterCosts::full_us(const prepare::PreparedFrame& set) const {
    double sum_us = 0;
    for (const prepare::Candidate& candidate : set.candidates) {
        if (candidate.child_count > 0) continue;
        const prepare::Choice& finest = set.choices[candidate.first_choice + candidate.choice_count - 1];
        sum_us += static_cast<double>(finest.cost.raster_us) * static_cast<double>(growth_[finest.rep]);
    }
    return static_cast<float>(sum_us);
}

bool QualityDwell::offer(double share) {
    if (on_) {
        if (share <= 1.0) return true;
        leave();
        return false;
    }
    calm_ = share <= ample_share ? std::min(calm_ + 1, wait_) : 0;
    return calm_ == wait_;
}

void QualityDwell::answer(bool bought) {
    if (bought) {
        on_ = true;
        ++kept_;
    } else if (on_) {
        leave();
    }
}

void QualityDwell::leave() {
    wait_ = kept_ < long_stay * wait_ ? std::min(2 * wait_, max_wait) : min_wait;
    on_ = false;
    calm_ = kept_ = 0;
}

}  // namespace surefoot
