// The light of boxes with pictures: what falls on what a face shows, at each moment of the day.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "render/bake/capture_box.hpp"
#include "render/bake/form_picture.hpp"
#include "render/model/daylight.hpp"
#include "render/model/model.hpp"

namespace surefoot::bake {

/// Sums over samples of what falls on them. Each counts by the brightness that its surface would have in a light of 1.
struct LightSums {
    enum Of : std::uint8_t { sky, ground, room, red, green, blue, first_sun };  ///< red, green, blue: lamps, as LampLight's most
    float weight = 0;
    std::array<float, first_sun + sizeof(model::SunSeen)> of{};
    void add(const LightSums& more, float times);
};

/// What a face was captured from.
struct FaceSource {
    const FormPicture& seen;  ///< keeps its sources
    std::span<const FaceSample> samples;
    std::uint32_t pixels = 0;  ///< of the face's side
};

/// Takes the light from pictures of faces, and gives it to their corners.
class BoxLight {
public:
    explicit BoxLight(const model::Model& model);
    /// Fills face.light, and divides all texels by that light in the model's own. In that, the face looks as before.
    void take_from(FaceCapture& face, const FaceSource& source) const;
    /// What falls on one sample.
    [[nodiscard]] LightSums on(const FormSample& sample, const SampleSource& source) const;

private:
    const model::Model& model_;
    model::Daylight own_;
    std::array<vec3, sizeof(model::SunSeen)> suns_{};
    std::vector<mat3> normals_;  ///< by node: turns normals of its full detail into the world
};

}  // namespace surefoot::bake
