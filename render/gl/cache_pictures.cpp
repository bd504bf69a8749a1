// Pictures of the image cache: their objects, captures, and drawing them (cache_pictures.hpp, gl_device.hpp).
#include "render/gl/cache_pictures.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "render/gl/gl_device.hpp"
#include "render/gl/resources.hpp"
#include "render/gl/undone.hpp"

namespace surefoot::gl {

namespace {

constexpr GLint box_planes = 6;
/// Pictures that a layer holds at 64 texels, and corners of one that its square does not cut.
constexpr std::uint32_t pictures_a_layer = 16, usual_vertices = 18;
/// In a frame a picture may be drawn into another one, and shown.
constexpr std::uint32_t draws_a_picture = 2;
constexpr std::uint16_t no_program = 0xffff;
/// llvmpipe (Mesa 22.3) has a fixed number of places for unfinished work on targets. Once all were in use, each flush waits for
/// the one before, for as long as the context lives. Then no slice is drawn while the next one is handed over.
constexpr std::uint32_t max_targets_in_flight = 16;

constexpr const char* picture_vertex = R"(#version 430 core
layout(location = 0) in vec4 place;
layout(location = 1) in vec3 at;
uniform mat4 view_projection;
out vec2 v_at;
flat out float v_layer;
void main() {
    v_at = at.xy;
    v_layer = at.z;
    gl_Position = view_projection * place;
}
)";
// Nothing but the sample: faces end where the square ends, so no coordinate has to be clamped.
constexpr const char* picture_fragment = R"(#version 430 core
in vec2 v_at;
flat in float v_layer;
out vec4 pixel;
uniform sampler2DArray pictures;
void main() { pixel = texture(pictures, vec3(v_at, v_layer)); }
)";

void write_low(const PictureMoment& moment, float* to) { std::copy_n(&moment.box_low.x, 3, to); }
void write_high(const PictureMoment& moment, float* to) { std::copy_n(&moment.box_high.x, 3, to); }

/// A metre before the eye of Pose{}.
CachePicture picture_before(std::uint16_t texels) {
    CachePicture picture;
    picture.place.texels = texels;
    picture.low_m = dvec2(-1);
    picture.side_m = 2;
    picture.box = {dvec3(-0.5, -0.5, -2), dvec3(0.5, 0.5, -1)};
    return picture;
}

Error no_pictures(std::string what) {
    return {"image cache", std::move(what), "Set fewer picture_layers, or 0", ErrorKind::unsupported};
}

/// Leaves unit 0 active.
void make_layers(const Api& gl, CachePictures& pictures, std::uint32_t layers) {
    constexpr auto side = static_cast<GLsizei>(picture_layer_px);
    gl.GenTextures(1, &pictures.texture);
    gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(picture_unit));
    gl.BindTexture(GL_TEXTURE_2D_ARRAY, pictures.texture);
    gl.TexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_RGBA8, side, side, static_cast<GLsizei>(layers));
    for (const GLenum which : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl.TexParameteri(GL_TEXTURE_2D_ARRAY, which, GL_LINEAR);
    for (const GLenum which : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        gl.TexParameteri(GL_TEXTURE_2D_ARRAY, which, GL_CLAMP_TO_EDGE);
    gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(material_unit));
    gl.GenRenderbuffers(1, &pictures.depth);
    gl.BindRenderbuffer(GL_RENDERBUFFER, pictures.depth);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, side, side);
    gl.GenRenderbuffers(1, &pictures.scratch);
    gl.BindRenderbuffer(GL_RENDERBUFFER, pictures.scratch);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, side, side);
}

/// False: the bound framebuffer cannot be drawn into. It is cleared, so that its memory is there.
bool is_drawable(const Api& gl, const CachePictures& pictures) {
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, pictures.depth);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) return false;
    gl.ClearColor(0, 0, 0, 0);
    gl.Clear(GL_COLOR_BUFFER_BIT);
    gl.Finish();  // max_targets_in_flight
    return true;
}

/// False: a layer cannot be drawn into.
bool make_framebuffers(const Api& gl, CachePictures& pictures, std::uint32_t layers) {
    for (std::uint32_t layer = 0; layer < layers; ++layer) {
        GLuint& framebuffer = pictures.framebuffers.emplace_back();
        gl.GenFramebuffers(1, &framebuffer);
        gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
        gl.FramebufferTextureLayer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, pictures.texture, 0, static_cast<GLint>(layer));
        if (!is_drawable(gl, pictures)) return false;
    }
    gl.GenFramebuffers(1, &pictures.scratch_framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, pictures.scratch_framebuffer);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, pictures.scratch);
    return is_drawable(gl, pictures);
}

