// Drawing on a GL context: from items to sorted, batched multi-draws. Nothing here allocates, outside the driver.
#include <algorithm>
#include <bit>
#include <cmath>

#include "render/gl/gl_device.hpp"
#include "render/model/view.hpp"

namespace surefoot::gl {

namespace {

/// A non-negative float's bits sort as the float does; anything else sorts first.
std::uint32_t distance_bits(float distance) { return distance > 0 ? std::bit_cast<std::uint32_t>(distance) : 0U; }

/// The part's usual program, what shows no sky first, culling, texture, then front to back. Programs beyond 2^9 and textures
/// beyond 2^20 share keys: batches compare the true state.
std::uint64_t state_key(std::uint32_t program, bool sky, draw::Culling culling, std::uint32_t texture, float distance) {
    return static_cast<std::uint64_t>(program & 0x1ffU) << 55U | static_cast<std::uint64_t>(sky ? 1 : 0) << 54U |
           static_cast<std::uint64_t>(culling) << 52U | static_cast<std::uint64_t>(texture & 0xfffffU) << 32U |
           distance_bits(distance);
}

/// Scales a part about the eye by its rank among coincident parts. Its place on the screen does not change, but its depth does.
/// So the same one of them shows, whatever the order of drawing. One rank is the smallest step that depth resolves over large
/// triangles. Parts of rank 0 are not moved: planes a millimetre apart at a kilometre keep their order.
void apply_depth_bias(std::uint8_t rank, std::array<float, 12>& rows) {
    if (rank == 0) return;
    const float away = 1.0F + static_cast<float>(rank) * 0x1p-20F;
    for (float& value : rows) value *= away;
}

std::array<std::uint8_t, 4> darkened(std::array<std::uint8_t, 4> colour, const vec3& factor) {
    for (std::size_t c = 0; c < 3; ++c) {
        const float value = static_cast<float>(colour[c]) * factor[static_cast<int>(c)] + 0.5F;
        colour[c] = static_cast<std::uint8_t>(std::clamp(value, 0.0F, 255.0F));
    }
    return colour;
}

}  // namespace

GeometryBuffers GlDevice::geometry() const {
    return {resources_.vertices, resources_.indices,    frame_.instance_buffer, frame_.command_buffer,
            resources_.sun_seen, resources_.lamp_light, resources_.sun_vertices};
}

void GlDevice::begin_frame(const Pose& pose, float resolution) {
    start_picture(pose);
    stats_ = {};
    step_ = model::resolution_step(resolution);
    stats_.resolution = model::resolution_steps[step_];
    shown_.pixel_rad /= stats_.resolution;
    stats_.samples = samples();
    stats_.filter = set_filter_;
    set_texture_detail(step_);
    draw_captures();
    if (lost_) return;
    draw_into(drawn_into(targets_.steps[step_], step_));
    clear_target();
}

void GlDevice::start_picture(const Pose& pose) {
    if (slices_ != slices_done_) wait_slices(0);  // an abandoned picture: its buffers may still be read
    ++frame_number_;
    pose_ = pose;
    view_projection_ = model::projection(pose, options_.viewport) * model::view_rotation(pose);
    slices_ = slices_done_ = 0;
    blended_count_ = 0;
    used_instances_ = used_commands_ = 0;
    used_picture_vertices_ = used_mesh_corners_ = used_mesh_indices_ = 0;
    state_known_ = false;
    shown_ = {light_, time_s_, pose.position, static_cast<float>(model::pixel_angle(pose, options_.viewport))};
    shown_.light.background *= vec3(options_.sky[0], options_.sky[1], options_.sky[2]);
    shown_.hidden = off_;
    if ((off_ & model::effect_fog) != 0) shown_.light.fog_density = 0;  // nor has what is behind everything any
    poses_.set_time(time_s_);
    if (!casters_.empty()) draw_shadow_map();
    if (shadow_.framebuffer != 0) place_shadow();
}

void GlDevice::draw_into(const Target& target) {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
    gl_.Viewport(0, 0, target.width, target.height);
    gl_.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);  // reversed-Z needs 0..1: -1..1 would round near 1
    gl_.Enable(GL_DEPTH_TEST);
    gl_.DepthFunc(GL_GREATER);
    gl_.CullFace(GL_BACK);
    set_blending(false);
    gl_.BindBuffer(GL_DRAW_INDIRECT_BUFFER, frame_.command_buffer);
}

void GlDevice::clear_target() {
    const vec3& behind = shown_.light.background;
    gl_.ClearColor(behind.r, behind.g, behind.b, 1.0F);
    gl_.ClearDepthf(0.0F);
    gl_.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    draw_background();
}

