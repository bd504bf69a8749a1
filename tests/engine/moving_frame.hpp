// One frame of an engine on a model in which things move: prepared, selected and submitted at a time.
#pragma once

#include "render/engine.hpp"

namespace surefoot::test {

/// `prepared` was reserved by the engine. On the thread that draws.
inline SubmitReport moving_frame(Engine& engine, prepare::PreparedFrame& prepared, const Pose& pose, double time_s,
                                 double budget_us, const SubmitLimits& limits) {
    engine.device().draws.plays();
    PrepareHints hints;
    hints.time_s = time_s;
    engine.prepare({pose, 0.25, 0.06}, 0, 0, 0, prepared, hints);
    engine.set_time(time_s);
    engine.select(prepared, budget_us, {}, 0);
    return engine.submit(pose, limits);
}

}  // namespace surefoot::test
