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
    int absent_core = -1;  ///< a requested frame core that does not exist or is not allowed: another one is used; -1: none
    rt::CpuMask all;       ///< of every other thread; the frame core is outside of it where the kernel isolates that one
    int frame_priority = 80, raster_priority = 70, worker_priority = 60;
    bool input = false;                        ///< an input thread steers
    bool devices = false;                      ///< and another one finds its devices
    std::vector<std::string> driver_prefixes;  ///< the driver's rasterisers
    int rasterisers = 0;                       ///< how many were found
    int workers = 1;                           ///< of the preparation, its own thread among them
    int unnamed = 1;  ///< threads that carry the program's name when all of ours are in place: the main one, a driver's
};

/// The frame thread gets rt::default_frame_core(), unless the request names a core that can be used.
Result<PlacingPlan> plan_placing(const WalkRequest& request, bool fifo_granted);

/// Places the driver's rasterisers below the frame thread, on all cores: if each were pinned to a core, the one on the frame
/// core would delay every barrier until the frame thread sleeps. Call when the context exists.
Result<std::vector<pid_t>> place_rasterisers(PlacingPlan& plan);
/// Rasterisers whose CPU time counts as the frame core's, for the control.
std::vector<pid_t> on_frame_core(const PlacingPlan& plan, const std::vector<pid_t>& rasterisers);
/// The preparation's own thread and its workers (1 and up): below the rasterisers, on every core.
rt::Placement prepare_placement(const PlacingPlan& plan);
rt::Placement worker_placement(const PlacingPlan& plan, int number);
rt::Placement frame_placement(const PlacingPlan& plan);
/// The input thread: between the frame thread and the rasterisers, so that drawing cannot delay a report; on every core, so
/// that the frame thread does not either.
rt::Placement input_placement(const PlacingPlan& plan);

/// Threads of this process that carry its name now.
int count_unnamed(const std::string& program_name);

/// Of the table: the workers' row, if there are any.
std::vector<rt::DeclaredThread> worker_rows(const PlacingPlan& plan);
/// What the census compares with: every thread that a session may have.
std::vector<rt::DeclaredThread> thread_table(const PlacingPlan& plan, bool real_clock, const std::string& program_name);

}  // namespace surefoot::walk
