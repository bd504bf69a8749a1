// Whether pictures of the image cache show the scene: frames by the cache beside frames drawn in full, pixel by pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "render/cache/update.hpp"
#include "render/gl/device.hpp"
#include "rt/base/progress.hpp"
#include "tools/cache_study/study_meshes.hpp"
#include "tools/cache_study/study_scenes.hpp"

namespace surefoot::cache_study {

/// Samples of a pixel, across and up, of the picture that frames are compared with; fewer where that would be too large.
constexpr std::uint32_t samples_a_side = 8, max_fine_px = 4096;

/// What of a picture of full colours is not there in the scene.
struct WrongPixels {
    std::uint64_t pixels = 0, wrong = 0;
    std::vector<bool> at;  ///< one a pixel, row 0 on top
};

/// `fine` is the scene in full colours, a whole number of times as wide and high. A channel of a pixel is on from half on. It is
/// right to be on, or off, only where a sample within a pixel all round is so too. Pixels at the edge of the picture are not
/// compared: what is beside them is not known.
WrongPixels wrong_pixels(const gl::PixelImage& image, const gl::PixelImage& fine);

/// Wrong pixels whose colour is that of objects with a triangle within a pixel, hidden by others. A picture that moves by less
/// than a pixel shows what was just hidden.
std::uint64_t uncovered_pixels(const StudyScene& scene, const Pose& pose, const gl::PixelImage& image, const WrongPixels& wrong);

/// Which frames are compared, and by what pictures they are drawn.
struct CheckRequest {
    std::uint32_t width = 320, height = 240;
    double fov_y_rad = Pose{}.fov_y_rad;
    gl::BackendKind backend = gl::BackendKind::egl;
    cache::ValidityRules rules = cache::ValidityRules::corrected;
    cache::PlanePlace plane = cache::PlanePlace::harmonic_mean;
    PictureKind kind = PictureKind::quad;
    bool by_object = false;               ///< one picture an object, and no cache
    std::uint32_t first = 0, frames = 0;  ///< of the scene's eyes; frames 0: all
    std::uint32_t every = 1;              ///< of them one is compared
};

/// Frames, summed.
struct CheckedFrames {
    std::uint32_t frames = 0, wrong_frames = 0;
    std::uint64_t pixels = 0, wrong = 0;
    std::uint64_t uncovered = 0;             ///< of the wrong ones: what they show lies there, hidden by something else
    std::uint64_t pictures = 0, leaves = 0;  ///< drawn in them
    std::uint64_t meshes = 0;                ///< of the pictures
    std::uint64_t worst = 0;                 ///< wrong pixels of one frame
};

/// Walks with a cache that draws in full colours. Errors: of the device. Stops early where the user wants it.
Result<CheckedFrames> check_pictures(const StudyScene& scene, const CheckRequest& request, const Progress& progress);

}  // namespace surefoot::cache_study
