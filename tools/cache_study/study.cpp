// Runs a study.
#include "tools/cache_study/study.hpp"

#include <algorithm>
#include <limits>

#include "tools/cache_study/study_scenes.hpp"
#include "tools/cache_study/traced_points.hpp"

namespace surefoot::cache_study {

namespace {

/// One walk by one set of rules. Stops early where the user wants it.
std::vector<StudyFrame> walk_by(const StudyScene& scene, const cache::PixelAngles& pixels, const cache::CacheOptions& options,
                                const Progress& progress, std::string_view stage, ViewSheet* sheet) {
    std::vector<StudyFrame> frames;
    cache::CacheState state = cache::empty_state(scene.tree);
    TracedPoints points(scene);
    const std::size_t views = std::min(max_views, scene.eyes.size());
    for (std::size_t frame = 0; frame < scene.eyes.size() && !progress.stopped(); ++frame) {
        progress.update(stage, static_cast<double>(frame) / static_cast<double>(scene.eyes.size()));
        cache::CacheView view;
        view.eye = scene.eyes[frame];
        view.pixels = pixels;
        view.frame = static_cast<std::uint32_t>(frame);
        cache::CachePlan plan = cache::plan_frame(scene.tree, view, options, state);
        points.follow(plan);
        const double traced_rad = points.max_error_rad(plan, view.eye);
        frames.push_back({plan.counts, plan.after.bytes, plan.max_error_rad / pixels.smallest_rad,
                          traced_rad / pixels.smallest_rad, work_of(scene.tree, plan)});
        if (sheet != nullptr && frame == sheet->views.size() * scene.eyes.size() / views)
            add_view(*sheet, scene.tree, plan, view.eye);
        state = std::move(plan.after);
    }
    return frames;
}

}  // namespace

DrawWork work_of(const cache::BoxTree& tree, const cache::CachePlan& plan) {
    DrawWork work;
    for (const cache::Refresh& refresh : plan.refreshes) {
        const std::uint64_t side = plan.after.pictures[refresh.box].texels;
        work.texels += side * side;
        if (!refresh.from_children) work.triangles += tree.boxes[refresh.box].primitive_count;
    }
    for (const cache::BoxDraw& draw : plan.draws)
        if (!draw.picture) work.triangles += tree.boxes[draw.box].primitive_count;
    return work;
}

StudySums sums_of(std::span<const StudyFrame> frames) {
    StudySums sums;
    for (const StudyFrame& frame : frames) {
        const cache::CacheCounts& counts = frame.counts;
        sums.fresh += counts.fresh;
        sums.combined += counts.combined;
        sums.reused += counts.reused;
        sums.not_replaceable += counts.not_replaceable;
        sums.max_fresh = std::max(sums.max_fresh, counts.fresh);
        sums.bound_px = std::max(sums.bound_px, frame.bound_px);
        sums.max_refreshes = std::max(sums.max_refreshes, counts.fresh + counts.combined);
        sums.traced_px = std::max(sums.traced_px, frame.traced_px);
        sums.work.triangles += frame.work.triangles;
        sums.work.texels += frame.work.texels;
        ++sums.frames;
    }
    return sums;
}

StudySums sums_after_first(const std::vector<StudyFrame>& frames) {
    return sums_of(std::span(frames).subspan(std::min<std::size_t>(1, frames.size())));
}

StudyShape shape_of(const StudySums& sums) {
    const auto ratio = [](std::uint64_t above, std::uint64_t below) {
        if (below > 0) return static_cast<double>(above) / static_cast<double>(below);
        return above > 0 ? std::numeric_limits<double>::infinity() : 0.0;
    };
    return {ratio(sums.reused, sums.combined), ratio(sums.combined, sums.fresh)};
}

Result<Study> run_study(const StudyRequest& request, const Progress& progress) {
    auto scene = make_study(request.study, request.frames > 0 ? request.frames : usual_frames(request.study));
    if (!scene) return scene.error();
    Study study;
    study.triangles = scene->triangles.size();
    study.walked_m = scene->walked_m;
    study.step_m = scene->step_m;
    study.boxes = static_cast<std::uint32_t>(scene->tree.boxes.size());
    for (const cache::CacheBox& box : scene->tree.boxes)
        if (box.primitive_count > 0) ++study.filled_boxes;
    const cache::PixelAngles pixels = cache::pixel_angles(Pose{}, {request.width, request.height});
    cache::CacheOptions options;
    study.sheet.bounds = scene->tree.boxes.front().box;
    for (const dvec3& eye : scene->eyes) study.sheet.bounds.grow(eye);
    study.corrected = walk_by(*scene, pixels, options, progress, "counting", request.pictures ? &study.sheet : nullptr);
    options.rules = cache::ValidityRules::published;
    study.published = walk_by(*scene, pixels, options, progress, "counting as in 1996", nullptr);
    if (progress.stopped())
        return Error{request.study, "The study was stopped by the user, and nothing was written", "", ErrorKind::stopped};
    return study;
}

}  // namespace surefoot::cache_study
