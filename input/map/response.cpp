// Play, dead zones, curves and the finding of rest.
#include "input/map/response.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::input {

namespace {

constexpr double tremor_counts = 2.25;    // a hand's and an ADC's two counts, and rounding
constexpr double widest_play = 1.0 / 12;  // of the travel: a coarse control keeps most of its steps
constexpr double min_span = 0.05;         // from dead zone to full: keeps the curve's slope finite
constexpr double rest_window = 0.07;      // of the travel: a rest further off is a hand on the stick
constexpr std::int64_t still_ns = 500'000'000;

/// 0..1 to 0..1 between dead zone and full response.
double by_length(const Response& response, double length) {
    if (length <= response.dead) return 0;
    if (length >= response.full) return 1;
    return curve_at(response.curve, response.strength, (length - response.dead) / (response.full - response.dead));
}

}  // namespace

Response response_for(const Shape& shape, double half_travel_counts) {
    Response response;
    const double counts = std::min(tremor_counts / std::max(half_travel_counts, 0.5), widest_play);
    response.play = std::max(shape.hysteresis, counts);
    // What the counts add to the play, and the rounding of a coarse control, must not take from the room for a centre's drift.
    const double rounding = std::min(0.5 / std::max(half_travel_counts, 0.5), min_span);
    response.dead = std::max(shape.dead_zone, shape.hysteresis) + (response.play - shape.hysteresis) + rounding;
    response.full = std::max(std::min(shape.saturation, 1.0) - response.play, response.dead + min_span);
    response.full = std::min(response.full, 1.0 - response.play);
    response.dead = std::min(response.dead, response.full - min_span / 2);
    response.curve = shape.curve;
    response.strength = shape.strength;
    return response;
}

double curve_at(Curve curve, double strength, double t) {
    switch (curve) {
        case Curve::linear:
            return t;
        case Curve::power:
            return std::pow(t, strength);
        case Curve::expo:
            return t * ((1 - strength) + strength * t * t);
        case Curve::smooth:
            return t * t * (3 - 2 * t);
    }
    return t;
}

double respond(const Response& response, double deflection) {
    return std::copysign(by_length(response, std::abs(deflection)), deflection);
}

dvec2 respond(const Response& response, const dvec2& deflection) {
    const double length = glm::length(deflection);
    const double answer = by_length(response, length);
    return answer > 0 ? deflection * (answer / length) : dvec2(0.0);  // answer > 0: length > dead >= 0
}

double with_play(double held, double deflection, double half_width) {
    return std::clamp(held, deflection - half_width, deflection + half_width);
}

dvec2 with_play(const dvec2& held, const dvec2& deflection, double half_width) {
    const dvec2 apart = held - deflection;
    const double distance = glm::length(apart);
    return distance <= half_width ? held : deflection + apart * (half_width / distance);
}

RestFinder::RestFinder(std::int32_t min, std::int32_t max, Rest rest) : min_(min), max_(max), kind_(rest) {
    nominal_ = rest == Rest::min ? min_ : rest == Rest::max ? max_ : 0.5 * (min_ + max_);
    rest_ = nominal_;
}

double RestFinder::half_travel_counts() const {
    return kind_ == Rest::centre ? std::min(max_ - rest_, rest_ - min_) : max_ - min_;
}

double RestFinder::deflection(std::int32_t value) const {
    const double v = value;
    if (kind_ == Rest::min) return std::clamp((v - rest_) / (max_ - rest_), 0.0, 1.0);
    if (kind_ == Rest::max) return std::clamp((rest_ - v) / (rest_ - min_), 0.0, 1.0);
    return v >= rest_ ? std::min((v - rest_) / (max_ - rest_), 1.0) : std::max((v - rest_) / (rest_ - min_), -1.0);
}

void RestFinder::learn(std::int32_t value, bool active, std::int64_t now_ns) {
    const double v = value, travel = kind_ == Rest::centre ? 0.5 * (max_ - min_) : max_ - min_;
    const double still_counts = std::max(5.0, 0.01 * travel);  // tremor of two counts to either side
    if (active || std::abs(v - nominal_) > rest_window * travel + 1) {
        since_ns_ = -1;
        return;
    }
    if (since_ns_ < 0 || std::max(high_, v) - std::min(low_, v) > still_counts || now_ns < since_ns_) {
        low_ = high_ = v;
        since_ns_ = now_ns;
        return;
    }
    low_ = std::min(low_, v);
    high_ = std::max(high_, v);
    if (now_ns - since_ns_ < still_ns) return;
    const double found = 0.5 * (low_ + high_);
    // A coarse control (three positions) has no room beside its middle.
    if (std::abs(found - nominal_) <= rest_window * travel) rest_ = found;
    since_ns_ = -1;
}

}  // namespace surefoot::input
