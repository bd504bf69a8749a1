// Uploading textures (texture_upload.hpp).
#include "render/gl/texture_upload.hpp"

#include <algorithm>
#include <string>

namespace surefoot::gl {

Result<GLuint> upload_array(const Api& gl, const model::Model& model, const draw::TextureArray& array, bool soft) {
    GLint largest = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (std::max(array.width, array.height) > static_cast<std::uint32_t>(largest)) {
        return Error{"texture of " + std::to_string(array.width) + " x " + std::to_string(array.height),
                     "The texture is larger than the device's limit", "Scale the image down to " + std::to_string(largest),
                     ErrorKind::out_of_limits};
    }
    GLuint id = 0;
    gl.GenTextures(1, &id);
    gl.BindTexture(GL_TEXTURE_2D_ARRAY, id);
    const auto levels = static_cast<GLsizei>(array.levels);
    gl.TexStorage3D(GL_TEXTURE_2D_ARRAY, levels, GL_RGBA8, static_cast<GLsizei>(array.width), static_cast<GLsizei>(array.height),
                    static_cast<GLsizei>(array.layers.size()));
    for (std::size_t layer = 0; layer < array.layers.size(); ++layer) {
        std::uint64_t byte = model.textures[array.layers[layer]].first_byte;
        for (GLsizei level = 0; level < levels; ++level) {
            const std::uint32_t w = std::max(1U, array.width >> static_cast<unsigned>(level));
            const std::uint32_t h = std::max(1U, array.height >> static_cast<unsigned>(level));
            gl.TexSubImage3D(GL_TEXTURE_2D_ARRAY, level, 0, 0, static_cast<GLint>(layer), static_cast<GLsizei>(w),
                             static_cast<GLsizei>(h), 1, GL_RGBA, GL_UNSIGNED_BYTE, model.texels.data() + byte);
            byte += 4ULL * w * h;
        }
    }
    const GLint smaller = levels == 1 ? GL_LINEAR : soft ? GL_LINEAR_MIPMAP_NEAREST : GL_LINEAR_MIPMAP_LINEAR;
    const GLint wrap = array.clamp ? GL_CLAMP_TO_EDGE : GL_REPEAT;
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, smaller);
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_S, wrap);
    gl.TexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_WRAP_T, wrap);
    return id;
}

}  // namespace surefoot::gl
