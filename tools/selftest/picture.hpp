// Pictures for rows: a device on whatever software or hardware GL there is, and models of a few squares.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/model.hpp"
#include "rt/base/result.hpp"
#include "tools/selftest/hard.hpp"

namespace surefoot::selftest {

/// What `effort` names, else EGL without a surface, else OSMesa. The outcome says why there is none.
std::unique_ptr<gl::Device> open_picture(model::Viewport viewport, const Effort& effort, Outcome& outcome);

/// Uploads the model; says in `outcome` if the device refuses it.
bool load(gl::Device& device, const model::Model& model, Outcome& outcome);

/// The items in this order, a slice each.
gl::PixelImage draw(gl::Device& device, std::span<const gl::DrawItem> items, const Pose& pose);

/// The finest form of every leaf, in order of nodes.
std::vector<gl::DrawItem> finest_of(const model::Model& model);

/// A root over flat objects of one colour and one form each.
class Squares {
public:
    Squares();
    /// A parallelogram with corners origin, origin + along, origin + along + up, origin + up, seen from both sides, as an object
    /// of its own; positions about `origin`. Returns its node.
    model::Index add(const dvec3& origin, const vec3& along, const vec3& up, std::array<float, 3> colour,
                     const mat3& linear = mat3(1.0F));
    [[nodiscard]] model::Model finish();

private:
    model::Model model_;
};

/// The pixel's first three bytes equal the colour's.
bool is_colour(const gl::PixelImage& image, std::uint32_t x, std::uint32_t y, std::array<std::uint8_t, 3> colour);

}  // namespace surefoot::selftest
