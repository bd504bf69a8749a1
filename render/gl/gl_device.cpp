// The device on a real GL context: opening, loading, warming up, slices and fences. Drawing itself: gl_draw.cpp.
#include "render/gl/gl_device.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "render/gl/window_events.hpp"

namespace surefoot::gl {

namespace {

constexpr std::uint32_t max_slices = 1024;  // fences kept a frame; beyond it the oldest is waited for first
// A driver that has not finished a slice after ten waits of a second hangs.
constexpr GLuint64 wait_ns = 1'000'000'000;
constexpr int max_waits = 10;

/// False: the fence cannot be waited for, or the GPU has not reached it within the bound.
bool reached(const Api& gl, GLsync fence) {
    for (int i = 0; i < max_waits; ++i) {
        const GLenum result = gl.ClientWaitSync(fence, 0, wait_ns);
        if (result != GL_TIMEOUT_EXPIRED) return result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED;
    }
    return false;
}

}  // namespace

GlDevice::GlDevice(std::unique_ptr<Context> context, const DeviceOptions& options)
    : context_(std::move(context)), options_(options) {}

GlDevice::~GlDevice() = default;  // the context takes every object with it

Result<std::unique_ptr<Device>> GlDevice::make(std::unique_ptr<Context> context, const DeviceOptions& options) {
    std::unique_ptr<GlDevice> device(new GlDevice(std::move(context), options));
    device->draws.plays();  // nobody else has it yet
    if (auto ready = device->set_up(); !ready) return ready.error();
    return std::unique_ptr<Device>(std::move(device));
}

Result<void> GlDevice::set_up() {
    auto api = load_api([this](const char* function) { return context_->find(function); }, context_->name());
    if (!api) return api.error();
    gl_ = *api;
    const auto* name = reinterpret_cast<const char*>(gl_.GetString(GL_RENDERER));
    renderer_ = name != nullptr ? name : "unknown";
    software_ = is_software(renderer_);
    auto targets = make_targets(gl_, options_.viewport);
    if (!targets) return targets.error();
    targets_ = *targets;
    if (software_ && options_.processor_enlarges) make_enlargers();
    if (options_.rest) rest_ = make_rest_targets(gl_, targets_);
    samples_ = make_sample_targets(gl_, options_.viewport, options_.samples);
    auto frame = make_frame_buffers(gl_, std::max(1U, options_.max_items));
    if (!frame) return frame.error();
    frame_ = *frame;
    pending_.resize(frame_.instances.size());
    blended_.resize(frame_.instances.size());
    fences_.resize(max_slices, nullptr);
    gl_.GenQueries(1, &timer_);
    if (context_->reports_resets() && gl_.version >= 45)
        reset_status_ = reinterpret_cast<PFNGLGETGRAPHICSRESETSTATUSPROC>(context_->find("glGetGraphicsResetStatus"));
    prepare_presenting();
    return check_errors(gl_, context_->name(), "See `surefoot doctor`");
}

rt::TextureFilter GlDevice::filter() const {
    if (options_.filter != rt::TextureFilter::automatic) return options_.filter;
    return software_ ? rt::TextureFilter::bilinear : rt::TextureFilter::trilinear;
}

bool GlDevice::switches_filter() const {
    return options_.second_filter && options_.filter == rt::TextureFilter::automatic && software_;
}

void GlDevice::set_filter(rt::TextureFilter filter) {
    if (lost_ || !switches_filter() || filter == set_filter_) return;
    set_filter_ = filter;
    set_mip_levels(gl_, tables_.textures, resources_, filter == rt::TextureFilter::trilinear);
    state_known_ = false;
}

/// A smaller picture is enlarged: it shows the mip levels of the whole one.
void GlDevice::set_texture_detail(std::size_t step) {
    if (step == detail_step_ || !options_.smaller || lost_) return;
    detail_step_ = step;
    set_mip_bias(gl_, tables_.textures, resources_, std::log2(model::resolution_steps[step]));
    state_known_ = false;
}

model::EffectMask GlDevice::mask_of_variant(std::size_t variant) const {
    model::EffectMask mask = 0;
    for (std::size_t i = 0; i < options_.switches.size(); ++i)
        if ((variant >> i & 1U) != 0) mask |= options_.switches[i];
    return mask;
}

void GlDevice::hide_effects(model::EffectMask hidden) {
    variant_ = 0;
    for (std::size_t i = 0; i < options_.switches.size(); ++i)
        if ((options_.switches[i] & ~hidden) == 0) variant_ |= std::size_t{1} << i;
    off_ = mask_of_variant(variant_);
}

/// The state classes of all parts, then those that only parts without some switchable effects have.
std::vector<model::EffectMask> GlDevice::find_programs() {
    std::vector<model::EffectMask> masks = tables_.masks;
    without_.clear();
    for (std::size_t variant = 0; variant < std::size_t{1} << options_.switches.size(); ++variant) {
        for (const model::EffectMask mask : tables_.masks) {
            const model::EffectMask left = mask & ~mask_of_variant(variant);
            const auto found = std::find(masks.begin(), masks.end(), left);
            without_.push_back(static_cast<std::uint16_t>(found - masks.begin()));
            if (found == masks.end()) masks.push_back(left);
        }
    }
    return masks;
}

Result<void> GlDevice::load_background(const model::Model& model, const ProgramFactory& programs) {
    delete_program(gl_, background_);
    background_ = {};
    const model::EffectMask mask = options_.background ? model.called_for() & model::background_effects : 0;
    if (mask == 0) return {};
    auto program = make_program(gl_, mask, programs(mask), false, geometry());
    if (!program) return program.error();
    background_ = std::move(*program);
    return {};
}

Result<void> GlDevice::load(const model::Model& model, const ProgramFactory& programs) {
    free_resources(gl_, resources_);
    tables_ = draw::make_tables(model);
    const LoadOptions how{filter() == rt::TextureFilter::trilinear, samples() > 1};
    auto resources = load_resources(gl_, model, find_programs(), tables_.textures, programs, frame_, how);
    if (!resources) return resources.error();
    resources_ = std::move(*resources);
    if (auto shadow = load_shadow(model, programs); !shadow) return shadow.error();
    if (auto behind = load_background(model, programs); !behind) return behind.error();
    load_pictures(model, programs);
    load_meshes();
    set_filter_ = filter();
    detail_step_ = 0;
    light_ = model::daylight_of_model(model.sun_direction, model.light);
    poses_ = model::MotionPoses(model);
    time_s_ = 0;
    warm_up();
    if (lost_)
        return Error{"warming up " + renderer_, "The driver does not finish", "Restart the driver, or use another --backend",
                     ErrorKind::no_device};
    return check_errors(gl_, "warming up " + renderer_, "Report this together with the driver's version");
}

/// A part of each combination of program, texture and culling in the model.
std::vector<GlDevice::Pending> GlDevice::one_of_each_state() const {
    std::vector<std::pair<State, Pending>> kinds;
    for (std::uint32_t r = 0; r < tables_.reps.size(); ++r) {
        const draw::DrawRep& rep = tables_.reps[r];
        for (std::uint32_t p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            for (const std::uint32_t part : {p, tables_.parts[p].in_room}) {
                if (part == model::none) continue;
                const Pending pending{0, part, r};
                kinds.emplace_back(state_of(pending), pending);
            }
        }
    }
    const auto order = [](const auto& a, const auto& b) {
        const auto tuple = [](const State& s) { return std::tuple(s.program, s.texture, s.culling); };
        return tuple(a.first) < tuple(b.first);
    };
    std::sort(kinds.begin(), kinds.end(), order);
    const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
    kinds.erase(std::unique(kinds.begin(), kinds.end(), same), kinds.end());
    std::vector<Pending> out;
    out.reserve(kinds.size());
    for (const auto& [state, pending] : kinds) out.push_back(pending);
    return out;
}

/// Every combination of program, texture and culling is drawn once, with and without what can be switched: drivers compile on
/// first use, and the frame may not pay for it. One triangle of each; what it shows does not matter.
void GlDevice::warm_up() {
    const model::EffectMask off = off_;
    hide_effects(0);
    const std::vector<Pending> kinds = one_of_each_state();
    std::vector<model::EffectMask> done;
    for (std::size_t variant = std::size_t{1} << options_.switches.size(); variant-- > 0;) {
        const model::EffectMask hidden = mask_of_variant(variant);
        if (std::find(done.begin(), done.end(), hidden) != done.end()) continue;
        done.push_back(hidden);
        hide_effects(hidden);
        warm_up_parts(kinds);
    }
    hide_effects(off);
    warm_up_passes();
    stats_ = {};
}

void GlDevice::warm_up_parts(std::span<const Pending> kinds) {
    constexpr unsigned second = 2, smaller = 1;
    for (unsigned way = 4; way-- > 0;) {  // the filter of the first frame comes last
        if (((way & second) != 0 && !switches_filter()) || ((way & smaller) != 0 && !options_.smaller)) continue;
        set_filter((way & second) != 0 ? rt::TextureFilter::trilinear : filter());
        begin_frame(Pose{}, (way & smaller) != 0 ? model::resolution_steps.back() : 1.0F);
        for (const Pending& pending : kinds) {
            set_blending(is_blended(tables_.parts[pending.part]));
            warm_up_part(pending);
        }
        set_blending(false);
        warm_up_captures(kinds);
        finish_frame();
    }
}

void GlDevice::warm_up_part(const Pending& pending) {
    if (used_instances_ >= frame_.instances.size()) return;
    const State state = state_of(pending);
    const std::uint32_t at = used_commands_;
    write_instance(pending, used_instances_);
    append_command(pending, used_instances_, at);
    frame_.commands[at].index_count = std::min(3U, frame_.commands[at].index_count);
    apply(state);
    issue(state, at, 1);
    ++used_instances_;
}

void GlDevice::warm_up_passes() {
    // A driver may compile the enlarging pass for each size.
    for (const float resolution : model::resolution_steps) {
        begin_frame(Pose{}, resolution);
        warm_up_pictures();
        finish_frame();
    }
    if (!caster_kinds_.empty()) {
        refresh_shadow({}, caster_kinds_);
        begin_frame(Pose{});
        finish_frame();
    }
    if (rest_support() != RestSupport::none) {
        begin_rest(Pose{}, dvec2(0));
        show_rest(1);
        for (const bool first : {true, false}) {
            if (rest_support() == RestSupport::samples) add_sample(first);
        }
        if (rest_support() == RestSupport::samples) show_rest(2);
        finish_rest_frame();
    }
    if (context_->has_window()) {  // a window may get another size
        const auto w = static_cast<std::int32_t>(options_.viewport.width),
                   h = static_cast<std::int32_t>(options_.viewport.height);
        copy_to_window({0, 0, std::max(1, w / 2), std::max(1, h / 2)}, false);
    }
    present();
}

std::vector<std::string> GlDevice::program_listing() const {
    std::vector<std::string> lines;
    for (const Program& program : resources_.programs) {
        lines.push_back(std::to_string(program.mask) + ": " + program.source.name);
    }
    if (background_.id != 0) lines.push_back(std::to_string(background_.mask) + ": " + background_.source.name);
    return lines;
}

std::string GlDevice::program_text(model::EffectMask mask) const {
    for (const Program& program : resources_.programs) {
        if (program.mask == mask) return program.source.vertex + program.source.fragment;
    }
    if (background_.id != 0 && background_.mask == mask) return background_.source.vertex + background_.source.fragment;
    return {};
}

std::uint32_t GlDevice::end_slice() {
    if (slices_ - slices_done_ >= max_slices) wait_slices(max_slices - 1);
    fences_[slices_ % max_slices] = gl_.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl_.Flush();
    return ++slices_;
}

/// On a lost device nothing is waited for: no later frame writes what the GPU may still read.

void GlDevice::wait_slices(std::uint32_t in_flight) {
    while (slices_ - slices_done_ > in_flight) {
        GLsync& fence = fences_[slices_done_ % max_slices];
        lost_ = lost_ || !reached(gl_, fence);
        gl_.DeleteSync(fence);
        fence = nullptr;
        ++slices_done_;
    }
}

void GlDevice::finish_frame() {
    if (!lost_) resolve(targets_.steps[step_], step_);
    if (step_ > 0 && !lost_ && enlargers_.empty()) enlarge(gl_, targets_, step_);
    end_slice();
    wait_slices(0);
    if (step_ > 0 && !lost_ && !enlargers_.empty()) enlarge_by_processor();
    look_for_reset();
}

void GlDevice::make_enlargers() {
    for (std::size_t step = 1; step < targets_.steps.size(); ++step)
        enlargers_.emplace_back(model::viewport_of_step(options_.viewport, step), options_.viewport);
    shown_pixels_.resize(std::size_t{options_.viewport.width} * options_.viewport.height);
    small_pixels_.resize(shown_pixels_.size());
}

/// A software driver's pictures lie in memory. Their order of channels is the targets' own, so reading and writing only copy.
void GlDevice::enlarge_by_processor() {
    const Target &small = targets_.steps[step_], &shown = targets_.steps.front();
    gl_.BindFramebuffer(GL_FRAMEBUFFER, small.framebuffer);
    gl_.ReadPixels(0, 0, small.width, small.height, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV, small_pixels_.data());
    const std::size_t count = static_cast<std::size_t>(small.width) * static_cast<std::size_t>(small.height);
    enlargers_[step_ - 1].enlarge(std::span(small_pixels_).first(count), shown_pixels_);
    gl_.BindTexture(GL_TEXTURE_2D, shown.colour);
    gl_.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, shown.width, shown.height, GL_BGRA, GL_UNSIGNED_INT_8_8_8_8_REV,
                      shown_pixels_.data());
    gl_.BindFramebuffer(GL_FRAMEBUFFER, shown.framebuffer);
    state_known_ = false;
}

