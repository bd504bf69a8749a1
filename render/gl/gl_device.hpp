// The device on a real GL context: sorts, batches and multi-draws items, slice by slice.
#pragma once

#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/draw/tables.hpp"
#include "render/gl/cache_pictures.hpp"
#include "render/gl/context.hpp"
#include "render/gl/enlarge_pixels.hpp"
#include "render/gl/picture_meshes.hpp"
#include "render/gl/resources.hpp"
#include "render/gl/rest_targets.hpp"
#include "render/gl/sample_targets.hpp"
#include "render/gl/shadow_map.hpp"
#include "render/gl/targets.hpp"
#include "render/gl/window_fit.hpp"
#include "render/model/moving.hpp"

namespace surefoot::gl {

/// The device that draws by OpenGL. Every member on the thread of its context.
class GlDevice final : public Device {
public:
    static Result<std::unique_ptr<Device>> make(std::unique_ptr<Context> context, const DeviceOptions& options);
    ~GlDevice() override;
    GlDevice(const GlDevice&) = delete;
    GlDevice& operator=(const GlDevice&) = delete;

    [[nodiscard]] std::string renderer() const override { return renderer_; }
    [[nodiscard]] bool software() const override { return software_; }
    [[nodiscard]] std::shared_ptr<WindowEvents> window() const override { return context_->window(); }
    [[nodiscard]] std::uint32_t samples() const override { return samples_.samples; }
    [[nodiscard]] rt::TextureFilter filter() const override;
    [[nodiscard]] bool switches_filter() const override;
    void set_filter(rt::TextureFilter filter) override REQUIRES(draws);
    void hide_effects(model::EffectMask hidden) override REQUIRES(draws);
    void set_light(const model::Daylight& light) override REQUIRES(draws) { light_ = light; }
    void set_time(double time_s) override REQUIRES(draws) { time_s_ = std::isfinite(time_s) ? time_s : 0; }
    [[nodiscard]] bool receives_shadows() const override { return shadow_.framebuffer != 0; }
    void refresh_shadow(const ShadowView& view, std::span<const DrawItem> casters) override REQUIRES(draws);
    void show_shadow(bool shown) override REQUIRES(draws) { shadow_shown_ = shown; }
    [[nodiscard]] std::uint32_t picture_layers() const override {
        return static_cast<std::uint32_t>(pictures_.framebuffers.size());
    }
    [[nodiscard]] std::string picture_reason() const override { return picture_reason_; }
    using Device::capture_picture;
    bool capture_picture(const CachePicture& picture, std::span<const DrawItem> items,
                         std::span<const CachePicture> back_to_front) override REQUIRES(draws);
    void draw_pictures(std::span<const CachePicture> back_to_front) override REQUIRES(draws);
    bool capture_depths(const CachePicture& picture, std::span<const DrawItem> items, std::span<float> depths) override
        REQUIRES(draws);
    [[nodiscard]] bool draws_meshes() const override { return meshes_.program != 0; }
    void draw_picture_meshes(std::span<const PictureMesh> meshes) override REQUIRES(draws);
    Result<void> load(const model::Model& model, const ProgramFactory& programs) override REQUIRES(draws);
    [[nodiscard]] std::vector<std::string> program_listing() const override;
    [[nodiscard]] std::string program_text(model::EffectMask mask) const override;
    void bind() override ASSERT_CAPABILITY(draws) { context_->make_current(); }
    void release() override RELEASE(draws) NO_THREAD_SAFETY_ANALYSIS { context_->release(); }

