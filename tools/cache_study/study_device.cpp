// Draws a study. A box has the layer of its number, so that no picture needs a place looked for.
#include "tools/cache_study/study_device.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <limits>

#include "render/effects/effects.hpp"

namespace surefoot::cache_study {

namespace {

constexpr std::array<float, 3> day_sky{0.62F, 0.76F, 0.90F};
/// Texels that a picture has free on each side.
constexpr double margin_texels = 1;
/// Drawn at once; with more, a frame waits.
constexpr std::uint32_t mesh_triangles_a_frame = 1U << 18U;
/// Pixels by which two neighbours may be apart: each may be one beside its place.
constexpr double gap_pixels = 2;

double clock_ms(clockid_t clock) {
    timespec now{};
    clock_gettime(clock, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Rounding in a driver parts the faces of two boxes by less.
constexpr double seam_pixels = 0.1;

/// By how much the box of a picture is grown for its capture, where its farthest point is so far away.
double grown_m(double far_m, const cache::PixelAngles& pixels, double texel_rad) {
    return far_m * (gap_pixels * pixels.smallest_rad + texel_rad);
}

/// Nothing is farther away from an eye.
double farthest_m(const StudyScene& scene) {
    Box all = scene.tree.boxes.front().box;
    for (const dvec3& eye : scene.eyes) all.grow(eye);
    return all.diagonal();
}

}  // namespace

Stopwatch::Stopwatch() : begun_{clock_ms(CLOCK_MONOTONIC), clock_ms(CLOCK_PROCESS_CPUTIME_ID)} {}

DrawTimes Stopwatch::spent() const {
    return {clock_ms(CLOCK_MONOTONIC) - begun_.ms, clock_ms(CLOCK_PROCESS_CPUTIME_ID) - begun_.cpu_ms};
}

StudyDevice::StudyDevice(const StudyScene& scene, const DrawingOptions& options, StudyModel made)
    : scene_(scene),
      options_(options),
      made_(std::move(made)),
      held_(scene.tree.boxes.size()),
      seam_m_(held_.size()),
      meshes_(held_.size(), options.kind) {}

Result<std::unique_ptr<StudyDevice>> StudyDevice::open(const StudyScene& scene, const DrawingOptions& options) {
    Pose view;
    view.fov_y_rad = options.fov_y_rad;
    const cache::PixelAngles pixels = cache::pixel_angles(view, options.viewport);
    std::unique_ptr<StudyDevice> study(new StudyDevice(
        scene, options, make_study_model(scene, options.colouring, grown_m(farthest_m(scene), pixels, pixels.smallest_rad))));
    gl::DeviceOptions device;
    device.kind = options.backend;
    device.viewport = options.viewport;
    device.sky = options.colouring == Colouring::shaded ? day_sky : std::array<float, 3>{0, 0, 0};
    const std::size_t layers = std::max(scene.tree.boxes.size(), study->made_.objects.size());
    device.picture_layers = options.pictures ? static_cast<std::uint32_t>(layers) : 0;
    device.mesh_triangles = study->meshes_.any() ? mesh_triangles_a_frame : 0;
    auto opened = gl::open_device(device);
    if (!opened) return opened.error();
    study->device_ = std::move(*opened);
    study->device_->draws.plays();
    if (auto loaded = study->device_->load(study->made_.model, effects::assemble_program); !loaded) return loaded.error();
    if (study->device_->picture_layers() < device.picture_layers)
        return Error{"image cache", study->device_->picture_reason(), "Use another --backend", ErrorKind::unsupported};
    if (study->meshes_.any() && !study->device_->draws_meshes())
        return Error{"image cache", study->device_->picture_reason(), "Use --kind quad", ErrorKind::unsupported};
    return study;
}

void StudyDevice::use() { device_->bind(); }

Pose StudyDevice::pose_at(const dvec3& eye) const {
    Pose pose;
    pose.position = eye;
    pose.fov_y_rad = options_.fov_y_rad;
    const dvec3 right = glm::normalize(glm::cross(scene_.forward, dvec3(0, 1, 0)));
    pose.orientation = glm::quat_cast(dmat3(right, glm::cross(right, scene_.forward), -scene_.forward));
    return pose;
}

model::Frustum StudyDevice::frustum_of(const Pose& pose) const {
    return model::make_frustum(pose, options_.viewport, model::far_corners_m(scene_.tree.boxes.front().box));
}

/// Captured is more than shown: neighbours that are displaced by other amounts than it leave no crack then. The square reaches
/// round the grown box, with a margin.
gl::CachePicture StudyDevice::captured_picture(const Box& box, const cache::Picture& picture, const cache::PixelAngles& pixels,
                                               std::uint32_t layer) const {
    gl::CachePicture shown;
    shown.place.layer = static_cast<std::uint16_t>(layer);
    shown.place.texels = static_cast<std::uint16_t>(picture.texels);
    shown.eye = picture.eye;
    shown.right = picture.right;
    shown.up = picture.up;
    shown.forward = picture.forward;
    shown.plane_m = picture.plane_m;
    if (options_.plane != cache::PlanePlace::harmonic_mean)
        if (const auto other = cache::picture_of(box, picture.eye, options_.plane)) shown.plane_m = other->plane_m;
    const double texel_rad = picture.side_m / (picture.texels * picture.plane_m);
    const dvec3 by(grown_m(picture.far_m, pixels, texel_rad));
    shown.box = {box.min - by, box.max + by};
    dvec2 low(std::numeric_limits<double>::infinity()), high = -low;
    for (unsigned i = 0; i < 8; ++i) {
        const dvec3 corner((i & 1U) != 0 ? shown.box.max.x : shown.box.min.x, (i & 2U) != 0 ? shown.box.max.y : shown.box.min.y,
                           (i & 4U) != 0 ? shown.box.max.z : shown.box.min.z);
        const dvec3 ray = corner - shown.eye;
        const dvec2 at =
            dvec2(glm::dot(ray, shown.right), glm::dot(ray, shown.up)) * (shown.plane_m / glm::dot(ray, shown.forward));
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    shown.side_m = std::max(high.x - low.x, high.y - low.y) * picture.texels / (picture.texels - 2 * margin_texels);
    shown.low_m = low - dvec2(margin_texels * shown.side_m / picture.texels);
    return shown;
}

/// Where the grown box is shown, what is cut off in its rim would stand before what is whole in its neighbour. So faces are those
/// of the box itself.
gl::CachePicture StudyDevice::shown_picture(cache::Index i) const {
    gl::CachePicture shown = held_[i];
    const Box& box = scene_.tree.boxes[i].box;
    const double by = seam_m_[i];
    shown.box = {box.min - by, box.max + by};
    return shown;
}

/// In the order in which boxes are drawn: that of their splits. A picture of pictures needs its rim too: there children are shown
/// as they were captured.
void StudyDevice::add_children(cache::Index parent, cache::Index first, std::uint32_t count, const dvec3& eye,
                               std::vector<gl::CachePicture>& to) const {
    const std::vector<cache::CacheBox>& boxes = scene_.tree.boxes;
    if (count == 1) {
        if (boxes[first].primitive_count == 0) return;
        gl::CachePicture& child = to.emplace_back(shown_picture(first));
        for (int axis = 0; axis < 3; ++axis) {
            if (boxes[first].box.min[axis] <= boxes[parent].box.min[axis]) child.box.min[axis] = held_[first].box.min[axis];
            if (boxes[first].box.max[axis] >= boxes[parent].box.max[axis]) child.box.max[axis] = held_[first].box.max[axis];
        }
        return;
    }
    const cache::Index beyond = first + count / 2;
    const dvec3 &low = boxes[first].box.min, &high = boxes[beyond].box.min;
    const int axis = high.x > low.x ? 0 : high.y > low.y ? 1 : 2;
    const bool low_is_farther = eye[axis] >= high[axis];
    add_children(parent, low_is_farther ? first : beyond, count / 2, eye, to);
    add_children(parent, low_is_farther ? beyond : first, count / 2, eye, to);
}

void StudyDevice::capture(const Pose& pose, const gl::CachePicture& picture, const std::vector<gl::DrawItem>& items,
                          const std::vector<gl::CachePicture>& children, std::span<float> depths) {
    device_->draws.plays();
    for (const bool again : {false, true}) {
        if (depths.empty() ? device_->capture_picture(picture, items, children) : device_->capture_depths(picture, items, depths))
            return;
        if (!again) device_->begin_frame(pose);  // all that wait are drawn: there is room again
    }
}

void StudyDevice::make_pictures(const cache::CachePlan& plan, const Pose& pose, const cache::PixelAngles& pixels) {
    static const std::vector<gl::DrawItem> no_items;
    children_.assign(plan.refreshes.size(), {});
    for (std::size_t i = 0; i < plan.refreshes.size(); ++i) {
        const cache::Refresh& refresh = plan.refreshes[i];
        const cache::CacheBox& box = scene_.tree.boxes[refresh.box];
        const cache::Picture& picture = plan.after.pictures[refresh.box];
        if (refresh.from_children) add_children(refresh.box, box.first_child, box.child_count, picture.eye, children_[i]);
        held_[refresh.box] = captured_picture(box.box, picture, pixels, refresh.box);
        seam_m_[refresh.box] = seam_pixels * pixels.smallest_rad * picture.far_m;
        std::span<float> depths;
        if (refresh.from_children)
            meshes_.drop(refresh.box);
        else if (meshes_.any())
            depths = meshes_.depths_of(refresh.box, picture.texels);
        capture(pose, held_[refresh.box], refresh.from_children ? no_items : made_.of_captured[refresh.box], children_[i],
                depths);
    }
}

/// Captures that wait are drawn, and their depths are there.
void StudyDevice::begin(const Pose& pose) {
    device_->draws.plays();
    device_->begin_frame(pose);
    items_.clear();
    pictures_.clear();
    shown_meshes_.clear();
}

void StudyDevice::finish() {
    device_->draws.plays();
    device_->draw(items_);
    std::reverse(shown_meshes_.begin(), shown_meshes_.end());  // the nearest first
    device_->draw_picture_meshes(shown_meshes_);
    device_->end_slice();
    device_->draw_pictures(pictures_);
    device_->end_slice();
    device_->end_items();
    device_->finish_frame();
}

/// A box's picture, by the kind that is chosen.
void StudyDevice::show(cache::Index box, const cache::Picture& picture, const Pose& pose, DrawnFrame& drawn) {
    const gl::CachePicture shown = shown_picture(box);
    StudyMeshes::Seen seen;
    const double pixel_rad = model::pixel_angle(pose, options_.viewport);
    const double texel_rad = cache::texel_rad(picture, pose.position);
    seen.faces_px = cache::faces_sr(shown.box, pose.position) / (pixel_rad * pixel_rad);
    seen.texels_px = texel_rad * texel_rad / (pixel_rad * pixel_rad);
    ++drawn.pictures;
    if (!meshes_.shows(box, held_[box], picture, seen)) {
        pictures_.push_back(shown);
        return;
    }
    shown_meshes_.push_back(meshes_.mesh(box, held_[box]));
    ++drawn.meshes;
    drawn.mesh_triangles += shown_meshes_.back().indices.size() / 3;
}

DrawnFrame StudyDevice::draw_cached(const cache::CachePlan& plan, const Pose& pose, const cache::PixelAngles& pixels) {
    const Stopwatch watch;
    make_pictures(plan, pose, pixels);
    begin(pose);
    const model::Frustum frustum = frustum_of(pose);
    DrawnFrame drawn;
    for (const cache::BoxDraw& draw : plan.draws) {
        if (!model::visible(frustum, scene_.tree.boxes[draw.box].box)) continue;
        if (draw.picture) {
            show(draw.box, plan.after.pictures[draw.box], pose, drawn);
            continue;
        }
        ++drawn.leaves;
        items_.push_back(made_.of_leaf[draw.box]);
    }
    finish();
    drawn.times = watch.spent();
    drawn.made = meshes_.take_counts();
    return drawn;
}

DrawTimes StudyDevice::draw_full(const Pose& pose) {
    const Stopwatch watch;
    const model::Frustum frustum = frustum_of(pose);
    begin(pose);
    for (const StudyObject& part : made_.whole)
        if (model::visible(frustum, part.box)) items_.push_back(part.item);
    finish();
    return watch.spent();
}

DrawnFrame StudyDevice::draw_objects(const Pose& pose, const cache::PixelAngles& pixels) {
    const Stopwatch watch;
    std::vector<gl::DrawItem> near;
    std::vector<std::vector<gl::DrawItem>> captured(made_.objects.size());
    std::vector<gl::CachePicture> shown;
    for (std::size_t i = 0; i < made_.objects.size(); ++i) {
        const StudyObject& object = made_.objects[i];
        auto picture = cache::picture_of(object.box, pose.position);
        constexpr std::uint32_t texels = gl::picture_layer_px;
        if (!picture || cache::needed_texels(*picture, pixels.smallest_rad) > texels) {
            near.push_back(object.item);
            continue;
        }
        picture->texels = texels;
        captured[i].push_back(object.item);
        shown.push_back(captured_picture(object.box, *picture, pixels, static_cast<std::uint32_t>(i)));
        capture(pose, shown.back(), captured[i], {}, {});
    }
    std::sort(shown.begin(), shown.end(),
              [](const gl::CachePicture& a, const gl::CachePicture& b) { return a.plane_m > b.plane_m; });
    begin(pose);
    items_ = near;
    pictures_ = shown;
    finish();
    DrawnFrame drawn;
    drawn.times = watch.spent();
    drawn.pictures = static_cast<std::uint32_t>(shown.size());
    drawn.leaves = static_cast<std::uint32_t>(near.size());
    return drawn;
}

Result<gl::PixelImage> StudyDevice::read_pixels() {
    device_->draws.plays();
    return device_->read_pixels();
}

}  // namespace surefoot::cache_study
