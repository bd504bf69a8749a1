// Accuracy curves: sums, minima and merged parts against plain evaluation of what they stand for.
#include "render/model/curve.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rt/base/random.hpp"

namespace surefoot::model {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr Resources usual_weights{1, 0.7, 1e-3, 1e-5};

/// A form as plain numbers: what it takes at accuracies up to `to`; below `from`, what it takes there.
struct PlainForm {
    double from, to;
    Resources base, slope;
    [[nodiscard]] Resources at(double accuracy) const {
        const double a = std::isinf(to) ? 0 : std::clamp(accuracy, from, to);
        return {base.submit_us + slope.submit_us * a, base.raster_us + slope.raster_us * a, base.triangles + slope.triangles * a,
                base.texels + slope.texels * a};
    }
    [[nodiscard]] Curve curve() const { return from == to ? Curve::of_form(to, base) : Curve::of_line(from, to, base, slope); }
};

Resources random_amount(Random& random, double most) {
    return {random.range(0, most), random.range(0, most), std::floor(random.range(0, 1000 * most)),
            std::floor(random.range(0, 1e5 * most))};
}

PlainForm random_form(Random& random) {
    const double from = std::exp(random.range(-2, 6));
    if (random.range(0, 1) < 0.6) {
        const double to = random.range(0, 1) < 0.2 ? infinity : from;
        return {to, to, random_amount(random, 100), {}};
    }
    return {from, from * std::exp(random.range(0, 3)), random_amount(random, 50), random_amount(random, 2)};
}

double of_parts(std::span<const CurvePart> parts, double end, double accuracy) {
    const CurvePart* part = &parts[0];
    for (const CurvePart& p : parts)
        if (p.from <= accuracy) part = &p;
    const double a = std::min(std::max(accuracy, parts[0].from), end);
    const auto line = [&](double base, double slope) { return slope == 0 ? base : base + slope * a; };
    return weighed({line(part->base.submit_us, part->slope.submit_us), line(part->base.raster_us, part->slope.raster_us),
                    line(part->base.triangles, part->slope.triangles), line(part->base.texels, part->slope.texels)},
                   usual_weights);
}

/// Accuracies at which something may change, and between them.
std::vector<double> samples(std::initializer_list<std::span<const CurvePart>> curves, std::initializer_list<double> ends) {
    std::vector<double> at;
    for (const auto parts : curves)
        for (const CurvePart& part : parts) at.push_back(part.from);
    for (const double end : ends)
        if (std::isfinite(end)) at.push_back(end);
    std::sort(at.begin(), at.end());
    const std::size_t n = at.size();
    for (std::size_t i = 0; i < n; ++i) {
        at.push_back(std::nextafter(at[i], infinity));
        at.push_back(std::nextafter(at[i], 0.0));
        at.push_back(i + 1 < n ? at[i] + (at[i + 1] - at[i]) / 3 : std::min(at[i], 1e300) * 1.5);
    }
    at.push_back(at[0] / 2);
    return at;
}

void expect_rising(std::span<const CurvePart> parts, double end) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const double to = i + 1 < parts.size() ? parts[i + 1].from : end;
        const double begins =
            weighed(parts[i].base, usual_weights) +
            (weighed(parts[i].slope, usual_weights) != 0 ? weighed(parts[i].slope, usual_weights) * parts[i].from : 0);
        ASSERT_GE(weighed(parts[i].slope, usual_weights), -1e-12 * (1 + begins));
        if (i + 1 == parts.size()) break;
        ASSERT_LT(parts[i].from, to);
        const double before = of_parts(parts.first(i + 1), to, to), now = of_parts(parts, end, to);
        ASSERT_GE(now, before * (1 - 1e-12)) << "a curve falls at " << to;
    }
}

