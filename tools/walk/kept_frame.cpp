// A kept frame's memory, and its capture.
#include "tools/walk/kept_frame.hpp"

namespace surefoot::walk {

void KeptFrame::reserve(const Engine& engine) {
    engine.reserve(prepared);
    select::reserve(cut, engine.options().prepare.max_candidates);
    memory.reserve(engine.options().prepare.max_candidates);
}

capture::Capture capture_of(const KeptFrame& kept, const WalkRequest& request, const Engine& engine) {
    const select::SelectInput input{&engine.model(),        &kept.prepared,        &engine.costs(),  kept.budget_us,
                                    kept.correction.factor, kept.target_error_rad, request.slice_us, kept.correction.upper};
    capture::Capture taken =
        capture::take(input, request.selector, static_cast<float>(request.hysteresis), kept.memory, kept.cut);
    taken.frame = kept.frame;
    return taken;
}

}  // namespace surefoot::walk
