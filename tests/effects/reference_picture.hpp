// The reference for pictures: projects, clips and fills triangles one by one, in double (shading: reference_shading.hpp).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/effects/reference_shading.hpp"

namespace surefoot::reference {

constexpr double near_m = 0.05;  ///< what is nearer along the view direction is cut off

/// The picture: row 0 on top.
struct Picture {
    std::uint32_t width = 0, height = 0;
    std::vector<dvec3> colours;       ///< 0..1
    std::vector<double> nearness;     ///< 1 / depth of what is opaque; 0 where there is nothing
    std::vector<std::uint64_t> seen;  ///< a number for what a pixel shows: surface and mip level, with what is blended over it
    std::vector<bool> close_call;     ///< a mask's hole, or the other side of a sheet, may begin here or beside it

    /// Whether the 3 x 3 pixels about one do not all show the same, or it is not sure what this one shows.
    [[nodiscard]] bool is_edge(std::uint32_t x, std::uint32_t y) const {
        const std::uint64_t here = seen[std::size_t{y} * width + x];
        if (close_call[std::size_t{y} * width + x]) return true;
        for (std::uint32_t row = std::max(y, 1U) - 1; row <= std::min(y + 1, height - 1); ++row) {
            for (std::uint32_t column = std::max(x, 1U) - 1; column <= std::min(x + 1, width - 1); ++column)
                if (seen[std::size_t{row} * width + column] != here) return true;
        }
        return false;
    }
};

/// A corner on the picture.
struct ScreenCorner {
    dvec2 at{0.0};        ///< pixels, from the upper left
    double nearness = 0;  ///< 1 / depth: varies evenly on the picture
    Corner corner;
};

inline Surface operator*(double share, const Surface& s) {
    return {share * s.normal,       share * s.hidden,      share * s.sun,          share * s.lamps_before,
            share * s.lamps_behind, share * s.picture_sun, share * s.picture_lamps};
}
inline Surface operator+(const Surface& a, const Surface& b) {
    return {a.normal + b.normal,
            a.hidden + b.hidden,
            a.sun + b.sun,
            a.lamps_before + b.lamps_before,
            a.lamps_behind + b.lamps_behind,
            a.picture_sun + b.picture_sun,
            a.picture_lamps + b.picture_lamps};
}
inline Corner operator*(double share, const Corner& c) {
    return {share * c.from_eye, share * c.colour, share * c.uv, share * c.surface};
}
inline Corner operator+(const Corner& a, const Corner& b) {
    return {a.from_eye + b.from_eye, a.colour + b.colour, a.uv + b.uv, a.surface + b.surface};
}

/// What of a triangle lies beyond the near plane. It always cuts from the kept corner to the lost one: neighbours get the same
/// points.
inline std::vector<Corner> clip(const std::array<Corner, 3>& triangle, const dvec3& forward) {
    std::vector<Corner> kept;
    const auto beyond = [&](const Corner& c) { return glm::dot(c.from_eye, forward) - near_m; };
    const auto cut = [&](const Corner& in, const Corner& out) {
        const double share = beyond(in) / (beyond(in) - beyond(out));
        kept.push_back((1.0 - share) * in + share * out);
    };
    for (std::size_t i = 0; i < 3; ++i) {
        const Corner &here = triangle[i], &next = triangle[(i + 1) % 3];
        const bool is_in = beyond(here) >= 0, next_is_in = beyond(next) >= 0;
        if (is_in) kept.push_back(here);
        if (is_in && !next_is_in) cut(here, next);
        if (!is_in && next_is_in) cut(next, here);
    }
    return kept;
}

inline ScreenCorner project(const View& view, const Corner& corner) {
    const double width = view.viewport.width, height = view.viewport.height;
    const double half_y = std::tan(0.5 * view.pose.fov_y_rad), half_x = half_y * width / height;
    const double depth = glm::dot(corner.from_eye, view.pose.forward());
    const double x = glm::dot(corner.from_eye, view.pose.right()) / (depth * half_x);
    const double y = glm::dot(corner.from_eye, view.pose.up()) / (depth * half_y);
    return {dvec2(0.5 * (1.0 + x) * width, 0.5 * (1.0 - y) * height), 1.0 / depth, corner};
}

/// Twice the area of a, b, p. Swapping a and b changes its sign and nothing else: neighbours agree about their common edge.
inline double area_of(const dvec2& a, const dvec2& b, const dvec2& p) {
    if (b.x < a.x || (b.x == a.x && b.y < a.y)) return -area_of(b, a, p);
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// A triangle on the picture. Its corners stand clockwise as they are seen, so that its area is positive.
struct ScreenTriangle {
    std::array<ScreenCorner, 3> corners;

    [[nodiscard]] double area_beside(std::size_t i, const dvec2& p) const {
        return area_of(corners[(i + 1) % 3].at, corners[(i + 2) % 3].at, p);
    }
    /// A centre on a common edge belongs to one of the two: the one to the right of the edge, or below it.
    [[nodiscard]] bool covers(const dvec2& p) const {
        for (std::size_t i = 0; i < 3; ++i) {
            const dvec2 along = corners[(i + 2) % 3].at - corners[(i + 1) % 3].at;
            const bool owns = along.y < 0 || (along.y == 0 && along.x > 0);
            const double area = area_beside(i, p);
            if (area < 0 || (area == 0 && !owns)) return false;
        }
        return true;
    }
    [[nodiscard]] ScreenCorner at(const dvec2& p) const {
        ScreenCorner out{p, 0, {}};
        const double area = area_of(corners[0].at, corners[1].at, corners[2].at);
        for (std::size_t i = 0; i < 3; ++i) {
            const double share = area_beside(i, p) / area * corners[i].nearness;
            out.nearness += share;
            out.corner = out.corner + share * corners[i].corner;
        }
        out.corner = (1.0 / out.nearness) * out.corner;
        return out;
    }
    [[nodiscard]] dvec2 uv_at(const dvec2& p) const {
        dvec2 uv(0.0);
        double nearness = 0;
        const double area = area_of(corners[0].at, corners[1].at, corners[2].at);
        for (std::size_t i = 0; i < 3; ++i) {
            const double share = area_beside(i, p) / area * corners[i].nearness;
            nearness += share;
            uv += share * corners[i].corner.uv;
        }
        return (1.0 / nearness) * uv;
    }
};

/// A part that is drawn, and its place in the order of blended parts.
struct DrawnPart {
    double distance_m = 0;  ///< from the eye to the middle of its node's box
    model::Index node = 0, part = 0, placement = 0;
    bool captured = false;  ///< a picture that holds the light of the bake
};

/// Draws one pixel. Blended surfaces are hidden by opaque ones, and hide nothing themselves.
inline void put(Picture& picture, std::size_t at, double nearness, const dvec4& colour, bool blended, std::uint64_t seen) {
    if (nearness <= picture.nearness[at]) return;
    picture.colours[at] = (1.0 - colour.a) * picture.colours[at] + colour.a * dvec3(colour);
    picture.seen[at] = colour.a < 1 - 1e-6 ? 0x9e3779b97f4a7c15U * (picture.seen[at] + 1) + seen : seen;
    if (!blended) picture.nearness[at] = nearness;
}

inline void fill(Picture& picture, const View& view, const model::Material& material, const ScreenTriangle& triangle,
                 std::uint64_t surface) {
    dvec2 low(triangle.corners[0].at), high(low);
    for (const ScreenCorner& corner : triangle.corners) low = glm::min(low, corner.at), high = glm::max(high, corner.at);
    const auto pixel = [](double at, std::uint32_t end) { return static_cast<std::uint32_t>(std::clamp<double>(at, 0, end)); };
    for (std::uint32_t y = pixel(low.y, picture.height); y < pixel(high.y + 1, picture.height); ++y) {
        for (std::uint32_t x = pixel(low.x, picture.width); x < pixel(high.x + 1, picture.width); ++x) {
            const dvec2 centre(x + 0.5, y + 0.5), right(0.5, 0), below(0, 0.5);
            if (!triangle.covers(centre)) continue;
            const ScreenCorner here = triangle.at(centre);
            Fragment fragment{here.corner};
            if (has(material, model::effect_texture)) {
                fragment.uv_right = triangle.uv_at(centre + right) - triangle.uv_at(centre - right);
                fragment.uv_below = triangle.uv_at(centre + below) - triangle.uv_at(centre - below);
            }
            const Shade shade = colour_at_pixel(view, material, fragment);
            const std::size_t at = std::size_t{y} * picture.width + x;
            if (shade.is_close_call) picture.close_call[at] = true;
            if (shade.is_hole) continue;
            const bool textured = has(material, model::effect_texture);
            const std::uint64_t level = textured ? mip_level(view.model.textures[material.texture], fragment) : 0;
            put(picture, at, here.nearness, shade.colour, has(material, model::effect_blend), surface << 8U | level);
        }
    }
}

/// Draws a part, triangle by triangle. Neighbours in one plane count as one surface.
inline void draw(Picture& picture, const View& view, const DrawnPart& drawn) {
    const model::Part& part = view.model.parts[drawn.part];
    const model::Material& material = view.model.materials[part.material];
    const model::Placement& placement = view.model.placements[drawn.placement];
    const bool mirrored = glm::determinant(dmat3(placement.linear)) < 0;
    std::uint64_t surface = static_cast<std::uint64_t>(drawn.node) << 32U;
    dvec3 last_normal(0.0);
    for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
        std::array<Corner, 3> triangle;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const std::uint32_t vertex = part.first_vertex + view.model.indices[part.first_index + i + c];
            triangle[c] = corner_at(view, material, placement, vertex, drawn.captured);
        }
        const dvec3 edge = triangle[1].from_eye - triangle[0].from_eye, other = triangle[2].from_eye - triangle[0].from_eye;
        const dvec3 normal = (mirrored ? -1.0 : 1.0) * glm::normalize(glm::cross(edge, other));
        if (glm::dot(normal, last_normal) < 1 - 1e-9) ++surface;
        last_normal = normal;
        if (!material.two_sided && glm::dot(normal, triangle[0].from_eye) >= 0) continue;  // seen from behind
        const std::vector<Corner> kept = clip(triangle, view.pose.forward());
        for (std::size_t k = 2; k < kept.size(); ++k) {
            ScreenTriangle shown{project(view, kept[0]), project(view, kept[k - 1]), project(view, kept[k])};
            if (area_of(shown.corners[0].at, shown.corners[1].at, shown.corners[2].at) < 0)
                std::swap(shown.corners[1], shown.corners[2]);
            fill(picture, view, material, shown, surface);
        }
    }
}

