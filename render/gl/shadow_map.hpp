// The depth picture of what casts shadows, and its texture unit.
#pragma once

#include "render/gl/api.hpp"
#include "rt/base/result.hpp"

namespace surefoot::gl {

/// A depth texture that compares as it is sampled, with its framebuffer. 0: there is none.
struct ShadowMap {
    GLuint framebuffer = 0, depth = 0;
};

/// Makes it, all in the sun, and binds it to its unit. Unit 0 is the active one after it.
Result<ShadowMap> make_shadow_map(const Api& gl);
void free_shadow_map(const Api& gl, ShadowMap& map);

}  // namespace surefoot::gl
