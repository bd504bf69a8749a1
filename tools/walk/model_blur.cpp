// Measuring blur on a model (model_blur.hpp).
#include "tools/walk/model_blur.hpp"

#include "render/measure/blur.hpp"

namespace surefoot::walk {

std::vector<Pose> poses_along(const Path& path, std::uint32_t count) {
    std::vector<Pose> poses;
    const double length_s = path.duration_s();
    if (!(length_s > 0) && count > 1) count = 1;
    for (std::uint32_t i = 0; i < count; ++i) poses.push_back(sample_path(path, length_s * (i + 0.5) / count));
    return poses;
}

Result<model::BlurLoss> measure_blur(Engine& engine, std::span<const Pose> poses, const Progress& progress) {
    gl::Device& device = engine.device();
    device.draws.plays();
    std::vector<measure::PoseBlur> losses;
    gl::PixelImage full;
    for (const Pose& pose : poses) {
        const std::vector<gl::DrawItem> items = engine.full_detail(pose);
        measure::PoseBlur& of_pose = losses.emplace_back();
        for (std::size_t step = 0; step < model::resolution_steps.size(); ++step) {
            if (progress.stopped())
                return Error{"calibration", "The calibration was stopped: nothing was written", "Run it again",
                             ErrorKind::stopped};
            engine.draw_unbudgeted(pose, items, model::resolution_steps[step]);
            auto picture = device.read_pixels();
            if (!picture) return picture.error();
            if (step == 0)
                full = std::move(*picture);
            else
                of_pose[step] = measure::blur_loss_of(picture->rgba, full.rgba);
        }
        progress.update("blur", static_cast<double>(losses.size()) / static_cast<double>(poses.size()));
    }
    if (device.lost())
        return Error{"calibration", "The device was lost, so its pictures mean nothing", "Restart the driver, and try again",
                     ErrorKind::no_device};
    return measure::mean_blur_loss(losses);
}

}  // namespace surefoot::walk
