// A slow and exact judge of what stops a walker: which triangles block, and distances, contacts, floors and crossings of those.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "render/import/scene.hpp"
#include "rt/base/geometry.hpp"

namespace surefoot::exact {

/// [node][triangle], through the primitives in order. Empty: no mesh, an empty one, or a matrix that cannot be inverted.
std::vector<std::vector<bool>> blocking_triangles(const importer::Scene& scene);

/// Numbered boxes in sorted bins. Each lies in one bin: by the power of two above its longest side, and its lowest corner.
class Bins {
public:
    void add(const Box& box, std::uint32_t number);
    void sort();  ///< once, after the last add
    /// Numbers of all boxes that meet this one, and of some others near it. Sides may be infinite.
    [[nodiscard]] std::vector<std::uint32_t> near(const Box& box) const;

private:
    struct Entry {
        std::array<double, 3> bin{};  ///< x, z, y
        std::uint32_t number = 0;
        bool operator<(const Entry& other) const { return bin < other.bin; }
    };
    std::map<int, std::vector<Entry>> levels_;  ///< by the exponent of the bins' side
};

/// Numbered boxes by the columns that they stand on, for upright lines. Those that cover many columns are in no column.
class Columns {
public:
    void build(std::span<const Box> boxes);
    /// Numbers of all boxes that the line meets, and of no other.
    template <class Use>
    void at(double x, double z, const Use& use) const {
        for (const std::uint32_t number : wide_) use_if_met(number, x, z, use);
        const double column = std::floor((x - low_x_) / side_m_), row = std::floor((z - low_z_) / side_m_);
        if (!(column >= 0 && row >= 0 && column < static_cast<double>(sides_) && row < static_cast<double>(sides_))) return;
        const std::size_t cell = static_cast<std::size_t>(row) * sides_ + static_cast<std::size_t>(column);
        for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) use_if_met(numbers_[i], x, z, use);
    }

private:
    template <class Use>
    void use_if_met(std::uint32_t number, double x, double z, const Use& use) const {
        const Box& box = boxes_[number];
        if (x >= box.min.x && x <= box.max.x && z >= box.min.z && z <= box.max.z) use(number);
    }
    std::vector<Box> boxes_;
    double low_x_ = 0, low_z_ = 0, side_m_ = 1;
    std::size_t sides_ = 0;  ///< columns each way
    std::vector<std::uint32_t> first_, numbers_, wide_;
};

/// A triangle of a node's mesh, counted through the mesh's primitives.
struct Hit {
    std::uint32_t node = 0, triangle = 0;
    bool operator==(const Hit&) const = default;
};

/// The blocking triangles in the world, in doubles. A capsule is a level radius around an upright segment that starts at `low`
/// and is `length` high (0 or more).
class ExactGround {
public:
    static constexpr double none = 2.0;  ///< share of a move without contact

    ExactGround(const importer::Scene& scene, const std::vector<std::vector<bool>>& blocking);

    [[nodiscard]] std::size_t triangles() const { return triangles_.size(); }
    /// Smallest distance of the segment to a triangle; infinite beyond up_to.
    [[nodiscard]] double distance(const dvec3& low, double length, double up_to) const;
    [[nodiscard]] double penetration(const dvec3& low, double length, double radius) const;
    /// Smallest share of the move, 0 to 1, at which the capsule comes within its radius of a triangle, by over 1e-12 m. 0 if it
    /// is within it at first and then comes nearer to that triangle. Triangles that it leaves or slides along do not count.
    [[nodiscard]] double first_contact(const dvec3& low, double length, double radius, const dvec3& move) const;
    /// Sorted heights, one a triangle, at which the upright line meets triangles with |unit normal y| >= min_normal_y > 0.
    [[nodiscard]] std::vector<double> floors_at(double x, double z, double min_normal_y) const;
    /// The first triangle, seen from a, whose plane has a and b strictly on two sides, and whose face or rim the segment meets.
    [[nodiscard]] std::optional<Hit> crosses(const dvec3& a, const dvec3& b) const;

private:
    struct Triangle {
        std::array<dvec3, 3> corners{};
        Hit id;
    };
    std::vector<Triangle> triangles_;
    Bins bins_;
    Columns columns_;
};

}  // namespace surefoot::exact
