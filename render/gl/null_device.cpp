// The null device: draws nothing, records counts, and charges every item to the virtual cost clock exactly as prepare
// predicts it: same table, same pixel estimate, same combination of sums.
#include <algorithm>
#include <optional>
#include <utility>

#include "render/draw/tables.hpp"
#include "render/gl/picture_faces.hpp"
#include "render/gl/program.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/moving.hpp"
#include "rt/base/random.hpp"

namespace surefoot::gl {

namespace {

class NullDevice final : public Device {
public:
    NullDevice(const DeviceOptions& options, const NullOptions& null_options)
        : options_(options),
          null_(null_options),
          costs_(null_options.costs != nullptr ? *null_options.costs : model::default_costs()),
          random_(null_options.seed) {
        const float plain_us = costs_.rest_pass_us(options.viewport);
        costs_ = model::at_quality(costs_, gl::quality_of(*this, costs_));
        null_.rest_pass_us += static_cast<double>(costs_.rest_pass_us(options.viewport) - plain_us);
        if (switches_filter())
            other_grids_ = model::at_quality(costs_, {1, rt::TextureFilter::trilinear, rt::TextureFilter::bilinear}).grids;
    }

    [[nodiscard]] std::string renderer() const override { return "null"; }
    [[nodiscard]] bool software() const override { return true; }
    [[nodiscard]] std::uint32_t samples() const override { return std::max(1U, options_.samples); }
    [[nodiscard]] rt::TextureFilter filter() const override {
        if (options_.filter != rt::TextureFilter::automatic) return options_.filter;
        return costs_.filter == rt::TextureFilter::automatic ? rt::TextureFilter::bilinear : costs_.filter;
    }
    [[nodiscard]] bool switches_filter() const override {
        return options_.second_filter && options_.filter == rt::TextureFilter::automatic &&
               filter() == rt::TextureFilter::bilinear;
    }
    void set_filter(rt::TextureFilter filter) override REQUIRES(draws) {
        if (!switches_filter() || filter == set_filter_) return;
        set_filter_ = filter;
        std::swap(costs_.grids, other_grids_);  // of equal layout, so item_costs_ stays right
    }
    void set_time(double time_s) override REQUIRES(draws) { time_s_ = time_s; }
    Result<void> load(const model::Model& model, const ProgramFactory& programs) override REQUIRES(draws);
    [[nodiscard]] std::vector<std::string> program_listing() const override;
    [[nodiscard]] std::string program_text(model::EffectMask mask) const override;
    void hide_effects(model::EffectMask hidden) override REQUIRES(draws) { hidden_ = left_out(options_.switches, hidden); }
    [[nodiscard]] bool receives_shadows() const override {
        return model_ != nullptr && (model_->called_for() & model::effect_moving_shadow) != 0;
    }
    void bind() override ASSERT_CAPABILITY(draws) {}
    void release() override RELEASE(draws) NO_THREAD_SAFETY_ANALYSIS {}

