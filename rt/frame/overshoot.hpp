// How much later than forecast frames end: the measured margin of the in-frame check.
#pragma once

#include <array>
#include <cstddef>

namespace surefoot::rt {

/// The 95 % quantile of the last 64 differences of a frame's end and the forecast of its last check, in us. Each check forecasts
/// the end of the frame. What a driver does late, or a slice that takes longer than predicted, ends the frame after it.
class Overshoot {
public:
    static constexpr std::size_t window = 64;

    /// Ignores what is not finite.
    void update(double late_us);
    /// Not negative. 0 until frames say otherwise.
    [[nodiscard]] double margin_us() const { return margin_us_; }

private:
    std::array<double, window> late_us_{};
    std::size_t next_ = 0;
    double margin_us_ = 0;
};

}  // namespace surefoot::rt
