// From deflection to response: hysteresis against tremor, dead zones, curves. Pure functions. All values are fractions of the
// travel from rest to an end: -1..1, or 0..1 if rest is at an end.
//
//   raw ─► normalised by the rest ─► play (hysteresis) ─► dead zone, saturation ─► curve ─► -1..1
//
// Hysteresis is play (backlash), as in a worn gear: the held value follows the deflection only when they differ by more than the
// band. So noise within the band moves nothing, anywhere in the travel. The response stays continuous; two thresholds at the edge
// of the dead zone would step there.
#pragma once

#include <cstdint>

#include "rt/base/geometry.hpp"

namespace surefoot::input {

enum class Curve : std::uint8_t {
    linear,  ///< t
    power,   ///< t^strength, strength 1..4
    expo,    ///< (1 - strength) t + strength t^3, strength 0..1: fine near rest
    smooth,  ///< t^2 (3 - 2 t): gentle at both ends
};

/// Settings of the user for one axis or stick.
struct Shape {
    double dead_zone =
        0.1;  ///< 0..0.9; wider than a centre that is off by 3 % of the whole range (6 % of the travel) plus the play
    double hysteresis =
        0.02;  ///< half width of the play; 0..0.3, at most the dead zone. Raised to 2.25 counts where those are more
    double saturation = 0.95;  ///< deflection of the full response: few sticks reach the end of their declared range
    Curve curve = Curve::expo;
    double strength = 0.6;
    double smoothing_s = 0;  ///< time constant of a first-order low pass on the response, and so its lag; 0..1
};

/// A Shape made consistent for one control.
struct Response {
    double play = 0;  ///< half width
    double dead = 0;  ///< >= play, so that a release always ends inside
    double full = 1;  ///< response 1 from here on; reached for any deflection >= full + play
    Curve curve = Curve::linear;
    double strength = 0;
};

/// `half_travel_counts`: counts from rest to the nearer end, >= 0.5. The play is at least 2.25 counts: tremor of two counts plus
/// rounding. It is at most a twelfth of the travel, so less for coarse controls.
Response response_for(const Shape& shape, double half_travel_counts);

/// t in 0..1 to 0..1; monotone, 0 at 0, 1 at 1.
double curve_at(Curve curve, double strength, double t);
/// -1..1 to -1..1 without play: odd, monotone, continuous, exactly 0 up to the dead zone and exactly 1 from `full` on.
double respond(const Response& response, double deflection);
/// The same by length, for a stick pair: the direction is kept, so every direction responds alike. Length <= 1.
dvec2 respond(const Response& response, const dvec2& deflection);

/// The new held value after a change of the deflection.
double with_play(double held, double deflection, double half_width);
dvec2 with_play(const dvec2& held, const dvec2& deflection, double half_width);

enum class Rest : std::uint8_t { centre, min, max };  ///< where the control stands when nobody touches it

/// Learns where a control really rests: the middle of values that were stable for half a second. The values must lie inside the
/// dead zone, and within 7 % of the travel from the nominal rest. So a new rest never shows in the response.
class RestFinder {
public:
    RestFinder() = default;
    /// min < max, in counts.
    RestFinder(std::int32_t min, std::int32_t max, Rest rest);

    /// Deflection of a raw value, clamped: -1..1, or 0..1 where rest is at an end. 0 at the rest, exactly 1 at the ends.
    [[nodiscard]] double deflection(std::int32_t value) const;
    void learn(std::int32_t value, bool active, std::int64_t now_ns);
    [[nodiscard]] double half_travel_counts() const;

private:
    double min_ = -1, max_ = 1, nominal_ = 0, rest_ = 0;
    Rest kind_ = Rest::centre;
    double low_ = 0, high_ = 0;  ///< of the still values so far
    std::int64_t since_ns_ = -1;
};

}  // namespace surefoot::input
