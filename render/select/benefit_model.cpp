// Benefits by distance: of a box's middle, of its nearest corner, or of its nearest point.
#include "render/select/benefit_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "rt/base/named.hpp"

namespace surefoot::select {

namespace {

double nearest_corner(const Box& box, const dvec3& eye) {
    const dvec3 low = glm::abs(box.min - eye), high = glm::abs(box.max - eye);
    return glm::length(glm::min(low, high));
}

double distance_by(BenefitModel model, const Box& box, const dvec3& eye) {
    switch (model) {
        case BenefitModel::distance_centre:
            return glm::length(box.centre() - eye);
        case BenefitModel::distance_point:
            return box.distance(eye);
        default:
            return nearest_corner(box, eye);
    }
}

}  // namespace

std::span<const BenefitModelEntry> benefit_models() {
    static constexpr std::array all = {
        BenefitModelEntry{usual_benefit_model, "size, error, focus and motion, as the other selectors", BenefitModel::surefoot},
        BenefitModelEntry{"distance-centre", "how near the middle of a box is", BenefitModel::distance_centre},
        BenefitModelEntry{"distance-vertex", "how near its nearest corner is", BenefitModel::distance_vertex},
        BenefitModelEntry{"distance-point", "how near its nearest point is", BenefitModel::distance_point},
        BenefitModelEntry{"subtree-max", "how near the nearest corner of an object below is", BenefitModel::subtree_max}};
    return all;
}

std::span<const std::string_view> searches_by_benefit() {
    static constexpr std::array<std::string_view, 2> names = {"best-first-1994", "two-stage-1994"};
    return names;
}

Result<BenefitModel> benefit_model_named(std::string_view name) {
    if (const BenefitModelEntry* entry = find_named(benefit_models(), name)) return entry->model;
    return Error{"benefit model '" + std::string(name) + "'", "There is no such model of the benefit",
                 "Use one of: " + names_in_words(benefit_models()), ErrorKind::misuse};
}

void find_benefits(const SelectInput& input, bool of_subtree, std::span<float> benefits) {
    const prepare::PreparedFrame& prepared = *input.prepared;
    const bool greatest_below = of_subtree || input.benefit == BenefitModel::subtree_max;
    std::fill(benefits.begin(), benefits.end(), 0.0F);
    for (auto c = static_cast<Index>(benefits.size()); c-- > 0;) {  // children come after their parents
        const prepare::Candidate& at = prepared.candidates[c];
        if (!greatest_below || at.child_count == 0) {
            const double d = distance_by(input.benefit, input.model->nodes[at.node].box, prepared.region.centre.position);
            benefits[c] = static_cast<float>(1.0 / (1.0 + d * d));
        }
        if (greatest_below && at.parent != none) benefits[at.parent] = std::max(benefits[at.parent], benefits[c]);
    }
}

}  // namespace surefoot::select
