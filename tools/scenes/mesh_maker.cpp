// Builds meshes from boxes, tubes, lathes and free surfaces, one primitive a material.
#include "tools/scenes/mesh_maker.hpp"

#include <algorithm>
#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

namespace surefoot::scenes {
namespace {

dvec3 unit_or(const dvec3& v, const dvec3& otherwise) {
    const double length = glm::length(v);
    return length > 1e-12 ? v / length : otherwise;
}

/// |cos|^e and |sin|^e with their signs: superellipses. The cosine of a pole is 6e-17, not 0: its root would make a
/// ring of dust of it.
double power(double value, double exponent) {
    return std::abs(value) < 1e-12 ? 0.0 : std::copysign(std::pow(std::abs(value), exponent), value);
}

}  // namespace

Colour shade(const Colour& colour, double factor) {
    Colour out = colour;
    for (std::size_t i = 0; i < 3; ++i)
        out[i] = static_cast<std::uint8_t>(std::clamp(static_cast<double>(colour[i]) * factor, 0.0, 255.0));
    return out;
}

Colour mix(const Colour& a, const Colour& b, double t) {
    Colour out{};
    for (std::size_t i = 0; i < 4; ++i)
        out[i] = static_cast<std::uint8_t>(std::clamp(a[i] + (b[i] - a[i]) * std::clamp(t, 0.0, 1.0), 0.0, 255.0));
    return out;
}

dmat4 move(const dvec3& by) { return glm::translate(dmat4(1.0), by); }
dmat4 turn_y(double angle_rad) { return glm::rotate(dmat4(1.0), angle_rad, dvec3(0, 1, 0)); }
dmat4 turn(double angle_rad, const dvec3& axis) { return glm::rotate(dmat4(1.0), angle_rad, axis); }
dmat4 stretch(const dvec3& by) { return glm::scale(dmat4(1.0), by); }

importer::Primitive& MeshMaker::part() {
    for (importer::Primitive& p : mesh_.primitives) {
        if (p.material == brush.material) return p;
    }
    mesh_.primitives.emplace_back();
    mesh_.primitives.back().material = brush.material;
    return mesh_.primitives.back();
}

std::uint32_t MeshMaker::vertex(const dvec3& position, const dvec3& normal, const dvec2& uv) {
    importer::Primitive& p = part();
    p.positions.emplace_back(dvec3(brush.frame * dvec4(position, 1.0)));
    p.normals.emplace_back(unit_or(glm::transpose(glm::inverse(dmat3(brush.frame))) * normal, dvec3(0, 1, 0)));
    p.uvs.emplace_back(uv);
    p.colours.push_back(brush.colour);
    return static_cast<std::uint32_t>(p.positions.size() - 1);
}

/// Turned so that its front is where its normals point; poles give triangles without area, which are left out.
void MeshMaker::emit(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    importer::Primitive& p = part();
    const dvec3 pa(p.positions[a]), pb(p.positions[b]), pc(p.positions[c]);
    const dvec3 area = glm::cross(pb - pa, pc - pa);
    const double longest = std::max({glm::length(pb - pa), glm::length(pc - pb), glm::length(pa - pc)});
    if (glm::length(area) <= 1e-7 * longest * longest) return;
    const dvec3 normal = dvec3(p.normals[a]) + dvec3(p.normals[b]) + dvec3(p.normals[c]);
    if (glm::dot(area, normal) >= 0) {
        p.indices.insert(p.indices.end(), {a, b, c});
    } else {
        p.indices.insert(p.indices.end(), {a, c, b});
    }
}

void MeshMaker::emit_grid(std::span<const std::uint32_t> vertices, int columns, int rows) {
    for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < columns; ++c) {
            const auto at = [&](int column, int row) {
                const int vertex = row * (columns + 1) + column;
                return vertices[static_cast<std::size_t>(vertex)];
            };
            emit(at(c, r), at(c + 1, r), at(c + 1, r + 1));
            emit(at(c, r), at(c + 1, r + 1), at(c, r + 1));
        }
    }
}

void MeshMaker::quad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
    const dvec3 n = unit_or(glm::cross(b - a, d - a), dvec3(0, 1, 0));
    const dvec3 along = unit_or(b - a, dvec3(1, 0, 0)), across = glm::cross(along, n);  // v runs downwards: against ad
    const auto uv = [&](const dvec3& p) { return brush.uv_per_m * dvec2(glm::dot(p, along), glm::dot(p, across)); };
    const std::array<std::uint32_t, 4> v{vertex(a, n, uv(a)), vertex(b, n, uv(b)), vertex(d, n, uv(d)), vertex(c, n, uv(c))};
    emit_grid(v, 1, 1);
}