Result<void> make_drawing(const Api& gl, CachePictures& pictures, std::uint32_t layers) {
    auto program = link_program(gl, {picture_vertex, picture_fragment, "pictures of the image cache"});
    if (!program) return program.error();
    pictures.program = *program;
    pictures.view_projection = gl.GetUniformLocation(pictures.program, "view_projection");
    gl.UseProgram(pictures.program);
    gl.Uniform1i(gl.GetUniformLocation(pictures.program, "pictures"), picture_unit);
    const std::size_t count = std::size_t{layers} * pictures_a_layer * draws_a_picture * usual_vertices + max_picture_vertices;
    void* memory = make_mapped_buffer(gl, GL_ARRAY_BUFFER, pictures.vertex_buffer, count * sizeof(PictureVertex));
    if (memory == nullptr) return no_pictures("The device cannot map the corners of pictures");
    pictures.vertices = {static_cast<PictureVertex*>(memory), count};
    gl.GenVertexArrays(1, &pictures.vertex_array);
    gl.BindVertexArray(pictures.vertex_array);
    gl.BindVertexBuffer(0, pictures.vertex_buffer, 0, sizeof(PictureVertex));
    gl.VertexAttribFormat(0, 4, GL_FLOAT, GL_FALSE, offsetof(PictureVertex, place));
    gl.VertexAttribFormat(1, 3, GL_FLOAT, GL_FALSE, offsetof(PictureVertex, at));
    for (const GLuint attribute : {0U, 1U}) {
        gl.VertexAttribBinding(attribute, 0);
        gl.EnableVertexAttribArray(attribute);
    }
    gl.BindVertexArray(0);
    return check_errors(gl, "image cache", "Set fewer picture_layers, or 0");
}

}  // namespace

Result<CachePictures> make_cache_pictures(const Api& gl, std::uint32_t layers) {
    GLint max_layers = 0, max_planes = 0;
    gl.GetIntegerv(GL_MAX_ARRAY_TEXTURE_LAYERS, &max_layers);
    gl.GetIntegerv(GL_MAX_CLIP_DISTANCES, &max_planes);
    if (max_planes < box_planes) return no_pictures("The device has no six clip distances");
    if (layers > static_cast<std::uint32_t>(std::max(0, max_layers)))
        return no_pictures("The device has no texture array of " + std::to_string(layers) + " layers");
    Undone<CachePictures> made(gl, free_cache_pictures);
    CachePictures& pictures = made.value;
    make_layers(gl, pictures, layers);
    if (auto fine = check_errors(gl, "image cache", "Set fewer picture_layers, or 0"); !fine) return fine.error();
    if (!make_framebuffers(gl, pictures, layers)) return no_pictures("The device cannot draw into a layer of a texture array");
    if (auto fine = make_drawing(gl, pictures, layers); !fine) return fine.error();
    return made.keep();
}

void free_cache_pictures(const Api& gl, CachePictures& pictures) {
    if (!pictures.framebuffers.empty())
        gl.DeleteFramebuffers(static_cast<GLsizei>(pictures.framebuffers.size()), pictures.framebuffers.data());
    gl.DeleteFramebuffers(1, &pictures.scratch_framebuffer);
    gl.DeleteRenderbuffers(1, &pictures.depth);
    gl.DeleteRenderbuffers(1, &pictures.scratch);
    gl.DeleteTextures(1, &pictures.texture);
    gl.DeleteProgram(pictures.program);
    gl.DeleteVertexArrays(1, &pictures.vertex_array);
    gl.DeleteBuffers(1, &pictures.vertex_buffer);
    pictures = {};
}

ProgramSource capture_source(ProgramSource source) {
    source.vertex = source.vertex_in_box;
    source.name += ", cut by a box";
    source.uniforms.push_back({"box_low", 3, write_low});
    source.uniforms.push_back({"box_high", 3, write_high});
    return source;
}

/// Where the driver cannot, there are no pictures: that is no error of loading.
void GlDevice::load_pictures(const model::Model& model, const ProgramFactory& programs) {
    free_cache_pictures(gl_, pictures_);
    capture_programs_.clear();
    picture_reason_.clear();
    captures_.clear();
    capture_count_ = 0;
    if (options_.picture_layers == 0) return;
    auto made = make_cache_pictures(gl_, options_.picture_layers);
    if (!made) {
        picture_reason_ = made.error().text();
        take_errors(gl_);
        return;
    }
    pictures_ = std::move(*made);
    if (auto compiled = compile_captures(model, programs); !compiled) {
        picture_reason_ = compiled.error().text();
        free_cache_pictures(gl_, pictures_);
        return;
    }
    captures_.resize(max_captures);
}

