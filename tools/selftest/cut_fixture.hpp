// One model seen from one region: preparation and selection with the arrays between them, and what must hold of their numbers.
#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

#include "render/prepare/prepared.hpp"
#include "render/select/registry.hpp"

namespace surefoot::selftest {

/// A model with one prepared frame, for rows about cuts.
class CutFixture {
public:
    explicit CutFixture(model::Model model, prepare::PrepareOptions options = {});

    const prepare::PreparedFrame& prepare(const prepare::Region& region, model::Viewport viewport = {1280, 720});
    const select::Cut& select(std::string_view selector, double budget_us, double correction = 1);
    /// As if nothing had been shown yet.
    void forget();

    [[nodiscard]] const model::Model& model() const { return model_; }
    [[nodiscard]] model::CostModel& costs() { return costs_; }
    [[nodiscard]] const prepare::PreparedFrame& frame() const { return frame_; }
    [[nodiscard]] const select::SlicePlan& plan() const { return plan_; }
    [[nodiscard]] select::SelectState& state() { return state_; }

private:
    model::Model model_;
    model::CostModel costs_;
    prepare::PrepareOptions options_;
    std::unique_ptr<prepare::Preparer> preparer_;
    prepare::PreparedFrame frame_;
    select::SelectState state_;
    select::Cut cut_;
    select::SlicePlan plan_;
};

/// Candidates and choices with a number that is not finite or out of its range, or out of order: errors fall, costs rise.
std::uint64_t unsound(const prepare::PreparedFrame& frame, const model::CostModel& costs);
/// Numbers of the cut that are not finite, and 1 if it is not legal.
std::uint64_t illegal(const prepare::PreparedFrame& frame, const select::Cut& cut);

/// A model without geometry: a root over `count` leaves in a row of boxes of 1 m, each of `forms` forms.
model::Model star(std::uint32_t count, std::uint32_t forms);
/// A model without geometry: each node holds one, `depth` deep.
model::Model chain(std::uint32_t depth);

}  // namespace surefoot::selftest
