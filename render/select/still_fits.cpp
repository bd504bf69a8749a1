// The in-frame check: whether the rest of the frame still fits, judged by how wrong it has been so far.
#include <algorithm>
#include <cmath>

#include "render/select/select.hpp"

namespace surefoot::select {

bool still_fits(const CheckInput& input) {
    if (!(input.rest_us > 0.0)) return true;                   // nothing left
    if (input.rest_stand_in_us >= input.rest_us) return true;  // stand-ins would gain nothing
    const double wrong = input.predicted_so_far_us > 0.0 ? input.elapsed_us / input.predicted_so_far_us : 1.0;
    const double factor = std::clamp(std::isfinite(wrong) ? wrong : 8.0, 1.0, 8.0);
    return input.elapsed_us + input.rest_us * factor * input.margin <= input.limit_us;  // NaN: does not fit
}

}  // namespace surefoot::select
