// The device on a real GL context: sorts, batches and multi-draws items, slice by slice.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "render/draw/tables.hpp"
#include "render/gl/context.hpp"
#include "render/gl/resources.hpp"

namespace surefoot::gl {

class GlDevice final : public Device {
public:
    static Result<std::unique_ptr<Device>> make(std::unique_ptr<Context> context, const DeviceOptions& options);
    ~GlDevice() override;
    GlDevice(const GlDevice&) = delete;
    GlDevice& operator=(const GlDevice&) = delete;

    [[nodiscard]] std::string renderer() const override { return renderer_; }
    [[nodiscard]] bool software() const override { return software_; }
    Result<void> load(const model::Model& model, const ProgramFactory& programs) override;
    [[nodiscard]] std::vector<std::string> program_listing() const override;
    [[nodiscard]] std::string program_text(model::EffectMask mask) const override;
    void bind() override { context_->make_current(); }
    void release() override { context_->release(); }

    void begin_frame(const Pose& pose) override;
    void draw(std::span<const DrawItem> items) override;
    std::uint32_t end_slice() override;
    void wait_slices(std::uint32_t in_flight) override;
    void end_items() override;
    void finish_frame() override;
    [[nodiscard]] FrameStats stats() const override { return stats_; }
    [[nodiscard]] bool lost() const override { return lost_; }
    Result<PixelImage> read_pixels() override;
    bool begin_timer() override;
    double end_timer_ms() override;

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

    GlDevice(std::unique_ptr<Context> context, const DeviceOptions& options);
    Result<void> set_up();
    void warm_up();
    [[nodiscard]] State state_of(const Pending& pending) const;
    void submit(std::span<Pending> sorted);
    void submit_blended();
    void issue(const State& state, std::uint32_t first, std::uint32_t count);
    void apply(const State& state);
    void set_blending(bool on);
    void write_instance(const Pending& pending, std::uint32_t at);
    void append_command(const Pending& pending, std::uint32_t at, std::uint32_t first_of_batch);

    std::unique_ptr<Context> context_;
    DeviceOptions options_;
    Api gl_;
    std::string renderer_;
    bool software_ = false;
    Target target_;
    FrameBuffers frame_;
    Resources resources_;
    draw::DrawTables tables_;

    Pose pose_;
    mat4 view_projection_{1.0F};
    vec3 sun_direction_{0, 1, 0};
    std::uint64_t frame_number_ = 0;
    FrameStats stats_;
    std::vector<Pending> pending_, blended_;
    std::size_t blended_count_ = 0;
    std::uint32_t used_instances_ = 0, used_commands_ = 0;
    State current_{};
    bool state_known_ = false;
    std::vector<GLsync> fences_;  ///< of this frame's slices; waited ones are null
    std::uint32_t slices_ = 0, slices_done_ = 0;
    GLuint timer_ = 0;
    PFNGLGETGRAPHICSRESETSTATUSPROC reset_status_ = nullptr;  ///< null: the driver reports no resets
    bool lost_ = false;
};

}  // namespace surefoot::gl
