// surefootd with a fault in it, for tests: SUREFOOT_TEST_FAULT names what the frame thread does in its fortieth frame.
#include <atomic>
#include <cstdlib>
#include <string>

#include "tools/daemon/daemon.hpp"

int main(int argc, char** argv) {
    using namespace surefoot::app;
    const char* named = std::getenv("SUREFOOT_TEST_FAULT");
    const std::string fault = named == nullptr ? "" : named;
    return surefoot::daemon::run_main(argc, argv, [fault](FramePhase phase, const surefoot::rt::FrameRecord& record) {
        if (phase != FramePhase::submit || record.frame != 40) return Fault::none;
        if (fault == "runaway") {
            for (std::atomic<unsigned> forever{0};;) ++forever;
        }
        return fault == "context-lost" ? Fault::context_lost : Fault::none;
    });
}
