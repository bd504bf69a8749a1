// A model, its preparation and a selector's arrays in one place, for the tests of selection.
#pragma once

#include <limits>
#include <memory>

#include "render/prepare/prepared.hpp"
#include "render/select/registry.hpp"
#include "tests/prepare/random_model.hpp"

namespace surefoot::test {

constexpr double infinity = std::numeric_limits<double>::infinity();

struct Scene {
    model::Model model;
    model::CostModel costs = model::default_costs();
    prepare::PreparedFrame frame;
    select::SelectState state;
    select::Cut cut;
    select::SlicePlan plan;
    std::unique_ptr<prepare::Preparer> preparer;

    explicit Scene(model::Model m, prepare::PrepareOptions options = {}) : model(std::move(m)) {
        options.max_candidates = std::min<std::uint32_t>(options.max_candidates, static_cast<std::uint32_t>(model.nodes.size()));
        preparer = std::make_unique<prepare::Preparer>(model, costs, options);
        preparer->reserve(frame);
        state.reserve(model, options.max_candidates);
        select::reserve(cut, options.max_candidates);
        plan.reserve(options.max_candidates);
    }
    const prepare::PreparedFrame& look(const prepare::Region& region) {
        preparer->run(region, {1280, 720}, 0, 0, 0, frame);
        return frame;
    }
    [[nodiscard]] select::SelectInput input(double budget_us, double target_rad = 0) const {
        return {&model, &frame, &costs, budget_us, 1.0, target_rad, 1000.0};
    }
    const select::Cut& run(std::string_view selector, double budget_us, double target_rad = 0) {
        select::find_selector(selector)->run(input(budget_us, target_rad), state, cut);
        return cut;
    }
    void forget() { state.reserve(model, state.max_candidates()); }
};

}  // namespace surefoot::test