    using Device::begin_frame;
    void begin_frame(const Pose& pose, float resolution) override REQUIRES(draws);
    void draw(std::span<const DrawItem> items) override REQUIRES(draws);
    std::uint32_t end_slice() override REQUIRES(draws);
    void wait_slices(std::uint32_t in_flight) override REQUIRES(draws);
    void end_items() override REQUIRES(draws);
    void finish_frame() override REQUIRES(draws);
    [[nodiscard]] RestSupport rest_support() const override REQUIRES(draws);
    void begin_rest(const Pose& pose, const dvec2& offset_px) override REQUIRES(draws);
    void draw_rest(std::span<const DrawItem> items, Parts parts) override REQUIRES(draws);
    void add_sample(bool first) override REQUIRES(draws);
    void show_rest(std::uint32_t samples) override REQUIRES(draws);
    void finish_rest_frame() override REQUIRES(draws);
    rt::Shown present() override REQUIRES(draws);
    [[nodiscard]] rt::Refreshes refreshes() const override { return context_->refreshes(); }
    std::vector<std::string> watch_screen() override { return context_->watch_screen(); }
    void wait_for_flips(bool wait) override { context_->wait_for_flips(wait); }
    [[nodiscard]] FrameStats stats() const override REQUIRES(draws) { return stats_; }
    [[nodiscard]] bool lost() const override REQUIRES(draws) { return lost_; }
    Result<PixelImage> read_pixels() override REQUIRES(draws);
    bool begin_timer() override REQUIRES(draws);
    double end_timer_ms() override REQUIRES(draws);

private:
    /// One part of an item, waiting in draw() or, if blended, until end_items().
    struct Pending {
        std::uint64_t key;
        std::uint32_t part, rep;
    };
    /// GL state that a batch shares.
    struct State {
        std::uint32_t program, texture;
        draw::Culling culling;
        bool operator==(const State&) const = default;
    };

    /// What parts are drawn into.
    enum class Drawing : std::uint8_t { picture, shadow, capture };
    /// A capture that waits for the next picture.
    struct WaitingCapture {
        CachePicture picture;
        std::span<const DrawItem> items;
        std::span<const CachePicture> pictures;
        std::span<float> depths = {};  ///< to be read; empty: none
    };

