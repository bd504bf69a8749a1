// The walk's frame: take the newest pose, take the newest prepared set, select, submit, account, present. Runs on the frame
// thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "render/capture/capture.hpp"
#include "render/engine.hpp"
#include "rt/clock/clock.hpp"
#include "rt/exchange/triple_buffer.hpp"
#include "rt/frame/corrections.hpp"
#include "rt/frame/form_correction.hpp"
#include "rt/frame/loop.hpp"
#include "rt/frame/overshoot.hpp"
#include "tools/walk/frame_limit.hpp"
#include "tools/walk/pose_source.hpp"
#include "tools/walk/prepare_thread.hpp"
#include "tools/walk/snapshots.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// One frame, kept for `surefoot replay`. The frame thread copies it into reserved memory while `kept` is false, then sets
/// `kept`. Another thread makes the file from it while `kept` is true.
struct KeptFrame {
    std::atomic<bool> kept{false};
    std::uint64_t frame = 0;  ///< of the walk
    prepare::PreparedFrame prepared;
    select::Cut cut;
    std::vector<select::Shown> memory;  ///< before the selection
    select::RememberedItems bought_before;
    select::ItemList offered;
    double budget_us = 0, target_error_rad = 0;
    Correction correction;

    /// Reserves memory for any cut that `engine` may select.
    void reserve(const Engine& engine);
};

/// The kept frame in the form that is written to a file. Allocates; not for the frame thread.
capture::Capture capture_of(const KeptFrame& kept, const WalkRequest& request, const Engine& engine);

/// Settings of the stages. References must outlive them.
struct WalkStagesOptions {
    const WalkRequest& request;
    std::int64_t period_ns = 0;
    double budget_us = 0;  ///< of the whole frame, from its due time
    double limit_us = 0;   ///< of the in-frame check, from the due time
    int shared_cores = 0;  ///< of real-time rasterisers and workers: FrameLimit; 0: they share none
    double target_error_rad = 0;
    std::uint64_t capture_frame = ~0ULL;      ///< number of the frame to keep
    bool capture_missed = false;              ///< also keep missed frames, one at a time
    const FaultHook* inject = nullptr;        ///< injects faults, for tests; null: none
    const TestDisplay* display = nullptr;     ///< takes the pictures, for tests; null: the device does
    const std::atomic<bool>* stop = nullptr;  ///< ends the rehearsal; may be null
    const std::atomic<bool>* left = nullptr;  ///< the same
    RegionClip* clip = nullptr;               ///< where frames are prepared inline; null where nobody walks
    std::atomic<bool>* lost = nullptr;        ///< set when the graphics device is lost; may be null
};

/// At most. A correction is the median of 15, and changes by 6 % a frame; then a resolution is chosen.
constexpr int rehearsed_frames = 24;
/// Whether a walk has a rehearsal: it is there for the corrections of costs. A walk without one begins at once.
constexpr bool rehearses(const WalkRequest& request, bool virtual_clock) { return request.correct_costs && !virtual_clock; }

/// The stages of a walk. The frame thread calls all members.
class WalkStages final : public rt::FrameStages {
public:
    /// `clock` is the loop's; where the request's is virtual, a rt::VirtualClock. Everything must outlive this.
    WalkStages(Engine& engine, PoseSource& pose_source, rt::Clock& clock, rt::TripleBuffer<PoseSample>& poses,
               rt::TripleBuffer<prepare::PreparedFrame>& prepared, SnapshotStore& snapshots, KeptFrame& kept,
               const WalkStagesOptions& options);

    /// Draws the first view again and again, as frames of the walk: one a period, with sets prepared meanwhile. So corrections
    /// are known before the first frame, and the resolution is chosen by them. The last one begins two periods before `until_ns`
    /// at the latest. A stop ends it. Nothing on the virtual clock, or where costs are not corrected.
    void rehearse(std::int64_t until_ns);

    void sample(rt::FrameRecord& record) override;
    void select(rt::FrameRecord& record) override;
    void submit(rt::FrameRecord& record) override;
    void finish(rt::FrameRecord& record) override;
    void account(rt::FrameRecord& record) override;
    rt::Shown present(rt::FrameRecord& record) override;
    void shown_late(const rt::FrameRecord& record) override;

private:
    Fault inject(FramePhase phase, const rt::FrameRecord& record) const;
    void inject_submit(rt::FrameRecord& record) const;
    void inject_raster(const rt::FrameRecord& record, std::int64_t begun_ns);
    void prepare_inline();
    [[nodiscard]] PrepareHints hints() const;
    void publish_rehearsed(const FramePose& newest, std::int64_t due_ns);
    void take(const FramePose& from, rt::FrameRecord& record);
    [[nodiscard]] rt::ShownLight light_at(const FramePose& at) const;
    void show(const rt::ShownLight& light);
    [[nodiscard]] double walk_time_s() const;  ///< of the frame, from its due time
    void latch(rt::FrameRecord& record);
    /// What the frames at this resolution have taught, as far as predictions are corrected. filtered: those that bought the
    /// second mip level.
    [[nodiscard]] Correction correction_at(float resolution, bool filtered) const;
    /// How much later than forecast recent frames ended, us, within bounds.
    [[nodiscard]] double margin_us() const;
    [[nodiscard]] double taken_by_lead_us() const;
    [[nodiscard]] SubmitLimits frame_limits() const;  ///< without a clock, and as if the frame began now
    [[nodiscard]] double planned_us(const Correction& by, double spent_us) const;
    [[nodiscard]] FrameTime frame_time(const rt::FrameRecord& record) const;
    void learn(double actual_us);
    void keep(const rt::FrameRecord& record);
    [[nodiscard]] double cost_factor(const rt::FrameRecord& record, double actual_us) const;

    Engine& engine_;
    PoseSource& pose_source_;
    rt::Clock& clock_;
    rt::TripleBuffer<PoseSample>& poses_;
    rt::TripleBuffer<prepare::PreparedFrame>& prepared_;
    SnapshotStore& snapshots_;
    KeptFrame& kept_;
    WalkStagesOptions options_;
    const WalkRequest& request_;
    FrameLimit limit_;
    const bool virtual_clock_;            ///< prepare on this thread, and add the device's virtual time to the clock
    const model::EffectMask called_for_;  ///< of the model
    rt::Corrections corrections_;         ///< by step of resolution, then those with the second mip level
    rt::Overshoot overshoot_;
    rt::FormCorrection forms_;
    PoseSample now_;
    SubmitReport report_;
    float learnt_resolution_ = 1;       ///< of the last frame that drew a selected cut; the picture at rest is another
    double lead_us_ = 0;                ///< what presenting usually takes
    double time_left_us_ = 0;           ///< until the limit, as the last submission began
    std::uint64_t walked_ = 0;          ///< frames so far, with the rehearsed ones and without the control's bare ones
    std::uint64_t rehearsed_ = 0;       ///< of them
    float shown_hour_ = rt::no_hour;    ///< that the engine was given last
    std::uint64_t path_slot_ = 0;       ///< position on the path, in periods; with a control it does not advance in bare blocks
    bool filtered_ = false;             ///< the last frame that was learnt from had the second mip level
    bool coarse_ = false;               ///< the last selection was Engine::select_last()
    const select::Cut* cut_ = nullptr;  ///< of the last selection
    double requested_budget_us_ = 0;    ///< what that selection was given
    Correction requested_correction_;
};

}  // namespace surefoot::walk
