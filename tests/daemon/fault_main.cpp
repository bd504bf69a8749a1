// surefootd with a fault in it, for tests: SUREFOOT_TEST_FAULT names what the frame thread does in its fortieth frame, or, as
// FAULT:FILE, in the first one after FILE is there.
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string>

#include "systemd/daemon/daemon.hpp"

int main(int argc, char** argv) {
    using namespace surefoot::walk;
    const char* named = std::getenv("SUREFOOT_TEST_FAULT");
    const std::string all = named == nullptr ? "" : named, fault = all.substr(0, all.find(':'));
    const std::string file = fault == all ? "" : all.substr(fault.size() + 1);
    return surefoot::daemon::run_main(argc, argv, [fault, file](FramePhase phase, const surefoot::rt::FrameRecord& record) {
        const bool now = file.empty() ? record.frame == 40 : ::access(file.c_str(), F_OK) == 0;
        if (phase != (fault == "hang-present" ? FramePhase::present : FramePhase::submit) || !now) return Fault::none;
        if (fault == "runaway") {
            for (std::atomic<unsigned> forever{0};;) ++forever;
        }
        if (fault.starts_with("hang")) {
            while (true) ::pause();
        }
        return fault == "context-lost" ? Fault::context_lost : Fault::none;
    });
}