/// On the cleared target, before all else. Where depth is not tested, none is written.
void GlDevice::draw_background() {
    if (background_.id == 0 || (off_ & background_.mask) != 0) return;
    shown_.to_direction = mat4(glm::inverse(dmat4(view_projection_)));  // a picture at rest has moved it by parts of a pixel
    gl_.UseProgram(background_.id);
    gl_.BindVertexArray(background_.vertex_array);
    write_uniforms(gl_, background_, shown_);
    if (samples_.samples > 1) set_coverage(false);
    gl_.Disable(GL_CULL_FACE);
    gl_.Disable(GL_DEPTH_TEST);
    gl_.DrawArrays(GL_TRIANGLES, 0, 3);
    gl_.Enable(GL_DEPTH_TEST);
    state_known_ = false;
}

void GlDevice::set_blending(bool on) {
    if (on) {
        gl_.Enable(GL_BLEND);
        gl_.BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    } else {
        gl_.Disable(GL_BLEND);
    }
    gl_.DepthMask(on ? GL_FALSE : GL_TRUE);
}

/// Alpha says which samples of a pixel are drawn. Their own alpha is 1 then: the picture is opaque.
void GlDevice::set_coverage(bool on) {
    for (const GLenum what : {GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SAMPLE_ALPHA_TO_ONE}) on ? gl_.Enable(what) : gl_.Disable(what);
}

GlDevice::State GlDevice::state_of(const Pending& pending) const {
    const draw::DrawPart& part = tables_.parts[pending.part];
    const draw::Placed& placed = tables_.placements[tables_.reps[pending.rep].placement];
    return {program_of(part), texture_of(part), drawing_ == Drawing::shadow ? draw::Culling::none : draw::culling(part, placed)};
}

/// The part, or the same without the sun where the eye sees only sides that see no sky.
std::uint32_t GlDevice::shown_part(std::uint32_t part, std::uint32_t placement) {
    const std::uint32_t in_room = tables_.parts[part].in_room;
    if (in_room == model::none || drawing_ == Drawing::shadow) return part;
    const draw::Placed& placed = tables_.placements[placement];
    const vec3 eye = draw::eye_in_frame(placed.moves ? placed_now(placement) : placed, pose_.position);
    return tables_.closed.shows_no_sky(part, eye) ? in_room : part;
}

void GlDevice::draw(std::span<const DrawItem> items) { draw_parts(items, Parts::all); }

void GlDevice::draw_rest(std::span<const DrawItem> items, Parts parts) {
    if (lost_ || rest_.picture.framebuffer == 0) return;
    draw_into(drawn_into(rest_.picture, 0));  // frames in between show the other target
    state_known_ = false;
    draw_parts(items, parts);
    if (blended_count_ > 0) submit_blended();
    end_slice();
}

void GlDevice::draw_parts(std::span<const DrawItem> items, Parts parts) {
    const vec3 eye(pose_.position - tables_.middle);
    std::size_t count = 0;
    for (const DrawItem& item : items) {
        const draw::DrawRep& rep = tables_.reps[item.rep];
        const draw::Placed& placed = tables_.placements[rep.placement];
        const float distance = placed.moves ? static_cast<float>(glm::length(placed_now(rep.placement).origin - pose_.position))
                                            : glm::length(vec3(tables_.centres[item.node]) - eye);
        ++stats_.items;
        stats_.triangles += rep.triangles;
        for (std::uint32_t own = rep.first_part; own < rep.first_part + rep.part_count; ++own) {
            const std::uint32_t p = shown_part(own, rep.placement);
            const draw::DrawPart& part = tables_.parts[p];
            if (part.index_count == 0 || (parts != Parts::all && is_blended(part) != (parts == Parts::blended))) continue;
            if (drawing_ == Drawing::capture && !has_capture_program(part)) continue;
            if (is_blended(part)) {
                if (blended_count_ == blended_.size()) submit_blended();  // out of order rather than not at all
                // Far first, part by part; ids break ties.
                const float away = draw::distance_m(part, placed.moves ? placed_now(rep.placement) : placed, pose_.position);
                const std::uint64_t key = static_cast<std::uint64_t>(~distance_bits(away)) << 32U | item.node;
                blended_[blended_count_++] = {key, p, item.rep};
                continue;
            }
            if (count == pending_.size()) {
                submit({pending_.data(), count});
                count = 0;
            }
            // In the order of all effects, whatever is hidden: where depths are equal, the first one shows.
            const std::uint64_t key =
                state_key(program_of(tables_.parts[own], 0), p == own, draw::culling(part, placed), texture_of(part), distance);
            pending_[count++] = {key, p, item.rep};
        }
    }
    submit({pending_.data(), count});
}

void GlDevice::end_items() {
    if (blended_count_ == 0) return;
    submit_blended();
    end_slice();
}

void GlDevice::submit_blended() {
    set_blending(true);
    submit({blended_.data(), blended_count_});
    set_blending(false);
    blended_count_ = 0;
}

