// Stages that do next to nothing, in own code that is clean: for tests of the loop itself.
#pragma once

#include "rt/frame/loop.hpp"

namespace surefoot::rt::test {

class IdleStages : public FrameStages {
public:
    void sample(FrameRecord& r) override { r.prepared_age = 1; }
    void select(FrameRecord&) override {}
    void submit(FrameRecord&) override {}
    void finish(FrameRecord&) override {}
    void account(FrameRecord&) override {}
};

}  // namespace surefoot::rt::test
