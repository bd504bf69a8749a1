// Judges which triangles of a scene block a walker, by plain sorting. Shares no code with the bake, which it checks.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "tests/ground/exact_ground.hpp"
#include "tests/ground/exact_shapes.hpp"

namespace surefoot::exact {
namespace {

using importer::Material;
using importer::Mesh;
using importer::Primitive;
using importer::Scene;

constexpr double small_m = 0.3, near_m = 0.002;
constexpr double upright_y = 0.5, floor_y = 0.70710678118, same_sheet = 0.98480775301;
constexpr double sheet_width_m = 1.0, sheet_height_m = 0.5, sheet_low_m = 0.3, sheet_high_m = 0.8;

/// Sets of numbers that are united step by step.
class Sets {
public:
    explicit Sets(std::size_t count) : up_(count) { std::iota(up_.begin(), up_.end(), 0U); }
    std::uint32_t find(std::uint32_t i) {
        while (up_[i] != i) i = up_[i] = up_[up_[i]];
        return i;
    }
    void unite(std::uint32_t a, std::uint32_t b) { up_[find(a)] = find(b); }

private:
    std::vector<std::uint32_t> up_;
};

// --- Triangles that hide nothing ---

double alpha_of(const image::Image& picture, const dvec2& uv) {
    const auto texel = [](double at, std::uint32_t size) {
        return std::min(static_cast<std::uint32_t>((at - std::floor(at)) * size), size - 1);
    };
    const std::size_t row = texel(uv.y, picture.height), column = texel(uv.x, picture.width);
    return picture.rgba.at((row * picture.width + column) * 4 + 3);
}

/// Of the triangle whose indices start at `first`.
bool is_solid(const Scene& scene, const Primitive& primitive, std::size_t first) {
    const Material& material = scene.materials.at(primitive.material);
    if (material.alpha == model::AlphaMode::opaque) return true;
    const double cutoff = material.alpha == model::AlphaMode::mask ? material.alpha_cutoff : 0.99;
    const double factor = material.colour[3];
    if (factor < cutoff) return false;
    if (material.image == importer::none || primitive.uvs.empty()) return true;
    const image::Image& picture = scene.images.at(material.image);
    if (picture.width == 0 || picture.height == 0 || picture.rgba.empty()) return true;
    std::array<dvec2, 3> uvs;
    for (std::size_t c = 0; c < 3; ++c) {
        uvs[c] = dvec2(primitive.uvs.at(primitive.indices[first + c]));
        if (!std::isfinite(uvs[c].x) || !std::isfinite(uvs[c].y)) return false;
    }
    const double smallest = 255.0 * cutoff / factor;
    for (int i = 0; i <= 8; ++i) {
        for (int j = 0; i + j <= 8; ++j) {
            const dvec2 uv = uvs[0] * (i / 8.0) + uvs[1] * (j / 8.0) + uvs[2] * ((8 - i - j) / 8.0);
            if (!(alpha_of(picture, uv) >= smallest)) return false;
        }
    }
    return true;
}

// --- Meshes with equal corners made one ---

/// Triangles of all primitives. Equal positions are one point.
struct Welded {
    std::vector<vec3> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    std::vector<bool> solid;
};

Welded weld(const Scene& scene, const Mesh& mesh) {
    Welded welded;
    std::vector<std::pair<std::array<float, 3>, std::size_t>> corners;
    for (const Primitive& primitive : mesh.primitives) {
        for (std::size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
            for (std::size_t c = 0; c < 3; ++c) {
                const vec3 at = primitive.positions.at(primitive.indices[i + c]) + 0.0F;  // -0 becomes 0
                corners.push_back({{at.x, at.y, at.z}, corners.size()});
            }
            welded.solid.push_back(is_solid(scene, primitive, i));
        }
    }
    welded.triangles.resize(welded.solid.size());
    std::sort(corners.begin(), corners.end());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto& [at, place] = corners[i];
        if (i == 0 || at != corners[i - 1].first) welded.points.emplace_back(at[0], at[1], at[2]);
        welded.triangles[place / 3][place % 3] = static_cast<std::uint32_t>(welded.points.size() - 1);
    }
    return welded;
}

/// A triangle in the world. Without area its normal is not a number, and all comparisons with it are false.
struct Placed {
    Corners corners;
    dvec3 normal;
    double area;
};

Placed place(const Welded& mesh, std::size_t triangle, const dmat4& world) {
    Placed placed{};
    Corners own;
    for (std::size_t c = 0; c < 3; ++c) {
        own[c] = dvec3(mesh.points[mesh.triangles[triangle][c]]);
        placed.corners[c] = dvec3(world * dvec4(own[c], 1.0));
    }
    const dmat3 linear(world);
    const dvec3 across = glm::cross(linear * (own[1] - own[0]), linear * (own[2] - own[0]));
    const double length = glm::length(across);
    placed.normal = across / length;
    placed.area = 0.5 * length;
    return placed;
}

// --- Parts: solid triangles that hang together ---

/// Points of small parts near points of other parts, found in cells of just over `reach`.
class NearPoints {
public:
    NearPoints(const std::vector<vec3>& points, double reach) : points_(points), reach_(reach) {}

