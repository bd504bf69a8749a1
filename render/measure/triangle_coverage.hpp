// Triangle coverage: tests whether a triangle lies wholly within some distance of a surface. Surface triangles are projected into
// its plane and subtracted from it, one by one. Needed where many small triangles lie along a large one: only together do they
// cover it. Exact, but for a stated margin.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "rt/base/geometry.hpp"

namespace surefoot::measure {

/// Tracks which part of one triangle is covered by pieces.
class TriangleCoverage {
public:
    /// The triangle to be covered. margin: narrower pieces count as covered, so callers must add it to their bound.
    TriangleCoverage(const vec3& a, const vec3& b, const vec3& c, double margin);
    /// Subtracts the part that lies along this triangle's normal within distance `within` of the triangle a, b, c.
    /// False: too many pieces are left. The state stays valid; try again with a smaller triangle.
    bool subtract(const vec3& a, const vec3& b, const vec3& c, double within);
    [[nodiscard]] bool done() const { return left_.empty(); }
    /// Largest distance along the normal of any covered part.
    [[nodiscard]] double reach() const { return reach_; }
    /// The centre of one remaining piece. Requires !done().
    [[nodiscard]] vec3 uncovered() const;

private:
    struct Polygon {
        std::array<dvec2, 16> points;
        std::size_t count = 0;
        dvec2 low{0}, high{0};  ///< of its points
        void measure();
    };
    /// Splits `inside` at the line. The part to the right of the line is added to `outside`.
    void split(Polygon& inside, const dvec2& from, const dvec2& to, std::vector<Polygon>& outside) const;

    dvec3 origin_, u_, v_, normal_;
    double margin_ = 0, reach_ = 0;
    std::vector<Polygon> left_, next_, parts_;
};

}  // namespace surefoot::measure
