// Chooses the occluders to draw, joins them to surfaces, and tests boxes against them. occlusion_pixels.cpp fills the pixels.
#include "render/prepare/occlusion.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::prepare {

namespace {

constexpr float behind_m = 0.01F;         ///< what is drawn lies farther in front of the eye; here depths are cut off
constexpr float min_solid_angle = 6e-4F;  ///< about a pixel: less fills none
constexpr double margin_rad = 0.15;       ///< beside the view, for what is seen past its edge from beside the middle
constexpr double widest_half_rad = 80.0 / 180.0 * 3.14159265358979323846;
constexpr float depth_slack = 1e-4F;  ///< of a depth: rounding, and up to 3e-5 by which draw/coincidence.hpp moves surfaces
constexpr float rounding = 1e-6F;     ///< of lengths in float
/// How a box is taken apart. deep: the ratio of depths beyond which its parts are looked at; max_pixels: the same of their
/// number.
struct PartLimits {
    float deep;
    int max_pixels, max_parts;
    std::size_t max_stack;
};
constexpr PartLimits usual_parts{1.25F, 1 << 30, 40, 12};
/// The outer side of a wall lies right behind its inner side: only small parts show that. It takes microseconds a box.
constexpr PartLimits parts_behind_rooms{1.02F, 32, 1000, 40};
constexpr double far_m = 1e6;  ///< for the frustum's second test only: it has no far plane
constexpr std::uint32_t no_triangle = 0xffffffffU;

std::uint8_t side_of(std::uint32_t from, std::uint32_t to) { return from < to ? 1 : 2; }

}  // namespace

void Occlusion::Rect::grow(const Rect& r) {
    x0 = std::min(x0, r.x0);
    x1 = std::max(x1, r.x1);
    y0 = std::min(y0, r.y0);
    y1 = std::max(y1, r.y1);
}

Occlusion::Occlusion(const Occluders& occluders) : occluders_(occluders) {
    if (occluders.triangles.empty()) return;
    constexpr std::size_t pixel_count = static_cast<std::size_t>(columns) * rows;
    for (auto* plane : {&depth_, &covered_, &crossed_, &eroded_, &length_}) plane->resize(pixel_count);
    tiles_.resize(pixel_count / (tile * tile));
    facing_.reserve(occluders.triangles.size());
    drawn_.reserve(max_drawn);
    order_.reserve(max_drawn);
    surface_nearest_.resize(max_drawn);
    first_at_edge_.resize(occluders.edge_count, no_triangle);
    edge_sides_.resize(occluders.edge_count);
}

vec3 Occlusion::to_view(const dvec3& world) const {
    const dvec3 d = world - eye_;
    return {glm::dot(d, right_), glm::dot(d, up_), glm::dot(d, forward_)};
}

/// False where the view is too wide for one plane of pixels.
bool Occlusion::aim(const Region& region, model::Viewport viewport) {
    const Pose& pose = region.centre;
    const model::HalfAngles half = model::half_angles(pose, viewport, region.angle_rad + margin_rad);
    if (!(half.x < widest_half_rad && half.y < widest_half_rad)) return false;
    eye_ = pose.position;
    right_ = pose.right();
    up_ = pose.up();
    forward_ = pose.forward();
    frustum_ = model::make_frustum(pose, viewport, far_m, region.radius_m, region.angle_rad);
    radius_m_ = static_cast<float>(region.radius_m);
    clamp_from_m_ = static_cast<float>(region.radius_m / std::sin(margin_rad));
    const auto wide = static_cast<float>(std::tan(half.x)), high = static_cast<float>(std::tan(half.y));
    if (wide == wide_ && high == high_) return true;
    wide_ = wide;
    high_ = high;
    half_column_ = wide_ / columns;
    half_row_ = high_ / rows;
    pixel_rad_ = std::sqrt(half_column_ * half_column_ + half_row_ * half_row_) * (1.0F + edge_slack);
    pixel_turn_ = Turn::of_sine(std::min(1.0F, pixel_rad_));
    const float corner = std::sqrt(wide_ * wide_ + high_ * high_);  // a tangent
    corner_turn_ = Turn::of_tangent(corner).plus(pixel_turn_);
    for (int y = 0; y < rows; ++y) {
        const float ty = static_cast<float>(2 * y + 1) * half_row_ - high_;
        for (int x = 0; x < columns; ++x) {
            const float tx = static_cast<float>(2 * x + 1) * half_column_ - wide_;
            length_[pixel(x, y)] = std::sqrt(tx * tx + ty * ty + 1.0F);
        }
    }
    return true;
}

