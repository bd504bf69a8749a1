// The renderer's one door: open a model, prepare, select, submit, report. Who reads this header knows the whole renderer's shape.
//
//   workers:       prepare(region) ──► PreparedFrame ──┐  (handed over by the caller, newest wins)
//   frame thread:  select(prepared, budget) ──► Cut ◄──┘ ──► submit(pose, limit): slice by slice ──► SubmitReport
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/cost.hpp"
#include "render/model/model.hpp"
#include "render/prepare/prepared.hpp"
#include "render/select/registry.hpp"
#include "rt/base/result.hpp"

namespace surefoot {

struct EngineOptions {
    gl::DeviceOptions device;  ///< the costs of the null backend are the engine's
    prepare::PrepareOptions prepare;
    std::string selector{select::usual_selector};
    double slice_us = 1000;  ///< predicted length of a slice
    float hysteresis = 1.25F;
    bool in_frame_check = true;  ///< slices are checked against the time left; off only to show what it is worth
};

/// What one frame may spend and against which clock it is checked.
struct SubmitLimits {
    double elapsed_us = 0;                            ///< already spent in this frame when submit is called
    double limit_us = 0;                              ///< when the frame must be done, from its start
    std::int64_t (*now_ns)(void* context) = nullptr;  ///< null: the device's charged time (virtual)
    void* now_context = nullptr;
};

/// What recent frames say of the predictions: actual over predicted, at the median and, from there, at the upper quantile.
struct Correction {
    double factor = 1;
    double upper = 0;  ///< 0: the cost table's
};

/// What the submission did. Times in us from the call.
struct SubmitReport {
    double submitted_us = 0;    ///< last slice handed to the driver
    double finished_us = 0;     ///< last fence passed
    double predicted_us = 0;    ///< of what was drawn, uncorrected, median (not the upper quantile)
    model::ItemCost predicted;  ///< the sums that predicted_us follows from, slices included
    std::uint32_t slices = 0, downgraded_slices = 0, items = 0, draws = 0;
    std::uint32_t culled = 0;  ///< of the region's cut, outside this pose's view
    std::uint64_t triangles = 0;
    float worst_error_rad = 0;  ///< of what was drawn, stand-ins included
    double benefit_mean = 0;
};

/// A model, a device and the arrays between them. prepare() may run on any one thread at a time; everything else belongs to
/// the thread that called bind(). Nothing here allocates after open(), outside the driver.
class Engine {
public:
    /// Call from a neutral thread: driver and worker threads inherit from their creator.
    static Result<std::unique_ptr<Engine>> open(model::Model model, const model::CostModel& costs, const EngineOptions& options);
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    /// Without its texels.
    [[nodiscard]] const model::Model& model() const;
    [[nodiscard]] const model::CostModel& costs() const;
    [[nodiscard]] gl::Device& device();
    [[nodiscard]] const EngineOptions& options() const;

    void reserve(prepare::PreparedFrame& frame) const;
    void prepare(const prepare::Region& region, std::uint64_t frame, double speed_mps, double turn_rps,
                 prepare::PreparedFrame& out);

    /// Takes another selector from the next prepare() on, while none runs: `flat` needs more of it than the others. Allocates.
    Result<void> set_selector(std::string_view name);
    /// Turns the in-frame check off or on: off where whole cuts are to be timed.
    void set_in_frame_check(bool on);

    /// budget_us: of the whole frame; target_error_rad 0: as far as the budget goes.
    const select::Cut& select(const prepare::PreparedFrame& prepared, double budget_us, const Correction& correction,
                              double target_error_rad);
    /// What the selector remembers between frames; copied before a select() that is to be captured.
    [[nodiscard]] const select::SelectState& selection_memory() const;
    /// Draws the cut of the last select(), or the coarse levels of the last select_coarse().
    SubmitReport submit(const Pose& pose, const SubmitLimits& limits);
    /// In place of select() when no prepared frame may be used: the top levels' meshes, valid from everywhere, no culling.
    void select_coarse();

    /// (node, representation) in drawing order of the last submit(); valid until the next.
    [[nodiscard]] std::span<const gl::DrawItem> drawn() const;
    /// The most items that drawn() can hold.
    [[nodiscard]] std::size_t drawn_capacity() const;

    /// Draws items outside any budget (pictures for reports): full detail of everything visible, or a remembered set.
    void draw_unbudgeted(const Pose& pose, std::span<const gl::DrawItem> items);
    /// Every visible leaf at full detail, for draw_unbudgeted; allocates.
    [[nodiscard]] std::vector<gl::DrawItem> full_detail(const Pose& pose) const;

private:
    struct Impl;
    explicit Engine(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// The region that a prepared frame was made for holds the pose's eye and all of its view.
bool covers(const prepare::Region& region, const Pose& pose, model::Viewport viewport);

/// The region for the next frames, from the last two samples: extrapolated by `horizon_s`, widened by what may change in it.
prepare::Region predict_region(const Pose& before, const Pose& now, double dt_s, double horizon_s);

}  // namespace surefoot
