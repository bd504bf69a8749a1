// How much of a period a frame may use: the one figure that walks and sweeps share.
#pragma once

namespace surefoot::walk {

/// Share of the period by which a frame is to be done: the limit of the in-frame check, and the budget if none is set. The rest
/// is for what the machine does late.
constexpr double frame_share = 0.88;

}  // namespace surefoot::walk
