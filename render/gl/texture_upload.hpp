// Uploads an array of textures of equal size, levels and wrap.
#pragma once

#include "render/draw/texture_arrays.hpp"
#include "render/gl/api.hpp"
#include "render/model/model.hpp"
#include "rt/base/result.hpp"

namespace surefoot::gl {

/// soft: nearest mip level instead of trilinear, which costs software GL time for every pixel.
Result<GLuint> upload_array(const Api& gl, const model::Model& model, const draw::TextureArray& array, bool soft);

}  // namespace surefoot::gl
