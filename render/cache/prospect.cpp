// Where a picture is to be seen from, how many texels it takes, and how long it lives.
#include "render/cache/prospect.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::cache {

namespace {

constexpr std::array<std::uint32_t, 3> sides = {64, 128, 256};
constexpr double rim_texels = 1;
constexpr int tries = 5, halvings = 7;
constexpr double used_at_first = 0.9;  ///< of the error that a picture may have, which it has at first

bool fits_at(const Picture& picture, const EyeCourse& course, double max_rad, double frames) {
    return valid_around(picture, course.eye + course.step_m * frames, course.radius_m, max_rad);
}

/// Gives the picture its rim and the fewest texels that are fine enough from the eye. False: none are.
bool choose_texels(Picture& picture, const dvec3& eye, double max_rad) {
    const Picture window = picture;
    for (const std::uint32_t texels : sides) {
        const double inner = texels - 2 * rim_texels;
        picture = window;
        picture.texels = texels;
        picture.side_m = window.side_m * texels / inner;
        picture.low_m = window.low_m - dvec2(window.side_m * rim_texels / inner);
        if (texel_rad(picture, eye) <= max_rad) return true;
    }
    return false;
}

}  // namespace

double life_of(const Picture& picture, const EyeCourse& course, double max_rad) {
    if (!fits_at(picture, course, max_rad, 0)) return -1;
    if (fits_at(picture, course, max_rad, course.max_frames)) return course.max_frames;
    double lives = 0, fails = course.max_frames;
    for (int i = 0; i < halvings; ++i) {
        const double middle = 0.5 * (lives + fails);
        (fits_at(picture, course, max_rad, middle) ? lives : fails) = middle;
    }
    return lives;
}

double grown_for(const Box& box, const dvec3& eye, double max_rad) {
    return max_rad * (glm::length(box.centre() - eye) + 0.5 * box.diagonal());
}

std::optional<Prospect> prospect_of(const Box& box, const EyeCourse& course, double max_rad) {
    if (!(max_rad > 0)) return std::nullopt;
    // Most boxes are too near: their sides say so before anything is worked out.
    const dvec3 to_middle = box.centre() - course.eye;
    const double distance = glm::length(to_middle), half = 0.5 * box.diagonal();
    if (!std::isfinite(distance) || !(distance > half)) return std::nullopt;
    const double widest = std::max({box.half().x, box.half().y, box.half().z});
    if (widest > max_rad * sides.back() * (distance + half)) return std::nullopt;
    Prospect found;
    found.grown_m = grown_for(box, course.eye, max_rad);
    found.box = {box.min - dvec3(found.grown_m), box.max + dvec3(found.grown_m)};
    const auto from_here = picture_of(found.box, course.eye);
    if (!from_here) return std::nullopt;
    const double a_frame = picture_errors(*from_here, course.eye + course.step_m).total();
    const double around = picture_errors(*from_here, course.eye, course.radius_m).total();
    const double left = used_at_first * max_rad - around;
    if (!(left > 0)) return std::nullopt;
    double ahead = a_frame > 0 ? std::min(left / a_frame, 0.5 * course.max_frames) : 0.0;
    for (int i = 0; i < tries; ++i, ahead = i + 1 < tries ? 0.6 * ahead : 0.0) {
        const dvec3 from = course.eye + course.step_m * ahead;
        auto picture = picture_of(found.box, from);
        if (!picture || !choose_texels(*picture, course.eye + course.step_m * (2 * ahead), max_rad)) continue;
        if (!fits_at(*picture, course, max_rad, 0)) continue;
        found.picture = *picture;
        found.life_frames = life_of(*picture, course, max_rad);
        return found;
    }
    return std::nullopt;
}

}  // namespace surefoot::cache
