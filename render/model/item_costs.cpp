// Predicting what a representation costs (item_costs.hpp).
#include "render/model/item_costs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "render/model/model.hpp"

namespace surefoot::model {

ItemCosts::ItemCosts(const Model& model, const CostModel& costs) : ItemCosts(model, costs, PixelEstimator(model)) {}

ItemCosts::ItemCosts(const Model& model, const CostModel& costs, PixelEstimator estimator)
    : model_(model), costs_(costs), estimator_(std::move(estimator)) {
    const auto grid_of = [&](EffectMask effects) {
        return static_cast<std::uint32_t>(&costs.grid_for(effects) - costs.grids.data());
    };
    grid_of_part_.reserve(model.parts.size());
    for (const Part& part : model.parts) grid_of_part_.push_back(grid_of(model.materials[part.material].effects));
    std::vector<Class> found;
    std::map<std::pair<Index, Index>, Classes> known;  // by their parts
    classes_of_.reserve(model.reps.size());
    for (const Representation& rep : model.reps) {
        if (rep.part_count == 0) {  // by what it says of itself
            classes_of_.push_back({static_cast<std::uint32_t>(found.size()), 1});
            found.push_back({grid_of(rep.effects), static_cast<float>(rep.triangles), 1});
            continue;
        }
        const auto [entry, fresh] = known.try_emplace({rep.first_part, rep.part_count});
        if (fresh) entry->second = gather(rep, found);
        classes_of_.push_back(entry->second);
    }
    classes_ = std::vector<Class>(found.begin(), found.end());  // what stays, locked, is as large as it must be
    price_effects();
}

void ItemCosts::Increment::add(const EffectPrice& price, float triangles, float share) {
    submit_us += 1e-3F * price.submit_ns_per_triangle * triangles;
    raster_us += 1e-3F * price.raster_ns_per_triangle * triangles;
    raster_us_per_pixel += 1e-3F * price.raster_ns_per_pixel * share;
}

void ItemCosts::price_effects() {
    EffectMask of_model = 0;
    for (const Material& material : model_.materials) of_model |= material.effects;
    for (const Representation& rep : model_.reps) of_model |= rep.effects;
    for (const EffectPrice& price : costs_.prices) {
        if ((price.effect & of_model) == 0) continue;
        prices_.push_back(price);
        priced_ |= price.effect;
    }
    if (prices_.empty()) return;
    std::map<std::pair<Index, Index>, std::uint32_t> known;  // by their parts
    priced_as_.reserve(model_.reps.size());
    for (const Representation& rep : model_.reps) {
        const auto form = static_cast<std::uint32_t>(beyond_grids_.size());
        if (rep.part_count > 0) {
            const auto [entry, fresh] = known.try_emplace({rep.first_part, rep.part_count}, form);
            priced_as_.push_back(entry->second);
            if (!fresh) continue;
        } else {
            priced_as_.push_back(form);
        }
        of_effects_.resize(of_effects_.size() + prices_.size());
        price_form(rep, std::span(of_effects_).last(prices_.size()), beyond_grids_.emplace_back());
    }
}

void ItemCosts::price_form(const Representation& rep, std::span<Increment> of_effects, Increment& beyond_grids) const {
    if (rep.part_count == 0)
        return price_part(rep.effects, costs_.grid_for(rep.effects), static_cast<float>(rep.triangles), 1, of_effects,
                          beyond_grids);
    std::vector<double> areas;
    double total = 0;
    for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        double& area = areas.emplace_back(0);
        for_triangles(model_, p, [&](const Material&, const vec3& a, const vec3& b, const vec3& c) {
            area += static_cast<double>(0.5F * glm::length(glm::cross(b - a, c - a)));
        });
        total += area;
    }
    const bool measurable = total > 0 && std::isfinite(total);
    for (std::uint32_t i = 0; i < rep.part_count; ++i) {
        const Part& part = model_.parts[rep.first_part + i];
        const double share = measurable ? areas[i] / total : 1.0 / rep.part_count;
        const std::uint32_t triangles = part.index_count / 3;
        price_part(model_.materials[part.material].effects, costs_.grids[grid_of_part_[rep.first_part + i]],
                   static_cast<float>(triangles), static_cast<float>(share), of_effects, beyond_grids);
    }
}