/// Makes one curve of up to `objects` objects with up to six forms each, and compares every step with plain evaluation.
void check_random_curve(std::uint64_t seed, int objects) {
    Random random(seed);
    Curve whole;
    for (int o = 0; o < objects; ++o) {
        Curve object;
        const auto forms = static_cast<int>(random.range(1, 7));
        for (int f = 0; f < forms; ++f) {
            const PlainForm form = random_form(random);
            const Curve one = form.curve();
            ASSERT_TRUE(one.known());
            const CurveParts both = CurveParts::cheaper(object, one, usual_weights);
            const Curve next = both.compacted(usual_weights);
            ASSERT_LE(next.parts().size(), Curve::max_parts);
            for (const double a : samples({object.parts(), one.parts(), both.parts()}, {object.end(), one.end()})) {
                if (a > both.end() || a <= 0) continue;
                double plain = a <= one.end() ? weighed(form.at(a), usual_weights) : infinity;
                if (object.known() && a <= object.end()) plain = std::min(plain, weighed(object.at(a), usual_weights));
                ASSERT_NEAR(of_parts(both.parts(), both.end(), a), plain, 1e-12 * (1 + plain)) << "seed " << seed << " at " << a;
                ASSERT_GE(weighed(next.at(a), usual_weights), plain * (1 - 1e-12)) << "seed " << seed << ": a promise has grown";
            }
            expect_rising(both.parts(), both.end());
            expect_rising(next.parts(), next.end());
            object = next;
        }
        if (o == 0) {
            whole = object;
            continue;
        }
        const CurveParts both = CurveParts::sum(whole, object);
        const Curve next = both.compacted(usual_weights);
        for (const double a : samples({whole.parts(), object.parts()}, {whole.end(), object.end()})) {
            if (a <= 0) continue;
            const double plain = weighed(whole.at(a), usual_weights) + weighed(object.at(a), usual_weights);
            ASSERT_NEAR(of_parts(both.parts(), both.end(), a), plain, 1e-12 * (1 + plain)) << "seed " << seed << " at " << a;
            ASSERT_GE(weighed(next.at(a), usual_weights), plain * (1 - 1e-12)) << "seed " << seed << ": a promise has grown";
        }
        expect_rising(next.parts(), next.end());
        whole = next;
    }
}

/// Each makes 17 curves in the mean.
void check_random_curves(std::uint64_t first, std::uint64_t count) {
    for (std::uint64_t seed = first; seed < first + count && !testing::Test::HasFatalFailure(); ++seed)
        check_random_curve(seed, 4);
}

TEST(Curve, SumsAndMinimaEqualPlainEvaluation) { check_random_curves(1, 2000); }
TEST(Nightly, AMillionCurvesEqualPlainEvaluation) { check_random_curves(100'000, 60'000); }

TEST(Curve, ADiscreteFormServesUpToItsAccuracyAndIncludesIt) {
    const Curve coarse = Curve::of_form(10, {1, 0, 0, 0}), fine = Curve::of_form(50, {4, 0, 0, 0});
    const Curve exact = Curve::of_form(infinity, {9, 0, 0, 0});
    const Curve object = cheaper_of(cheaper_of(fine, exact, usual_weights), coarse, usual_weights);
    for (const auto& [accuracy, takes] :
         {std::pair{0.1, 1.0}, {10.0, 1.0}, {std::nextafter(10.0, 11.0), 4.0}, {50.0, 4.0}, {51.0, 9.0}, {1e300, 9.0}})
        EXPECT_EQ(object.at(accuracy).submit_us, takes) << accuracy;
    EXPECT_TRUE(std::isinf(object.end()));
    EXPECT_EQ(object.parts().size(), 3U);
    const Curve group = sum_of(object, coarse, usual_weights);
    EXPECT_EQ(group.at(60).submit_us, 10) << "above its end a child shows its best";
    EXPECT_EQ(group.at(5).submit_us, 2);
}

TEST(Curve, AFinerFormThatTakesLessReplacesTheCoarse) {
    const Curve object = cheaper_of(Curve::of_form(10, {5, 0, 0, 0}), Curve::of_form(20, {3, 0, 0, 0}), usual_weights);
    EXPECT_EQ(object.parts().size(), 1U);
    EXPECT_EQ(object.at(1).submit_us, 3);
}