    void add(std::uint32_t point, std::uint32_t part) {
        const dvec3 cell = glm::floor(dvec3(points_[point]) / (1.001 * reach_));
        records_.emplace_back(cell.x, cell.y, cell.z, part, point);
    }

    /// Unites parts of which at least one is small.
    void unite(const std::vector<bool>& is_small, Sets& parts) {
        std::sort(records_.begin(), records_.end());
        ends_.assign(records_.size(), records_.size());
        for (std::size_t i = records_.size(); i-- > 1;) ends_[i - 1] = same_run(i - 1, i) ? ends_[i] : i;
        for (std::size_t run = 0; run < records_.size(); run = ends_[run])
            if (is_small[std::get<3>(records_[run])]) unite_around(run, parts);
    }

private:
    using Record = std::tuple<double, double, double, std::uint32_t, std::uint32_t>;  ///< cell, part, point

    [[nodiscard]] bool same_run(std::size_t a, std::size_t b) const {
        const auto key = [&](std::size_t i) {
            const auto& [x, y, z, part, point] = records_[i];
            return std::tuple(x, y, z, part);
        };
        return key(a) == key(b);
    }

    void unite_around(std::size_t run, Sets& parts) const {
        const auto [x, y, z, part, first_point] = records_[run];
        for (const double dx : {-1.0, 0.0, 1.0}) {
            for (const double dy : {-1.0, 0.0, 1.0}) {
                const auto from = std::lower_bound(records_.begin(), records_.end(), Record{x + dx, y + dy, z - 1.0, 0U, 0U});
                auto other = static_cast<std::size_t>(from - records_.begin());
                for (; other < records_.size(); other = ends_[other]) {
                    const auto& [ox, oy, oz, other_part, other_point] = records_[other];
                    if (ox != x + dx || oy != y + dy || oz > z + 1.0) break;
                    if (parts.find(part) != parts.find(other_part) && touch(run, other)) parts.unite(part, other_part);
                }
            }
        }
    }

    [[nodiscard]] bool touch(std::size_t run_a, std::size_t run_b) const {
        for (std::size_t a = run_a; a < ends_[run_a]; ++a) {
            for (std::size_t b = run_b; b < ends_[run_b]; ++b) {
                const dvec3 apart = dvec3(points_[std::get<4>(records_[a])]) - dvec3(points_[std::get<4>(records_[b])]);
                if (glm::length(apart) <= reach_) return true;
            }
        }
        return false;
    }

