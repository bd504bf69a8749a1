// How a frame's time usually runs against its prediction. Near slices fill pixels, far ones have small triangles, and a table is
// wrong by another factor for each. So a frame that is behind its prediction in the middle may end in time, each time.
#pragma once

#include <array>
#include <cstddef>

namespace surefoot::select {

/// Learnt from each check of each frame that was drawn by one resolution, by the predicted time of what was finished. Moving
/// means of about eight frames. A fixed size, no allocation.
class FrameProfile {
public:
    static constexpr std::size_t bins = 16;
    /// As far as a frame was predicted to be. Both 1: as predicted, or not known yet.
    struct Usual {
        double wrong = 1;  ///< what still_fits() thinks of the part before: CheckInput::usual_wrong
        double tail = 1;   ///< measured by predicted time of all after it
    };
    [[nodiscard]] Usual at(double finished_predicted_us, double limit_us) const;

    void begin() { count_ = 0; }
    /// A check: measured and predicted time of what is finished, and wrongness() there. The first of each bin counts.
    void note(double finished_us, double finished_predicted_us, double wrong, double limit_us);
    /// The frame's end, measured and predicted. Learns from what was noted since begin().
    void finish(double end_us, double end_predicted_us, double limit_us);

private:
    struct Point {
        std::size_t bin = 0;
        double finished_us = 0, predicted_us = 0, wrong = 1;
    };
    std::array<Usual, bins> usual_{};
    std::array<Point, bins> points_{};
    std::size_t count_ = 0;
};

}  // namespace surefoot::select
