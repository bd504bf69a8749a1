// A program for tests/bench/double_cost: prepares, selects and submits frames of a model along its path, each stage inside a
// function that callgrind can count alone: surefoot_counted_prepare, _select, _submit. It is compiled a second time with `float`
// for `double`, so all that it prints is what the two should have in common, and the CPU time of each. bench_frame_stages
// MODEL.walk FRAMES null|egl [PATH.csv|""] [LIFT_M] [SHIFT_M] [leaves] -> one JSON object, means of a frame. SHIFT_M moves model
// and path that far from the origin; `leaves` prints "frame node" of each leaf in view instead.
#include <fmt/format.h>

#include <time.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "render/engine.hpp"
#include "render/model/walk_file.hpp"
#include "tools/walk/path_source.hpp"

namespace {

using namespace surefoot;

constexpr double period_s = 1.0 / 30, horizon_s = 3 * period_s, budget_us = 26'000, limit_us = 33'333;
constexpr double speed_mps = 1.4, turn_rps = 0.1;

/// For callgrind's --toggle-collect: names of their own, never inlined.
extern "C" [[gnu::noinline]] void surefoot_counted_prepare(Engine& engine, const prepare::Region& region,
                                                           prepare::PreparedFrame& out) {
    engine.prepare(region, 0, speed_mps, turn_rps, out);
}
extern "C" [[gnu::noinline]] void surefoot_counted_select(Engine& engine, const prepare::PreparedFrame& prepared) {
    engine.select(prepared, budget_us, {}, 0);
}
extern "C" [[gnu::noinline]] void surefoot_counted_submit(Engine& engine, const Pose& pose, const SubmitLimits& limits,
                                                          SubmitReport& report) {
    report = engine.submit(pose, limits);
}

std::int64_t cpu_ns() {
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return t.tv_sec * 1'000'000'000LL + t.tv_nsec;
}

int fail(const Error& error) {
    fmt::print(stderr, "{}\n", error.text());
    return 1;
}

void shift(model::Model& model, Path& path, const dvec3& by) {
    for (model::Node& node : model.nodes) {
        node.box.min += by;
        node.box.max += by;
    }
    for (model::Placement& placement : model.placements) placement.origin += by;
    for (PathSample& sample : path.samples) sample.pose.position += by;
}

struct Times {
    double frame_s;
    [[nodiscard]] Pose now(const Path& path) const { return sample_path(path, frame_s); }
    [[nodiscard]] Pose before(const Path& path) const { return sample_path(path, frame_s - period_s); }
};

Times times_of(const Path& path, int frame, int frames) {
    return {path.duration_s() * (static_cast<double>(frame) + 0.5) / static_cast<double>(frames)};
}

void print_leaves(const model::Model& model, const Path& path, int frames) {
    for (int i = 0; i < frames; ++i) {
        const auto frustum =
            model::make_frustum(times_of(path, i, frames).now(path), {}, model::far_corners_m(model.nodes[0].box));
        for (std::size_t n = 0; n < model.nodes.size(); ++n) {
            if (model.nodes[n].child_count == 0 && model::visible(frustum, model.nodes[n].box)) fmt::print("{} {}\n", i, n);
        }
    }
}

int run(Engine& engine, const Path& path, int frames) {
    engine.device().bind();
    prepare::PreparedFrame prepared;
    engine.reserve(prepared);
    SubmitLimits limits;
    limits.limit_us = limit_us;
    std::array<std::int64_t, 3> ns{};
    std::uint64_t visits = 0, candidates = 0, choices = 0, items = 0, triangles = 0;
    for (int i = 0; i < frames; ++i) {
        const Times times = times_of(path, i, frames);
        const Pose now = times.now(path), before = times.before(path);
        const prepare::Region region = predict_region(before, now, period_s, horizon_s);
        // The frame before is not counted: it leaves what selection remembers, and the caches, as a walk does.
        engine.prepare(region, 0, speed_mps, turn_rps, prepared);
        engine.select(prepared, budget_us, {}, 0);
        engine.submit(before, limits);
        const std::int64_t start = cpu_ns();
        surefoot_counted_prepare(engine, region, prepared);
        const std::int64_t after_prepare = cpu_ns();
        surefoot_counted_select(engine, prepared);
        const std::int64_t after_select = cpu_ns();
        SubmitReport report;
        surefoot_counted_submit(engine, now, limits, report);
        ns[0] += after_prepare - start;
        ns[1] += after_select - after_prepare;
        ns[2] += cpu_ns() - after_select;
        visits += prepared.visits;
        candidates += prepared.candidates.size();
        choices += prepared.choices.size();
        items += report.items;
        triangles += report.triangles;
    }
    const auto n = static_cast<std::uint64_t>(frames);
    const auto ns_each = static_cast<std::int64_t>(frames);
    fmt::print(
        "{{\"visits\": {}, \"candidates\": {}, \"choices\": {}, \"items\": {}, \"triangles\": {}, \"cpu_ns\": {{\"prepare\": {}, "
        "\"select\": {}, \"submit\": {}}}}}\n",
        visits / n, candidates / n, choices / n, items / n, triangles / n, ns[0] / ns_each, ns[1] / ns_each, ns[2] / ns_each);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    const int frames = argc > 3 ? std::atoi(argv[2]) : 0;
    const std::string_view backend = argc > 3 ? argv[3] : "";
    if (frames < 1 || (backend != "null" && backend != "egl"))
        return fmt::print(stderr, "bench_frame_stages MODEL.walk FRAMES null|egl [PATH.csv|\"\"] [LIFT_M] [SHIFT_M] [leaves]\n"),
               2;
    auto model = model::read_walk(argv[1]);
    if (!model) return fail(model.error());
    auto path = walk::choose_path(argc > 4 ? argv[4] : "", argv[1], *model, argc > 5 ? std::atof(argv[5]) : 0);
    if (!path) return fail(path.error());
    const double far_m = argc > 6 ? std::atof(argv[6]) : 0;
    if (far_m != 0) shift(*model, path->path, far_m * glm::normalize(dvec3(1, 0, 1)));
    if (argc > 7 && std::string_view(argv[7]) == "leaves") return print_leaves(*model, path->path, frames), 0;
    EngineOptions options;
    options.device.kind = backend == "egl" ? gl::BackendKind::egl : gl::BackendKind::null;
    auto engine = Engine::open(std::move(*model), model::default_costs(), options);
    if (!engine) return fail(engine.error());
    return run(**engine, path->path, frames);
}