    const std::vector<vec3>& points_;
    double reach_;
    std::vector<Record> records_;
    std::vector<std::size_t> ends_;  ///< of the run of records of the same cell and part
};

/// By the number of the part that the point lies in: whether that part is small. False for points of no part.
std::vector<bool> small_parts(const Welded& mesh, const std::vector<bool>& used, const dvec3& scale, Sets& parts) {
    std::vector<Box> boxes(mesh.points.size());
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p)
        if (used[p]) boxes[parts.find(p)].grow(dvec3(mesh.points[p]));
    std::vector<bool> is_small(mesh.points.size(), false);
    for (std::size_t p = 0; p < boxes.size(); ++p) {
        const dvec3 size = (boxes[p].max - boxes[p].min) * scale;
        is_small[p] = !boxes[p].empty() && std::max({size.x, size.y, size.z}) < small_m;
    }
    return is_small;
}

/// Solid triangles that block.
std::vector<bool> solid_that_block(const Welded& mesh, const dmat3& linear) {
    const dvec3 scale(glm::length(linear[0]), glm::length(linear[1]), glm::length(linear[2]));
    Sets parts(mesh.points.size());
    std::vector<bool> used(mesh.points.size(), false);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        if (!mesh.solid[t]) continue;
        const auto& [a, b, c] = mesh.triangles[t];
        used[a] = used[b] = used[c] = true;
        parts.unite(a, b);
        parts.unite(b, c);
    }
    NearPoints near(mesh.points, near_m / std::max({scale.x, scale.y, scale.z}));
    for (std::uint32_t p = 0; p < mesh.points.size(); ++p)
        if (used[p]) near.add(p, parts.find(p));
    const std::vector<bool> small_before = small_parts(mesh, used, scale, parts);
    near.unite(small_before, parts);
    const std::vector<bool> small_after = small_parts(mesh, used, scale, parts);
    std::vector<bool> blocks(mesh.triangles.size(), false);
    for (std::size_t t = 0; t < blocks.size(); ++t) blocks[t] = mesh.solid[t] && !small_after[parts.find(mesh.triangles[t][0])];
    return blocks;
}

// --- Floors ---

/// Solid triangles that block and are level enough to stand on.
class Floors {
public:
    void add(const Placed& placed) {
        if (!(std::abs(placed.normal.y) >= floor_y) || !is_finite(placed.corners)) return;
        bins_.add(box_of(placed.corners), static_cast<std::uint32_t>(triangles_.size()));
        triangles_.push_back(placed.corners);
    }
    void sort() { bins_.sort(); }

    /// Whether a sheet from `low` to `high` is in the way of one who stands under or over that place.
    [[nodiscard]] bool is_in_the_way(double x, double z, double low, double high) const {
        for (const std::uint32_t t : bins_.near(upright_line(x, z))) {
            const std::optional<double> ground = height_at(triangles_[t], x, z);
            if (ground && low <= *ground + sheet_low_m && high >= *ground + sheet_high_m) return true;
        }
        return false;
    }

private:
    std::vector<Corners> triangles_;
    Bins bins_;
};

// --- Sheets: upright sheer triangles that hang together ---

struct Upright {
    std::uint32_t triangle;
    Placed placed;
};

/// One set number for each triangle.
std::vector<std::uint32_t> sheet_numbers(const Welded& mesh, const std::vector<Upright>& uprights) {
    Sets sheets(uprights.size());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> uses;  // point, upright
    for (std::uint32_t u = 0; u < uprights.size(); ++u)
        for (const std::uint32_t point : mesh.triangles[uprights[u].triangle]) uses.emplace_back(point, u);
    std::sort(uses.begin(), uses.end());
    for (std::size_t i = 0; i < uses.size(); ++i) {
        for (std::size_t j = i + 1; j < uses.size() && uses[j].first == uses[i].first; ++j) {
            const std::uint32_t a = uses[i].second, b = uses[j].second;
            if (sheets.find(a) == sheets.find(b)) continue;
            if (std::abs(glm::dot(uprights[a].placed.normal, uprights[b].placed.normal)) >= same_sheet) sheets.unite(a, b);
        }
    }
    std::vector<std::uint32_t> numbers(uprights.size());
    for (std::uint32_t u = 0; u < uprights.size(); ++u) numbers[u] = sheets.find(u);
    return numbers;
}