void GlDevice::submit(std::span<Pending> sorted) {
    if (sorted.empty() || lost_) return;  // lost: the GPU may still read the mapped buffers
    std::sort(sorted.begin(), sorted.end(), [](const Pending& a, const Pending& b) {
        return a.key != b.key ? a.key < b.key : a.part != b.part ? a.part < b.part : a.rep < b.rep;
    });
    State state = state_of(sorted.front());
    std::uint32_t first = used_commands_;
    for (const Pending& pending : sorted) {
        const State next = state_of(pending);
        const bool full = used_instances_ == frame_.instances.size();
        if (next != state || full) {
            issue(state, first, used_commands_ - first);
            state = next;
            first = used_commands_;
        }
        if (full) {  // more parts than max_items: wait until the buffers may be written again; correct, if slow
            gl_.Finish();
            used_instances_ = used_commands_ = first = 0;
        }
        write_instance(pending, used_instances_);
        append_command(pending, used_instances_, first);
        ++used_instances_;
    }
    issue(state, first, used_commands_ - first);
}

/// A moving placement at the time of the picture.
draw::Placed GlDevice::placed_now(std::uint32_t placement) {
    const draw::Placed& placed = tables_.placements[placement];
    return draw::moved(placed, poses_.at(tables_.motions[placement]));
}

void GlDevice::write_instance(const Pending& pending, std::uint32_t at) {
    const draw::DrawPart& part = tables_.parts[pending.part];
    const std::uint32_t placement = tables_.reps[pending.rep].placement;
    const draw::Placed& placed = tables_.placements[placement];
    Instance instance;
    if (placed.moves)
        draw::eye_relative_rows(placed_now(placement), pose_.position, instance.rows);
    else
        draw::eye_relative_rows(placed, pose_.position, instance.rows);
    const std::uint32_t in_rep = tables_.model_part(pending.part) - tables_.reps[pending.rep].first_part;
    apply_depth_bias(tables_.depth_bias.ranks[tables_.depth_bias.first_of_rep[pending.rep] + in_rep], instance.rows);
    const bool by_hour = part.captured && (off_ & model::effect_sun) == 0;
    instance.colour = by_hour ? darkened(part.colour, shown_.light.pictures) : part.colour;
    instance.alpha_cutoff = part.alpha_cutoff;
    instance.two_sided = part.two_sided ? 1.0F : 0.0F;
    instance.texture_layer = part.texture_layer;
    frame_.instances[at] = instance;
}

/// A command of its own, or one instance more of the batch's last command when the geometry is the same.
void GlDevice::append_command(const Pending& pending, std::uint32_t at, std::uint32_t first_of_batch) {
    const draw::DrawPart& part = tables_.parts[pending.part];
    if (used_commands_ > first_of_batch) {
        DrawCommand& last = frame_.commands[used_commands_ - 1];
        if (last.first_index == part.first_index && last.base_vertex == part.base_vertex &&
            last.index_count == part.index_count) {
            ++last.instances;
            return;
        }
    }
    frame_.commands[used_commands_++] = {part.index_count, 1, part.first_index, part.base_vertex, at};
}

void GlDevice::apply(const State& state) {
    Program& program = resources_.programs[state.program];
    const bool all = !state_known_;
    if (all || state.program != current_.program) {
        gl_.UseProgram(program.id);
        gl_.BindVertexArray(program.vertex_array);
        ++stats_.state_changes;
    }
    if (samples_.samples > 1 && (all || program.coverage != resources_.programs[current_.program].coverage))
        set_coverage(program.coverage);
    if (program.frame != frame_number_) {
        gl_.UniformMatrix4fv(program.view_projection, 1, GL_FALSE, &view_projection_[0][0]);
        write_uniforms(gl_, program, shown_);
        if (program.reads_sun_seen) set_sun_moment(gl_, program, geometry(), shown_.light.sun_moment);
        program.frame = frame_number_;
    }
    if (state.texture != model::none && (all || state.texture != current_.texture)) {
        gl_.BindTexture(GL_TEXTURE_2D_ARRAY, resources_.textures[state.texture]);
        ++stats_.state_changes;
    }
    if (all || state.culling != current_.culling) {
        if (state.culling == draw::Culling::none) {
            gl_.Disable(GL_CULL_FACE);
        } else {
            gl_.Enable(GL_CULL_FACE);
            gl_.FrontFace(state.culling == draw::Culling::front_flipped ? GL_CW : GL_CCW);
        }
        ++stats_.state_changes;
    }
    current_ = state;
    state_known_ = true;
}

void GlDevice::issue(const State& state, std::uint32_t first, std::uint32_t count) {
    if (count == 0) return;
    apply(state);
    ++stats_.batches;
    stats_.draws += count;
    // The API takes an offset in a buffer as a pointer.  NOLINTNEXTLINE(performance-no-int-to-ptr)
    const auto offset = reinterpret_cast<const void*>(static_cast<std::uintptr_t>(first) * sizeof(DrawCommand));
    gl_.MultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, offset, static_cast<GLsizei>(count), sizeof(DrawCommand));
}

}  // namespace surefoot::gl