/// Chooses occluders that face every eye of the region, largest in the view first, and notes their shared edges.
void Occlusion::choose() {
    facing_.clear();
    drawn_.clear();
    // The near plane would cut off a nearer occluder, so it must be farther than that from every eye.
    const double wide = wide_, high = high_;
    const double min_away = static_cast<double>(radius_m_) + model::near_plane_m * std::sqrt(1.0 + wide * wide + high * high);
    const double side_x = std::sqrt(1.0 + wide * wide), side_y = std::sqrt(1.0 + high * high);
    const auto beside = [&](const vec3& at, double radius) {
        return static_cast<double>(std::abs(at.x) - wide_ * at.z) > radius * side_x ||
               static_cast<double>(std::abs(at.y) - high_ * at.z) > radius * side_y;
    };
    for (std::uint32_t i = 0; i < occluders_.triangles.size(); ++i) {
        const Occluder& o = occluders_.triangles[i];
        const double away = glm::dot(o.normal, eye_) - o.offset;
        const bool from_behind = away < 0;
        if (!(std::abs(away) > min_away) || (from_behind && !o.two_sided)) continue;
        const dvec3 d = o.centre - eye_;
        const double square = glm::dot(d, d);
        const auto solid_angle = static_cast<float>(o.area_m2 * std::abs(away) / (square * std::sqrt(square)));
        if (!(solid_angle > min_solid_angle) || beside(to_view(o.centre), o.radius_m)) continue;
        facing_.push_back({solid_angle, i, from_behind});
    }
    const auto more = [](const Facing& a, const Facing& b) {
        return a.solid_angle != b.solid_angle ? a.solid_angle > b.solid_angle : a.triangle < b.triangle;
    };
    if (facing_.size() > max_drawn) {
        std::nth_element(facing_.begin(), facing_.begin() + max_drawn, facing_.end(), more);
        facing_.resize(max_drawn);
        std::sort(facing_.begin(), facing_.end(), [](const Facing& a, const Facing& b) { return a.triangle < b.triangle; });
    }
    for (const Facing& facing : facing_) place(facing);
}

void Occlusion::place(const Facing& facing) {
    const Occluder& o = occluders_.triangles[facing.triangle];
    Drawn d;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t from = facing.from_behind ? 2 - k : k;
        d.corner[k] = o.corners[from];
        d.edge[k] = o.edges[facing.from_behind ? (from + 2) % 3 : from];
        d.at[k] = to_view(occluders_.corners[d.corner[k]]);
    }
    const auto outside = [&](const vec3& plane) {
        return glm::dot(plane, d.at[0]) < 0 && glm::dot(plane, d.at[1]) < 0 && glm::dot(plane, d.at[2]) < 0;
    };
    if (outside({0, 0, 1}) || outside({1, 0, wide_}) || outside({-1, 0, wide_}) || outside({0, 1, high_}) ||
        outside({0, -1, high_}))
        return;
    const double away = glm::dot(o.normal, eye_) - o.offset;
    d.inverse_depth = vec3(dvec3(glm::dot(o.normal, right_), glm::dot(o.normal, up_), glm::dot(o.normal, forward_)) / -away);
    const float min_z = std::min({d.at[0].z, d.at[1].z, d.at[2].z}), max_z = std::max({d.at[0].z, d.at[1].z, d.at[2].z});
    if (!(max_z > behind_m)) return;
    d.nearest = 1.0F / std::max(min_z, behind_m);
    d.farthest = 1.0F / max_z;
    d.surface = static_cast<std::uint32_t>(drawn_.size());
    for (std::size_t k = 0; k < 3; ++k) edge_sides_[d.edge[k]] |= side_of(d.corner[k], d.corner[(k + 1) % 3]);
    drawn_.push_back(d);
}

std::uint32_t Occlusion::surface_of(std::uint32_t drawn) {
    while (drawn_[drawn].surface != drawn) {
        drawn_[drawn].surface = drawn_[drawn_[drawn].surface].surface;
        drawn = drawn_[drawn].surface;
    }
    return drawn;
}

