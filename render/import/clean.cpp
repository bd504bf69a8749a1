// Repairs one primitive: drops what cannot be drawn, with counts, and makes the normals that are missing.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "render/import/finish.hpp"

namespace surefoot::importer {
namespace {

/// Beyond this a coordinate is no place on earth nor in a model of it, and squares of it overflow float.
constexpr float largest_coordinate_m = 1e12F;
/// |cross| below this share of the longest edge squared is rounding, not area (double, so 1e-16 and some room).
constexpr double zero_area_share = 1e-14;

enum class Verdict { good, non_finite, enormous };

Verdict judge(const vec3& p) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) return Verdict::non_finite;
    const vec3 a = glm::abs(p);
    return a.x > largest_coordinate_m || a.y > largest_coordinate_m || a.z > largest_coordinate_m ? Verdict::enormous
                                                                                                  : Verdict::good;
}

/// Twice the area as a vector; zero to rounding means no area.
dvec3 area_vector(const Primitive& p, const std::uint32_t* t) {
    const dvec3 a(p.positions[t[0]]);
    return glm::cross(dvec3(p.positions[t[1]]) - a, dvec3(p.positions[t[2]]) - a);
}

bool has_area(const Primitive& p, const std::uint32_t* t) {
    const dvec3 a(p.positions[t[0]]), b(p.positions[t[1]]), c(p.positions[t[2]]);
    const double longest2 = std::max({glm::dot(b - a, b - a), glm::dot(c - b, c - b), glm::dot(a - c, a - c)});
    const double area = glm::length(area_vector(p, t));
    return longest2 > 0 && area > zero_area_share * longest2;
}

/// Keeps the triangles that can be drawn, in place and in order.
void keep_good_triangles(Primitive& p, Repairs& dropped) {
    const std::size_t vertices = p.positions.size();
    std::vector<Verdict> verdicts(vertices);
    for (std::size_t i = 0; i < vertices; ++i) verdicts[i] = judge(p.positions[i]);
    dropped.partial += p.indices.size() % 3 != 0 ? 1 : 0;
    std::size_t kept = 0;
    for (std::size_t i = 0; i + 3 <= p.indices.size(); i += 3) {
        const std::array<std::uint32_t, 3> t{p.indices[i], p.indices[i + 1], p.indices[i + 2]};
        if (t[0] >= vertices || t[1] >= vertices || t[2] >= vertices) {
            ++dropped.out_of_range;
            continue;
        }
        const Verdict worst = std::max({verdicts[t[0]], verdicts[t[1]], verdicts[t[2]]});
        if (verdicts[t[0]] == Verdict::non_finite || verdicts[t[1]] == Verdict::non_finite ||
            verdicts[t[2]] == Verdict::non_finite) {
            ++dropped.non_finite;
        } else if (worst == Verdict::enormous) {
            ++dropped.enormous;
        } else if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
            ++dropped.repeated;
        } else if (!has_area(p, t.data())) {
            ++dropped.zero_area;
        } else {
            std::copy(t.begin(), t.end(), p.indices.begin() + static_cast<std::ptrdiff_t>(kept));
            kept += 3;
        }
    }
    p.indices.resize(kept);
}

