// Responses: every curve swept over 65,536 points, dead zones in all directions, play against noise, rests found.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "input/map/response.hpp"
#include "rt/base/random.hpp"
#include "tests/input/stick_fixture.hpp"

namespace surefoot::input {
namespace {

struct Case {
    Curve curve;
    double strength;
};
const std::vector<Case> curves = {{Curve::linear, 0}, {Curve::power, 1},  {Curve::power, 2},  {Curve::power, 4},
                                  {Curve::expo, 0},   {Curve::expo, 0.6}, {Curve::expo, 1.0}, {Curve::smooth, 0.5}};

TEST(Response, EveryCurveIsMonotoneOddContinuousAndExactAtBothEnds) {
    for (const Case& c : curves)
        for (const double dead : {0.02, 0.1, 0.3, 0.6}) {
            Shape shape;
            shape.curve = c.curve;
            shape.strength = c.strength;
            shape.dead_zone = dead;
            const Response r = response_for(shape, 127.5);
            const double steepest = 4.0 / (r.full - r.dead);  // no curve here is steeper than 4
            double before = -1.0;
            for (int i = 0; i < 65'536; ++i) {
                const double n = -1.0 + 2.0 * i / 65'535.0, out = respond(r, n);
                ASSERT_GE(out, before) << n;
                ASSERT_LE(out - before, i == 0 ? 0.0 : steepest * 2.0 / 65'535.0 + 1e-12) << "a step at " << n;
                ASSERT_EQ(out, -respond(r, -n)) << n;
                ASSERT_TRUE(std::abs(n) > r.dead || out == 0.0) << n;
                before = out;
            }
            EXPECT_EQ(respond(r, 1.0), 1.0);
            EXPECT_EQ(respond(r, -1.0), -1.0);
        }
}

TEST(Response, EveryRawValueOfEveryRestReachesItsPlace) {
    struct Device {
        const char* name;
        int min, max, rest;
    };
    for (const Device& d : {Device{"gravis", 0, 255, 127}, Device{"dualshock3", 0, 255, 128}, Device{"t16000m", 0, 16383, 8192},
                            Device{"puck", -350, 350, 0}, Device{"16 bit", -32768, 32767, 0}, Device{"three places", -1, 1, 0},
                            Device{"6 bit", 0, 63, 32}})
        for (const double drift : {-0.03, 0.0, 0.03})
            for (const bool learned : {false, true}) {
                const int travel = (d.max - d.min) / 2;
                const int rest = d.rest + static_cast<int>(drift * (d.max - d.min));
                RestFinder finder(d.min, d.max, Rest::centre);
                const Response r = response_for(Shape{}, finder.half_travel_counts());
                double held = 0;
                for (int i = 0; learned && i < 1200; ++i) finder.learn(rest, false, i * 1'000'000LL);
                const auto at = [&](int raw) { return respond(r, held = with_play(held, finder.deflection(raw), r.play)); };
                const std::string text = std::string(d.name) + " drift " + std::to_string(drift) + (learned ? " learned" : "");
                EXPECT_EQ(at(rest), 0.0) << text;
                EXPECT_GE(at(d.max), 0.995) << text;
                EXPECT_EQ(at(rest), 0.0) << text;
                EXPECT_LE(at(d.min), -0.995) << text;
                EXPECT_EQ(at(rest), 0.0) << text;
                // Every value on the way, upwards: monotone.
                double before = -1;
                for (int raw = d.min; raw <= d.max; raw += std::max(1, travel / 8192)) {
                    const double out = at(raw);
                    ASSERT_GE(out, before) << text << " at " << raw;
                    before = out;
                }
            }
}

/// Largest departure from the mean response over all directions, relative.
double unevenness(const Shape& shape, int counts, double reach) {
    const double half = counts / 2.0;
    const Response r = response_for(shape, half);
    RestFinder finder(0, counts, Rest::centre);
    double least = 2, most = 0, sum = 0;
    for (int degree = 0; degree < 360; ++degree) {
        dvec2 held{0.0};
        const double angle = degree * 0.017453292519943295;
        for (int i = 1; i <= 200; ++i) {  // pushed out from rest
            const double m = half * reach * i / 200;
            const dvec2 n{finder.deflection(static_cast<int>(std::lround(half + m * std::cos(angle)))),
                          finder.deflection(static_cast<int>(std::lround(half + m * std::sin(angle))))};
            held = with_play(held, n, r.play);
        }
        const double out = glm::length(respond(r, held));
        least = std::min(least, out);
        most = std::max(most, out);
        sum += out / 360;
    }
    return std::max(most - sum, sum - least) / sum;
}

TEST(Response, ARadialDeadZoneIsEqualInAllDirections) {
    Shape linear;
    linear.curve = Curve::linear;
    for (const double reach : {0.5, 0.7, 0.9, 1.0}) {
        EXPECT_LE(unevenness(Shape{}, 65535, reach), 0.001) << reach;
        // Eight bits: what is left is the rounding of the counts themselves.
        EXPECT_LE(unevenness(linear, 255, reach), 0.02) << reach;
        EXPECT_TRUE(reach <= 0.5 || unevenness(Shape{}, 255, reach) <= 0.02) << reach;
    }
    const Response r = response_for(Shape{}, 127.5);
    EXPECT_LE(glm::length(respond(r, dvec2(1.0, 1.0))), 1.0 + 1e-15) << "a square gate is no faster in its corners";
}

TEST(Response, NoiseWithinNineTenthsOfTheBandNeverToggles) {
    Random random(5);
    Shape shape;
    const Response r = response_for(shape, 32768);
    for (int k = 0; k < 400; ++k) {
        const double hold = k < 200 ? r.dead + random.range(-2, 2) * r.play : random.range(-1, 1);
        double held = 0;
        bool on = false;
        int toggles = 0, changes = 0;
        double before = 0;
        for (int i = 0; i < 5000; ++i) {
            const double noise = 0.9 * r.play * (random.below(4) == 0 ? (random.below(2) == 0 ? 1 : -1) : random.range(-1, 1));
            held = with_play(held, hold + noise, r.play);
            const double out = respond(r, held);
            if (i > 200 && out != before) ++changes;  // the first noise may still push the play to its place
            toggles += (out != 0) != on ? 1 : 0;
            on = out != 0;
            before = out;
        }
        EXPECT_LE(toggles, 1) << "on once at most, never off again";
        EXPECT_EQ(changes, 0) << hold;
    }
}

TEST(Response, RestIsLearnedOnlyFromStillnessNearWhereItShouldBe) {
    RestFinder f(0, 255, Rest::centre);
    for (int i = 0; i < 1000; ++i) f.learn(131, false, i * 1'000'000LL);
    EXPECT_EQ(f.deflection(131), 0.0);
    for (int i = 1000; i < 9000; ++i) f.learn(170, false, i * 1'000'000LL);
    EXPECT_EQ(f.deflection(131), 0.0) << "a hand on the stick is no rest";
    for (int i = 9000; i < 19000; ++i) f.learn(125, true, i * 1'000'000LL);
    EXPECT_EQ(f.deflection(131), 0.0) << "not while it steers";
    for (int i = 19000; i < 19400; ++i) f.learn(125, false, i * 1'000'000LL);
    EXPECT_EQ(f.deflection(131), 0.0) << "not so soon";
    EXPECT_EQ(f.deflection(255), 1.0);
    EXPECT_EQ(f.deflection(0), -1.0);
    RestFinder pedal(0, 1023, Rest::max);
    EXPECT_EQ(pedal.deflection(1023), 0.0);
    EXPECT_EQ(pedal.deflection(0), 1.0);
}

}  // namespace
}  // namespace surefoot::input
