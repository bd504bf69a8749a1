// Runs a study.
#include "tools/cache_study/study.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "tools/cache_study/study_scenes.hpp"
#include "tools/cache_study/traced_points.hpp"

namespace surefoot::cache_study {

namespace {

/// Frames with a picture: those in the middle of five equal parts of the walk, or all of fewer.
std::size_t view_at(std::size_t view, std::size_t frames) {
    return (2 * view + 1) * frames / (2 * std::min<std::size_t>(views_a_study, frames));
}

/// What else a walk makes than counts.
struct WalkOutputs {
    ViewSheet* sheet = nullptr;
    StudyDevice* device = nullptr;
    std::vector<StudyView>* views = nullptr;
};

/// The plan and the frame by it, then the same frame in full.
FrameTimes times_of(StudyDevice& device, const cache::CachePlan& plan, const DrawTimes& planned, const cache::CacheView& view,
                    StudyView* pictures) {
    const Pose pose = device.pose_at(view.eye);
    const auto keep = [&](gl::PixelImage StudyView::*image) {
        if (pictures == nullptr) return;
        auto pixels = device.read_pixels();
        if (pixels) pictures->*image = std::move(*pixels);
    };
    FrameTimes times;
    const DrawnFrame drawn = device.draw_cached(plan, pose, view.pixels);
    keep(&StudyView::cached);
    times.cached = {planned.ms + drawn.times.ms, planned.cpu_ms + drawn.times.cpu_ms};
    times.pictures = drawn.pictures;
    times.leaves = drawn.leaves;
    times.meshes = drawn.meshes;
    times.mesh_triangles = drawn.mesh_triangles;
    times.made = drawn.made;
    times.full = device.draw_full(pose);
    keep(&StudyView::full);
    return times;
}

/// One walk by one set of rules. Stops early where the user wants it.
std::vector<StudyFrame> walk_by(const StudyScene& scene, const cache::PixelAngles& pixels, const cache::CacheOptions& options,
                                const Progress& progress, std::string_view stage, const WalkOutputs& outputs) {
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
        const Stopwatch planning;
        cache::CachePlan plan = cache::plan_frame(scene.tree, view, options, state);
        const DrawTimes planned = planning.spent();
        points.follow(plan);
        const double traced_rad = points.max_error_rad(plan, view.eye);
        frames.push_back({plan.counts, plan.after.bytes, plan.max_error_rad / pixels.smallest_rad,
                          traced_rad / pixels.smallest_rad, work_of(scene.tree, plan), std::nullopt});
        if (outputs.sheet != nullptr && frame == outputs.sheet->views.size() * scene.eyes.size() / views)
            add_view(*outputs.sheet, scene.tree, plan, view.eye);
        if (outputs.device != nullptr) {
            const bool shown = outputs.views != nullptr && frame == view_at(outputs.views->size(), scene.eyes.size());
            StudyView pictures{view.frame, {}, {}, {}};
            frames.back().times = times_of(*outputs.device, plan, planned, view, shown ? &pictures : nullptr);
            if (shown) outputs.views->push_back(std::move(pictures));
        }
        state = std::move(plan.after);
    }
    return frames;
}

/// None where nothing is to be drawn, or nothing can be.
std::unique_ptr<StudyDevice> device_for(const StudyScene& scene, const StudyRequest& request, Study& study) {
    study.no_times = "Nothing is drawn: no device was requested";
    if (!request.backend) return nullptr;
    DrawingOptions options;
    options.backend = *request.backend;
    options.viewport = {request.width, request.height};
    options.kind = request.kind;
    auto device = StudyDevice::open(scene, options);
    if (!device) {
        study.no_times = "Nothing is drawn: " + device.error().text();
        return nullptr;
    }
    study.no_times.clear();
    study.renderer = (*device)->renderer();
    return std::move(*device);
}

/// After the walk: the places of the cache's pictures are free.
void draw_by_object(StudyDevice& device, const StudyScene& scene, const cache::PixelAngles& pixels,
                    std::vector<StudyView>& views) {
    for (StudyView& view : views) {
        if (device.draw_objects(device.pose_at(scene.eyes[view.frame]), pixels).pictures == 0) continue;
        auto image = device.read_pixels();
        if (image) view.by_object = std::move(*image);
    }
}

Result<void> check_all(const StudyScene& scene, const StudyRequest& request, const Progress& progress,
                       std::vector<StudyCheck>& checks) {
    constexpr std::uint32_t compared = 20;
    CheckRequest check;
    check.width = request.width;
    check.height = request.height;
    check.backend = *request.backend;
    check.kind = request.kind;
    check.every = std::max(1U, static_cast<std::uint32_t>(scene.eyes.size()) / compared);
    CheckRequest far = check, published = check, objects = check;
    far.kind = PictureKind::quad;  // what meshes show does not depend on a plane
    far.plane = cache::PlanePlace::far_face;
    published.rules = cache::ValidityRules::published;
    objects.by_object = true;
    for (const auto& [what, one] : {std::pair{"cache", &check},
                                    {"planes_at_far_faces", &far},
                                    {"tests_of_1996", &published},
                                    {"a_picture_an_object", &objects}}) {
        auto checked = check_pictures(scene, *one, progress);
        if (!checked) return checked.error();
        checks.push_back({what, *checked});
    }
    return {};
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
        if (!frame.times) continue;
        ++sums.drawn;
        sums.faster += frame.times->cached.ms < frame.times->full.ms ? 1 : 0;
        sums.faster_cpu += frame.times->cached.cpu_ms < frame.times->full.cpu_ms ? 1 : 0;
        sums.cached.ms += frame.times->cached.ms;
        sums.cached.cpu_ms += frame.times->cached.cpu_ms;
        sums.full.ms += frame.times->full.ms;
        sums.full.cpu_ms += frame.times->full.cpu_ms;
        sums.pictures += frame.times->pictures;
        sums.meshes += frame.times->meshes;
        sums.mesh_triangles += frame.times->mesh_triangles;
        sums.made.made += frame.times->made.made;
        sums.made.too_dear += frame.times->made.too_dear;
        sums.made.read_texels += frame.times->made.read_texels;
        sums.made.making_cpu_ms += frame.times->made.making_cpu_ms;
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
    std::unique_ptr<StudyDevice> device = device_for(*scene, request, study);
    WalkOutputs outputs{request.pictures ? &study.sheet : nullptr, device.get(), request.views ? &study.views : nullptr};
    study.corrected = walk_by(*scene, pixels, options, progress, device ? "drawing" : "counting", outputs);
    if (device && request.views) draw_by_object(*device, *scene, pixels, study.views);
    device.reset();
    options.rules = cache::ValidityRules::published;
    study.published = walk_by(*scene, pixels, options, progress, "counting as in 1996", {});
    if (request.views && study.no_times.empty())
        if (auto checked = check_all(*scene, request, progress, study.checks); !checked) return checked.error();
    if (progress.stopped())
        return Error{request.study, "The study was stopped by the user, and nothing was written", "", ErrorKind::stopped};
    return study;
}

}  // namespace surefoot::cache_study
