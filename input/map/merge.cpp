// Bounded sums of wishes.
#include "input/map/merge.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::input {

bool bound(Wish& wish) {
    bool finite = true;
    for (double* part : {&wish.forward, &wish.side, &wish.up, &wish.turn, &wish.look, &wish.speed}) {
        if (std::isfinite(*part)) {
            *part = std::clamp(*part, -64.0, 64.0);  // no overflow in the squares below
            continue;
        }
        *part = 0;
        finite = false;
    }
    const double walk = std::sqrt(wish.forward * wish.forward + wish.side * wish.side + wish.up * wish.up);
    if (walk > 1) {
        wish.forward /= walk;
        wish.side /= walk;
        wish.up /= walk;
    }
    const double turning = std::sqrt(wish.turn * wish.turn + wish.look * wish.look);
    if (turning > 1) {
        wish.turn /= turning;
        wish.look /= turning;
    }
    wish.speed = std::clamp(wish.speed, -1.0, 1.0);
    return finite;
}

Wish merge(std::span<const Wish> wishes) {
    Wish sum;
    for (const Wish& wish : wishes) {
        sum.forward += wish.forward;
        sum.side += wish.side;
        sum.up += wish.up;
        sum.turn += wish.turn;
        sum.look += wish.look;
        sum.speed += wish.speed;
        sum.next_viewpoint |= wish.next_viewpoint;
        sum.reset |= wish.reset;
        sum.tour |= wish.tour;
        sum.pause |= wish.pause;
    }
    bound(sum);
    return sum;
}

}  // namespace surefoot::input
