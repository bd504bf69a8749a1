// Where the sun stands at an hour, on a day, at a latitude.
// Source: declination after Cooper 1969, altitude and azimuth after Duffie & Beckman 2013, 1.6. Within half a degree.
#pragma once

#include "rt/base/geometry.hpp"

namespace surefoot::model {

/// Solar time: the sun is highest at 12.
struct SunTime {
    double hour = 12;          ///< 0..24
    double day = 172;          ///< of the year, 1..365; 172 is 21 June
    double latitude_deg = 50;  ///< -90..90, north is positive
};

/// Unit, towards the sun. +Y is up, -Z is north, +X is east. y <= 0: it is below the horizon.
dvec3 towards_sun(const SunTime& time);
/// Hours from noon to sunset; 12 where the sun does not set, or does not rise.
double half_day_h(double day, double latitude_deg);

}  // namespace surefoot::model