/// The picture of a step, out of its samples.
void GlDevice::resolve(const Target& shown, std::size_t step) {
    if (samples_.samples == 1) return;
    set_coverage(false);
    resolve_samples(gl_, samples_.steps[step], shown);
    state_known_ = false;
}

/// The second picture is whole.
void GlDevice::resolve_rest() {
    if (!rest_resolved_) resolve(rest_.picture, 0);
    rest_resolved_ = true;
}

void GlDevice::look_for_reset() {
    if (reset_status_ != nullptr && reset_status_() != GL_NO_ERROR) lost_ = true;
}

RestSupport GlDevice::rest_support() const {
    return rest_.picture.framebuffer == 0 ? RestSupport::none
           : rest_.sum.framebuffer == 0   ? RestSupport::picture
                                          : RestSupport::samples;
}

void GlDevice::begin_rest(const Pose& pose, const dvec2& offset_px) {
    start_picture(pose);
    if (offset_px != dvec2(0)) {
        const vec2 moved(2.0 * offset_px / dvec2(options_.viewport.width, options_.viewport.height));
        for (int c = 0; c < 4; ++c) {
            view_projection_[c][0] += moved.x * view_projection_[c][3];
            view_projection_[c][1] += moved.y * view_projection_[c][3];
        }
    }
    set_texture_detail(0);
    draw_captures();
    if (lost_ || rest_.picture.framebuffer == 0) return;
    rest_resolved_ = false;
    draw_into(drawn_into(rest_.picture, 0));
    clear_target();
}

