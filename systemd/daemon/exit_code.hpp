// Exit codes of surefootd: one for each kind of fault. From 64 on they are those of sysexits.h, so that systemd
// shows the name too.
#pragma once

#include "tools/walk/walk.hpp"

namespace surefoot::daemon {

enum ExitCode : int {
    exit_success = 0,
    exit_failure = 1,        ///< what has no number of its own
    exit_usage = 2,          ///< wrong command line
    exit_no_input = 66,      ///< model, path, steering, recording or cost table cannot be read
    exit_unavailable = 69,   ///< no graphics context, or it was lost
    exit_runaway = 70,       ///< a real-time thread never slept
    exit_cannot_write = 73,  ///< the state folder: a stop could not be remembered
    exit_no_real_time = 77,  ///< `strict`, and the machine refuses what real time needs
    exit_config = 78,        ///< the settings file
};

/// Of an Error that run_walk() returned in this step.
constexpr ExitCode exit_code_of(walk::WalkStep step) {
    switch (step) {
        case walk::WalkStep::request:
            return exit_config;
        case walk::WalkStep::input:
        case walk::WalkStep::model:
            return exit_no_input;
        case walk::WalkStep::real_time:
            return exit_no_real_time;
        case walk::WalkStep::device:
            return exit_unavailable;
        case walk::WalkStep::frames:
        case walk::WalkStep::ending:
            break;
    }
    return exit_failure;
}

}  // namespace surefoot::daemon
