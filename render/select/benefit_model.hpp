// The published benefits of a cluster, by its distance from the eye. The 1994 searches may go by them, for comparison.
// Source: Maciel 1994, 3.3.2 and 3.5.1, figures 3.13 and 3.17.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "render/select/select.hpp"
#include "rt/base/result.hpp"

namespace surefoot::select {

/// A benefit model by name.
struct BenefitModelEntry {
    std::string_view name, help;
    BenefitModel model;
};

constexpr std::string_view usual_benefit_model = "surefoot";

std::span<const BenefitModelEntry> benefit_models();
/// The selectors that go by SelectInput::benefit.
std::span<const std::string_view> searches_by_benefit();
/// An unknown name is an Error that lists the known ones.
Result<BenefitModel> benefit_model_named(std::string_view name);

/// Writes a benefit for every candidate: 1 / (1 + distance^2), the distance in m from the middle of the region.
/// of_subtree: a cluster has the greatest benefit of the visible objects below it, and not its own. benefits: one a candidate.
/// For all models but BenefitModel::surefoot.
void find_benefits(const SelectInput& input, bool of_subtree, std::span<float> benefits);

}  // namespace surefoot::select
