// The sun's direction from its declination and its hour angle.
#include "render/model/sun_time.hpp"

#include <cmath>
#include <numbers>

namespace surefoot::model {

namespace {

constexpr double radian_deg = 180 / std::numbers::pi;

double declination_of(double day) { return 23.45 / radian_deg * std::sin(2 * std::numbers::pi * (284 + day) / 365); }

}  // namespace

dvec3 towards_sun(const SunTime& time) {
    constexpr double degree = std::numbers::pi / 180;
    const double declination = declination_of(time.day);
    const double hour_angle = 15 * degree * (time.hour - 12), latitude = time.latitude_deg * degree;
    const double to_equator = std::cos(declination) * std::cos(hour_angle);  // in the meridian's plane, across the axis
    const double up = std::sin(latitude) * std::sin(declination) + std::cos(latitude) * to_equator;
    const double south = std::sin(latitude) * to_equator - std::cos(latitude) * std::sin(declination);
    const double west = std::cos(declination) * std::sin(hour_angle);
    return glm::normalize(dvec3(-west, up, south));
}

double half_day_h(double day, double latitude_deg) {
    const double cosine = -std::tan(latitude_deg / radian_deg) * std::tan(declination_of(day));
    return std::abs(cosine) < 1 ? std::acos(cosine) * radian_deg / 15 : 12.0;
}

}  // namespace surefoot::model
