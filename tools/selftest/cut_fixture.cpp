// Preparation and selection for rows (cut_fixture.hpp).
#include "tools/selftest/cut_fixture.hpp"

#include <algorithm>
#include <cmath>

#include "render/prepare/evaluate.hpp"

namespace surefoot::selftest {

CutFixture::CutFixture(model::Model model, prepare::PrepareOptions options)
    : model_(std::move(model)), costs_(model::default_costs()), options_(options) {
    options_.max_candidates = std::min<std::uint32_t>(options_.max_candidates, static_cast<std::uint32_t>(model_.nodes.size()));
    preparer_ = std::make_unique<prepare::Preparer>(model_, costs_, options_);
    preparer_->reserve(frame_);
    select::reserve(cut_, options_.max_candidates);
    plan_.reserve(options_.max_candidates);
    forget();
}

void CutFixture::forget() { state_.reserve(model_, options_.max_candidates); }

const prepare::PreparedFrame& CutFixture::prepare(const prepare::Region& region, model::Viewport viewport) {
    preparer_->run(region, viewport, 0, 0, 0, frame_);
    return frame_;
}

const select::Cut& CutFixture::select(std::string_view selector, double budget_us, double correction) {
    const select::SelectInput input{&model_, &frame_, &costs_, budget_us, correction, 0, 1000.0};
    select::find_selector(selector)->run(input, state_, cut_);
    select::plan_slices(input, cut_, 1000.0, plan_);
    return cut_;
}

std::uint64_t unsound(const prepare::PreparedFrame& frame, const model::CostModel& costs) {
    std::uint64_t bad = 0;
    const auto fine = [](float v) { return std::isfinite(v) && v >= 0; };
    for (const prepare::Candidate& c : frame.candidates) {
        bad += fine(c.pixels) && fine(c.children_cost.submit_us) && fine(c.children_cost.raster_us) &&
                       fine(c.floor_cost.submit_us) && fine(c.floor_cost.raster_us)
                   ? 0
                   : 1;
        for (std::uint32_t k = 0; k < c.choice_count; ++k) {
            const prepare::Choice& now = frame.choices[c.first_choice + k];
            bad += fine(now.cost.submit_us) && fine(now.cost.raster_us) && fine(now.error_rad) && fine(now.benefit) &&
                           fine(now.subtree_benefit) && now.benefit <= 1 && now.subtree_benefit <= 1
                       ? 0
                       : 1;
            if (k == 0) continue;
            const prepare::Choice& coarser = frame.choices[c.first_choice + k - 1];
            const bool ordered =
                now.error_rad < coarser.error_rad && now.benefit <= coarser.benefit &&
                prepare::cost_metric(costs.combine, now.cost) > prepare::cost_metric(costs.combine, coarser.cost);
            bad += ordered ? 0 : 1;
        }
    }
    bad += fine(frame.full_cost.submit_us) && fine(frame.full_cost.raster_us) ? 0 : 1;
    return bad;
}

std::uint64_t illegal(const prepare::PreparedFrame& frame, const select::Cut& cut) {
    std::uint64_t bad = select::check_legal(frame, cut).empty() ? 0 : 1;
    for (const double v :
         {static_cast<double>(cut.sum.submit_us), static_cast<double>(cut.sum.raster_us), static_cast<double>(cut.predicted_us),
          static_cast<double>(cut.floor_us), static_cast<double>(cut.worst_error_rad), cut.benefit})
        bad += std::isfinite(v) && v >= 0 ? 0 : 1;
    return bad;
}

namespace {

void add_forms(model::Model& m, model::Node& node, std::uint32_t forms) {
    node.first_rep = static_cast<model::Index>(m.reps.size());
    node.rep_count = forms;
    for (std::uint32_t k = 0; k < forms; ++k) {
        model::Representation rep;
        rep.error_m = k + 1 == forms && node.child_count == 0 ? 0.0F : 0.5F / static_cast<float>(1U << (2 * k));
        rep.triangles = 12U << (2 * k);
        rep.area_m2 = {1, 1, 1};
        m.reps.push_back(rep);
    }
}

}  // namespace

model::Model star(std::uint32_t count, std::uint32_t forms) {
    model::Model m;
    m.placements.emplace_back();
    m.nodes.resize(static_cast<std::size_t>(count) + 1);
    const auto side = static_cast<std::uint32_t>(std::ceil(std::sqrt(static_cast<double>(count))));
    for (std::uint32_t i = 0; i < count; ++i) {
        model::Node& node = m.nodes[i + 1];
        const dvec3 low(3.0 * (i % side), 0, -3.0 * (i / side));
        node.box = {low, low + dvec3(1)};
        node.parent = 0;
        m.nodes[0].box.grow(node.box);
        add_forms(m, node, forms);
    }
    m.nodes[0].first_child = 1;
    m.nodes[0].child_count = count;
    add_forms(m, m.nodes[0], 1);
    m.reps.back().error_m = 4;
    return m;
}

model::Model chain(std::uint32_t depth) {
    model::Model m;
    m.placements.emplace_back();
    m.nodes.resize(depth);
    for (std::uint32_t i = 0; i < depth; ++i) {
        model::Node& node = m.nodes[i];
        node.box = {dvec3(-1, -1, -12), dvec3(1, 1, -10)};
        node.parent = i == 0 ? model::none : i - 1;
        node.child_count = i + 1 < depth ? 1 : 0;
        node.first_child = i + 1 < depth ? i + 1 : model::none;
        add_forms(m, node, 1);
        m.reps.back().triangles = 12 + i;
        m.reps.back().error_m = i + 1 < depth ? 1.0F - 0.9F * static_cast<float>(i) / static_cast<float>(depth) : 0.0F;
    }
    return m;
}

}  // namespace surefoot::selftest