void MeshMaker::picture(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d) {
    const dvec3 n = unit_or(glm::cross(b - a, d - a), dvec3(0, 1, 0));
    const std::array<std::uint32_t, 4> v{vertex(a, n, {0, 1}), vertex(b, n, {1, 1}), vertex(d, n, {0, 0}), vertex(c, n, {1, 0})};
    emit_grid(v, 1, 1);
}

void MeshMaker::triangle(const dvec3& a, const dvec3& b, const dvec3& c) {
    const dvec3 n = unit_or(glm::cross(b - a, c - a), dvec3(0, 1, 0));
    const dvec3 along = unit_or(b - a, dvec3(1, 0, 0)), across = glm::cross(along, n);
    const auto uv = [&](const dvec3& p) { return brush.uv_per_m * dvec2(glm::dot(p, along), glm::dot(p, across)); };
    const std::uint32_t i = vertex(a, n, uv(a)), j = vertex(b, n, uv(b)), k = vertex(c, n, uv(c));
    emit(i, j, k);
}

void MeshMaker::box(const dvec3& l, const dvec3& h) {
    quad({l.x, l.y, h.z}, {h.x, l.y, h.z}, {h.x, h.y, h.z}, {l.x, h.y, h.z});
    quad({h.x, l.y, l.z}, {l.x, l.y, l.z}, {l.x, h.y, l.z}, {h.x, h.y, l.z});
    quad({h.x, l.y, h.z}, {h.x, l.y, l.z}, {h.x, h.y, l.z}, {h.x, h.y, h.z});
    quad({l.x, l.y, l.z}, {l.x, l.y, h.z}, {l.x, h.y, h.z}, {l.x, h.y, l.z});
    quad({l.x, h.y, h.z}, {h.x, h.y, h.z}, {h.x, h.y, l.z}, {l.x, h.y, l.z});
    quad({l.x, l.y, l.z}, {h.x, l.y, l.z}, {h.x, l.y, h.z}, {l.x, l.y, h.z});
}

void MeshMaker::lathe(std::span<const dvec2> profile, int sides) {
    // A point given twice ends one smooth stretch and begins the next.
    std::size_t first = 0;
    while (first + 1 < profile.size()) {
        std::size_t last = first + 1;
        while (last + 1 < profile.size() && profile[last + 1] != profile[last]) ++last;
        const auto stretch_of = profile.subspan(first, last - first + 1);
        const int rows = static_cast<int>(stretch_of.size()) - 1;
        std::vector<std::uint32_t> v;
        for (int r = 0; r <= rows; ++r) {
            const dvec2& here = stretch_of[static_cast<std::size_t>(r)];
            const dvec2 along = stretch_of[static_cast<std::size_t>(std::min(r + 1, rows))] -
                                stretch_of[static_cast<std::size_t>(std::max(r - 1, 0))];
            for (int s = 0; s <= sides; ++s) {
                const double angle = 2.0 * pi * s / sides;
                const dvec3 out(std::cos(angle), 0, -std::sin(angle));
                const dvec3 normal = out * along.y - dvec3(0, along.x, 0);
                v.push_back(vertex(out * here.x + dvec3(0, here.y, 0), normal,
                                   {static_cast<double>(s) / sides, -here.y * brush.uv_per_m}));
            }
        }
        emit_grid(v, sides, rows);
        first = last + (last + 1 < profile.size() ? 1 : 0);
        if (last + 1 >= profile.size()) break;
    }
}

void MeshMaker::ellipsoid(const dvec3& centre, const dvec3& radii, int sides, int rings) {
    cushion(centre, radii, 1.0, sides, rings);
}

void MeshMaker::cushion(const dvec3& centre, const dvec3& half, double roundness, int sides, int rings) {
    const double e = std::max(roundness, 0.05);
    std::vector<std::uint32_t> v;
    for (int r = 0; r <= rings; ++r) {
        const double latitude = pi * r / rings - pi / 2;
        for (int s = 0; s <= sides; ++s) {
            const double longitude = 2.0 * pi * s / sides;
            const dvec3 on(power(std::cos(latitude), e) * power(std::cos(longitude), e), power(std::sin(latitude), e),
                           power(std::cos(latitude), e) * power(std::sin(longitude), e));
            const double f = 2.0 - e;
            const dvec3 n(power(std::cos(latitude), f) * power(std::cos(longitude), f), power(std::sin(latitude), f),
                          power(std::cos(latitude), f) * power(std::sin(longitude), f));
            v.push_back(vertex(centre + on * half, n / half, dvec2(2.0 * s / sides, 1.0 - static_cast<double>(r) / rings)));
        }
    }
    emit_grid(v, sides, rings);
}

