// Meshes of a study's pictures.
#include "tools/cache_study/study_meshes.hpp"

#include <time.h>

#include <algorithm>
#include <array>
#include <utility>

#include "render/gl/picture_faces.hpp"

namespace surefoot::cache_study {

namespace {

constexpr std::array<Named, 3> kinds = {Named{"quad", "faces of the box, blended"},
                                        Named{"meshed", "a mesh of the depths, opaque"},
                                        Named{"cheaper", "for each picture the one that costs less to draw"}};

double thread_cpu_ms() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace

std::span<const Named> picture_kinds() { return kinds; }

PictureKind picture_kind_named(std::string_view name) {
    for (std::size_t i = 0; i < kinds.size(); ++i)
        if (kinds[i].name == name) return static_cast<PictureKind>(i);
    return PictureKind::quad;
}

StudyMeshes::StudyMeshes(std::size_t boxes, PictureKind kind)
    : kind_(kind),
      mesher_(kind == PictureKind::quad ? 1 : gl::picture_layer_px, kind == PictureKind::quad ? 2 : max_mesh_triangles),
      meshes_(boxes) {}

std::span<float> StudyMeshes::depths_of(cache::Index box, std::uint32_t texels) {
    BoxMesh& mesh = meshes_[box];
    mesh.state = State::read;
    mesh.depths.assign(std::size_t{texels} * texels, 0.0F);
    counts_.read_texels += 1.0 * texels * texels;
    return mesh.depths;
}

void StudyMeshes::drop(cache::Index box) { meshes_[box].state = State::empty; }

void StudyMeshes::make(BoxMesh& mesh, const gl::CachePicture& held, const cache::Picture& picture, const Seen& seen) {
    const double start_ms = thread_cpu_ms();
    const auto per_m = static_cast<float>(1 / gl::nearest_depth_m(held));
    mesh.covered = 0;
    for (float& depth : mesh.depths) {
        depth *= per_m;
        mesh.covered += depth > 0 ? 1 : 0;
    }
    cache::DepthMeshLimits limits{static_cast<float>(cache::mesh_tolerance(picture, mesh_share)), max_mesh_triangles};
    if (kind_ == PictureKind::cheaper) {
        const double room = prices_.max_triangles(seen.faces_px, seen.texels_px * mesh.covered);
        limits.max_triangles = static_cast<std::uint32_t>(std::min<double>(limits.max_triangles, room));
    }
    const cache::DepthMeshResult result = mesher_.make(mesh.depths, held.place.texels, limits);
    mesh.state = result == cache::DepthMeshResult::too_dear ? State::too_dear : State::made;
    mesh.depths = {};
    mesh.corners.clear();
    for (const cache::DepthCorner& corner : mesher_.corners()) {
        const dvec2 at = (held.low_m + dvec2(corner.x, corner.y) * (held.side_m / held.place.texels)) / held.plane_m;
        const dvec3 place = (held.right * at.x + held.up * at.y + held.forward) / static_cast<double>(corner.inverse_depth);
        mesh.corners.push_back({vec3(place), vec2(corner.at_x, corner.at_y)});
    }
    mesh.indices.assign(mesher_.indices().begin(), mesher_.indices().end());
    ++(mesh.state == State::made ? counts_.made : counts_.too_dear);
    counts_.making_cpu_ms += thread_cpu_ms() - start_ms;
}

bool StudyMeshes::shows(cache::Index box, const gl::CachePicture& held, const cache::Picture& picture, const Seen& seen) {
    BoxMesh& mesh = meshes_[box];
    if (!any() || mesh.state == State::empty) return false;
    if (mesh.state == State::read) make(mesh, held, picture, seen);
    if (mesh.state != State::made) return false;
    if (kind_ == PictureKind::mesh) return true;
    const double triangles = static_cast<double>(mesh.indices.size()) / 3;
    return prices_.mesh(seen.texels_px * mesh.covered, triangles) < prices_.quad(seen.faces_px);
}

gl::PictureMesh StudyMeshes::mesh(cache::Index box, const gl::CachePicture& held) const {
    return {held.place, held.eye, meshes_[box].corners, meshes_[box].indices};
}

MeshCounts StudyMeshes::take_counts() { return std::exchange(counts_, {}); }

}  // namespace surefoot::cache_study
