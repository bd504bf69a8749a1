// The walk's frame: take the newest pose, take the newest prepared set, select, submit, account. Runs on the frame thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "render/capture/capture.hpp"
#include "render/engine.hpp"
#include "rt/clock/clock.hpp"
#include "rt/exchange/triple_buffer.hpp"
#include "rt/frame/controller.hpp"
#include "rt/frame/loop.hpp"
#include "tools/walk/pose_source.hpp"
#include "tools/walk/prepare_thread.hpp"
#include "tools/walk/snapshots.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// One frame kept for `surefoot replay`: copied by the frame thread into memory that was sized before, put together by another.
/// The frame thread writes while `kept` is false. The reader may read while it is true.
struct KeptFrame {
    std::atomic<bool> kept{false};
    std::uint64_t frame = 0;  ///< of the walk
    prepare::PreparedFrame prepared;
    select::Cut cut;
    std::vector<select::Shown> memory;  ///< before the selection
    double budget_us = 0, target_error_rad = 0;
    Correction correction;

    /// For all that `engine` may select.
    void reserve(const Engine& engine);
};

/// As a file holds it. Allocates.
capture::Capture capture_of(const KeptFrame& kept, const WalkRequest& request, const Engine& engine);

struct WalkStagesOptions {
    const WalkRequest& request;
    std::int64_t period_ns = 0;
    double budget_us = 0;  ///< of the whole frame, from its due time
    double limit_us = 0;   ///< of the in-frame check, from the due time
    double target_error_rad = 0;
    std::uint64_t capture_frame = ~0ULL;  ///< kept, or else (capture_missed) the first missed one that nobody has taken yet
    bool capture_missed = false;
    const FaultHook* inject = nullptr;  ///< null: no faults
    std::atomic<bool>* lost = nullptr;  ///< set when the device is; may be null
};

class WalkStages final : public rt::FrameStages {
public:
    /// `clock` is the loop's; where the request's is virtual, a rt::VirtualClock. Everything must outlive this.
    WalkStages(Engine& engine, PoseSource& pose_source, rt::Clock& clock, rt::TripleBuffer<PoseSample>& poses,
               rt::TripleBuffer<prepare::PreparedFrame>& prepared, SnapshotStore& snapshots, KeptFrame& kept,
               const WalkStagesOptions& options);

    void sample(rt::FrameRecord& record) override;
    void select(rt::FrameRecord& record) override;
    void submit(rt::FrameRecord& record) override;
    void finish(rt::FrameRecord& record) override;
    void account(rt::FrameRecord& record) override;

private:
    void inject(FramePhase phase, const rt::FrameRecord& record) const;
    void prepare_inline();
    void take(const FramePose& from, rt::FrameRecord& record);
    void latch(rt::FrameRecord& record);
    [[nodiscard]] FrameTime frame_time(const rt::FrameRecord& record) const;
    void keep(const rt::FrameRecord& record);

    Engine& engine_;
    PoseSource& pose_source_;
    rt::Clock& clock_;
    rt::TripleBuffer<PoseSample>& poses_;
    rt::TripleBuffer<prepare::PreparedFrame>& prepared_;
    SnapshotStore& snapshots_;
    KeptFrame& kept_;
    WalkStagesOptions options_;
    const WalkRequest& request_;  ///< control: bare blocks lie between, the path's time is counted in walked frames
    const bool virtual_clock_;    ///< prepare inline, charge the device's virtual time
    rt::CostController controller_;
    PoseSample now_;
    SubmitReport report_;
    std::uint64_t walked_ = 0, path_slot_ = 0;
    bool coarse_ = false;
    const select::Cut* cut_ = nullptr;  ///< the last selection's, and what it was asked
    double requested_budget_us_ = 0;
    Correction requested_correction_;
};

}  // namespace surefoot::walk
