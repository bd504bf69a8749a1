// The declared table of the session's threads (core, policy, priority), and the functions that apply it.
#pragma once

#include <string>
#include <vector>

#include "rt/base/result.hpp"
#include "rt/threads/census.hpp"
#include "rt/threads/placement.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// Cores and priorities of one session, from the request and the machine.
struct PlacingPlan {
    bool fifo = false;  ///< requested and granted
    int frame_core = 0;
    int absent_core = -1;  ///< the requested frame core, if it does not exist or is not allowed; then another is used; -1: none
    rt::CpuMask all;       ///< the cores of all other threads; without the frame core if the kernel isolates it
    int frame_priority = 80, raster_priority = 70, worker_priority = 60;
    bool input = false;                        ///< an input thread steers
    bool devices = false;                      ///< a thread finds devices (sf-devices)
    bool window = false;                       ///< a thread reads a window's events (sf-window)
    std::vector<std::string> driver_prefixes;  ///< names of the driver's rasterisers begin so
    int rasterisers = 0;                       ///< number of rasterisers found
    int workers = 1;                           ///< of preparation, with the prepare thread
    int unnamed = 1;                           ///< threads with the program's own name: the main thread, and those of the driver
};

/// The frame thread gets rt::default_frame_core(), unless the request names a core that can be used. Error: this process
/// may use no core.
Result<PlacingPlan> plan_placing(const WalkRequest& request, bool fifo_granted);

/// Places the driver's rasterisers below the frame thread, on all cores. If each were pinned to a core, the one on the frame core
/// would not run while the frame thread does. The others would wait for it. Call when the context exists.
Result<std::vector<pid_t>> place_rasterisers(PlacingPlan& plan);
/// The rasterisers whose CPU time counts as that of the frame core: one if they share all cores, else none. The control burns it
/// too.
std::vector<pid_t> on_frame_core(const PlacingPlan& plan, const std::vector<pid_t>& rasterisers);
/// The place of the prepare thread, below the rasterisers, on every core; and of its worker `number`, from 1.
rt::Placement prepare_placement(const PlacingPlan& plan);
rt::Placement worker_placement(const PlacingPlan& plan, int number);
rt::Placement frame_placement(const PlacingPlan& plan);
/// The place of the input thread. It has a priority between the frame thread and the rasterisers, so drawing cannot delay a
/// report. It may use every core, so the frame thread cannot delay a report either.
rt::Placement input_placement(const PlacingPlan& plan);
/// The place of the thread that reads a window's events: that of the input thread, for the same reasons.
rt::Placement window_placement(const PlacingPlan& plan);

/// Number of threads of this process that have the program's own name now.
int count_unnamed(const std::string& program_name);

/// The row of the workers in the table; empty without workers.
std::vector<rt::DeclaredThread> worker_rows(const PlacingPlan& plan);
/// The declared table, which the census compares with: every thread that a session may have.
std::vector<rt::DeclaredThread> thread_table(const PlacingPlan& plan, bool real_clock, const std::string& program_name);

}  // namespace surefoot::walk