    using Device::begin_frame;
    void begin_frame(const Pose& pose, float resolution) override REQUIRES(draws);
    void draw(std::span<const DrawItem> items) override REQUIRES(draws);
    void charge_us(double us) override REQUIRES(draws) {
        other_us_ += us;
        charge();
    }
    std::uint32_t end_slice() override REQUIRES(draws) {
        ++slices_;
        charge();
        return slices_;
    }
    void wait_slices(std::uint32_t) override REQUIRES(draws) {}
    void end_items() override REQUIRES(draws) {
        if (blended_ > 0) end_slice();
        blended_ = 0;
    }
    void finish_frame() override REQUIRES(draws) {
        if (stats_.resolution < 1) frame_us_ += null_.cost_scale * factor_ * null_.enlarge_us;
    }
    [[nodiscard]] std::uint32_t picture_layers() const override { return model_ != nullptr ? options_.picture_layers : 0; }
    using Device::capture_picture;
    bool capture_picture(const CachePicture& picture, std::span<const DrawItem>, std::span<const CachePicture>) override
        REQUIRES(draws) {
        if (captures_ == max_captures || !lies_within(picture.place, picture_layers())) return false;
        ++captures_;
        return true;
    }
    void draw_pictures(std::span<const CachePicture> back_to_front) override REQUIRES(draws) {
        if (picture_layers() > 0) stats_.pictures += static_cast<std::uint32_t>(back_to_front.size());
    }
    [[nodiscard]] RestSupport rest_support() const override REQUIRES(draws) {
        return options_.rest ? RestSupport::samples : RestSupport::none;
    }
    void begin_rest(const Pose& pose, const dvec2& offset_px) override REQUIRES(draws);
    void draw_rest(std::span<const DrawItem> items, Parts parts) override REQUIRES(draws);
    void add_sample(bool) override REQUIRES(draws) { charge_pass(); }
    void show_rest(std::uint32_t) override REQUIRES(draws) { charge_pass(); }
    void finish_rest_frame() override REQUIRES(draws) {}
    [[nodiscard]] FrameStats stats() const override REQUIRES(draws) { return stats_; }
    Result<PixelImage> read_pixels() override REQUIRES(draws) {
        return Error{"backend 'null'", "The backend draws nothing, so there is no picture", "Use --backend egl for pictures",
                     ErrorKind::unsupported};
    }
    [[nodiscard]] double charged_us() const override REQUIRES(draws) { return before_us_ + frame_us_; }
    [[nodiscard]] bool charges() const override { return true; }

private:
    void charge() REQUIRES(draws);
    [[nodiscard]] model::ItemCost cost_of(const DrawItem& item) REQUIRES(draws);
    /// The picture at rest has no fixed costs of a frame: its passes are charged one by one.
    void charge_pass() REQUIRES(draws) { before_us_ += null_.cost_scale * factor_ * null_.rest_pass_us; }

