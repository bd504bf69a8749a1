// Bounded sums of motion requests.
#include "input/map/merge.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace surefoot::input {

bool bound(MotionRequest& request) {
    bool finite = true;
    for (double* part :
         {&request.forward, &request.side, &request.up, &request.turn, &request.look, &request.speed, &request.zoom}) {
        if (std::isfinite(*part)) {
            *part = std::clamp(*part, -64.0, 64.0);  // no overflow in the squares below
            continue;
        }
        *part = 0;
        finite = false;
    }
    const double walk = std::sqrt(request.forward * request.forward + request.side * request.side + request.up * request.up);
    if (walk > 1) {
        request.forward /= walk;
        request.side /= walk;
        request.up /= walk;
    }
    const double turning = std::sqrt(request.turn * request.turn + request.look * request.look);
    if (turning > 1) {
        request.turn /= turning;
        request.look /= turning;
    }
    request.speed = std::clamp(request.speed, -1.0, 1.0);
    request.zoom = std::clamp(request.zoom, -1.0, 1.0);
    for (double* angle : {&request.turn_by_rad, &request.look_by_rad}) {
        finite = finite && std::isfinite(*angle);
        *angle = std::isfinite(*angle) ? std::clamp(*angle, -std::numbers::pi, std::numbers::pi) : 0;
    }
    return finite;
}

MotionRequest merge(std::span<const MotionRequest> requests) {
    MotionRequest sum;
    for (const MotionRequest& request : requests) {
        sum.forward += request.forward;
        sum.side += request.side;
        sum.up += request.up;
        sum.turn += request.turn;
        sum.look += request.look;
        sum.speed += request.speed;
        sum.zoom += request.zoom;
        sum.turn_by_rad += request.turn_by_rad;
        sum.look_by_rad += request.look_by_rad;
        sum.next_viewpoint |= request.next_viewpoint;
        sum.reset |= request.reset;
        sum.tour |= request.tour;
        sum.pause |= request.pause;
        sum.switched |= request.switched;
    }
    bound(sum);
    return sum;
}

}  // namespace surefoot::input
