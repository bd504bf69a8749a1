// The daemon: the session of `surefoot walk`, without end.
#pragma once

#include "tools/app/walk.hpp"
#include "systemd/daemon/options.hpp"

namespace surefoot::daemon {

/// Until a signal ends it, or a fault. Call it from the first thread, before any other is made. Returns the exit code.
/// inject: faults for tests; empty in service.
int run(const Options& options, const app::FaultHook& inject = {});

/// surefootd's main: command line, then run().
int run_main(int argc, char** argv, const app::FaultHook& inject = {});

}  // namespace surefoot::daemon