TEST(Curve, LinesCrossWhereTheyTakeTheSame) {
    const Curve steep = Curve::of_line(1, 100, {0, 0, 0, 0}, {1, 0, 0, 0}),
                flat = Curve::of_line(1, 100, {30, 0, 0, 0}, {0.25, 0, 0, 0});
    const Curve both = cheaper_of(steep, flat, usual_weights);
    ASSERT_EQ(both.parts().size(), 2U);
    EXPECT_DOUBLE_EQ(both.parts()[1].from, 40);
    EXPECT_DOUBLE_EQ(both.at(80).submit_us, 50);
    EXPECT_DOUBLE_EQ(both.scaled(0.5).at(40).submit_us, 50) << "the same at half the accuracy";
}

TEST(Curve, ALongStaircaseStaysNearWhatItTakes) {
    Curve curve;
    for (int level = 0; level < 80; ++level) {  // a twentieth more each: about a line
        const double takes = std::floor(12 * std::pow(1.05, level));
        curve = cheaper_of(curve, Curve::of_form(0.34 * takes + 3, {0, 0, takes, 0}), {0, 0, 1, 0});
    }
    EXPECT_EQ(curve.parts().size(), Curve::max_parts);
    double most = 1;
    for (int level = 0; level < 80; ++level) {
        const double takes = std::floor(12 * std::pow(1.05, level));
        most = std::max(most, curve.at(0.34 * takes + 3).triangles / takes);
    }
    EXPECT_LT(most, 1.35);
    std::vector<CurvePoint> forms;
    for (int level = 80; level-- > 0;) {
        const double takes = std::floor(12 * std::pow(1.05, level));
        forms.push_back({0.34 * takes + 3, {0, 0, takes, 0}});
        forms.push_back({0.3 * takes, {0, 0, 1.5 * takes, 0}});  // never the cheaper one
    }
    const Curve at_once = curve_of_forms(forms, {0, 0, 1, 0});
    EXPECT_EQ(at_once.parts().size(), Curve::max_parts);
    double max_at_once = 1;
    for (std::size_t i = 0; i < forms.size(); i += 2) {
        const double takes = forms[i].takes.triangles;
        max_at_once = std::max(max_at_once, at_once.at(forms[i].accuracy).triangles / takes);
        EXPECT_GE(at_once.at(forms[i].accuracy).triangles, takes * (1 - 1e-12));
    }
    EXPECT_LT(max_at_once, 1.1) << "of " << most << " one by one";
}

TEST(Curve, ResourcesThatFallAsOthersRiseStillMerge) {
    Curve curve = Curve::of_line(1000, 4000, {2000, 0, 0, 0}, {1, 0, 0, 0});
    for (int level = 30; level-- > 0;) {  // by turns submit and raster time; their sum hardly rises
        const double takes = 1000 + level;
        const Resources form = level % 2 == 0 ? Resources{takes, 0, 0, 0} : Resources{0, takes, 0, 0};
        const Curve next = cheaper_of(curve, Curve::of_form(10 + level, form), {1, 1, 0, 0});
        for (int below = 0; below < 30; ++below)
            EXPECT_GE(weighed(next.at(10 + below), {1, 1, 0, 0}), (below >= level ? 1000 + below : 1000 + level) * (1 - 1e-12));
        EXPECT_GE(next.at(2000).submit_us, 4000 * (1 - 1e-12));
        curve = next;
    }
}

TEST(Curve, FormsThatTakeNothingMergeToo) {
    Curve curve;
    for (int level = 0; level < 40; ++level) {  // nothing by the weights, but for the last ones
        const double takes = level < 36 ? 0 : 1e6 * level;
        curve = cheaper_of(curve, Curve::of_form(10 + level, {takes, 0, static_cast<double>(level), 0}), {1, 0, 0, 0});
        curve = sum_of(curve, Curve::of_form(3.5 + level, {0, 0, 1, 0}), {1, 0, 0, 0});
    }
    EXPECT_LE(curve.parts().size(), Curve::max_parts);
    EXPECT_GE(curve.at(49).submit_us, 39e6 * (1 - 1e-12));
}

