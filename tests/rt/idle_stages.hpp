// Stages that do next to nothing, in own code that is clean: for tests of the loop itself.
#pragma once

#include "rt/frame/loop.hpp"
#include "tests/rt/in_child.hpp"

namespace surefoot::rt::test {

class IdleStages : public FrameStages {
public:
    void sample(FrameRecord& r) override { r.prepared_age = 1; }
    void select(FrameRecord&) override {}
    void submit(FrameRecord&) override {}
    void finish(FrameRecord&) override {}
    void account(FrameRecord&) override {}
};

/// Says when the loop is well under way.
class SignallingStages final : public IdleStages {
public:
    explicit SignallingStages(StartSignal& under_way) : under_way_(under_way) {}
    void sample(FrameRecord& r) override {
        IdleStages::sample(r);
        if (r.frame == 8) under_way_.send();
    }

private:
    StartSignal& under_way_;
};

}  // namespace surefoot::rt::test
