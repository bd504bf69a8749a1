// The session: a real-time walk through a model, with its threads placed, its frames accounted and its results handed back.
// The commands walk and soak, and the daemon, all run this.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/settings.hpp"
#include "render/gl/backends.hpp"
#include "render/select/select.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "rt/clock/display_clock.hpp"
#include "rt/frame/record.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
struct Path;
}
namespace surefoot::capture {
struct Capture;
}
namespace surefoot::model {
struct CostModel;
}

namespace surefoot::walk {

/// The input that means all connected devices. A recording of that name is "./devices".
constexpr std::string_view live_input = "devices";
/// The input that means keyboard and mouse of the window. A recording of that name has a "./" in front too.
constexpr std::string_view window_input = gl::window_backend;

/// The request for one walk: the settings, with file names that can be opened, and what no settings file has. 0 or empty means
/// the default in the comment.
struct WalkRequest : config::Settings {
    WalkRequest();            ///< the schema's defaults
    std::string config_file;  ///< where settings came from: not to be written over; may be empty
    bool may_leave = false;   ///< Escape in a window, and closing it, end the walk
    bool may_steer = false;   ///< keyboard and mouse of a window steer
    bool clear_stop = false;  ///< live: release a stop that an earlier walk left latched
    /// 0: as `seconds`, else as the recording plus a second, else (live too) as the path is long. A visitor who steers by a
    /// window walks on until he leaves.
    std::uint64_t frames = 0;
    double seconds = 0;
    /// Of a walk that keeps records, 0.4 KiB each. A longer one is refused; one that a visitor prolongs ends there.
    std::uint64_t max_kept_frames = 4'000'000;
    bool keep_records = true;  ///< false: records go only to the observer, and no outputs are made of them
    bool endless = false;      ///< until progress.stop: records go only to the observer and are not kept, so there are no outputs
    double cost_noise = 0;     ///< relative, seeded (virtual clock)
    select::BenefitModel benefit = select::BenefitModel::surefoot;  ///< of the 1994 selectors
    bool correct_costs = true;                                      ///< online correction of predictions; false: frozen at 1
    bool stills = false;  ///< each frame is prepared where it looks from, as if the eye stood there (virtual clock only)
    std::uint32_t control_pairs = 90;
    double control_block_s = 2.0;
    std::shared_ptr<const model::CostModel> given_costs;  ///< in place of the state folder's and of the model's fit; null: those
    std::shared_ptr<const Path> given_path;               ///< in place of path_file; null: that
    std::string ledger_file, trace_file, report_dir, snap_dir;
    std::uint64_t snap_every = 0;
    std::uint32_t pictures =
        0;  ///< frames to compare with full detail after the walk; 0: as many as a report shows, if there is one
    std::string capture_file;  ///< one frame's prepared arrays and cut, for `surefoot replay`
    std::uint64_t capture_frame = 0;
};

/// Result of a walk.
struct WalkOutcome {
    report::WalkSummary summary;
    std::vector<rt::FrameRecord> records;
    std::vector<Error> failures;                   ///< outputs that could not be written; the others are complete
    std::vector<std::string> notes;                ///< messages for the user, one line each
    bool stopped = false;                          ///< ended before its last frame, by progress.stop
    bool left = false;                             ///< ended by the visitor, by Escape in the window or by closing it
    bool lost = false;                             ///< ended because the graphics context was lost; failures has the error
    std::vector<report::PictureFigures> pictures;  ///< that were compared with full detail, in order
    std::string report_page;                       ///< the report's index.html, if requested
};

/// The step of a walk. An Error of run_walk() belongs to the last notified step.
enum class WalkStep : std::uint8_t { request, input, real_time, model, device, frames, ending };

/// Faults for tests: called on the frame thread as each stage of a frame begins; what it does there delays that stage. raster:
/// the picture was handed to the rasterisers (real clock).
enum class FramePhase : std::uint8_t { sample, select, submit, raster, finish, present };
/// upload: what the hook did in `submit` was an upload. draw_again: in `raster`, the picture is drawn once more, and the hook is
/// called again.
enum class Fault : std::uint8_t { none, context_lost, upload, draw_again };
using FaultHook = std::function<Fault(FramePhase, const rt::FrameRecord&)>;

/// A display that takes the pictures in the device's place: of tests, to which it tells when it showed them. present() is called
/// on the frame thread, at the time of showing; it returns when the picture is shown.
struct TestDisplay {
    rt::Refreshes refreshes;
    std::function<rt::Shown(const rt::FrameRecord&)> present;
};

/// Known when all threads are in place; the spans are valid during the call only.
struct WalkStart {
    std::int64_t t0_ns = 0, period_ns = 0;  ///< slot k is due at t0 + k * period
    std::span<const rt::Lack> degraded;
    std::string uncalibrated;  ///< the cost table is missing or another machine's: what, and the remedy; else empty
    std::string renderer, path;
    rt::Granted granted;
    int rasterisers = 0;
};

/// Observers of a walk: telemetry, the daemon, soaks. Each may be empty.
struct WalkObserver {
    std::function<void(WalkStep)> on_step;                  ///< on the caller's thread, as each begins
    std::function<void(const WalkStart&)> on_started;       ///< on the caller's thread, before the first slot is due (real clock)
    std::function<void(const rt::FrameRecord&)> on_record;  ///< on the monitor thread: every frame, in order
    std::function<void(const rt::Lack&)> on_degraded;       ///< on the caller's thread: found after on_started
    std::function<void(const rt::InputState&)> on_input;    ///< on the caller's thread: whenever it has changed
    /// On the caller's thread, a tenth of a second later at most: a missed frame for `surefoot replay`, the first
    /// since the last call. Not for frames drawn from coarse levels, nor beside capture_file, nor of the largest models.
    std::function<void(const capture::Capture&)> on_missed_frame;
    FaultHook inject;
    std::function<void()> inject_prepare;  ///< for tests: on sf-prepare before each set, which it delays (real clock)
    const TestDisplay* display = nullptr;  ///< real clock only; its refresh is a whole multiple of the rate
};

/// Errors, all before the first frame: unreadable model, path, recording or steering file, no context, --strict without real
/// time, outputs that could not be written. What fails after the walk is in the outcome's failures. Stopping (progress.stop) ends
/// the walk at the next frame; what was walked is summed up and written. An endless walk has an end too, but no figures.
Result<WalkOutcome> run_walk(const WalkRequest& request, const Progress& progress, const WalkObserver& observer = {});

}  // namespace surefoot::walk
