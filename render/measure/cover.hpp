// Whether a flat triangle lies wholly within some distance of a surface: what surface triangles cover of it, subtracted piece
// by piece in its plane. Where many small triangles lie along a large one, no single one of them is near all of it; together
// they are. Exact but for a stated margin.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "rt/base/geometry.hpp"

namespace surefoot::measure {

class Cover {
public:
    /// The triangle to be covered. margin: pieces narrower than this count as covered; callers add it to their bound.
    Cover(const vec3& a, const vec3& b, const vec3& c, double margin);
    /// Takes away what lies under or over the triangle (along this one's normal) within `within` of it.
    /// False: too many pieces are left to go on; nothing is lost, but ask again with a smaller triangle.
    bool subtract(const vec3& a, const vec3& b, const vec3& c, double within);
    [[nodiscard]] bool done() const { return left_.empty(); }
    /// Largest distance along the normal at which something was covered.
    [[nodiscard]] double reach() const { return reach_; }
    /// The middle of one of the pieces left; not done().
    [[nodiscard]] vec3 uncovered() const;

private:
    struct Polygon {
        std::array<dvec2, 16> points;
        std::size_t count = 0;
        dvec2 low{0}, high{0};  ///< of its points
        void measure();
    };
    /// Splits `inside` at the line; what is to its right is added to `outside`.
    void split(Polygon& inside, const dvec2& from, const dvec2& to, std::vector<Polygon>& outside) const;

    dvec3 origin_, u_, v_, normal_;
    double margin_ = 0, reach_ = 0;
    std::vector<Polygon> left_, next_, parts_;
};

}  // namespace surefoot::measure