    DeviceOptions options_;
    NullOptions null_;
    model::CostModel costs_;
    std::vector<model::CostGrid> other_grids_;  ///< of the filter that is not set
    rt::TextureFilter set_filter_ GUARDED_BY(draws) = filter();
    Random random_;
    struct LoadedProgram {
        model::EffectMask mask;
        ProgramSource source;
    };
    std::vector<LoadedProgram> programs_;
    const model::Model* model_ = nullptr;
    std::optional<model::ItemCosts> item_costs_;
    model::MovingNodes moving_ GUARDED_BY(draws);
    model::MotionPoses poses_ GUARDED_BY(draws);  ///< of this picture
    double time_s_ GUARDED_BY(draws) = 0;
    model::EffectMask hidden_ GUARDED_BY(draws) = 0;
    dvec3 eye_{0.0};
    model::ViewScale scale_;
    FrameStats stats_ GUARDED_BY(draws);
    double submit_us_ GUARDED_BY(draws) = 0, raster_us_ GUARDED_BY(draws) = 0, factor_ GUARDED_BY(draws) = 1;
    double before_us_ GUARDED_BY(draws) = 0, frame_us_ GUARDED_BY(draws) = 0, other_us_ GUARDED_BY(draws) = 0;
    std::uint32_t slices_ GUARDED_BY(draws) = 0, blended_ GUARDED_BY(draws) = 0;
    std::uint32_t captures_ GUARDED_BY(draws) = 0;  ///< that wait for the next picture
};

Result<void> NullDevice::load(const model::Model& model, const ProgramFactory& programs) {
    if (costs_.grids.empty())
        return Error{"cost table", "The table holds no state class", "Run `surefoot calibrate`", ErrorKind::damaged};
    programs_.clear();
    for (const model::EffectMask mask : draw::make_tables(model).masks) programs_.push_back({mask, programs(mask)});
    const model::EffectMask behind = options_.background ? model.called_for() & model::background_effects : 0;
    if (behind != 0) programs_.push_back({behind, programs(behind)});
    model_ = &model;
    item_costs_.emplace(model, costs_);
    moving_ = model::MovingNodes(model);
    poses_ = model::MotionPoses(model);
    time_s_ = 0;
    return {};
}

std::vector<std::string> NullDevice::program_listing() const {
    std::vector<std::string> lines;
    for (const auto& program : programs_) lines.push_back(std::to_string(program.mask) + ": " + program.source.name);
    return lines;
}

std::string NullDevice::program_text(model::EffectMask mask) const {
    for (const auto& program : programs_) {
        if (program.mask == mask) return program.source.vertex + program.source.fragment;
    }
    return {};
}

void NullDevice::begin_frame(const Pose& pose, float resolution) {
    before_us_ += frame_us_;
    eye_ = pose.position;
    poses_.set_time(time_s_);
    stats_ = {};
    stats_.resolution = model::resolution_steps[model::resolution_step(resolution)];
    stats_.samples = samples();
    stats_.filter = set_filter_;
    stats_.captures = std::exchange(captures_, 0);
    scale_ = model::scaled(model::make_view_scale(pose, options_.viewport), stats_.resolution);
    submit_us_ = raster_us_ = other_us_ = 0;
    slices_ = blended_ = 0;
    // One factor a frame: what makes real predictions wrong is common to a frame's items. Drawn even without noise, so that
    // the sequence does not depend on it.
    factor_ = std::max(0.0, 1.0 + null_.noise * (2.0 * random_.unit() - 1.0));
    charge();
}

model::ItemCost NullDevice::cost_of(const DrawItem& item) {
    float pixels = 0;
    if (const auto moving = moving_.find(item.node, poses_))
        return item_costs_->of(item.rep, moving->rest, moving->pose.back(eye_), model::turned_back(scale_, moving->pose), pixels,
                               hidden_);
    return item_costs_->of(item.rep, model_->nodes[item.node].box, eye_, scale_, pixels, hidden_);
}

void NullDevice::draw(std::span<const DrawItem> items) {
    for (const DrawItem& item : items) {
        const model::Representation& rep = model_->reps[item.rep];
        const model::ItemCost cost = cost_of(item);
        submit_us_ += static_cast<double>(cost.submit_us);
        raster_us_ += static_cast<double>(cost.raster_us);
        ++stats_.items;
        stats_.draws += rep.part_count;
        stats_.triangles += rep.triangles;
        if ((rep.effects & model::effect_blend) != 0) ++blended_;
    }
    ++stats_.batches;
    charge();
}

void NullDevice::begin_rest(const Pose& pose, const dvec2&) {
    captures_ = 0;
    eye_ = pose.position;
    scale_ = model::make_view_scale(pose, options_.viewport);
    charge_pass();
    before_us_ += null_.cost_scale * factor_ * null_.behind_us;
}

/// A slice of its own, as the engine predicts it. Items with blended parts are charged both times.
void NullDevice::draw_rest(std::span<const DrawItem> items, Parts parts) {
    model::ItemCost sum{costs_.slice_us, 0};
    for (const DrawItem& item : items) {
        if (parts == Parts::blended && (model_->reps[item.rep].effects & model::effect_blend) == 0) continue;
        sum += cost_of(item);
        stats_.draws += model_->reps[item.rep].part_count;
    }
    const float us = costs_.combine.frame_us(sum.submit_us, sum.raster_us) - costs_.combine.fixed_us;
    before_us_ += null_.cost_scale * factor_ * static_cast<double>(us);
}

/// As the engine predicts a frame: slices are submit time.
void NullDevice::charge() {
    const double slices_us = static_cast<double>(slices_) * static_cast<double>(costs_.slice_us);
    const model::FrameCombine combine = costs_.combine_at(stats_.resolution, options_.viewport);
    const float sums = combine.frame_us(static_cast<float>(submit_us_ + slices_us), static_cast<float>(raster_us_));
    frame_us_ = null_.cost_scale * factor_ * (static_cast<double>(sums) + other_us_);
}

}  // namespace

Result<std::unique_ptr<Device>> open_null_device(const DeviceOptions& options, const NullOptions& null_options) {
    return std::unique_ptr<Device>(std::make_unique<NullDevice>(options, null_options));
}

}  // namespace surefoot::gl