/// A surface goes on across an edge that has triangles on both sides, as seen; the order is nearest surface first.
void Occlusion::join() {
    order_.clear();
    const auto count = static_cast<std::uint32_t>(drawn_.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        order_.push_back(i);
        for (const std::uint32_t edge : drawn_[i].edge) {
            if (edge_sides_[edge] != 3) continue;
            if (first_at_edge_[edge] == no_triangle)
                first_at_edge_[edge] = i;
            else
                drawn_[surface_of(i)].surface = surface_of(first_at_edge_[edge]);
        }
    }
    for (std::uint32_t i = 0; i < count; ++i) surface_nearest_[i] = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        for (const std::uint32_t edge : drawn_[i].edge) first_at_edge_[edge] = no_triangle;
        float& nearest = surface_nearest_[surface_of(i)];
        nearest = std::max(nearest, drawn_[i].nearest);
        drawn_[i].surface = surface_of(i);
    }
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
        const std::uint32_t sa = drawn_[a].surface, sb = drawn_[b].surface;
        if (sa == sb) return a < b;
        return surface_nearest_[sa] != surface_nearest_[sb] ? surface_nearest_[sa] > surface_nearest_[sb] : sa < sb;
    });
}

Occlusion::Rect Occlusion::pixels(float x0, float x1, float y0, float y1) const {
    if (!(x1 >= -wide_ && x0 <= wide_ && y1 >= -high_ && y0 <= high_)) return {};
    const auto at = [](float tangent, float limit, float half, int count) {
        const float inside = (std::clamp(tangent, -limit, limit) + limit) / (2.0F * half);
        return std::clamp(static_cast<int>(inside), 0, count - 1);
    };
    return {at(x0 - edge_slack * half_column_, wide_, half_column_, columns),
            at(x1 + edge_slack * half_column_, wide_, half_column_, columns),
            at(y0 - edge_slack * half_row_, high_, half_row_, rows), at(y1 + edge_slack * half_row_, high_, half_row_, rows)};
}

Occlusion::Rect Occlusion::rect_of(const Drawn& triangle) const {
    float x0 = beyond, x1 = -beyond, y0 = beyond, y1 = -beyond;
    const auto take = [&](const vec3& p) {
        x0 = std::min(x0, p.x / p.z);
        x1 = std::max(x1, p.x / p.z);
        y0 = std::min(y0, p.y / p.z);
        y1 = std::max(y1, p.y / p.z);
    };
    for (std::size_t k = 0; k < 3; ++k) {  // no point of the view that is nearer than behind_m lies on it
        const vec3 &a = triangle.at[k], &b = triangle.at[(k + 1) % 3];
        if (a.z >= behind_m) take(a);
        if ((a.z >= behind_m) == (b.z >= behind_m)) continue;
        vec3 cut = a + (behind_m - a.z) / (b.z - a.z) * (b - a);
        cut.z = behind_m;
        take(cut);
    }
    return pixels(x0, x1, y0, y1);
}

bool Occlusion::nearer_than(float inverse_depth, const Rect& rect) const {
    for (int ty = rect.y0 / tile; ty <= rect.y1 / tile; ++ty) {
        for (int tx = rect.x0 / tile; tx <= rect.x1 / tile; ++tx) {
            if (tiles_[tile_at(tx, ty)] > inverse_depth) continue;
            const int y1 = std::min(rect.y1, ty * tile + tile - 1), x1 = std::min(rect.x1, tx * tile + tile - 1);
            for (int y = std::max(rect.y0, ty * tile); y <= y1; ++y) {
                for (int x = std::max(rect.x0, tx * tile); x <= x1; ++x) {
                    if (!(depth_[pixel(x, y)] > inverse_depth)) return false;
                }
            }
        }
    }
    return true;
}

void Occlusion::draw_surface(std::span<const std::uint32_t> members) {
    Rect rect;
    for (const std::uint32_t i : members) rect.grow(rect_of(drawn_[i]));
    if (rect.empty() || nearer_than(surface_nearest_[drawn_[members.front()].surface], rect)) return;
    begin_surface(rect);
    for (const std::uint32_t i : members) {
        const Rect own = rect_of(drawn_[i]);
        if (!own.empty()) fill(drawn_[i], own);
    }
    for (const std::uint32_t i : members) {
        const Drawn& d = drawn_[i];
        for (std::size_t k = 0; k < 3; ++k) {
            if (edge_sides_[d.edge[k]] != 3) erode(d.at[k], d.at[(k + 1) % 3], rect);
        }
    }
    end_surface(rect);
    empty_ = false;
}

void Occlusion::draw(const Region& region, model::Viewport viewport) {
    empty_ = true;
    if (occluders_.triangles.empty() || !aim(region, viewport)) return;
    std::fill(depth_.begin(), depth_.end(), 0.0F);
    std::fill(tiles_.begin(), tiles_.end(), 0.0F);
    choose();
    join();
    work_ = 0;
    for (std::size_t at = 0; at < order_.size() && work_ < max_work;) {  // the nearest surfaces hide most
        std::size_t end = at;
        while (end < order_.size() && drawn_[order_[end]].surface == drawn_[order_[at]].surface) ++end;
        draw_surface(std::span(order_).subspan(at, end - at));
        at = end;
    }
    for (const Drawn& d : drawn_)
        for (const std::uint32_t edge : d.edge) edge_sides_[edge] = 0;
}

