// One quick calibration for all tests that read its table: it takes more than ten seconds.
#pragma once

#include "render/measure/calibrate.hpp"

namespace surefoot::measure::test {

constexpr model::Viewport quick_view{320, 180};

inline CalibrateOptions quick_options() {
    CalibrateOptions options;
    options.quick = true;
    options.device.viewport = quick_view;
    return options;
}

/// Calibrates at the first call; the same table after that. One thread.
inline const Result<Calibration>& quick_table() {
    static const Result<Calibration> table = calibrate(quick_options(), {});
    return table;
}

}  // namespace surefoot::measure::test