/// Draws the full detail: the finest representation of every leaf. Blended parts come last, from far to near.
inline Picture draw(const View& view) {
    std::vector<DrawnPart> opaque, blended;
    for (model::Index n = 0; n < view.model.nodes.size(); ++n) {
        const model::Node& node = view.model.nodes[n];
        if (node.child_count != 0) continue;
        const model::Representation& rep = view.model.reps[node.first_rep + node.rep_count - 1];
        const double distance_m = glm::length(0.5 * (node.box.min + node.box.max) - view.pose.position);
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            const model::Material& material = view.model.materials[view.model.parts[p].material];
            const bool captured = rep.kind == model::RepKind::textured_box && !has(material, model::effect_lit_picture);
            (has(material, model::effect_blend) ? blended : opaque).push_back({distance_m, n, p, rep.placement, captured});
        }
    }
    std::sort(blended.begin(), blended.end(), [](const DrawnPart& a, const DrawnPart& b) {
        return std::tuple(-a.distance_m, a.node, a.part) < std::tuple(-b.distance_m, b.node, b.part);
    });
    const std::size_t pixels = std::size_t{view.viewport.width} * view.viewport.height;
    Picture picture{view.viewport.width, view.viewport.height, {}, {}, {}, {}};
    picture.colours.assign(pixels, view.behind());
    picture.nearness.assign(pixels, 0.0);
    picture.seen.assign(pixels, 0);
    picture.close_call.assign(pixels, false);
    for (const DrawnPart& part : opaque) draw(picture, view, part);
    for (const DrawnPart& part : blended) draw(picture, view, part);
    return picture;
}

}  // namespace surefoot::reference
