// Thinning surfaces, and the pixels that they rasterise (pixel_estimator.hpp).
#include "render/model/pixel_estimator.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "render/model/model.hpp"

namespace surefoot::model {

namespace {

constexpr std::size_t max_samples = 128;  // triangles, and samples, of a surface
constexpr float near_half_diagonals = 3.0F, close_half_diagonals = 1.5F;
constexpr auto max_each = static_cast<std::uint32_t>(PixelEstimator::max_pieces);  // triangles that are looked at one by one
constexpr float surface_share = 2.0F / 3.0F;

/// Nearer than so many half diagonals of the box.
bool within(float half_diagonals, const Box& box, const dvec3& eye) {
    const vec3 half(box.half()), away(box.centre() - eye);
    return glm::dot(away, away) < half_diagonals * half_diagonals * glm::dot(half, half);
}

bool is_see_through(const Material& material) { return (material.effects & (effect_alpha_mask | effect_blend)) != 0; }

vec3 area_of(const vec3& a, const vec3& b, const vec3& c) { return 0.5F * glm::cross(b - a, c - a); }

/// The n-th of a sequence that fills the unit square evenly, folded into a triangle.
vec2 place_in_triangle(std::size_t n) {
    const auto at = static_cast<double>(n);
    double u = 0.5 + at * 0.7548776662466927, v = 0.5 + at * 0.5698402909980532;
    u -= std::floor(u);
    v -= std::floor(v);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    return {static_cast<float>(u), static_cast<float>(v)};
}

/// A convex polygon as it is cut: a triangle and one corner more a plane.
struct Polygon {
    std::array<vec3, 8> points;
    std::size_t count = 3;