    GlDevice(std::unique_ptr<Context> context, const DeviceOptions& options);
    Result<void> set_up() REQUIRES(draws);
    std::vector<model::EffectMask> find_programs() REQUIRES(draws);
    [[nodiscard]] model::EffectMask mask_of_variant(std::size_t variant) const;
    void warm_up() REQUIRES(draws);
    [[nodiscard]] std::vector<Pending> one_of_each_state() const REQUIRES(draws);
    void warm_up_parts(std::span<const Pending> kinds) REQUIRES(draws);
    void warm_up_part(const Pending& pending) REQUIRES(draws);
    void warm_up_passes() REQUIRES(draws);
    void copy_to_window(const FittedPicture& fit, bool half_turn) REQUIRES(draws);
    void start_picture(const Pose& pose) REQUIRES(draws);
    void set_texture_detail(std::size_t step) REQUIRES(draws);
    void draw_into(const Target& target) REQUIRES(draws);
    [[nodiscard]] const Target& drawn_into(const Target& shown, std::size_t step) const REQUIRES(draws) {
        return samples_.samples > 1 ? samples_.steps[step] : shown;
    }
    void resolve(const Target& shown, std::size_t step) REQUIRES(draws);
    void resolve_rest() REQUIRES(draws);
    void make_enlargers() REQUIRES(draws);
    void enlarge_by_processor() REQUIRES(draws);
    void set_coverage(bool on) REQUIRES(draws);
    void clear_target() REQUIRES(draws);
    Result<void> load_background(const model::Model& model, const ProgramFactory& programs) REQUIRES(draws);
    void draw_background() REQUIRES(draws);
    void draw_parts(std::span<const DrawItem> items, Parts parts) REQUIRES(draws);
    void look_for_reset() REQUIRES(draws);
    void prepare_presenting() REQUIRES(draws);
    void fill_window() REQUIRES(draws);
    void fill_pixel_rows(const PixelRows& rows) REQUIRES(draws);
    Result<void> load_shadow(const model::Model& model, const ProgramFactory& programs) REQUIRES(draws);
    void draw_shadow_map() REQUIRES(draws);
    void place_shadow() REQUIRES(draws);
    void load_pictures(const model::Model& model, const ProgramFactory& programs) REQUIRES(draws);
    Result<void> compile_captures(const model::Model& model, const ProgramFactory& programs) REQUIRES(draws);
    void draw_captures() REQUIRES(draws);
    void begin_captures() REQUIRES(draws);
    void end_captures() REQUIRES(draws);
    void cut_by_box(bool on) REQUIRES(draws);
    void begin_capture(const CachePicture& picture, GLuint framebuffer) REQUIRES(draws);
    void draw_capture(const WaitingCapture& capture) REQUIRES(draws);
    void draw_pictures_into(const PicturePlace& place, std::span<const CachePicture> back_to_front) REQUIRES(draws);
    void issue_pictures(std::size_t first) REQUIRES(draws);
    void warm_up_captures(std::span<const Pending> kinds) REQUIRES(draws);
    void warm_up_pictures() REQUIRES(draws);
    void load_meshes() REQUIRES(draws);
    void read_depths(const PicturePlace& place, std::span<float> to) REQUIRES(draws);
    void issue_meshes(std::size_t first) REQUIRES(draws);
    void warm_up_meshes(const CachePicture& picture) REQUIRES(draws);
    [[nodiscard]] bool has_capture_program(const draw::DrawPart& part) const REQUIRES(draws);
    [[nodiscard]] std::uint32_t program_of(const draw::DrawPart& part) const REQUIRES(draws) {
        return program_of(part, variant_);
    }
    [[nodiscard]] std::uint32_t program_of(const draw::DrawPart& part, std::size_t variant) const REQUIRES(draws) {
        if (drawing_ == Drawing::shadow) return caster_programs_[part.program];
        const std::vector<std::uint16_t>& programs = drawing_ == Drawing::capture ? capture_programs_ : without_;
        return programs[variant * tables_.masks.size() + part.program];
    }
    /// As it is drawn now: a switchable effect that is left out is none.
    [[nodiscard]] bool is_blended(const draw::DrawPart& part) const REQUIRES(draws) {
        return part.blended && (off_ & model::effect_blend) == 0;
    }
    [[nodiscard]] std::uint32_t texture_of(const draw::DrawPart& part) const REQUIRES(draws) {
        if (drawing_ == Drawing::shadow && (tables_.masks[part.program] & model::effect_alpha_mask) == 0) return model::none;
        return (off_ & model::effect_texture) != 0 ? model::none : part.texture;
    }
    [[nodiscard]] GeometryBuffers geometry() const REQUIRES(draws);
    [[nodiscard]] State state_of(const Pending& pending) const REQUIRES(draws);
    [[nodiscard]] std::uint32_t shown_part(std::uint32_t part, std::uint32_t placement) REQUIRES(draws);
    void submit(std::span<Pending> sorted) REQUIRES(draws);
    void submit_blended() REQUIRES(draws);
    void issue(const State& state, std::uint32_t first, std::uint32_t count) REQUIRES(draws);
    void apply(const State& state) REQUIRES(draws);
    void set_blending(bool on) REQUIRES(draws);
    void write_instance(const Pending& pending, std::uint32_t at) REQUIRES(draws);
    [[nodiscard]] draw::Placed placed_now(std::uint32_t placement) REQUIRES(draws);
    void append_command(const Pending& pending, std::uint32_t at, std::uint32_t first_of_batch) REQUIRES(draws);

    std::unique_ptr<Context> context_;
    DeviceOptions options_;
    Api gl_;
    std::string renderer_;
    bool software_ = false;
    Targets targets_ GUARDED_BY(draws);
    RestTargets rest_ GUARDED_BY(draws);
    bool rest_resolved_ GUARDED_BY(draws) = false;  ///< the second picture is out of its samples
    SampleTargets samples_;                         ///< of frames and of the second picture, which never alternate within one
    std::size_t step_ GUARDED_BY(draws) = 0;        ///< of this frame, in model::resolution_steps
    std::vector<PixelEnlarger> enlargers_ GUARDED_BY(draws);  ///< of the steps below the first; none: a pass enlarges
    std::vector<std::uint32_t> small_pixels_ GUARDED_BY(draws), shown_pixels_ GUARDED_BY(draws);
    RowCopier copier_ GUARDED_BY(draws);
    std::vector<std::uint32_t> copied_pixels_ GUARDED_BY(draws);  ///< on the way to memory that a screen is read from
    FrameBuffers frame_ GUARDED_BY(draws);
    Resources resources_;
    draw::DrawTables tables_;
    rt::TextureFilter set_filter_ GUARDED_BY(draws) = rt::TextureFilter::bilinear;  ///< in the parameters of all textures

