// Prepares frames along a path, and puts every selector's cut beside the best one.
#include "tools/accuracy/value_share.hpp"

#include <algorithm>
#include <cmath>

#include "config/seat.hpp"
#include "config/settings.hpp"
#include "render/engine.hpp"
#include "render/model/walk_file.hpp"
#include "tools/walk/path_source.hpp"
#include "tools/walk/prepare_thread.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::accuracy {

namespace {

/// A selector's memory and cut, made for each frame: none knows another's.
struct Selection {
    select::SelectState state;
    select::Cut cut;
    explicit Selection(const select::SelectInput& input) {
        const auto candidates = static_cast<std::uint32_t>(input.prepared->candidates.size());
        state.reserve(*input.model, candidates);
        state.hysteresis = 1;
        select::reserve(cut, candidates);
    }
};

double value_of(const select::Cut& cut) { return cut.value + cut.bought.value; }

double full_detail_us(const select::SelectInput& input) {
    Selection all(input);
    select::find_selector(select::full_detail_selector)->run(input, all.state, all.cut);
    return static_cast<double>(all.cut.predicted_us);
}

/// The sums of add_frame() as means.
void take_means(ValueShares& shares) {
    const double n = std::max(1U, shares.frames);
    for (ValueShare& s : shares.selectors) {
        s.of_best /= n;
        s.of_bound /= n;
    }
    shares.bound_gap /= n;
}

}  // namespace

void add_frame(const select::SelectInput& input, const select::OracleLimits& limits, ValueShares& into) {
    if (input.prepared->candidates.empty()) return;
    Selection best(input);
    const select::Optimum optimum = select::find_optimum(input, best.state, best.cut, limits);
    if (optimum.floor_binds || !(optimum.value > 0.0)) {
        ++into.floor_frames;
        return;
    }
    if (full_detail_us(input) <= input.budget_us) {
        ++into.full_frames;
        return;
    }
    ++into.frames;
    into.proven += optimum.proven ? 1U : 0U;
    into.bound_gap += 1.0 - optimum.value / optimum.bound;
    for (ValueShare& s : into.selectors) {
        Selection one(input);
        select::find_offline_selector(s.selector)->run(input, one.state, one.cut);
        const double value = value_of(one.cut);
        s.of_best += value / optimum.value;
        s.of_bound += value / optimum.bound;
        s.min_of_best = std::min(s.min_of_best, value / optimum.value);
        s.min_of_bound = std::min(s.min_of_bound, value / optimum.bound);
    }
}

Result<ValueShares> value_shares(const model::Model& model, const model::CostModel& costs, const Path& path,
                                 const ShareRequest& request, const Progress& progress) {
    constexpr int preparations = 4;  // until the visits of a frame are limited as in a walk
    prepare::PrepareOptions options;
    options.workers = request.workers;
    options.sky = request.sky;
    options.acuity_rad = request.acuity_rad;
    options.max_candidates = static_cast<std::uint32_t>(std::min<std::size_t>(options.max_candidates, model.nodes.size()));
    prepare::Preparer preparer(model, costs, options);
    prepare::PreparedFrame frame;
    preparer.reserve(frame);
    ValueShares shares;
    for (const std::string& name : request.selectors) {
        if (select::find_offline_selector(name) == nullptr) return select::selector_named(name).error();
        shares.selectors.push_back({name});
    }
    for (std::uint32_t i = 0; i < request.frames; ++i) {
        if (progress.stopped()) return Error{"best cuts", "The search was stopped by the user", "", ErrorKind::stopped};
        progress.update("best cuts", static_cast<double>(i) / request.frames);
        const double at_s = path.duration_s() * (i + 0.5) / request.frames;
        const Pose now = sample_path(path, at_s), before = sample_path(path, std::max(0.0, at_s - request.period_s));
        const prepare::Region region = predict_region(before, now, request.period_s, walk::horizon_s(request.period_s));
        const double speed_mps = glm::length(now.position - before.position) / request.period_s;
        const double w = std::min(1.0, std::abs(glm::dot(now.orientation, before.orientation)));
        for (int k = 0; k < preparations; ++k)
            preparer.run(region, request.viewport, i, speed_mps, 2.0 * std::acos(w) / request.period_s, frame);
        if (frame.candidates.empty()) continue;
        select::SelectInput input{&model, &frame, &costs, request.budget_us, 1.0, 0.0, request.slice_us};
        input.benefit = request.benefit;
        if (!(request.budget_us > 0.0)) input.budget_us = request.share_of_full * full_detail_us(input);
        add_frame(input, request.limits, shares);
    }
    take_means(shares);
    return shares;
}

Result<ValueShares> value_shares_of_walk(const walk::WalkRequest& walk, ShareRequest request, const Progress& progress) {
    model::WalkFileInfo file;
    auto model = model::read_walk(walk.model_file, &file);
    if (!model) return model.error();
    auto path = walk::choose_path(walk.path_file, walk.model_file, *model, walk.lift_m);
    if (!path) return path.error();
    walk::apply_seat(walk, path->path);
    std::string note;
    const std::string state = walk::state_directory(walk.state_dir);
    auto table = walk::load_costs(state, "", note);
    if (!table) return table.error();
    auto costs = walk::fitted_costs(state, *table, {file.hash, walk.width, walk.height, walk.backend});
    if (!costs) return costs.error();
    request.viewport = {walk.width, walk.height, walk.shift_x, walk.shift_y};
    request.acuity_rad = config::acuity_rad(walk);
    request.period_s = 1.0 / walk.rate_hz;
    request.slice_us = walk.slice_us;
    request.benefit = walk.benefit;
    request.sky = config::colour_of(walk.sky);
    request.workers = std::max(1, walk.workers);
    return value_shares(*model, *costs, path->path, request, progress);
}

}  // namespace surefoot::accuracy
