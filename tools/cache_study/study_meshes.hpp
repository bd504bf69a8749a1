// Meshes in place of planes, for a study: their making from depths that were read back, and the choice of a kind by its price.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "render/cache/boxes.hpp"
#include "render/cache/depth_mesh.hpp"
#include "render/gl/device.hpp"
#include "rt/base/named.hpp"

namespace surefoot::cache_study {

/// What shows a picture: faces of its box, blended; a mesh of its depths, opaque; or for each the one that costs less.
enum class PictureKind : std::uint8_t { quad, mesh, cheaper };
std::span<const Named> picture_kinds();
/// Of a name of picture_kinds().
PictureKind picture_kind_named(std::string_view name);

/// Share of the plane's error that a mesh may have.
constexpr double mesh_share = 0.5;
constexpr std::uint32_t max_mesh_triangles = 8192;

/// What became of meshes, since the last take_counts().
struct MeshCounts {
    std::uint32_t made = 0, too_dear = 0;
    double read_texels = 0, making_cpu_ms = 0;
};

/// The mesh of each box, if it has one.
class StudyMeshes {
public:
    StudyMeshes(std::size_t boxes, PictureKind kind);
    [[nodiscard]] bool any() const { return kind_ != PictureKind::quad; }

    /// A new picture: where its depths are to be read. Its earlier mesh is gone.
    std::span<float> depths_of(cache::Index box, std::uint32_t texels);
    /// A picture without depths: one of pictures.
    void drop(cache::Index box);

    /// How a picture is seen.
    struct Seen {
        double faces_px = 0;   ///< what the faces of its box cover, as a quad
        double texels_px = 0;  ///< what one of its texels covers
    };
    /// Whether a mesh shows the picture. It is made where it is first needed. `held`: as it was captured.
    bool shows(cache::Index box, const gl::CachePicture& held, const cache::Picture& picture, const Seen& seen);
    [[nodiscard]] gl::PictureMesh mesh(cache::Index box, const gl::CachePicture& held) const;
    MeshCounts take_counts();

private:
    enum class State : std::uint8_t { empty, read, made, too_dear };
    /// A box's mesh.
    struct BoxMesh {
        State state = State::empty;
        std::uint32_t covered = 0;
        std::vector<float> depths;
        std::vector<gl::MeshCorner> corners;
        std::vector<std::uint16_t> indices;
    };
    void make(BoxMesh& mesh, const gl::CachePicture& held, const cache::Picture& picture, const Seen& seen);

    PictureKind kind_;
    cache::KindPrices prices_;
    cache::DepthMesher mesher_;
    std::vector<BoxMesh> meshes_;
    MeshCounts counts_;
};

}  // namespace surefoot::cache_study
