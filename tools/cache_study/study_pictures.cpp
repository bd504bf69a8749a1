// Compares frames.
#include "tools/cache_study/study_pictures.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tools/cache_study/study_device.hpp"

namespace surefoot::cache_study {

namespace {

constexpr std::uint8_t half = 128, all_channels = 7;

std::uint8_t channels_on(const std::uint8_t* rgba) {
    return static_cast<std::uint8_t>((rgba[0] >= half ? 1 : 0) | (rgba[1] >= half ? 2 : 0) | (rgba[2] >= half ? 4 : 0));
}

/// Channels that are on, and off, somewhere in a pixel.
struct Seen {
    std::uint8_t on = 0, off = 0;
};

std::vector<Seen> seen_by_pixel(const gl::PixelImage& fine, std::uint32_t width, std::uint32_t height, std::uint32_t samples) {
    std::vector<Seen> seen(std::size_t{width} * height);
    for (std::uint32_t y = 0; y < height * samples; ++y) {
        for (std::uint32_t x = 0; x < width * samples; ++x) {
            const std::uint8_t on = channels_on(&fine.rgba[4 * (std::size_t{y} * fine.width + x)]);
            Seen& of = seen[std::size_t{y / samples} * width + x / samples];
            of.on |= on;
            of.off |= static_cast<std::uint8_t>(~on & all_channels);
        }
    }
    return seen;
}

using PixelCorners = std::array<dvec2, 3>;

/// False: a corner is not before the eye.
bool to_pixels(const cache::Triangle& triangle, const Pose& pose, model::Viewport viewport, PixelCorners& to) {
    const model::PictureExtent extent = model::picture_extent(pose, viewport);
    const dvec3 right = pose.right(), up = pose.up(), forward = pose.forward();
    for (std::size_t c = 0; c < 3; ++c) {
        const dvec3 ray = triangle[c] - pose.position;
        const double depth = glm::dot(ray, forward);
        if (!(depth > model::near_plane_m)) return false;
        to[c].x = 0.5 * viewport.width * (1 + glm::dot(ray, right) / (depth * extent.half_x));
        to[c].y = 0.5 * viewport.height * (1 - glm::dot(ray, up) / (depth * extent.half_y));
    }
    return true;
}

/// Whether a triangle reaches into a square.
bool reaches(const PixelCorners& corners, const dvec2& middle, double half_side) {
    const auto apart = [&](const dvec2& axis) {
        const double a = glm::dot(axis, corners[0] - middle), b = glm::dot(axis, corners[1] - middle),
                     c = glm::dot(axis, corners[2] - middle), reach = half_side * (std::abs(axis.x) + std::abs(axis.y));
        return std::min({a, b, c}) > reach || std::max({a, b, c}) < -reach;
    };
    if (apart({1, 0}) || apart({0, 1})) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        const dvec2 edge = corners[(i + 1) % 3] - corners[i];
        if (apart({-edge.y, edge.x})) return false;
    }
    return true;
}

}  // namespace

std::uint64_t uncovered_pixels(const StudyScene& scene, const Pose& pose, const gl::PixelImage& image, const WrongPixels& wrong) {
    constexpr double half_window_px = 1.5;
    std::vector<std::size_t> places;
    for (std::size_t at = 0; at < wrong.at.size(); ++at)
        if (wrong.at[at]) places.push_back(at);
    if (places.empty()) return 0;
    std::vector<Seen> near(places.size());
    for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
        PixelCorners corners;
        if (!to_pixels(scene.triangles[i], pose, {image.width, image.height}, corners)) continue;
        const dvec2 low = glm::min(glm::min(corners[0], corners[1]), corners[2]) - half_window_px;
        const dvec2 high = glm::max(glm::max(corners[0], corners[1]), corners[2]) + half_window_px;
        const std::uint8_t on = channels_on(full_colour(scene.objects[i]).data());
        for (std::size_t place = 0; place < places.size(); ++place) {
            const dvec2 middle = dvec2(places[place] % image.width, places[place] / image.width) + 0.5;
            if (middle.x < low.x || middle.y < low.y || middle.x > high.x || middle.y > high.y) continue;
            if (!reaches(corners, middle, half_window_px)) continue;
            near[place].on |= on;
            near[place].off |= static_cast<std::uint8_t>(~on & all_channels);
        }
    }
    std::uint64_t count = 0;
    for (std::size_t place = 0; place < places.size(); ++place) {
        const std::uint8_t on = channels_on(&image.rgba[4 * places[place]]);
        count += (on & ~near[place].on) == 0 && (~on & all_channels & ~near[place].off) == 0 ? 1 : 0;
    }
    return count;
}

