// The daemon: the session of `surefoot walk`, without end.
#pragma once

#include "systemd/daemon/options.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::daemon {

/// Until a signal ends it, or a fault. Call it from the first thread, before any other is made. Returns the exit code.
/// inject: faults for tests; empty in service.
int run(const Options& options, const walk::FaultHook& inject = {});

/// surefootd's main: command line, then run().
int run_main(int argc, char** argv, const walk::FaultHook& inject = {});

}  // namespace surefoot::daemon