void ItemCosts::price_part(EffectMask effects, const CostGrid& grid, float triangles, float share,
                           std::span<Increment> of_effects, Increment& beyond_grids) const {
    for (std::size_t i = 0; i < prices_.size(); ++i) {
        if ((prices_[i].effect & effects) == 0) continue;
        of_effects[i].add(prices_[i], triangles, share);
        if ((prices_[i].effect & grid.effects) == 0) beyond_grids.add(prices_[i], triangles, share);
    }
}

ItemCost ItemCosts::of_effects(Index r, float pixels, EffectMask effects) const {
    ItemCost sum;
    if ((effects & priced_) == 0) return sum;
    const std::size_t first = priced_as_[r] * prices_.size();
    for (std::size_t i = 0; i < prices_.size(); ++i)
        if ((prices_[i].effect & effects) != 0) sum += of_effects_[first + i].at(std::min(pixels, max_pixels));
    return sum;
}

ItemCosts::Classes ItemCosts::gather(const Representation& rep, std::vector<Class>& found) const {
    struct Sum {
        std::uint32_t triangles = 0;
        double area = 0;
    };
    std::map<std::uint32_t, Sum> sums;  // by grid
    double total = 0;
    for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        Sum& sum = sums[grid_of_part_[p]];
        for_triangles(model_, p, [&](const Material&, const vec3& a, const vec3& b, const vec3& c) {
            const auto area = static_cast<double>(0.5F * glm::length(glm::cross(b - a, c - a)));
            ++sum.triangles;
            sum.area += area;
            total += area;
        });
    }
    const Classes classes{static_cast<std::uint32_t>(found.size()), static_cast<std::uint32_t>(sums.size())};
    const bool measurable = total > 0 && std::isfinite(total);
    for (const auto& [grid, sum] : sums) {
        const double share = measurable ? sum.area / total : 1.0 / classes.count;
        found.push_back({grid, static_cast<float>(sum.triangles), static_cast<float>(share)});
    }
    return classes;
}

ItemCost ItemCosts::of(Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale, float& all_pixels,
                       EffectMask hidden) const {
    ItemCost cost = by_cells(r, node_box, eye, scale, all_pixels);
    cost.raster_us += 1e-3F * costs_.ns_per_pixel * std::min(all_pixels, max_pixels);
    if (prices_.empty()) return cost;
    cost += beyond_grids_[priced_as_[r]].at(std::min(all_pixels, max_pixels));
    if ((hidden & priced_) == 0) return cost;
    const ItemCost less = of_effects(r, all_pixels, hidden);
    return {std::max(0.0F, cost.submit_us - less.submit_us), std::max(0.0F, cost.raster_us - less.raster_us)};
}

ItemCost ItemCosts::by_cells(Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale, float& all_pixels) const {
    const Representation& rep = model_.reps[r];
    const auto classes = std::span(classes_).subspan(classes_of_[r].first, classes_of_[r].count);
    std::array<float, PixelEstimator::max_parts> of_part;  // NOLINT: filled as far as it is read
    ItemCost sum;
    all_pixels = 0;
    const auto add = [&](const Class& c, float pixels) { sum += costs_.item(c.triangles, pixels, costs_.grids[c.grid]); };
    if (estimator_.part_pixels(model_, r, node_box, eye, scale, of_part)) {
        for (const Class& c : classes) {
            float pixels = 0;
            for (std::uint32_t p = 0; p < rep.part_count; ++p)
                if (grid_of_part_[rep.first_part + p] == c.grid) pixels += of_part[p];
            add(c, std::min(pixels, max_pixels));
            all_pixels += pixels;
        }
    } else {
        const float pixels = estimator_.pixels(model_, r, node_box, eye, scale);
        for (const Class& c : classes) add(c, pixels * c.share);
        all_pixels = pixels;
    }
    return sum;
}

}  // namespace surefoot::model