void MeshMaker::tube(std::span<const dvec3> centres, std::span<const double> radii, int sides, bool capped) {
    std::vector<std::uint32_t> v;
    const int rows = static_cast<int>(centres.size()) - 1;
    dvec3 side(0);
    double length = 0;
    for (int r = 0; r <= rows; ++r) {
        const auto i = static_cast<std::size_t>(r);
        const dvec3 along = unit_or(
            centres[static_cast<std::size_t>(std::min(r + 1, rows))] - centres[static_cast<std::size_t>(std::max(r - 1, 0))],
            dvec3(0, 1, 0));
        if (r == 0) side = std::abs(along.y) < 0.9 ? dvec3(0, 1, 0) : dvec3(1, 0, 0);
        side = unit_or(side - along * glm::dot(side, along), dvec3(0, 0, 1));
        const dvec3 other = glm::cross(along, side);
        if (r > 0) length += glm::length(centres[i] - centres[i - 1]);
        for (int s = 0; s <= sides; ++s) {
            const double angle = 2.0 * pi * s / sides;
            const dvec3 out = side * std::cos(angle) + other * std::sin(angle);
            v.push_back(vertex(centres[i] + out * radii[i], out, {static_cast<double>(s) / sides, -length * brush.uv_per_m}));
        }
    }
    emit_grid(v, sides, rows);
    if (!capped) return;
    for (const std::size_t end : {std::size_t{0}, centres.size() - 1}) {
        const std::size_t neighbour = end == 0 ? 1 : centres.size() - 2;
        const dvec3 normal = unit_or(centres[end] - centres[neighbour], dvec3(0, 1, 0));
        const std::uint32_t middle = vertex(centres[end], normal, {0.5, 0.5});
        std::vector<std::uint32_t> rim;
        importer::Primitive& p = part();
        const dmat4 frame = brush.frame;
        brush.frame = dmat4(1.0);
        const dvec3 turned = unit_or(glm::transpose(glm::inverse(dmat3(frame))) * normal, normal);
        for (int s = 0; s <= sides; ++s) {
            const std::size_t from = end == 0 ? static_cast<std::size_t>(s)
                                              : v.size() - static_cast<std::size_t>(sides) - 1 + static_cast<std::size_t>(s);
            rim.push_back(vertex(dvec3(p.positions[v[from]]), turned, {0.5, 0.5}));
        }
        brush.frame = frame;
        for (int s = 0; s < sides; ++s) emit(middle, rim[static_cast<std::size_t>(s)], rim[static_cast<std::size_t>(s) + 1]);
    }
}

void MeshMaker::rod(const dvec3& from, const dvec3& to, double radius, int sides) {
    tube(std::array{from, to}, std::array{radius, radius}, sides, true);
}

void MeshMaker::surface(int columns, int rows, const std::function<dvec3(double, double)>& at) {
    std::vector<std::uint32_t> v;
    for (int r = 0; r <= rows; ++r) {
        for (int c = 0; c <= columns; ++c) {
            const double u = static_cast<double>(c) / columns, w = static_cast<double>(r) / rows;
            const double du = 0.25 / columns, dw = 0.25 / rows;
            const dvec3 n = glm::cross(at(u + du, w) - at(u - du, w), at(u, w + dw) - at(u, w - dw));
            v.push_back(vertex(at(u, w), unit_or(n, dvec3(0, 1, 0)), dvec2(u, 1.0 - w) * brush.uv_per_m));
        }
    }
    emit_grid(v, columns, rows);
}

void MeshMaker::leaf(const dvec3& base, const dvec3& tip, const dvec3& side, const dvec3& normal) {
    const dvec3 middle = 0.5 * (base + tip);
    const std::array<std::uint32_t, 4> v{vertex(base, normal, {0, 1}), vertex(middle + side, normal, {1, 1}),
                                         vertex(middle - side, normal, {0, 0}), vertex(tip, normal, {1, 0})};
    emit_grid(v, 1, 1);
}

void MeshMaker::blade(const dvec3& base, const dvec3& tip, const dvec3& side, const dvec3& normal) {
    const std::uint32_t a = vertex(base - side, normal, {0, 1}), b = vertex(base + side, normal, {1, 1}),
                        c = vertex(tip, normal, {0.5, 0});
    emit(a, b, c);
}

std::size_t MeshMaker::triangles() const {
    std::size_t sum = 0;
    for (const importer::Primitive& p : mesh_.primitives) sum += p.indices.size() / 3;
    return sum;
}

}  // namespace surefoot::scenes
