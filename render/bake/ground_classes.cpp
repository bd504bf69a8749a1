// Parts, sheets and their sizes.
#include "render/bake/ground_classes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <unordered_map>

#include "rt/base/hash.hpp"

namespace surefoot::bake {

namespace {

/// Sets that grow together.
class Unions {
public:
    explicit Unions(std::size_t count) : of_(count) { std::iota(of_.begin(), of_.end(), 0U); }
    std::uint32_t root(std::uint32_t i) {
        while (of_[i] != i) i = of_[i] = of_[of_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = root(a), b = root(b);
        if (a != b) of_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> of_;
};

constexpr int picture_samples = 8;  // a side of a triangle

/// Whether a picture hides nothing of a triangle: its texels at 45 places pass the alpha test.
bool shows_all(const image::Image& image, const std::array<vec2, 3>& uv, double min_alpha) {
    const auto texel = [](double at, std::uint32_t size) {
        const double wrapped = at - std::floor(at);
        return std::min(static_cast<std::uint32_t>(wrapped * size), size - 1);
    };
    for (int i = 0; i <= picture_samples; ++i) {
        for (int j = 0; i + j <= picture_samples; ++j) {
            const double a = static_cast<double>(i) / picture_samples, b = static_cast<double>(j) / picture_samples;
            const dvec2 at = a * dvec2(uv[0]) + b * dvec2(uv[1]) + (1 - a - b) * dvec2(uv[2]);
            if (!std::isfinite(at.x) || !std::isfinite(at.y)) return false;
            const std::size_t index = std::size_t{texel(at.y, image.height)} * image.width + texel(at.x, image.width);
            if (image.rgba[4 * index + 3] < min_alpha) return false;
        }
    }
    return true;
}

bool is_solid(const importer::Scene& scene, const importer::Primitive& primitive, std::size_t triangle) {
    const importer::Material& material = scene.materials[primitive.material];
    if (material.alpha == model::AlphaMode::opaque) return true;
    const double cutoff = material.alpha == model::AlphaMode::mask ? material.alpha_cutoff : 0.99;
    const double factor = material.colour[3];
    if (factor < cutoff) return false;
    if (material.image == importer::none || primitive.uvs.empty()) return true;
    const image::Image& image = scene.images[material.image];
    if (image.rgba.empty()) return true;
    std::array<vec2, 3> uv;
    for (std::size_t c = 0; c < 3; ++c) uv[c] = primitive.uvs[primitive.indices[3 * triangle + c]];
    return shows_all(image, uv, 255.0 * cutoff / factor);
}

/// Numbers equal positions once.
class Welder {
public:
    explicit Welder(std::vector<dvec3>& points) : points_(points) {}
    std::uint32_t add(const vec3& p) {
        const std::array<float, 3> key{p.x == 0 ? 0.0F : p.x, p.y == 0 ? 0.0F : p.y, p.z == 0 ? 0.0F : p.z};
        const auto [it, fresh] = numbers_.try_emplace(key, static_cast<std::uint32_t>(points_.size()));
        if (fresh) points_.emplace_back(p);
        return it->second;
    }

private:
    struct Hash {
        std::size_t operator()(const std::array<float, 3>& key) const {
            return surefoot::hash_bytes(std::as_bytes(std::span(key)));
        }
    };
    std::vector<dvec3>& points_;
    std::unordered_map<std::array<float, 3>, std::uint32_t, Hash> numbers_;
};

/// Longest side along the node's axes, placed.
double placed_size(const Box& box, const dvec3& scale) {
    const dvec3 sides = (box.max - box.min) * scale;
    return std::max({sides.x, sides.y, sides.z});
}

/// Points by cells as wide as `reach`, for those within reach of one.
class NearPoints {
public:
    NearPoints(const std::vector<dvec3>& points, const std::vector<bool>& wanted, double reach) : points_(points), reach_(reach) {
        for (std::uint32_t i = 0; i < points.size(); ++i)
            if (wanted[i]) cells_.emplace_back(key(cell(points[i])), i);
        std::sort(cells_.begin(), cells_.end());
    }
    template <class Use>
    void for_near(const dvec3& p, const Use& use) const {
        const auto at = cell(p);
        for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x)
            for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y)
                for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z) {
                    const std::uint64_t k = key({x, y, z});
                    for (auto it = std::lower_bound(cells_.begin(), cells_.end(), std::pair{k, 0U});
                         it != cells_.end() && it->first == k; ++it)
                        if (glm::length(points_[it->second] - p) <= reach_) use(it->second);
                }
    }

private:
    using Cell = std::array<std::int64_t, 3>;
    [[nodiscard]] Cell cell(const dvec3& p) const {
        return {static_cast<std::int64_t>(std::floor(p.x / reach_)), static_cast<std::int64_t>(std::floor(p.y / reach_)),
                static_cast<std::int64_t>(std::floor(p.z / reach_))};
    }
    static std::uint64_t key(const Cell& c) { return surefoot::hash_bytes(std::as_bytes(std::span(c))); }

