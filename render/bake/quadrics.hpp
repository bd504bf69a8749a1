// Quadric errors of positions and of attributes (Garland and Heckbert 1997; Hoppe 1999).
#pragma once

#include <array>
#include <cstddef>

#include "rt/base/geometry.hpp"

namespace surefoot::bake {

/// Of a vertex: normal, texture coordinates, colour.
constexpr std::size_t attributes = 8;
using Attributes = std::array<double, attributes>;

/// Sums of squared distances to planes, weighted by area.
struct PlaneQuadric {
    std::array<double, 6> a{};  ///< symmetric: xx, xy, xz, yy, yz, zz
    dvec3 b{0};
    double c = 0;

    void add_plane(const dvec3& n, double d, double weight) {
        a[0] += weight * n.x * n.x;
        a[1] += weight * n.x * n.y;
        a[2] += weight * n.x * n.z;
        a[3] += weight * n.y * n.y;
        a[4] += weight * n.y * n.z;
        a[5] += weight * n.z * n.z;
        b += weight * d * n;
        c += weight * d * d;
    }
    void add(const PlaneQuadric& q) {
        for (std::size_t i = 0; i < a.size(); ++i) a[i] += q.a[i];
        b += q.b;
        c += q.c;
    }
    [[nodiscard]] double at(const dvec3& p) const {
        const double square =
            a[0] * p.x * p.x + a[3] * p.y * p.y + a[5] * p.z * p.z + 2 * (a[1] * p.x * p.y + a[2] * p.x * p.z + a[4] * p.y * p.z);
        return square + 2 * glm::dot(b, p) + c;
    }
};

/// Sums of squared differences to attributes that are linear on their triangles, weighted by area.
struct AttributeQuadric {
    PlaneQuadric squares;                      ///< of all attributes' linear functions
    std::array<dvec3, attributes> gradient{};  ///< weighted sums
    Attributes offset{};
    double weight = 0;

    void add_linear(std::size_t which, const dvec3& g, double d, double area) {
        squares.add_plane(g, d, area);
        gradient[which] += area * g;
        offset[which] += area * d;
    }
    void add(const AttributeQuadric& q) {
        squares.add(q.squares);
        for (std::size_t i = 0; i < attributes; ++i) {
            gradient[i] += q.gradient[i];
            offset[i] += q.offset[i];
        }
        weight += q.weight;
    }
    [[nodiscard]] double at(const dvec3& p, const Attributes& s) const {
        double sum = squares.at(p), all = 0;
        for (std::size_t i = 0; i < attributes; ++i) {
            sum -= 2 * s[i] * (glm::dot(gradient[i], p) + offset[i]);
            all += s[i] * s[i];
        }
        return sum + weight * all;
    }
};

}  // namespace surefoot::bake
