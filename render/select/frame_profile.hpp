// How a frame's time usually runs against its prediction. Near slices fill pixels, far ones have small triangles, and a table is
// wrong by another factor for each. So a frame that is behind its prediction in the middle may end in time, each time.
#pragma once

#include <array>
#include <cstddef>

namespace surefoot::select {

/// Learnt from each check of each frame, in sixteenths of a limit that stays, by the predicted time of what was finished. It
/// forgives little: what makes frames look better is learnt over about eight frames and forgotten at once. A rest that took over
/// twice its time in one frame alone was a stall, and says nothing. What frames no longer show, since all after a check was drawn
/// coarse, is forgotten over about eight frames. Used by the thread that draws. A fixed size, no allocation.
class FrameProfile {
public:
    static constexpr std::size_t bins = 16;
    /// Measured time divided by predicted time. Both are 1 where nothing is known.
    struct Usual {
        double head = 1;  ///< of all that is finished by then, 1..4
        double tail = 1;  ///< of all after it, 1..4
    };
    /// A place that is no number is the first bin.
    [[nodiscard]] Usual at(double finished_predicted_us, double limit_us) const;

    void begin() { count_ = 0; }
    /// A check: measured and predicted time of what is finished. The first of each bin counts.
    void note(double finished_us, double finished_predicted_us, double limit_us);
    /// The frame's end, measured and predicted. Learns from what was noted since begin(); ignores what is no number.
    void finish(double end_us, double end_predicted_us, double limit_us);

private:
    struct Point {
        std::size_t bin = 0;
        double finished_us = 0, predicted_us = 0;
    };
    std::array<Usual, bins> usual_{};
    std::array<bool, bins> stalled_{};  ///< the rest took over twice its time, the last time that it was drawn in full
    std::array<Point, bins> points_{};
    std::size_t count_ = 0;
};

}  // namespace surefoot::select
