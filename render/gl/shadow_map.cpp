// The shadow map of a GL device: its texture, and drawing into it (shadow_map.hpp, gl_device.hpp).
#include "render/gl/shadow_map.hpp"

#include <algorithm>
#include <array>

#include "render/gl/gl_device.hpp"
#include "render/gl/undone.hpp"

namespace surefoot::gl {

namespace {

/// Effects with which a caster's part is drawn: those that cut holes, and none where there are no holes.
model::EffectMask caster_mask(model::EffectMask mask) {
    constexpr model::EffectMask of_holes = model::effect_texture | model::effect_vertex_colour | model::effect_alpha_mask;
    return (mask & model::effect_alpha_mask) != 0 ? mask & of_holes : 0;
}

}  // namespace

Result<ShadowMap> make_shadow_map(const Api& gl) {
    Undone<ShadowMap> made(gl, free_shadow_map);
    ShadowMap& map = made.value;
    constexpr auto side = static_cast<GLsizei>(shadow_map_px);
    gl.GenTextures(1, &map.depth);
    gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(shadow_unit));
    gl.BindTexture(GL_TEXTURE_2D, map.depth);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, side, side, 0, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, nullptr);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
    gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(material_unit));
    gl.GenFramebuffers(1, &map.framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, map.framebuffer);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, map.depth, 0);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error{"shadow map", "The device cannot draw into a depth texture", "Bake the model without what moves",
                     ErrorKind::unsupported};
    gl.DepthMask(GL_TRUE);
    gl.ClearDepthf(0.0F);
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    return made.keep();
}

void free_shadow_map(const Api& gl, ShadowMap& map) {
    gl.DeleteFramebuffers(1, &map.framebuffer);
    gl.DeleteTextures(1, &map.depth);
    map = {};
}

/// A map where a program reads one, and the programs that draw it where something moves.
Result<void> GlDevice::load_shadow(const model::Model& model, const ProgramFactory& programs) {
    free_shadow_map(gl_, shadow_);
    caster_programs_.clear();
    caster_kinds_.clear();
    casters_ = {};
    shadow_shown_ = false;
    const auto receives = [](model::EffectMask mask) { return (mask & model::effect_moving_shadow) != 0; };
    if (std::none_of(tables_.masks.begin(), tables_.masks.end(), receives)) return {};
    auto map = make_shadow_map(gl_);
    if (!map) return map.error();
    shadow_ = *map;
    if (model.motions.empty()) return {};
    std::vector<bool> casts(tables_.masks.size(), false);
    for (std::uint32_t r = 0; r < tables_.reps.size(); ++r) {
        const draw::DrawRep& rep = tables_.reps[r];
        if (!tables_.placements[rep.placement].moves) continue;
        for (std::uint32_t p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            if (casts[tables_.parts[p].program]) continue;
            casts[tables_.parts[p].program] = true;
            caster_kinds_.push_back({rep.node, r});
        }
    }
    caster_programs_.assign(tables_.masks.size(), 0);
    for (std::size_t i = 0; i < casts.size(); ++i) {
        if (!casts[i]) continue;
        const model::EffectMask mask = caster_mask(tables_.masks[i]);
        const auto same = [&](const Program& program) { return program.mask == mask; };
        auto found = std::find_if(resources_.programs.begin(), resources_.programs.end(), same);
        if (found == resources_.programs.end()) {
            auto program = make_program(gl_, mask, programs(mask), samples() > 1, geometry());
            if (!program) return program.error();
            resources_.programs.push_back(std::move(*program));
            found = resources_.programs.end() - 1;
        }
        caster_programs_[i] = static_cast<std::uint32_t>(found - resources_.programs.begin());
    }
    return {};
}

void GlDevice::refresh_shadow(const ShadowView& view, std::span<const DrawItem> casters) {
    if (shadow_.framebuffer == 0 || caster_programs_.empty()) return;
    shadow_view_ = view;
    casters_ = casters;
}

/// Items are drawn as for a picture whose eye is the map's origin. They are a slice, so the first one of the picture waits for
/// them.
void GlDevice::draw_shadow_map() {
    const std::span<const DrawItem> casters = casters_;
    casters_ = {};
    if (lost_) return;
    const Pose eye = pose_;
    const mat4 of_eye = view_projection_;
    pose_.position = shadow_view_.origin;
    view_projection_ = shadow_view_.from_origin;
    drawing_ = Drawing::shadow;
    constexpr auto side = static_cast<GLsizei>(shadow_map_px);
    draw_into({shadow_.framebuffer, 0, side, side});
    gl_.ClearDepthf(0.0F);
    gl_.Clear(GL_DEPTH_BUFFER_BIT);
    draw_parts(casters, Parts::opaque);
    drawing_ = Drawing::picture;
    pose_ = eye;
    view_projection_ = of_eye;
    for (const std::uint32_t program : caster_programs_) resources_.programs[program].frame = 0;
    state_known_ = false;
    end_slice();
}

/// Where the map stands for the eye of this picture. The sum is made in double: both may be far from 0.
void GlDevice::place_shadow() {
    shown_.shadow = {};
    if (!shadow_shown_) return;
    const mat4& m = shadow_view_.from_origin;
    const dvec3 eye = pose_.position - shadow_view_.origin;
    dmat4 from_eye(m);
    from_eye[3] = dmat4(m) * dvec4(eye, 1.0);
    const dmat4 to_texture(dvec4(0.5, 0, 0, 0), dvec4(0, 0.5, 0, 0), dvec4(0, 0, 1, 0), dvec4(0.5, 0.5, 0, 1));
    shown_.shadow.from_eye = mat4(to_texture * from_eye);
    shown_.shadow.towards = shadow_view_.towards;
    shown_.shadow.texel = shadow_view_.texel_m / shadow_view_.depth_m;
}

}  // namespace surefoot::gl
