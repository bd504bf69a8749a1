// Builds meshes from boxes, tubes, lathes and free surfaces, one primitive a material.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "render/import/scene.hpp"

namespace surefoot::scenes {

using importer::Index;
using Colour = std::array<std::uint8_t, 4>;

constexpr double pi = 3.14159265358979323846;

/// sRGB, 0..255.
constexpr Colour rgb(int r, int g, int b) {
    return {static_cast<std::uint8_t>(r), static_cast<std::uint8_t>(g), static_cast<std::uint8_t>(b), 255};
}
/// A lighter (factor > 1) or darker one.
Colour shade(const Colour& colour, double factor);
Colour mix(const Colour& a, const Colour& b, double t);

dmat4 move(const dvec3& by);
dmat4 turn_y(double angle_rad);
dmat4 turn(double angle_rad, const dvec3& axis);
dmat4 stretch(const dvec3& by);

/// What the next shapes are made of, and where.
struct Brush {
    Index material = 0;
    Colour colour{255, 255, 255, 255};
    dmat4 frame{1.0};       ///< shape to mesh; not mirrored
    double uv_per_m = 1.0;  ///< repeats of the texture a metre
};

/// Collects the triangles of a mesh, a primitive for each material.
class MeshMaker {
public:
    explicit MeshMaker(std::string name) { mesh_.name = std::move(name); }

    Brush brush;

    /// Corners in order around; texture coordinates in metres along ab and across, so that neighbours in a plane agree.
    void quad(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d);
    /// The same with texture 0..1 across it.
    void picture(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d);
    void triangle(const dvec3& a, const dvec3& b, const dvec3& c);
    void box(const dvec3& low, const dvec3& high);
    /// A closed surface of revolution about y: (radius, y) from bottom to top; a point given twice makes an edge.
    void lathe(std::span<const dvec2> profile, int sides);
    void ellipsoid(const dvec3& centre, const dvec3& radii, int sides, int rings);
    /// Between box (roundness 0) and ellipsoid (1).
    void cushion(const dvec3& centre, const dvec3& half, double roundness, int sides, int rings);
    /// Round about a line of centres; open ends are closed by cones of no height when `capped`.
    void tube(std::span<const dvec3> centres, std::span<const double> radii, int sides, bool capped);
    void rod(const dvec3& from, const dvec3& to, double radius, int sides);
    /// (columns x rows) cells of at(u, v), u and v in 0..1; normals from the neighbours. Front: u to v counter-clockwise.
    void surface(int columns, int rows, const std::function<dvec3(double, double)>& at);
    /// One leaf or tuft: a rhombus or triangle with a normal of one's own (leaves are shaded as their crown is).
    void leaf(const dvec3& base, const dvec3& tip, const dvec3& side, const dvec3& normal);
    void blade(const dvec3& base, const dvec3& tip, const dvec3& side, const dvec3& normal);

    [[nodiscard]] std::size_t triangles() const;
    /// The mesh, which must not be empty.
    importer::Mesh take() { return std::move(mesh_); }

private:
    importer::Primitive& part();
    std::uint32_t vertex(const dvec3& position, const dvec3& normal, const dvec2& uv);
    void emit(std::uint32_t a, std::uint32_t b, std::uint32_t c);
    void emit_grid(std::span<const std::uint32_t> vertices, int columns, int rows);

    importer::Mesh mesh_;
};

}  // namespace surefoot::scenes