WrongPixels wrong_pixels(const gl::PixelImage& image, const gl::PixelImage& fine) {
    WrongPixels result;
    const std::uint32_t width = image.width, height = image.height;
    const std::uint32_t samples = width > 0 ? fine.width / width : 0;
    if (samples == 0 || fine.width != width * samples || fine.height != height * samples) return result;
    const std::vector<Seen> seen = seen_by_pixel(fine, width, height, samples);
    result.at.resize(seen.size());
    for (std::uint32_t y = 1; y + 1 < height; ++y) {
        for (std::uint32_t x = 1; x + 1 < width; ++x) {
            Seen near;
            for (const std::uint32_t v : {y - 1, y, y + 1}) {
                for (const std::uint32_t u : {x - 1, x, x + 1}) {
                    near.on |= seen[std::size_t{v} * width + u].on;
                    near.off |= seen[std::size_t{v} * width + u].off;
                }
            }
            ++result.pixels;
            const std::size_t at = std::size_t{y} * width + x;
            const std::uint8_t on = channels_on(&image.rgba[4 * at]);
            const bool right = (on & ~near.on) == 0 && (~on & all_channels & ~near.off) == 0;
            result.at[at] = !right;
            result.wrong += right ? 0 : 1;
        }
    }
    return result;
}

Result<CheckedFrames> check_pictures(const StudyScene& scene, const CheckRequest& request, const Progress& progress) {
    DrawingOptions options;
    options.backend = request.backend;
    options.viewport = {request.width, request.height};
    options.colouring = Colouring::by_object;
    options.plane = request.plane;
    options.fov_y_rad = request.fov_y_rad;
    options.kind = request.kind;
    auto cached = StudyDevice::open(scene, options);
    if (!cached) return cached.error();
    const std::uint32_t samples = std::clamp(max_fine_px / std::max({request.width, request.height, 1U}), 1U, samples_a_side);
    options.viewport = {request.width * samples, request.height * samples};
    options.pictures = false;
    options.kind = PictureKind::quad;
    auto fine = StudyDevice::open(scene, options);
    if (!fine) return fine.error();
    CheckedFrames checked;
    cache::CacheState state = cache::empty_state(scene.tree);
    cache::CacheOptions cache_options;
    cache_options.rules = request.rules;
    cache::CacheView view;
    view.pixels = cache::pixel_angles((*cached)->pose_at(dvec3(0)), {request.width, request.height});
    const auto end = static_cast<std::uint32_t>(scene.eyes.size());
    const std::uint32_t last = request.frames == 0 ? end : std::min(end, request.first + request.frames);
    for (std::uint32_t frame = request.first; frame < last && !progress.stopped(); ++frame) {
        progress.update("comparing", static_cast<double>(frame - request.first) / (last - request.first));
        view.eye = scene.eyes[frame];
        view.frame = frame - request.first;
        const Pose pose = (*cached)->pose_at(view.eye);
        const bool compared = view.frame % request.every == request.every - 1;
        DrawnFrame drawn;
        (*cached)->use();
        if (!request.by_object) {
            cache::CachePlan plan = cache::plan_frame(scene.tree, view, cache_options, state);
            drawn = (*cached)->draw_cached(plan, pose, view.pixels);
            state = std::move(plan.after);
        } else if (compared) {
            drawn = (*cached)->draw_objects(pose, view.pixels);
        }
        if (!compared) continue;
        const auto image = (*cached)->read_pixels();
        (*fine)->use();
        (*fine)->draw_full(pose);
        const auto whole = (*fine)->read_pixels();
        if (!image) return image.error();
        if (!whole) return whole.error();
        const WrongPixels wrong = wrong_pixels(*image, *whole);
        ++checked.frames;
        checked.wrong_frames += wrong.wrong > 0 ? 1 : 0;
        checked.pixels += wrong.pixels;
        checked.wrong += wrong.wrong;
        checked.uncovered += uncovered_pixels(scene, pose, *image, wrong);
        checked.worst = std::max(checked.worst, wrong.wrong);
        checked.pictures += drawn.pictures;
        checked.leaves += drawn.leaves;
        checked.meshes += drawn.meshes;
    }
    return checked;
}

}  // namespace surefoot::cache_study
