// Rays through what blocks a walker: trees over the triangles of a ground, made for a bake and thrown away with it.
// Source: splits by the surface area heuristic in bins, Wald 2007, section 3.
#pragma once

#include <cstdint>
#include <vector>

#include "render/model/ground.hpp"

namespace surefoot::bake {

/// A ray in the world. direction: unit.
struct Ray {
    dvec3 from{0.0}, direction{0.0};
    double max_m = 0;
};

/// A ground, ready for rays. Constant once made; any thread may ask. About 60 bytes a triangle. The ground must outlive it.
class RayTree {
public:
    explicit RayTree(const model::Ground& ground);

    /// Metres to the nearest triangle within max_m, whichever side it shows; infinity: none. Single floats: right within a
    /// millionth of a mesh's size, and where triangles meet a ray in a million may slip through.
    [[nodiscard]] double nearest_hit_m(const Ray& ray) const;
    /// Whether there is one. Ends at the first that it finds.
    [[nodiscard]] bool is_blocked(const Ray& ray) const;

private:
    struct Node {
        vec3 low{0.0F}, high{0.0F};
        std::uint32_t first = 0;  ///< triangle, or the first of two children
        std::uint32_t count = 0;  ///< of triangles; 0: two children
    };
    /// A corner and two sides.
    struct Triangle {
        vec3 corner{0.0F}, u{0.0F}, v{0.0F};
    };
    /// In a frame of its own, about `middle`.
    struct Mesh {
        dvec3 middle{0.0};
        std::vector<Node> nodes;
        std::vector<Triangle> triangles;
    };
    struct Bounds;
    struct Building;
    /// Of one instance or several: where they are, with a little room.
    struct Around {
        dvec3 middle{0.0};
        vec3 half{0.0F};
    };
    /// A ray in a mesh's frame; its way is as long as the ray.
    struct LocalRay {
        vec3 from{0.0F}, way{0.0F};
    };

    static Mesh make_mesh(const model::Ground& ground, const model::GroundMesh& mesh);
    static bool cross_mesh(const Mesh& mesh, const LocalRay& ray, bool any, float& share);
    [[nodiscard]] float first_share(const Ray& ray, bool any) const;

    const model::Ground& ground_;
    std::vector<Mesh> meshes_;
    std::vector<dmat3> inverse_;  ///< by instance
    std::vector<Around> around_;  ///< by node of the tree of instances
};

}  // namespace surefoot::bake