    /// Keeps where `inside` >= 0, linear in the point.
    template <class Inside>
    void cut(Inside inside) {
        std::array<vec3, 8> kept;  // NOLINT: filled as far as it is read
        std::size_t n = 0;
        for (std::size_t i = 0; i < count; ++i) {
            const vec3 &from = points[i], &to = points[i + 1 < count ? i + 1 : 0];
            const float f = inside(from), t = inside(to);
            if (f >= 0) kept[n++] = from;
            if ((f >= 0) != (t >= 0) && n < kept.size()) kept[n++] = from + (f / (f - t)) * (to - from);
            if (n == kept.size()) break;
        }
        points = kept;
        count = n;
    }
};

}  // namespace

/// A view in the coordinates of a surface: x and y in the picture where they lie between -z and z.
struct PixelEstimator::LocalView {
    vec3 eye{0}, x{0}, y{0}, z{0};
    float side = 1;  ///< -1 where the placement mirrors: the front stays the front, as it is drawn
    float near_m = 0;
    float pixels = 0;        ///< of the picture
    float sample_scale = 0;  ///< pixels of a sample's area at depth 1, seen from ahead
    [[nodiscard]] vec3 seen(const vec3& at) const {
        const vec3 d = at - eye;
        return {glm::dot(x, d), glm::dot(y, d), glm::dot(z, d)};
    }
    /// A bit for each plane of the view that a point as seen lies beyond.
    [[nodiscard]] std::uint32_t beyond(const vec3& v) const {
        const auto bit = [](bool is, std::uint32_t n) { return static_cast<std::uint32_t>(is) << n; };
        return bit(v.z < near_m, 0) | bit(v.z < -v.x, 1) | bit(v.z < v.x, 2) | bit(v.z < -v.y, 3) | bit(v.z < v.y, 4);
    }
};

PixelEstimator::PixelEstimator(const Model& model) {
    // Measured first, so that the arrays are made once and as large as they must be: they stay locked for as long as there is a
    // walk.
    std::map<std::pair<Index, Index>, std::uint32_t> known;
    std::vector<Index> shown_by;  // a surface: one representation that has it
    std::vector<float> areas;
    placed_.reserve(model.reps.size());
    for (Index r = 0; r < model.reps.size(); ++r) {
        const Representation& rep = model.reps[r];
        const auto [found, fresh] =
            known.try_emplace({rep.first_part, rep.part_count}, static_cast<std::uint32_t>(shown_by.size()));
        if (fresh) shown_by.push_back(r);
        placed_.push_back({found->second, rep.placement});
    }
    surfaces_.reserve(shown_by.size());
    Surface next;
    for (const Index r : shown_by) {
        measure(model, model.reps[r], areas, next);
        surfaces_.push_back(next);
        next.first_triangle += next.triangles;
        next.first_sample += next.samples;
    }
    triangles_.reserve(next.first_triangle);
    samples_.reserve(next.first_sample);
    for (std::size_t s = 0; s < shown_by.size(); ++s) fill(model, model.reps[shown_by[s]], surfaces_[s]);

    each_.assign(model.reps.size(), false);
    for (const Node& node : model.nodes) {
        const auto reps = std::span(model.reps).subspan(node.first_rep, node.rep_count);
        const bool each = std::all_of(reps.begin(), reps.end(), [](const Representation& rep) {
            return rep.part_count > 0 && rep.part_count <= max_parts && rep.triangles <= max_each;
        });
        std::fill_n(each_.begin() + node.first_rep, node.rep_count, each);
    }

    places_.reserve(model.placements.size());
    for (const Placement& p : model.placements) {
        const glm::dmat3 linear(p.linear);
        const double determinant = glm::determinant(linear);
        Place place{p.origin, p.linear, mat3(1.0F), 0};
        if (std::isnormal(static_cast<float>(determinant))) {
            place.inverse = mat3(glm::inverse(linear));
            place.determinant = static_cast<float>(determinant);
        }
        places_.push_back(place);
    }
}

void PixelEstimator::measure(const Model& model, const Representation& rep, std::vector<float>& areas, Surface& surface) {
    areas.clear();
    double total = 0;
    for_triangles(model, rep, [&](const Material&, const vec3& a, const vec3& b, const vec3& c) {
        areas.push_back(glm::length(area_of(a, b, c)));
        total += static_cast<double>(areas.back());
    });
    surface.triangles = surface.samples = 0;
    if (!std::isfinite(total)) return;  // beyond all measure: the box decides
    // Whole: what is larger than a sample's share. Equal ones beyond `most` are sampled.
    surface.whole_m2 = 0;
    if (areas.size() > max_samples) {
        std::nth_element(areas.begin(), areas.begin() + max_samples, areas.end(), std::greater<>());
        surface.whole_m2 = std::max(areas[max_samples], static_cast<float>(total / max_samples));
    }
    double rest = 0;
    for (const float area : areas) {
        if (area > surface.whole_m2)
            ++surface.triangles;
        else
            rest += static_cast<double>(area);
    }
    if (rest > 0) {
        const double share = std::ceil(static_cast<double>(max_samples) * rest / total);
        surface.samples = static_cast<std::uint32_t>(std::clamp(share, 4.0, static_cast<double>(max_samples)));
    }
    surface.sample_m2 = surface.samples > 0 ? static_cast<float>(rest / surface.samples) : 0.0F;
}

void PixelEstimator::fill(const Model& model, const Representation& rep, Surface& surface) {
    if (surface.triangles + surface.samples == 0) return;
    double passed = 0;
    std::uint32_t n = 0;
    for_triangles(model, rep, [&](const Material& material, const vec3& a, const vec3& b, const vec3& c) {
        const vec3 facing = area_of(a, b, c);
        const float area = glm::length(facing);
        if (!(area > 0)) return;
        if (area > surface.whole_m2) {
            triangles_.push_back({a, b, c, material.two_sided, is_see_through(material)});
            return;
        }
        passed += static_cast<double>(area);
        for (; n < surface.samples && (n + 0.5) * static_cast<double>(surface.sample_m2) < passed; ++n) {
            const vec2 place = place_in_triangle(n);
            samples_.push_back({a + place.x * (b - a) + place.y * (c - a), facing * (surface.sample_m2 / area),
                                material.two_sided ? -1.0F : 0.0F, is_see_through(material)});
        }
    });
    // Areas so small that their sum is not what their shares add up to.
    for (; n < surface.samples; ++n) samples_.push_back({vec3(0), vec3(0), 0.0F, false});
}

float PixelEstimator::pixels_of(const Triangle& t, const LocalView& view) {
    Polygon p{{view.seen(t.a), view.seen(t.b), view.seen(t.c)}};
    const vec3 a = p.points[0], b = p.points[1], c = p.points[2];
    const float towards = view.side * glm::dot(glm::cross(b - a, c - a), a);
    if (towards < 0 && !t.both_sides) return 0;
    const std::uint32_t beyond_a = view.beyond(a), beyond_b = view.beyond(b), beyond_c = view.beyond(c);
    if ((beyond_a & beyond_b & beyond_c) != 0) return 0;
    const float picture = 0.25F * view.pixels;  // it is 2 by 2
    if ((beyond_a | beyond_b | beyond_c) == 0) return 0.5F * std::abs(towards) / (a.z * b.z * c.z) * picture;
    p.cut([&](const vec3& v) { return v.z - view.near_m; });
    p.cut([](const vec3& v) { return v.z + v.x; });
    p.cut([](const vec3& v) { return v.z - v.x; });
    p.cut([](const vec3& v) { return v.z + v.y; });
    p.cut([](const vec3& v) { return v.z - v.y; });
    float doubled = 0;
    for (std::size_t i = 0; i < p.count; ++i) {
        const vec3 &from = p.points[i], &to = p.points[i + 1 < p.count ? i + 1 : 0];
        doubled += (from.x * to.y - to.x * from.y) / (from.z * to.z);
    }
    return 0.5F * std::abs(doubled) * picture;
}

float PixelEstimator::pixels_of(const Sample& s, float sample_m2, const LocalView& view) {
    const vec3 d = s.at - view.eye;
    const float z = glm::dot(view.z, d);
    if (!(z > view.near_m) || std::abs(glm::dot(view.x, d)) > z || std::abs(glm::dot(view.y, d)) > z) return 0;
    const float ahead = -glm::dot(s.area, d);
    const float square = glm::dot(d, d);
    // A patch as large as its distance covers less than it would far away: about what a disc of its area does.
    return std::max(ahead, ahead * s.back) * square / ((square + 0.5F * sample_m2) * z * z * z) * view.sample_scale;
}

bool PixelEstimator::look(Index r, const dvec3& eye, const ViewScale& scale, LocalView& view) const {
    if (r >= placed_.size()) return false;
    const Place& place = places_[placed_[r].place];
    if (place.determinant == 0) return false;
    const mat3 turned = glm::transpose(place.linear);
    const float f = scale.pixels_per_radian;
    view = {place.inverse * vec3(eye - place.origin),
            turned * scale.across / scale.tan_half_x,
            turned * scale.rise / scale.tan_half_y,
            turned * scale.forward,
            place.determinant < 0 ? -1.0F : 1.0F,
            scale.near_m,
            scale.viewport_pixels,
            f * f * std::abs(place.determinant)};
    return true;
}

float PixelEstimator::surface_pixels(Index r, const dvec3& eye, const ViewScale& scale) const {
    LocalView view;
    if (!look(r, eye, scale, view)) return -1;
    const Surface& surface = surfaces_[placed_[r].surface];
    if (surface.triangles + surface.samples == 0) return -1;
    float pixels = 0;
    for (std::uint32_t i = 0; i < surface.triangles; ++i) pixels += pixels_of(triangles_[surface.first_triangle + i], view);
    for (std::uint32_t i = 0; i < surface.samples; ++i)
        pixels += pixels_of(samples_[surface.first_sample + i], surface.sample_m2, view);
    return pixels >= 0 ? std::min(pixels, max_pixels) : -1.0F;
}

float PixelEstimator::pixels(const Model& model, Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale) const {
    std::array<float, max_parts> of_part;  // NOLINT: filled as far as it is read
    if (part_pixels(model, r, node_box, eye, scale, of_part)) {
        const auto end = of_part.begin() + model.reps[r].part_count;
        return std::min(std::accumulate(of_part.begin(), end, 0.0F), max_pixels);
    }
    const float by_box = rasterised_pixels(model.reps[r], node_box, eye, scale);
    if (node_box.empty() || !within(near_half_diagonals, node_box, eye)) return by_box;
    const float by_surface = surface_pixels(r, eye, scale);
    return by_surface < 0 ? by_box : by_box + surface_share * (by_surface - by_box);
}

bool PixelEstimator::part_pixels(const Model& model, Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale,
                                 std::span<float> of_part) const {
    const Representation& rep = model.reps[r];
    LocalView view;
    if (rep.part_count > of_part.size() || !tests_each(model, r, node_box, eye) || !look(r, eye, scale, view)) return false;
    float sum = 0;
    for (std::uint32_t p = 0; p < rep.part_count; ++p) {
        of_part[p] = 0;
        for_triangles(model, rep.first_part + p, [&](const Material& material, const vec3& a, const vec3& b, const vec3& c) {
            of_part[p] += pixels_of(Triangle{a, b, c, material.two_sided, false}, view);
        });
        sum += of_part[p];
    }
    return std::isfinite(sum);
}

bool PixelEstimator::tests_each(const Model& model, Index r, const Box& node_box, const dvec3& eye) const {
    return r < each_.size() && each_[r] && model.reps[r].part_count > 0 && !node_box.empty() &&
           within(close_half_diagonals, node_box, eye);
}

bool PixelEstimator::project(const Triangle& t, const LocalView& view, SeenPiece& out) {
    std::array<vec3, 3>& at = out.at;
    at = {view.seen(t.a), view.seen(t.b), view.seen(t.c)};
    if (!t.both_sides && view.side * glm::dot(glm::cross(at[1] - at[0], at[2] - at[0]), at[0]) < 0) return false;
    out.pixels = 0;
    out.see_through = t.see_through;
    return (view.beyond(at[0]) & view.beyond(at[1]) & view.beyond(at[2])) == 0;
}

std::ptrdiff_t PixelEstimator::pieces(const Model& model, Index r, const Box& node_box, const dvec3& eye, const ViewScale& scale,
                                      const Pieces& of, std::span<SeenPiece> out) const {
    LocalView view;
    if (out.empty() || !look(r, eye, scale, view)) return -1;
    std::size_t count = 0;
    const auto full = [&] { return count == out.size(); };
    if (of.each_triangle && tests_each(model, r, node_box, eye)) {
        std::uint32_t number = 0;
        for_triangles(model, model.reps[r], [&](const Material& material, const vec3& a, const vec3& b, const vec3& c) {
            if (full()) return;
            out[count].number = number++;
            if (project({a, b, c, material.two_sided, is_see_through(material)}, view, out[count])) ++count;
        });
        return static_cast<std::ptrdiff_t>(count);
    }
    const Surface& surface = surfaces_[placed_[r].surface];
    if (surface.triangles + surface.samples == 0) return -1;
    for (std::uint32_t i = 0; i < surface.triangles && !full(); ++i) {
        out[count].number = i;
        if (project(triangles_[surface.first_triangle + i], view, out[count])) ++count;
    }
    const std::uint32_t limit = std::max(1U, of.max_samples);
    const std::uint32_t every = std::max(1U, (surface.samples + limit - 1) / limit);
    for (std::uint32_t i = 0; i < surface.samples && !full(); i += every) {
        const Sample& sample = samples_[surface.first_sample + i];
        SeenPiece& piece = out[count];
        piece.pixels = static_cast<float>(every) * pixels_of(sample, surface.sample_m2, view);
        if (!(piece.pixels > 0)) continue;
        piece.at[0] = view.seen(sample.at);
        piece.see_through = sample.see_through;
        piece.number = surface.triangles + i;
        ++count;
    }
    return static_cast<std::ptrdiff_t>(count);
}

}  // namespace surefoot::model