TEST(Curve, OfManyFormsIsTheCheapestOfThem) {
    Random random(31);
    for (int run = 0; run < 300; ++run) {
        std::vector<CurvePoint> forms;
        const int count = run < 200 ? 14 : 250;
        for (int i = 0; i < count; ++i)
            forms.push_back({random.range(0, 1) < 0.1 ? infinity : std::exp(random.range(-2, 8)), random_amount(random, 100)});
        if (run % 7 == 0) forms.push_back({std::nan(""), {}});
        const Curve curve = curve_of_forms(forms, usual_weights);
        for (int i = 0; i < 60; ++i) {
            const double accuracy = i < count ? forms[static_cast<std::size_t>(i)].accuracy : std::exp(random.range(-3, 9));
            double least = infinity;
            for (const CurvePoint& form : forms)
                if (form.accuracy >= accuracy) least = std::min(least, weighed(form.takes, usual_weights));
            if (std::isinf(least)) continue;
            const double takes = weighed(curve.at(accuracy), usual_weights);
            if (count < 20) {
                ASSERT_NEAR(takes, least, 1e-12 * least) << "run " << run << " at " << accuracy;
            } else {
                ASSERT_GE(takes, least * (1 - 1e-12)) << "run " << run << " at " << accuracy;
            }
        }
    }
    EXPECT_FALSE(curve_of_forms({}, usual_weights).known());
}

TEST(Curve, SaysWhichAccuracyARoomBuys) {
    const Curve line = Curve::of_line(10, 100, {0, 20, 0, 0}, {1, 0, 0, 0});
    const Curve exact = cheaper_of(line, Curve::of_form(infinity, {300, 20, 0, 0}), {1, 1, 0, 0});
    EXPECT_EQ(accuracy_within(exact, {1, 0, 0, 0}, {0, 1, 0, 0}, 5), 0);
    EXPECT_EQ(accuracy_within(exact, {1, 0, 0, 0}, {0, 1, 0, 0}, 15), 0) << "the other sum takes 20";
    EXPECT_DOUBLE_EQ(accuracy_within(exact, {1, 0, 0, 0}, {0, 1, 0, 0}, 40), 40);
    EXPECT_DOUBLE_EQ(accuracy_within(exact, {1, 0, 0, 0}, {0, 1, 0, 0}, 200), 100);
    EXPECT_TRUE(std::isinf(accuracy_within(exact, {1, 0, 0, 0}, {0, 1, 0, 0}, 300)));
    EXPECT_EQ(accuracy_within({}, {1, 0, 0, 0}, {0, 1, 0, 0}, 1e9), 0);
}

TEST(Curve, IsUnknownWhereAFigureIsNone) {
    const double nan = std::nan("");
    EXPECT_FALSE(Curve::of_form(0, {1, 1, 1, 1}).known());
    EXPECT_FALSE(Curve::of_form(nan, {1, 1, 1, 1}).known());
    EXPECT_FALSE(Curve::of_form(5, {nan, 1, 1, 1}).known());
    EXPECT_FALSE(Curve::of_form(5, {-1, 1, 1, 1}).known());
    EXPECT_FALSE(Curve::of_line(5, 4, {}, {}).known());
    EXPECT_FALSE(Curve::of_line(5, infinity, {}, {1, 0, 0, 0}).known());
    const Curve known = Curve::of_form(5, {});
    EXPECT_TRUE(known.known()) << "a form may take nothing";
    EXPECT_FALSE(sum_of(known, {}, usual_weights).known());
    EXPECT_TRUE(cheaper_of({}, known, usual_weights).known());
    EXPECT_FALSE(cheaper_of({}, {}, usual_weights).known());
    EXPECT_EQ(Curve().at(3).submit_us, 0);
    const Curve equal = cheaper_of(known, known, usual_weights);
    EXPECT_EQ(equal.parts().size(), 1U);
}

TEST(Curve, ALineIsFittedByLeastSquares) {
    const std::vector<double> accuracy{1, 2, 3, 4, infinity}, line{5, 7, 9, 11, 99}, curved{1, 0, 0, 1, 99};
    const FittedLine fit = fit_line(accuracy, line);
    EXPECT_DOUBLE_EQ(fit.slope, 2);
    EXPECT_DOUBLE_EQ(fit.base, 3);
    EXPECT_DOUBLE_EQ(fit.r_squared, 1);
    EXPECT_NEAR(fit_line(accuracy, curved).r_squared, 0, 1e-12);
    EXPECT_EQ(fit_line({}, {}).slope, 0);
}

}  // namespace
}  // namespace surefoot::model