    const std::vector<dvec3>& points_;
    double reach_;
    std::vector<std::pair<std::uint64_t, std::uint32_t>> cells_;
};

/// Joins small parts to whatever has a corner within 2 mm of one of theirs.
void join_small_parts(const GroundFacts& facts, const std::vector<bool>& small, double reach, Unions& parts) {
    constexpr std::uint32_t nothing = 0xffffffffU;
    std::vector<std::uint32_t> part_of(facts.points.size(), nothing);
    std::vector<bool> used(facts.points.size(), false);
    for (std::size_t t = 0; t < facts.corners.size(); ++t) {
        if (!facts.solid[t]) continue;
        for (const std::uint32_t c : facts.corners[t]) part_of[c] = facts.part[t], used[c] = true;
    }
    const NearPoints near(facts.points, used, reach);
    for (std::uint32_t i = 0; i < facts.points.size(); ++i) {
        if (!used[i] || !small[part_of[i]]) continue;
        near.for_near(facts.points[i], [&](std::uint32_t other) { parts.join(part_of[i], part_of[other]); });
    }
}

dvec3 scale_of(const dmat4& world) {
    return {glm::length(dvec3(world[0])), glm::length(dvec3(world[1])), glm::length(dvec3(world[2]))};
}

/// Its heights, and in which of eight level directions it is widest.
void measure_outline(std::span<const dvec3> corners, Sheet& sheet) {
    Box box;
    for (const dvec3& p : corners) box.grow(p);
    sheet.low_m = box.min.y, sheet.high_m = box.max.y;
    for (int d = 0; d < 8; ++d) {
        const double angle = std::numbers::pi * d / 8;
        const dvec3 along(std::cos(angle), 0, std::sin(angle));
        double low = std::numeric_limits<double>::infinity(), high = -low;
        for (const dvec3& p : corners) {
            const double s = p.x * along.x + p.z * along.z;
            low = std::min(low, s), high = std::max(high, s);
        }
        if (high - low <= sheet.width_m) continue;
        sheet.width_m = high - low;
        sheet.along = along;
    }
}

}  // namespace

bool GroundFacts::all_solid() const { return std::find(solid.begin(), solid.end(), false) == solid.end(); }

GroundFacts ground_facts(const importer::Scene& scene, const importer::Mesh& mesh) {
    GroundFacts facts;
    Welder welder(facts.points);
    for (const importer::Primitive& primitive : mesh.primitives) {
        for (std::size_t t = 0; 3 * t + 2 < primitive.indices.size(); ++t) {
            std::array<std::uint32_t, 3> corners{};
            for (std::size_t c = 0; c < 3; ++c) corners[c] = welder.add(primitive.positions[primitive.indices[3 * t + c]]);
            facts.corners.push_back(corners);
            facts.solid.push_back(is_solid(scene, primitive, t));
        }
    }
    Unions points(facts.points.size());
    for (std::size_t t = 0; t < facts.corners.size(); ++t) {
        if (!facts.solid[t]) continue;
        points.join(facts.corners[t][0], facts.corners[t][1]);
        points.join(facts.corners[t][0], facts.corners[t][2]);
    }
    std::unordered_map<std::uint32_t, std::uint32_t> number;
    facts.part.assign(facts.corners.size(), 0);
    for (std::size_t t = 0; t < facts.corners.size(); ++t) {
        if (!facts.solid[t]) continue;
        const auto [it, fresh] =
            number.try_emplace(points.root(facts.corners[t][0]), static_cast<std::uint32_t>(facts.part_boxes.size()));
        if (fresh) facts.part_boxes.emplace_back();
        facts.part[t] = it->second;
        for (const std::uint32_t c : facts.corners[t]) facts.part_boxes[it->second].grow(facts.points[c]);
    }
    return facts;
}

