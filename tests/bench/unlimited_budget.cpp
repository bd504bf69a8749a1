// Bench: with an unlimited budget the cut's picture equals full detail (`flat`): share of pixels within 1/255.
// bench_unlimited_budget MODEL.walk [POSES 24] [PATH.csv] [LIFT_M] -> one JSON object; exit 1 below 99.9 %.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "render/engine.hpp"
#include "render/measure/image_metrics.hpp"
#include "render/model/walk_file.hpp"
#include "tools/walk/path_source.hpp"

namespace {
int fail(const surefoot::Error& error) {
    fmt::print(stderr, "{}\n", error.text());
    return 1;
}
}  // namespace

int main(int argc, char** argv) {
    using namespace surefoot;
    if (argc < 2) return fmt::print(stderr, "bench_unlimited_budget MODEL.walk [POSES] [PATH.csv]\n"), 2;
    const int poses = argc > 2 ? std::atoi(argv[2]) : 24;
    auto model = model::read_walk(argv[1]);
    if (!model) return fail(model.error());
    auto path = walk::choose_path(argc > 3 ? argv[3] : "", argv[1], *model, argc > 4 ? std::atof(argv[4]) : 0);
    if (!path) return fail(path.error());
    EngineOptions options;
    options.in_frame_check = false;
    auto engine = Engine::open(std::move(*model), model::default_costs(), options);
    if (!engine) return fail(engine.error());
    Engine& e = **engine;
    e.device().bind();
    prepare::PreparedFrame prepared, with_hidden;
    e.reserve(prepared);
    prepare::PrepareOptions all = e.options().prepare;
    all.occlusion = false;
    prepare::Preparer preparer(e.model(), e.costs(), all);
    preparer.reserve(with_hidden);
    SubmitLimits limits;
    limits.limit_us = std::numeric_limits<double>::infinity();
    double worst = 1, sum = 0, worst_hidden = 1;
    std::uint64_t cut_triangles = 0, full_triangles = 0;
    for (int i = 0; i < poses; ++i) {
        const Pose pose = sample_path(path->path, path->path.duration_s() * (i + 0.5) / poses);
        e.prepare({pose, 0, 0}, 0, 0, 0, prepared);
        e.select(prepared, std::numeric_limits<double>::infinity(), {}, 0);
        cut_triangles += e.submit(pose, limits).triangles;
        auto cut = e.device().read_pixels();
        if (!cut) return fail(cut.error());
        preparer.run({pose, 0, 0}, {}, 0, 0, 0, with_hidden);
        e.select(with_hidden, std::numeric_limits<double>::infinity(), {}, 0);
        e.submit(pose, limits);
        auto whole = e.device().read_pixels();
        if (!whole) return fail(whole.error());
        worst_hidden = std::min(worst_hidden, measure::share_within(cut->rgba, whole->rgba, 1));
        const auto items = e.full_detail(pose);
        for (const gl::DrawItem& item : items) full_triangles += e.model().reps[item.rep].triangles;
        e.draw_unbudgeted(pose, items);
        auto full = e.device().read_pixels();
        if (!full) return fail(full.error());
        const double share = measure::share_within(cut->rgba, full->rgba, 1);
        worst = std::min(worst, share);
        sum += share;
    }
    fmt::print(
        "{{\"model\": \"{}\", \"poses\": {}, \"share_within_1\": {{\"min\": {:.6f}, \"mean\": {:.6f}}}, \"triangles\": "
        "{{\"cut\": {}, \"flat\": {}}}, \"share_as_without_occlusion\": {:.6f}}}\n",
        argv[1], poses, worst, sum / poses, cut_triangles / poses, full_triangles / poses, worst_hidden);
    return worst >= 0.999 && worst_hidden >= 0.999 ? 0 : 1;
}