void GlDevice::add_sample(bool first) {
    if (lost_ || rest_.sum.framebuffer == 0) return;
    resolve_rest();
    add_to_sum(gl_, rest_, first);
    state_known_ = false;
    end_slice();
}

void GlDevice::show_rest(std::uint32_t samples) {
    if (lost_ || rest_.picture.framebuffer == 0) return;
    resolve_rest();
    if (samples > 1) {
        show_mean(gl_, rest_, targets_.steps.front(), samples);
    } else {
        show_picture(gl_, rest_, targets_.steps.front());
    }
    state_known_ = false;
    end_slice();
}

void GlDevice::finish_rest_frame() {
    wait_slices(0);
    look_for_reset();
}

Result<PixelImage> GlDevice::read_pixels() {
    if (lost_) return Error{"reading the picture", "The device is lost", "Open the device again", ErrorKind::no_device};
    PixelImage image;
    image.width = options_.viewport.width;
    image.height = options_.viewport.height;
    const std::size_t row = 4ULL * image.width;
    std::vector<std::uint8_t> upside_down(row * image.height);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, targets_.steps.front().framebuffer);
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl_.ReadPixels(0, 0, static_cast<GLsizei>(image.width), static_cast<GLsizei>(image.height), GL_RGBA, GL_UNSIGNED_BYTE,
                   upside_down.data());
    if (auto fine = check_errors(gl_, "reading the picture", "See `surefoot doctor`"); !fine) return fine.error();
    image.rgba.resize(upside_down.size());
    for (std::uint32_t y = 0; y < image.height; ++y) {
        std::copy_n(upside_down.data() + row * (image.height - 1 - y), row, image.rgba.data() + row * y);
    }
    return image;
}

bool GlDevice::begin_timer() {
    gl_.BeginQuery(GL_TIME_ELAPSED, timer_);
    return gl_.GetError() == GL_NO_ERROR;
}

double GlDevice::end_timer_ms() {
    gl_.EndQuery(GL_TIME_ELAPSED);
    GLuint64 ns = 0;
    gl_.GetQueryObjectui64v(timer_, GL_QUERY_RESULT, &ns);
    return static_cast<double>(ns) * 1e-6;
}

}  // namespace surefoot::gl