std::vector<bool> blocking_solids(const GroundFacts& facts, const dmat4& world) {
    const dvec3 scale = scale_of(world);
    std::vector<bool> small(facts.part_boxes.size());
    bool any_small = false;
    for (std::size_t p = 0; p < small.size(); ++p) {
        small[p] = placed_size(facts.part_boxes[p], scale) < foot_m;
        any_small = any_small || small[p];
    }
    if (!any_small) return facts.solid;
    Box all;
    for (const Box& box : facts.part_boxes) all.grow(box);
    if (placed_size(all, scale) < foot_m) return std::vector<bool>(facts.solid.size(), false);  // however they join
    Unions parts(facts.part_boxes.size());
    join_small_parts(facts, small, join_m / std::max({scale.x, scale.y, scale.z}), parts);
    std::vector<Box> boxes(facts.part_boxes.size());
    for (std::uint32_t p = 0; p < small.size(); ++p) boxes[parts.root(p)].grow(facts.part_boxes[p]);
    std::vector<bool> blocks(facts.solid.size());
    for (std::size_t t = 0; t < blocks.size(); ++t)
        blocks[t] = facts.solid[t] && placed_size(boxes[parts.root(facts.part[t])], scale) >= foot_m;
    return blocks;
}

std::vector<Sheet> upright_sheets(const GroundFacts& facts, const dmat4& world) {
    const auto place = [&](std::uint32_t point) { return dvec3(world * dvec4(facts.points[point], 1.0)); };
    std::vector<std::uint32_t> upright;
    std::vector<dvec3> normals;  // by upright triangle; as long as twice its area
    for (std::uint32_t t = 0; t < facts.corners.size(); ++t) {
        if (facts.solid[t]) continue;
        const dvec3 a = place(facts.corners[t][0]), b = place(facts.corners[t][1]), c = place(facts.corners[t][2]);
        const dvec3 n = glm::cross(b - a, c - a);
        const double length = glm::length(n);
        if (!(length > 0) || std::abs(n.y) > upright_max_y * length) continue;
        upright.push_back(t);
        normals.push_back(n);
    }
    std::unordered_map<std::uint32_t, std::vector<std::uint32_t>> at_point;
    Unions sheets(upright.size());
    for (std::uint32_t i = 0; i < upright.size(); ++i) {
        for (const std::uint32_t corner : facts.corners[upright[i]]) {
            std::vector<std::uint32_t>& others = at_point[corner];
            for (const std::uint32_t j : others) {
                const double along = std::abs(glm::dot(normals[i], normals[j]));
                if (along >= sheet_min_cos * glm::length(normals[i]) * glm::length(normals[j])) sheets.join(i, j);
            }
            others.push_back(i);
        }
    }
    std::vector<std::vector<std::uint32_t>> members(upright.size());
    for (std::uint32_t i = 0; i < upright.size(); ++i) members[sheets.root(i)].push_back(i);
    std::vector<Sheet> found;
    for (const std::vector<std::uint32_t>& of : members) {
        if (of.empty()) continue;
        Sheet sheet;
        std::vector<dvec3> corners;
        double area = 0;
        for (const std::uint32_t i : of) {
            sheet.triangles.push_back(upright[i]);
            const double weight = glm::length(normals[i]);
            area += weight;
            for (const std::uint32_t corner : facts.corners[upright[i]]) {
                corners.push_back(place(corner));
                sheet.centre += weight / 3 * corners.back();
            }
        }
        sheet.centre /= area;
        measure_outline(corners, sheet);
        if (sheet.width_m >= sheet_width_m && sheet.high_m - sheet.low_m >= sheet_high_m - sheet_low_m)
            found.push_back(std::move(sheet));
    }
    return found;
}

std::vector<dvec3> places_beside(const Sheet& sheet) {
    const dvec3 across(-sheet.along.z, 0, sheet.along.x);
    std::vector<dvec3> places;
    for (const double share : {-0.25, 0.0, 0.25})
        for (const double off_m : {0.0, -0.3, 0.3})
            places.push_back(sheet.centre + share * sheet.width_m * sheet.along + off_m * across);
    return places;
}

bool stands_on(const Sheet& sheet, double floor_m) {
    return sheet.low_m <= floor_m + sheet_low_m && sheet.high_m >= floor_m + sheet_high_m;
}

}  // namespace surefoot::bake
