// All that one walk holds while it lasts, and how it is opened. Members are made in their order and destroyed backwards.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "rt/clock/display_clock.hpp"
#include "rt/clock/grid.hpp"
#include "rt/exchange/triple_buffer.hpp"
#include "rt/frame/control.hpp"
#include "rt/frame/loop.hpp"
#include "rt/frame/steal_evidence.hpp"
#include "rt/threads/guard.hpp"
#include "rt/threads/memory.hpp"
#include "tools/walk/frame_share.hpp"
#include "tools/walk/input_session.hpp"
#include "tools/walk/path_source.hpp"
#include "tools/walk/placing.hpp"
#include "tools/walk/walk.hpp"
#include "tools/walk/walk_results.hpp"
#include "tools/walk/walk_stages.hpp"
#include "tools/walk/window_thread.hpp"
#include "tools/walk/worker_places.hpp"

namespace surefoot::walk {

/// The costs with Maciel's overhead factor on all that they predict (Maciel 1994, sections 3.3.1 and 4). A user sets it by hand,
/// for overheads that the table cannot know.
model::CostModel with_overhead(model::CostModel costs, double factor);

/// What the parts of a session share while it runs.
struct Session {
    rt::TripleBuffer<PoseSample> poses;  ///< both stand on cache lines of their own
    rt::TripleBuffer<prepare::PreparedFrame> prepared;
    const WalkRequest& request;
    const WalkObserver& observer;
    WalkFacts facts;
    PlacingPlan plan;
    std::optional<WorkerPlaces> worker_places;  ///< of the engine's workers
    std::unique_ptr<Engine> engine;
    ChosenPath path;
    std::unique_ptr<InputSession> input;  ///< null: the path is followed
    std::vector<std::string> notes;
    rt::Grid grid;
    std::optional<rt::DisplayClock> display;  ///< where a display tells when it shows pictures
    std::uint64_t frames = 0;                 ///< 0: until stopped
    bool may_be_prolonged = false;            ///< beyond `frames`, until the visitor leaves
    std::atomic<bool> prolonged{false};       ///< somebody uses the window: `frames` is no end any more
    std::unique_ptr<WindowThread> window;     ///< null without a window
    std::vector<pid_t> rasterisers;
    std::vector<pid_t> on_frame_core;        ///< those of them that share the frame thread's core
    Mutex steal_order;                       ///< its readings come in their order
    std::optional<rt::StealEvidence> steal;  ///< real clock: what the host took of the frame's cores
    KeptFrame kept;
    rt::ControlSchedule control;
    std::int64_t burn_ns = 0;  ///< the control's
    model::CostModel costs;
    rt::InputState reported_input;
    const bool virtual_clock = request.clock == rt::ClockKind::virtual_time;
    std::atomic<bool> lost{false};  ///< the graphics context

    Session(const WalkRequest& r, const WalkObserver& w) : request(r), observer(w) {}
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
    /// On every way out, refusals included: ends the workers, and releases the memory that claim() had locked.
    ~Session();
};

/// Notifies the observers which step begins.
void notify_step(const Session& s, WalkStep step);
/// Opens all that a walk needs but its threads: request, input, real time, costs, model, path, device. Fails with the first thing
/// that is wrong, named; what was opened until then goes with the session.
Result<void> open_session(Session& s, const Progress& progress);
/// Starts to read the window's events, where there is one. From a neutral thread.
void open_window_thread(Session& s);
/// A few frames along the path, so that programs, buffers and caches are warm and memory is touched.
void warm_up(Session& s);

}  // namespace surefoot::walk
