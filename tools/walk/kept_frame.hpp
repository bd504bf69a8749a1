// One frame kept for `surefoot replay`: copied by the frame thread into memory that was sized before, put together by another.
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "render/capture/capture.hpp"
#include "render/engine.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// The frame thread writes while `kept` is false. The reader may read while it is true.
struct KeptFrame {
    std::atomic<bool> kept{false};
    std::uint64_t frame = 0;  ///< of the walk
    prepare::PreparedFrame prepared;
    select::Cut cut;
    std::vector<select::Shown> memory;  ///< before the selection
    double budget_us = 0, target_error_rad = 0;
    Correction correction;

    /// For all that `engine` may select.
    void reserve(const Engine& engine);
};

/// As a file holds it. Allocates.
capture::Capture capture_of(const KeptFrame& kept, const WalkRequest& request, const Engine& engine);

}  // namespace surefoot::walk