bool Occlusion::hides(const Box& box) const {
    std::uint32_t parts = parts_behind_rooms.max_parts;
    return hides(box, parts);
}

bool Occlusion::hides(const Box& box, std::uint32_t& parts) const {
    if (empty_ || box.empty()) return false;
    if (!(box.distance(eye_) > static_cast<double>(radius_m_))) return false;
    // A large box is hidden where its parts are, each at a depth of its own.
    const PartLimits& limits = occluders_.has_rooms ? parts_behind_rooms : usual_parts;
    std::array<Box, parts_behind_rooms.max_stack> stack;
    std::size_t top = 0;
    stack[top++] = box;
    for (int tests = 0; top > 0; ++tests) {
        const Box part = stack[--top];
        if (occluders_.has_rooms && tests > usual_parts.max_parts) {
            if (parts == 0) return false;
            --parts;
        }
        const Hidden found = look(part);
        if (found == Hidden::yes) continue;
        if (found == Hidden::no || tests == limits.max_parts || top + 2 > limits.max_stack) return false;
        // Across the axis that adds most to its depth.
        const dvec3 size = (part.max - part.min) * (glm::abs(forward_) + 0.1);
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.z >= size.y ? 2 : 1;
        const double middle = 0.5 * (part.min[axis] + part.max[axis]);
        Box low = part, high = part;
        low.max[axis] = high.min[axis] = middle;
        const bool low_first = eye_[axis] < middle;  // what is nearest is seen soonest
        stack[top++] = low_first ? high : low;
        stack[top++] = low_first ? low : high;
    }
    return true;
}

Occlusion::Hidden Occlusion::look(const Box& box) const {
    const vec3 centre = to_view(box.centre());
    const dvec3 half = box.half();
    const auto extent = [&](const dvec3& axis) { return vec3(axis * half); };
    const vec3 r = extent(right_), u = extent(up_), f = extent(forward_);
    const auto reach = [](const vec3& v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    const float rough = rounding * (reach(centre) + reach(r) + reach(u) + reach(f));
    const float nearest = centre.z - reach(f) - rough, farthest = centre.z + reach(f);
    if (!(nearest > behind_m)) return model::visible(frustum_, box) ? Hidden::in_parts : Hidden::yes;
    float x0 = beyond, x1 = -beyond, y0 = beyond, y1 = -beyond;
    for (int corner = 0; corner < 8; ++corner) {
        const vec3 sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
        const float z = std::max(centre.z + glm::dot(sign, f), behind_m);
        const float x = (centre.x + glm::dot(sign, r)) / z, y = (centre.y + glm::dot(sign, u)) / z;
        x0 = std::min(x0, x);
        x1 = std::max(x1, x);
        y0 = std::min(y0, y);
        y1 = std::max(y1, y);
    }
    const float rim = rough / nearest;
    x0 -= rim;
    x1 += rim;
    y0 -= rim;
    y1 += rim;
    const bool reaches_out = x0 < -wide_ || x1 > wide_ || y0 < -high_ || y1 > high_;
    if (reaches_out && !model::visible(frustum_, box)) return Hidden::yes;
    // What of it lies outside the buffer is seen by no eye of the region, unless it is so near that one beside the middle sees
    // it.
    const bool sure = !reaches_out || box.distance(eye_) > static_cast<double>(clamp_from_m_) * 1.001;
    const Rect rect = pixels(x0, x1, y0, y1);
    if (sure && !rect.empty() && nearer_than(1.0F / (nearest * (1.0F - depth_slack)), rect)) return Hidden::yes;
    if (!occluders_.has_rooms) return farthest > usual_parts.deep * nearest || reaches_out ? Hidden::in_parts : Hidden::no;
    if (!model::visible(frustum_, box)) return Hidden::yes;
    const PartLimits& limits = parts_behind_rooms;
    const int pixels_seen = rect.empty() ? 0 : (rect.x1 - rect.x0 + 1) * (rect.y1 - rect.y0 + 1);
    const bool large = farthest > limits.deep * nearest || reaches_out || pixels_seen > limits.max_pixels;
    return large ? Hidden::in_parts : Hidden::no;
}

}  // namespace surefoot::prepare