/// For each state class of a leaf, with and without what can be switched: a program, unless it is blended.
Result<void> GlDevice::compile_captures(const model::Model& model, const ProgramFactory& programs) {
    std::vector<bool> captured(tables_.masks.size(), false);
    for (const draw::DrawRep& rep : tables_.reps) {
        if (model.nodes[rep.node].child_count > 0) continue;
        for (std::uint32_t p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
            for (const std::uint32_t part : {p, tables_.parts[p].in_room})
                if (part != model::none) captured[tables_.parts[part].program] = true;
    }
    const std::size_t others = resources_.programs.size();
    capture_programs_.assign(without_.size(), no_program);
    for (std::size_t i = 0; i < without_.size(); ++i) {
        const model::EffectMask mask = resources_.programs[without_[i]].mask;
        if (!captured[i % tables_.masks.size()] || (mask & model::effect_blend) != 0) continue;
        const auto first = resources_.programs.begin() + static_cast<std::ptrdiff_t>(others);
        const auto found =
            std::find_if(first, resources_.programs.end(), [&](const Program& program) { return program.mask == mask; });
        capture_programs_[i] = static_cast<std::uint16_t>(found - resources_.programs.begin());
        if (found != resources_.programs.end()) continue;
        auto program = make_program(gl_, mask, capture_source(programs(mask)), false, geometry());
        if (!program) {
            for (std::size_t made = others; made < resources_.programs.size(); ++made)
                delete_program(gl_, resources_.programs[made]);
            resources_.programs.resize(others);
            capture_programs_.clear();
            return program.error();
        }
        resources_.programs.push_back(std::move(*program));
    }
    return {};
}

bool GlDevice::has_capture_program(const draw::DrawPart& part) const {
    return capture_programs_[variant_ * tables_.masks.size() + part.program] != no_program;
}

bool GlDevice::capture_picture(const CachePicture& picture, std::span<const DrawItem> items,
                               std::span<const CachePicture> back_to_front) {
    if (lost_ || capture_count_ == captures_.size() || !lies_within(picture.place, picture_layers())) return false;
    captures_[capture_count_++] = {picture, items, back_to_front, {}};
    return true;
}

/// Each that waits is a slice, before the picture's own.
void GlDevice::draw_captures() {
    const std::size_t count = std::exchange(capture_count_, 0);
    if (count == 0 || lost_) return;
    const Pose pose = pose_;
    const mat4 view_projection = view_projection_;
    const PictureMoment shown = shown_;
    const FrameStats stats = stats_;
    const std::size_t detail = detail_step_;
    set_texture_detail(0);  // a picture has its own texels
    begin_captures();
    for (std::size_t i = 0; i < count; ++i) {
        draw_capture(captures_[i]);
        end_slice();
        wait_slices(max_targets_in_flight);
    }
    end_captures();
    set_texture_detail(detail);
    pose_ = pose;
    view_projection_ = view_projection;
    shown_ = shown;
    stats_ = stats;
    stats_.captures = static_cast<std::uint32_t>(count);
}

void GlDevice::begin_captures() {
    drawing_ = Drawing::capture;
    gl_.Enable(GL_SCISSOR_TEST);
    cut_by_box(true);
}

void GlDevice::end_captures() {
    cut_by_box(false);
    gl_.Disable(GL_SCISSOR_TEST);
    drawing_ = Drawing::picture;
    ++frame_number_;  // programs must read the moment anew
    state_known_ = false;
}

/// Programs of captures write the distances. The one that draws pictures does not.
void GlDevice::cut_by_box(bool on) {
    for (GLint plane = 0; plane < box_planes; ++plane) {
        const GLenum distance = GL_CLIP_DISTANCE0 + static_cast<GLenum>(plane);
        on ? gl_.Enable(distance) : gl_.Disable(distance);
    }
}

void GlDevice::begin_capture(const CachePicture& picture, GLuint framebuffer) {
    ++frame_number_;
    state_known_ = false;
    pose_.position = shown_.eye = picture.eye;
    view_projection_ = capture_projection(picture);
    shown_.pixel_rad = static_cast<float>(picture.side_m / (picture.plane_m * picture.place.texels));
    shown_.shadow = {};
    shown_.box_low = vec3(picture.box.min - picture.eye);
    shown_.box_high = vec3(picture.box.max - picture.eye);
    constexpr auto side = static_cast<GLsizei>(picture_layer_px);
    draw_into({framebuffer, 0, side, side});
    gl_.Viewport(picture.place.column, picture.place.row, picture.place.texels, picture.place.texels);
    gl_.Scissor(picture.place.column, picture.place.row, picture.place.texels, picture.place.texels);
    gl_.ClearColor(0, 0, 0, 0);
    gl_.ClearDepthf(0.0F);
    gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void GlDevice::draw_capture(const WaitingCapture& capture) {
    const PicturePlace& place = capture.picture.place;
    begin_capture(capture.picture,
                  capture.pictures.empty() ? pictures_.framebuffers[place.layer] : pictures_.scratch_framebuffer);
    draw_parts(capture.items, Parts::opaque);
    if (!capture.depths.empty()) read_depths(place, capture.depths);
    if (!capture.pictures.empty()) draw_pictures_into(place, capture.pictures);
}

/// GL leaves it undefined what a draw sees of a texture that it is drawn into, also in other layers of it. So what is made of
/// pictures is drawn beside the layers, and copied. Faces of boxes that are grown may begin before the depth of their parent.
void GlDevice::draw_pictures_into(const PicturePlace& place, std::span<const CachePicture> back_to_front) {
    cut_by_box(false);
    gl_.Enable(GL_DEPTH_CLAMP);
    draw_pictures(back_to_front);
    gl_.Disable(GL_DEPTH_CLAMP);
    gl_.BindFramebuffer(GL_DRAW_FRAMEBUFFER, pictures_.framebuffers[place.layer]);
    const GLint left = place.column, low = place.row, right = left + place.texels, high = low + place.texels;
    gl_.BlitFramebuffer(left, low, right, high, left, low, right, high, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    cut_by_box(true);
}

void GlDevice::draw_pictures(std::span<const CachePicture> back_to_front) {
    if (lost_ || pictures_.framebuffers.empty() || back_to_front.empty()) return;
    gl_.UseProgram(pictures_.program);
    gl_.BindVertexArray(pictures_.vertex_array);
    gl_.UniformMatrix4fv(pictures_.view_projection, 1, GL_FALSE, &view_projection_[0][0]);
    if (samples_.samples > 1) set_coverage(false);
    gl_.Disable(GL_CULL_FACE);
    set_blending(true);
    gl_.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    std::size_t first = used_picture_vertices_;
    for (const CachePicture& picture : back_to_front) {
        if (!lies_within(picture.place, picture_layers())) continue;
        if (pictures_.vertices.size() - used_picture_vertices_ < max_picture_vertices) {  // correct, if slow
            issue_pictures(first);
            gl_.Finish();
            used_picture_vertices_ = first = 0;
        }
        const std::size_t count =
            add_picture(picture, pose_.position, pictures_.vertices.subspan(used_picture_vertices_, max_picture_vertices));
        used_picture_vertices_ += count;
        stats_.pictures += count > 0 ? 1 : 0;
    }
    issue_pictures(first);
    set_blending(false);
    state_known_ = false;
}

void GlDevice::issue_pictures(std::size_t first) {
    if (used_picture_vertices_ == first) return;
    ++stats_.batches;
    ++stats_.draws;
    gl_.DrawArrays(GL_TRIANGLES, static_cast<GLint>(first), static_cast<GLsizei>(used_picture_vertices_ - first));
}

/// Every program with clip distances, as it is drawn into layers. Between pictures, in the state that kinds were drawn in.
void GlDevice::warm_up_captures(std::span<const Pending> kinds) {
    if (pictures_.framebuffers.empty()) return;
    begin_captures();
    CachePicture picture;
    for (const std::uint16_t texels : {std::uint16_t{picture_layer_px}, std::uint16_t{picture_layer_px / 4}}) {
        picture.place.texels = texels;  // drivers clear a whole layer and a part of one by other ways
        begin_capture(picture, pictures_.framebuffers.front());
        for (const Pending& pending : kinds) {
            const draw::DrawPart& part = tables_.parts[pending.part];
            if (!is_blended(part) && has_capture_program(part)) warm_up_part(pending);
        }
        const CachePicture of_pictures = picture_before(picture_layer_px), inside = picture_before(texels);
        draw_capture({of_pictures, {}, {&inside, 1}, {}});
    }
    std::array<float, 1> depth{};
    if (draws_meshes()) read_depths({0, 0, 0, 1}, depth);
    end_captures();
}

/// Into every target.
void GlDevice::warm_up_pictures() {
    if (pictures_.framebuffers.empty()) return;
    const CachePicture picture = picture_before(picture_layer_px);
    warm_up_meshes(picture);
    draw_pictures({&picture, 1});
}

}  // namespace surefoot::gl