bool sheet_blocks(const std::vector<const Placed*>& sheet, const Floors& floors) {
    Box box;
    dvec3 weighted(0.0);
    double area = 0.0;
    for (const Placed* placed : sheet) {
        box.grow(box_of(placed->corners));
        weighted += placed->area * (placed->corners[0] + placed->corners[1] + placed->corners[2]) / 3.0;
        area += placed->area;
    }
    const dvec3 centre = weighted / area;
    double width = -1.0;
    dvec3 along(0.0);
    for (int k = 0; k < 8; ++k) {
        const dvec3 level(std::cos(k * std::numbers::pi / 8.0), 0.0, std::sin(k * std::numbers::pi / 8.0));
        double first = std::numeric_limits<double>::infinity(), last = -first;
        for (const Placed* placed : sheet) {
            for (const dvec3& corner : placed->corners) {
                first = std::min(first, glm::dot(level, corner));
                last = std::max(last, glm::dot(level, corner));
            }
        }
        if (last - first > width) {
            width = last - first;
            along = level;
        }
    }
    if (!(width >= sheet_width_m) || !(box.max.y - box.min.y >= sheet_height_m)) return false;
    const dvec3 across(-along.z, 0.0, along.x);
    for (const double share : {-0.25, 0.0, 0.25}) {
        for (const double aside : {0.0, -0.3, 0.3}) {
            const dvec3 at = centre + share * width * along + aside * across;
            if (floors.is_in_the_way(at.x, at.z, box.min.y, box.max.y)) return true;
        }
    }
    return false;
}

/// Adds the sheer triangles that block.
void add_sheets(const Welded& mesh, const dmat4& world, const Floors& floors, std::vector<bool>& blocks) {
    std::vector<Upright> uprights;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (mesh.solid[t]) continue;
        const Placed placed = place(mesh, t, world);
        if (std::abs(placed.normal.y) <= upright_y && is_finite(placed.corners)) uprights.push_back({t, placed});
    }
    const std::vector<std::uint32_t> numbers = sheet_numbers(mesh, uprights);
    std::map<std::uint32_t, std::vector<std::uint32_t>> sheets;
    for (std::uint32_t u = 0; u < uprights.size(); ++u) sheets[numbers[u]].push_back(u);
    for (const auto& [number, members] : sheets) {
        std::vector<const Placed*> sheet;
        for (const std::uint32_t u : members) sheet.push_back(&uprights[u].placed);
        if (!sheet_blocks(sheet, floors)) continue;
        for (const std::uint32_t u : members) blocks[uprights[u].triangle] = true;
    }
}

}  // namespace

std::vector<std::vector<bool>> blocking_triangles(const Scene& scene) {
    std::vector<std::vector<bool>> blocks(scene.nodes.size());
    std::map<importer::Index, Welded> meshes;
    Floors floors;
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
        const importer::Node& node = scene.nodes[n];
        const double volume = glm::determinant(dmat3(node.world));
        if (node.mesh == importer::none || volume == 0.0 || !std::isfinite(volume)) continue;
        if (!meshes.contains(node.mesh)) meshes.emplace(node.mesh, weld(scene, scene.meshes.at(node.mesh)));
        const Welded& mesh = meshes.at(node.mesh);
        if (node.walk == importer::WalkRule::by_rule)
            blocks[n] = solid_that_block(mesh, dmat3(node.world));
        else
            blocks[n].assign(mesh.triangles.size(), node.walk == importer::WalkRule::block);
        for (std::size_t t = 0; t < blocks[n].size(); ++t)
            if (blocks[n][t]) floors.add(place(mesh, t, node.world));
    }
    floors.sort();
    for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
        const importer::Node& node = scene.nodes[n];
        if (!blocks[n].empty() && node.walk == importer::WalkRule::by_rule)
            add_sheets(meshes.at(node.mesh), node.world, floors, blocks[n]);
    }
    return blocks;
}

}  // namespace surefoot::exact