template <class T>
void gather(std::vector<T>& values, const std::vector<std::uint32_t>& old_of_new) {
    if (values.empty()) return;
    std::vector<T> out(old_of_new.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = values[old_of_new[i]];
    values = std::move(out);
}

/// Vertices that no triangle uses go: they may be what was not finite.
void drop_unused_vertices(Primitive& p) {
    std::vector<std::uint32_t> new_of_old(p.positions.size(), none);
    for (const std::uint32_t i : p.indices) new_of_old[i] = 0;
    std::vector<std::uint32_t> old_of_new;
    for (std::size_t i = 0; i < new_of_old.size(); ++i) {
        if (new_of_old[i] == none) continue;
        new_of_old[i] = static_cast<std::uint32_t>(old_of_new.size());
        old_of_new.push_back(static_cast<std::uint32_t>(i));
    }
    if (old_of_new.size() == p.positions.size()) return;
    for (std::uint32_t& i : p.indices) i = new_of_old[i];
    gather(p.positions, old_of_new);
    gather(p.normals, old_of_new);
    gather(p.uvs, old_of_new);
    gather(p.colours, old_of_new);
}

/// Unit normals: those given, renormalised; where none (or no usable one) is given, the mean of the triangles about the
/// vertex, weighted by area. Never an invented one: where the mean vanishes, that of the last triangle. Returns how many
/// given ones were unusable.
std::uint64_t make_normals(Primitive& p) {
    const bool given = !p.normals.empty();
    p.normals.resize(p.positions.size(), vec3(0));
    std::uint64_t unusable = 0;
    std::vector<bool> missing(p.positions.size(), false);
    bool any_missing = false;
    for (std::size_t i = 0; i < p.normals.size(); ++i) {
        const dvec3 n(p.normals[i]);
        const double length = glm::length(n);
        if (std::isfinite(length) && length > 1e-20) {
            p.normals[i] = vec3(n / length);
            continue;
        }
        missing[i] = any_missing = true;
        if (given) ++unusable;
    }
    if (!any_missing) return 0;
    std::vector<dvec3> sums(p.positions.size(), dvec3(0)), last(p.positions.size(), dvec3(0));
    for (std::size_t i = 0; i < p.indices.size(); i += 3) {
        const dvec3 area = area_vector(p, &p.indices[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            sums[p.indices[i + k]] += area;
            last[p.indices[i + k]] = area;
        }
    }
    for (std::size_t i = 0; i < p.normals.size(); ++i) {
        if (!missing[i]) continue;
        const bool cancelled = glm::length(sums[i]) <= 1e-9 * glm::length(last[i]);
        p.normals[i] = vec3(glm::normalize(cancelled ? last[i] : sums[i]));
    }
    return unusable;
}

template <class T>
bool drop_unless_parallel(std::vector<T>& values, std::size_t count) {
    if (values.empty() || values.size() == count) return false;
    values.clear();
    return true;
}

std::uint64_t repair_uvs(Primitive& p) {
    std::uint64_t repaired = 0;
    for (vec2& uv : p.uvs) {
        if (std::isfinite(uv.x) && std::isfinite(uv.y)) continue;
        uv = vec2(0);
        ++repaired;
    }
    return repaired;
}

}  // namespace

void repair(Primitive& primitive, Repairs& counts) {
    const std::size_t vertices = primitive.positions.size();
    counts.arrays += drop_unless_parallel(primitive.normals, vertices) ? 1 : 0;
    counts.arrays += drop_unless_parallel(primitive.uvs, vertices) ? 1 : 0;
    counts.arrays += drop_unless_parallel(primitive.colours, vertices) ? 1 : 0;
    keep_good_triangles(primitive, counts);
    drop_unused_vertices(primitive);
    counts.uvs += repair_uvs(primitive);
    counts.normals += make_normals(primitive);
}

void make_flat(Primitive& primitive) {
    const std::vector<std::uint32_t> corners = primitive.indices;
    gather(primitive.positions, corners);
    gather(primitive.uvs, corners);
    gather(primitive.colours, corners);
    primitive.normals.resize(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) primitive.indices[i] = static_cast<std::uint32_t>(i);
    for (std::size_t i = 0; i + 3 <= corners.size(); i += 3) {
        const vec3 normal(glm::normalize(area_vector(primitive, &primitive.indices[i])));
        for (std::size_t k = 0; k < 3; ++k) primitive.normals[i + k] = normal;
    }
}

void report_repairs(const Repairs& counts, const std::string& mesh_name, std::vector<std::string>& warnings,
                    std::vector<std::string>& lacks) {
    const auto line = [&](std::uint64_t count, const char* what) {
        if (count > 0) warnings.push_back(fmt::format("Mesh '{}': {} {}", mesh_name, count, what));
    };
    const auto broken = [&](std::uint64_t count, const char* what) {
        line(count, what);
        if (count > 0) lacks.push_back(warnings.back());
    };
    line(counts.arrays, "arrays of normals, coordinates or colours are dropped: not as long as the positions");
    line(counts.partial, "incomplete last triangles are dropped");
    broken(counts.out_of_range, "triangles are dropped: index out of range");
    broken(counts.non_finite, "triangles are dropped: position not finite");
    broken(counts.enormous, "triangles are dropped: coordinate beyond 1e12 m");
    line(counts.repeated, "triangles are dropped: repeated index");
    line(counts.zero_area, "triangles are dropped: zero area");
    broken(counts.uvs, "texture coordinates are not finite and set to 0");
    line(counts.normals, "normals have no length or are not finite; they are made from the triangles");
}

void clean(Primitive& primitive, const std::string& mesh_name, std::vector<std::string>& warnings) {
    Repairs counts;
    repair(primitive, counts);
    std::vector<std::string> lacks;
    report_repairs(counts, mesh_name, warnings, lacks);
}

}  // namespace surefoot::importer
