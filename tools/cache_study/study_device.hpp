// Draws the frames of a study with the product's device: by the image cache, in full, and with one picture an object.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/cache/update.hpp"
#include "render/gl/device.hpp"
#include "tools/cache_study/study_meshes.hpp"
#include "tools/cache_study/study_model.hpp"

namespace surefoot::cache_study {

/// How a study is drawn.
struct DrawingOptions {
    gl::BackendKind backend = gl::BackendKind::egl;
    model::Viewport viewport{320, 240};
    double fov_y_rad = Pose{}.fov_y_rad;
    Colouring colouring = Colouring::shaded;
    cache::PlanePlace plane = cache::PlanePlace::harmonic_mean;  ///< where pictures are captured and shown
    bool pictures = true;                                        ///< else it can only draw in full
    PictureKind kind = PictureKind::quad;
};

/// What a frame took, until the picture was whole.
struct DrawTimes {
    double ms = 0, cpu_ms = 0;  ///< on the wall, and of all threads of the process
};

/// Times from where it is made.
class Stopwatch {
public:
    Stopwatch();
    [[nodiscard]] DrawTimes spent() const;

private:
    DrawTimes begun_;
};

/// What a frame of the cache is made of.
struct DrawnFrame {
    DrawTimes times;
    std::uint32_t pictures = 0, leaves = 0;  ///< drawn: pictures, and boxes as triangles
    std::uint32_t meshes = 0;                ///< of the pictures
    std::uint64_t mesh_triangles = 0;
    MeshCounts made;
};

/// A device that holds a scene and the pictures of its boxes. All calls on one thread.
class StudyDevice {
public:
    static Result<std::unique_ptr<StudyDevice>> open(const StudyScene& scene, const DrawingOptions& options);

    /// Before the other calls, wherever another device was used since.
    void use();
    [[nodiscard]] std::string renderer() const { return device_->renderer(); }
    [[nodiscard]] Pose pose_at(const dvec3& eye) const;
    /// Makes the pictures of a plan and draws its frame, as far as it is in view. Every plan once, in order.
    DrawnFrame draw_cached(const cache::CachePlan& plan, const Pose& pose, const cache::PixelAngles& pixels);
    DrawTimes draw_full(const Pose& pose);
    /// As before the image cache: a picture of each object, new, that hides as its plane does. Objects that are too near for
    /// 256 texels are triangles. It uses the places of the cache's pictures.
    DrawnFrame draw_objects(const Pose& pose, const cache::PixelAngles& pixels);
    Result<gl::PixelImage> read_pixels();

private:
    StudyDevice(const StudyScene& scene, const DrawingOptions& options, StudyModel made);

    [[nodiscard]] gl::CachePicture captured_picture(const Box& box, const cache::Picture& picture,
                                                    const cache::PixelAngles& pixels, std::uint32_t layer) const;
    void make_pictures(const cache::CachePlan& plan, const Pose& pose, const cache::PixelAngles& pixels);
    [[nodiscard]] gl::CachePicture shown_picture(cache::Index i) const;
    void add_children(cache::Index parent, cache::Index first, std::uint32_t count, const dvec3& eye,
                      std::vector<gl::CachePicture>& to) const;
    void capture(const Pose& pose, const gl::CachePicture& picture, const std::vector<gl::DrawItem>& items,
                 const std::vector<gl::CachePicture>& children, std::span<float> depths);
    void begin(const Pose& pose);
    void finish();
    void show(cache::Index box, const cache::Picture& picture, const Pose& pose, DrawnFrame& drawn);
    [[nodiscard]] model::Frustum frustum_of(const Pose& pose) const;

    const StudyScene& scene_;
    DrawingOptions options_;
    StudyModel made_;
    std::unique_ptr<gl::Device> device_;
    std::vector<gl::CachePicture> held_;  ///< one a box: as captured
    std::vector<double> seam_m_;          ///< one a box: by so much it is grown where it is shown
    std::vector<std::vector<gl::CachePicture>> children_;
    std::vector<gl::DrawItem> items_;
    std::vector<gl::CachePicture> pictures_;
    StudyMeshes meshes_;
    std::vector<gl::PictureMesh> shown_meshes_;
};

}  // namespace surefoot::cache_study