    Program background_;                                    ///< id 0: nothing but a colour is behind everything
    model::EffectMask off_ GUARDED_BY(draws) = 0;           ///< effects that are left out
    std::size_t variant_ GUARDED_BY(draws) = 0;             ///< bit i: group i of the switches is left out
    std::vector<std::uint16_t> without_ GUARDED_BY(draws);  ///< programs, by variant, then by program of a part

    std::size_t detail_step_ GUARDED_BY(draws) = 0;  ///< the step for which all textures choose their mip levels

    Pose pose_ GUARDED_BY(draws);
    mat4 view_projection_ GUARDED_BY(draws){1.0F};
    model::Daylight light_ GUARDED_BY(draws);                       ///< of the next picture
    double time_s_ GUARDED_BY(draws) = 0;                           ///< of the next picture
    PictureMoment shown_ GUARDED_BY(draws);                         ///< of this picture
    model::MotionPoses poses_ GUARDED_BY(draws);                    ///< of this picture
    ShadowMap shadow_;                                              ///< none where no program reads one
    std::vector<std::uint32_t> caster_programs_ GUARDED_BY(draws);  ///< that draw it, by program of a part
    std::vector<DrawItem> caster_kinds_ GUARDED_BY(draws);          ///< one of each such program, to warm it up
    ShadowView shadow_view_ GUARDED_BY(draws);                      ///< of the map as it is drawn, or will be
    std::span<const DrawItem> casters_ GUARDED_BY(draws);           ///< of the map that waits to be drawn; empty: none does
    bool shadow_shown_ GUARDED_BY(draws) = false;
    Drawing drawing_ GUARDED_BY(draws) = Drawing::picture;
    CachePictures pictures_;
    PictureMeshes meshes_;
    std::string picture_reason_;
    std::vector<std::uint16_t> capture_programs_ GUARDED_BY(draws);  ///< beside those of `without_`; no_program: it draws none
    std::vector<WaitingCapture> captures_ GUARDED_BY(draws);
    std::size_t capture_count_ GUARDED_BY(draws) = 0, used_picture_vertices_ GUARDED_BY(draws) = 0;
    std::size_t used_mesh_corners_ GUARDED_BY(draws) = 0, used_mesh_indices_ GUARDED_BY(draws) = 0;
    std::uint64_t frame_number_ GUARDED_BY(draws) = 0;
    FrameStats stats_ GUARDED_BY(draws);
    std::vector<Pending> pending_ GUARDED_BY(draws), blended_ GUARDED_BY(draws);
    std::size_t blended_count_ GUARDED_BY(draws) = 0;
    std::uint32_t used_instances_ GUARDED_BY(draws) = 0, used_commands_ GUARDED_BY(draws) = 0;
    State current_ GUARDED_BY(draws){};
    bool state_known_ GUARDED_BY(draws) = false;
    std::vector<GLsync> fences_ GUARDED_BY(draws);  ///< of this frame's slices; waited ones are null
    std::uint32_t slices_ GUARDED_BY(draws) = 0, slices_done_ GUARDED_BY(draws) = 0;
    GLuint timer_ GUARDED_BY(draws) = 0;
    PFNGLGETGRAPHICSRESETSTATUSPROC reset_status_ = nullptr;  ///< null: the driver reports no resets
    bool lost_ GUARDED_BY(draws) = false;
};

}  // namespace surefoot::gl
