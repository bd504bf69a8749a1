// The in-frame check: whether the next slice still fits in full, judged by how wrong it has been so far.
#include <algorithm>
#include <cmath>

#include "render/select/select.hpp"

namespace surefoot::select {

bool still_fits(const CheckInput& input) {
    if (input.next_stand_in_us >= input.next_us) return true;  // the stand-in would gain nothing
    const double rest_us = std::isfinite(input.rest_stand_in_us) ? std::max(input.rest_stand_in_us, 0.0) : 0.0;
    const double time_left = std::clamp(1.0 - input.elapsed_us / input.limit_us, 0.0, 1.0);  // NaN stays one: does not fit
    const double prior_us = 0.05 * input.limit_us + 0.5 * rest_us * time_left;
    const double wrong = (input.elapsed_us + prior_us) / (input.predicted_so_far_us + prior_us);
    const double factor = std::clamp(std::isfinite(wrong) ? wrong : 8.0, 1.0, 8.0);
    return input.elapsed_us + (input.next_us + input.rest_stand_in_us) * factor * input.margin <=
           input.limit_us;  // NaN: does not fit
}

}  // namespace surefoot::select
