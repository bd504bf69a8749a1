// The cost table: fits recover what is known, and timer queries are judged.
#include "render/measure/calibrate.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "render/measure/calibrate_fit.hpp"
#include "render/measure/calibrate_run.hpp"
#include "rt/base/random.hpp"
#include "tests/measure/quick_table.hpp"

namespace surefoot {
namespace {

constexpr model::FrameCombine prior{100, 0.5F, 0.5F, 0.5F};

std::vector<measure::FrameSample> frames_by(const model::FrameCombine& truth, double noise, std::uint64_t seed, int count = 200) {
    Random random(seed);
    std::vector<measure::FrameSample> samples;
    for (int i = 0; i < count; ++i) {
        measure::FrameSample s;
        s.submit_us = 100 * std::exp(4 * random.unit());
        s.raster_us = 100 * std::exp(5 * random.unit());
        const double frame =
            static_cast<double>(truth.frame_us(static_cast<float>(s.submit_us), static_cast<float>(s.raster_us)));
        s.actual_us = frame * (1 + noise * (2 * random.unit() - 1));
        samples.push_back(s);
    }
    return samples;
}

TEST(FrameFit, recovers_known_weights) {
    const model::FrameCombine truth{300, 0.2F, 0.1F, 0.8F};
    const auto fitted = measure::fit_combine(frames_by(truth, 0, 1), prior);
    EXPECT_NEAR(fitted.fixed_us, 300, 6);
    EXPECT_NEAR(fitted.submit_weight, 0.2, 0.02);
    EXPECT_NEAR(fitted.raster_weight, 0.1, 0.02);
    EXPECT_NEAR(fitted.max_weight, 0.8, 0.02);
}

TEST(FrameFit, is_never_negative_and_deaf_to_outliers) {
    const model::FrameCombine truth{300, 0.7F, 0.9F, 0};
    auto samples = frames_by(truth, 0.05, 2);
    for (std::size_t i = 0; i < samples.size(); i += 20) samples[i].actual_us *= 8;  // stolen time
    const auto fitted = measure::fit_combine(samples, prior);
    EXPECT_GE(fitted.max_weight, 0);
    const auto clean = frames_by(truth, 0, 3);
    EXPECT_LT(measure::relative_error(clean, fitted, 0.9), 0.1);
}

TEST(FrameFit, takes_the_prior_where_samples_cannot_tell) {
    std::vector<measure::FrameSample> samples;
    for (int i = 1; i < 100; ++i) {
        const double raster = 50.0 * i;
        samples.push_back({0, raster, 100 + raster});  // max(S, R) is R
    }
    const auto fitted = measure::fit_combine(samples, prior);
    EXPECT_NEAR(fitted.raster_weight, fitted.max_weight, 0.02);
    EXPECT_NEAR(fitted.raster_weight + fitted.max_weight, 1, 0.01);
}

TEST(FrameFit, of_nothing_is_the_prior) {
    const auto fitted = measure::fit_combine({}, prior);
    EXPECT_EQ(fitted.fixed_us, prior.fixed_us);
    EXPECT_EQ(measure::relative_error({}, fitted, 0.5), 0);
}

/// Frames of a machine that charges every pixel. State classes differ: the table's raster time is 200 to 3000 pixels a us.
std::vector<measure::FrameSample> frames_of_pixels(const model::FrameCombine& truth, float ns_per_pixel, double noise) {
    std::vector<measure::FrameSample> samples = frames_by(truth, 0, 8);
    Random random(9);
    for (measure::FrameSample& s : samples) s.pixels = s.raster_us * random.range(200, 3000);
    const std::vector<measure::FrameSample> paid = measure::priced(samples, ns_per_pixel);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const auto us = truth.frame_us(static_cast<float>(paid[i].submit_us), static_cast<float>(paid[i].raster_us));
        samples[i].actual_us = static_cast<double>(us) * (1 + noise * (2 * random.unit() - 1));
    }
    return samples;
}

TEST(FrameFit, prices_pixels_as_worked_out_by_hand) {
    const std::array<measure::FrameSample, 1> frame{measure::FrameSample{3, 100, 50, {}, 20000}};
    const auto priced = measure::priced(frame, 0.5F);
    EXPECT_NEAR(priced[0].raster_us, 100 + 10, 1e-9);
    EXPECT_EQ(priced[0].submit_us, 3);
    EXPECT_EQ(priced[0].actual_us, 50);
    EXPECT_EQ(measure::priced(frame, 0)[0].raster_us, 100);
}

TEST(FrameFit, finds_the_price_of_a_pixel) {
    const model::FrameCombine truth{300, 0.7F, 2, 0};
    for (const float ns : {0.3F, 1.0F, 2.0F}) {
        const auto samples = frames_of_pixels(truth, ns, 0.05);
        const measure::FrameFit fit = measure::fit_frames(samples, prior);
        EXPECT_NEAR(fit.ns_per_pixel, ns, 0.51F * ns);
        EXPECT_LT(measure::relative_error(measure::priced(samples, fit.ns_per_pixel), fit.combine, 0.9), 0.08);
        EXPECT_GT(measure::relative_error(samples, measure::fit_combine(samples, prior), 0.9), 0.1)
            << "the table alone would have done";
    }
}

TEST(FrameFit, keeps_the_table_where_it_is_the_machine) {
    const model::FrameCombine truth{300, 0.7F, 0.9F, 0};
    for (const double noise : {0.0, 0.1}) {
        const measure::FrameFit fit = measure::fit_frames(frames_of_pixels(truth, 0, noise), prior);
        EXPECT_EQ(fit.ns_per_pixel, 0);
        EXPECT_NEAR(fit.combine.raster_weight, 0.9, 0.1);
    }
    EXPECT_EQ(measure::fit_frames({}, prior).combine.fixed_us, prior.fixed_us);
    EXPECT_EQ(measure::fit_frames({}, prior).ns_per_pixel, 0);
}

std::vector<measure::FrameSample> times(std::initializer_list<double> us, double raster_us = 7) {
    std::vector<measure::FrameSample> rounds;
    for (const double time : us) rounds.push_back({3, raster_us, time});
    return rounds;
}

TEST(FrameFit, settles_on_the_least_at_the_median_speed) {
    const std::vector<std::vector<measure::FrameSample>> rounds = {times({150, 100, 120, 126}), times({200, 260, 900}),
                                                                   times({50, 52}), times({10})};
    const measure::FrameTimes frame_times = measure::robust_frame_times(rounds);
    EXPECT_NEAR(frame_times.slowdown, 1.23, 1e-9);  // of (120 + 126) / 2 / 100, 260 / 200 and 51 / 50
    EXPECT_EQ(frame_times.repeated, 3U);
    ASSERT_EQ(frame_times.frames.size(), 4U);
    for (const std::size_t i : {0, 1, 2, 3})
        EXPECT_NEAR(frame_times.frames[i].actual_us, 1.23 * (std::array{100.0, 200.0, 50.0, 10.0})[i], 1e-9);
    EXPECT_EQ(frame_times.frames[0].raster_us, 7);
    EXPECT_EQ(measure::robust_frame_times({}).slowdown, 1.0);
}

TEST(FrameFit, settles_by_what_was_drawn_as_in_the_last_round) {
    std::vector<measure::FrameSample> rounds = times({40}, 5);  // something else
    for (const auto& sample : times({100, 110})) rounds.push_back(sample);
    const std::vector<std::vector<measure::FrameSample>> frames = {rounds};
    const measure::FrameTimes frame_times = measure::robust_frame_times(frames);
    EXPECT_EQ(frame_times.frames[0].raster_us, 7);
    EXPECT_NEAR(frame_times.frames[0].actual_us, 105, 1e-9);
}

// A machine that runs at two speeds, in turns of some frames: what one round says of a frame is the turn that it fell into.
TEST(FrameFit, of_rounds_is_the_same_whatever_turns_the_machine_takes) {
    const model::FrameCombine truth{300, 0.2F, 0.1F, 0.8F};
    const auto clean = frames_by(truth, 0, 5);
    Random random(6);
    std::vector<std::vector<measure::FrameSample>> rounds(clean.size());
    std::vector<measure::FrameSample> once = clean;
    for (int round = 0; round < 8; ++round) {
        double speed = 1;
        for (std::size_t i = 0; i < clean.size(); ++i) {
            if (random.below(12) == 0) speed = random.below(2) == 0 ? 1.0 : 1.8;
            once[i].actual_us = speed * clean[i].actual_us;
            rounds[i].push_back(once[i]);
        }
    }
    const measure::FrameTimes frame_times = measure::robust_frame_times(rounds);
    EXPECT_GT(frame_times.slowdown, 1.2);
    EXPECT_LT(frame_times.slowdown, 1.8 + 1e-6);
    std::vector<measure::FrameSample> middle = clean;
    for (measure::FrameSample& sample : middle) sample.actual_us *= frame_times.slowdown;
    EXPECT_LT(measure::relative_error(middle, measure::fit_combine(frame_times.frames, prior), 0.9), 0.02);
    EXPECT_GT(measure::relative_error(once, measure::fit_combine(once, prior), 0.9), 0.2) << "one round would have done";
}

TEST(EnlargeTime, is_the_median_of_what_the_pairs_differ_by) {
    const std::vector<measure::EmptyPair> pairs{{1000, 1300}, {500, 700}, {400, 9000}};  // one was disturbed
    EXPECT_FLOAT_EQ(measure::enlarge_ns_of(pairs, {1000, 200}).value(), 1.5F);           // 300 us of 200 000 pixels
}

TEST(EnlargeTime, is_never_free_and_never_without_end) {
    const std::vector<measure::EmptyPair> faster{{500, 400}}, stuck{{0, 1e9}};
    EXPECT_FLOAT_EQ(measure::enlarge_ns_of(faster, {1000, 200}).value(), 0.01F);
    EXPECT_FLOAT_EQ(measure::enlarge_ns_of(stuck, {1000, 200}).value(), 100);
}

/// Frames of 1000 x 200 pixels: a picture of 2 us and 3 ns a pixel, a new one of 40 us and 0.5 ns a texel.
measure::PictureTimes times_of_pictures() {
    using Times = measure::PictureTimes;
    const double many = 2.0 * Times::count, wide = 2.0 * Times::wide + 3e-3 * Times::fills * 200'000;
    const auto captures = [](double texels) { return Times::captures * (40 + 0.5e-3 * texels * texels); };
    const double small = captures(Times::small_texels), large = captures(Times::large_texels);
    return {{many, 9 * many, many}, {wide, wide, 0}, {small, small, 1e6}, {large, large, 1e6}};  // some were disturbed
}

TEST(PicturePrices, are_those_of_the_usual_frame) {
    model::CostModel costs;
    ASSERT_TRUE(measure::price_pictures(times_of_pictures(), {1000, 200}, costs));
    EXPECT_TRUE(costs.pictures_measured);
    EXPECT_FLOAT_EQ(costs.picture_us, 2);
    EXPECT_FLOAT_EQ(costs.picture_ns_per_pixel, 3);
    EXPECT_FLOAT_EQ(costs.capture_us, 40);
    EXPECT_FLOAT_EQ(costs.capture_ns_per_texel, 0.5F);
}

TEST(PicturePrices, are_never_free_and_need_times) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    model::CostModel costs;
    EXPECT_FALSE(measure::price_pictures({{-1}, {-64}, {-1}, {-2}}, {1000, 200}, costs)) << "nothing was drawn";
    EXPECT_FALSE(costs.pictures_measured);
    ASSERT_TRUE(measure::price_pictures({{-1}, {900}, {20}, {10}}, {1000, 200}, costs));
    for (const float price : {costs.picture_us, costs.picture_ns_per_pixel, costs.capture_us, costs.capture_ns_per_texel})
        EXPECT_GT(price, 0);
    const measure::PictureTimes good = times_of_pictures();
    for (auto times : {&measure::PictureTimes::many_us, &measure::PictureTimes::wide_us, &measure::PictureTimes::small_us,
                       &measure::PictureTimes::large_us}) {
        for (const std::vector<double>& bad : {std::vector<double>{}, std::vector<double>{1, nan, 1}}) {
            measure::PictureTimes without = good;
            without.*times = bad;
            model::CostModel unchanged;
            EXPECT_FALSE(measure::price_pictures(without, {1000, 200}, unchanged));
            EXPECT_FALSE(unchanged.pictures_measured);
            EXPECT_EQ(unchanged.capture_us, model::CostModel{}.capture_us);
        }
    }
}

TEST(DearerFactor, is_the_median_of_the_pairs_and_at_least_one) {
    const std::vector<measure::WorkPair> pairs{{100, 250}, {1000, 2000}, {10, 500}};  // the last was disturbed
    EXPECT_FLOAT_EQ(measure::dearer_factor_of(pairs, 4).value(), 2.5F);
    EXPECT_FLOAT_EQ(measure::dearer_factor_of(pairs, 2).value(), 2);
    EXPECT_FLOAT_EQ(measure::dearer_factor_of(std::vector<measure::WorkPair>{{100, 80}}, 4).value(), 1);
    EXPECT_FALSE(measure::dearer_factor_of({}, 4));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const measure::WorkPair bad : {measure::WorkPair{0, 1}, {-1, 1}, {nan, 1}, {1, nan}})
        EXPECT_FALSE(measure::dearer_factor_of(std::vector<measure::WorkPair>{{1, 2}, bad}, 4));
}

TEST(EnlargeTime, of_nothing_or_of_no_number_is_unknown) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const std::vector<measure::EmptyPair> good{{1, 2}}, no_number{{1, 2}, {nan, 2}, {1, 2}}, endless{{1, infinity}};
    EXPECT_FALSE(measure::enlarge_ns_of({}, {1000, 200}));
    EXPECT_FALSE(measure::enlarge_ns_of(good, {0, 200}));
    EXPECT_FALSE(measure::enlarge_ns_of(no_number, {1000, 200}));
    EXPECT_FALSE(measure::enlarge_ns_of(endless, {1000, 200}));
}

std::vector<measure::CalibrationPoint> affine_points() {
    std::vector<measure::CalibrationPoint> points;
    for (const double t : {6.0, 64.0, 1000.0, 60000.0}) {
        for (const double p : {20.0, 900.0, 30000.0}) {
            const double pixels = p * (1 - 1 / t);  // every mesh covers a little less than its sphere
            points.push_back({0, t, pixels, 2 + 0.05 * t, 1 + 0.003 * pixels + 0.01 * t, 0, 0});
        }
    }
    return points;
}

TEST(GridFill, follows_affine_costs_between_and_beyond_the_points) {
    model::CostModel costs;
    costs.grids.push_back(measure::fill_grid(0, affine_points()));
    for (const float t : {6.0F, 12.0F, 100.0F, 5000.0F, 200000.0F}) {
        for (const float p : {40.0F, 1000.0F, 500000.0F}) {
            const auto cost = costs.item(t, p, costs.grids[0]);
            EXPECT_NEAR(cost.submit_us, 2 + 0.05F * t, 0.04F * (2 + 0.05F * t));
            EXPECT_NEAR(cost.raster_us, 1 + 0.003F * p + 0.01F * t, 0.04F * (1 + 0.003F * p + 0.01F * t));
        }
    }
}

TEST(GridFill, never_makes_more_work_cheaper) {
    auto points = affine_points();
    Random random(4);
    for (auto& p : points) {
        p.submit_us *= random.range(0.5, 1.5);
        p.raster_us *= random.range(0.5, 1.5);
    }
    const auto grid = measure::fill_grid(0, points);
    for (std::uint32_t t = 0; t < grid.triangle_steps; ++t) {
        for (std::uint32_t p = 0; p < grid.pixel_steps; ++p) {
            const auto& c = grid.cells[t * grid.pixel_steps + p];
            ASSERT_TRUE(std::isfinite(c.submit_us) && std::isfinite(c.raster_us) && c.submit_us >= 0 && c.raster_us >= 0);
            if (t > 0) {
                EXPECT_GE(c.raster_us, grid.cells[(t - 1) * grid.pixel_steps + p].raster_us);
            }
        }
    }
}

/// A device whose drawing takes real time and whose timer says what it is told to.
class MockDevice final : public gl::Device {
public:
    explicit MockDevice(double share) : share_(share) {}
    std::string renderer() const override { return "mock"; }
    bool software() const override { return true; }
    Result<void> load(const model::Model&, const gl::ProgramFactory&) override { return {}; }
    std::vector<std::string> program_listing() const override { return {}; }
    std::string program_text(model::EffectMask) const override { return {}; }
    void bind() override {}
    void release() override {}
    using Device::begin_frame;
    void begin_frame(const Pose&, float) override {}
    void draw(std::span<const gl::DrawItem>) override {
        const auto now = [] { return std::chrono::steady_clock::now(); };
        const auto start = now();
        while (now() - start < std::chrono::milliseconds(5)) {
        }
        drawn_ms_ = std::chrono::duration<double, std::milli>(now() - start).count();
    }
    std::uint32_t end_slice() override { return 1; }
    void wait_slices(std::uint32_t) override {}
    void end_items() override {}
    void finish_frame() override {}
    gl::FrameStats stats() const override { return {}; }
    Result<gl::PixelImage> read_pixels() override { return gl::PixelImage{}; }
    bool begin_timer() override { return share_ >= 0; }
    double end_timer_ms() override { return share_ * drawn_ms_; }

private:
    double share_;
    double drawn_ms_ = 0;
};

TEST(TimerQuery, that_reports_almost_nothing_is_called_dishonest) {
    MockDevice liar(0.001);
    liar.draws.plays();
    const auto check = measure::check_timer(liar, Pose{}, {});
    EXPECT_TRUE(check.available);
    EXPECT_FALSE(check.honest);
    EXPECT_GE(check.wall_ms, 5);
}

TEST(TimerQuery, that_is_absent_is_not_trusted) {
    MockDevice none(-1);
    none.draws.plays();
    const auto check = measure::check_timer(none, Pose{}, {});
    EXPECT_FALSE(check.available);
    EXPECT_FALSE(check.honest);
}

TEST(TimerQuery, is_honest_within_a_fifth_of_the_wall) {
    EXPECT_TRUE(measure::judge_timer(true, 9, 10).honest);
    EXPECT_TRUE(measure::judge_timer(true, 11.9, 10).honest);
    EXPECT_FALSE(measure::judge_timer(true, 7.9, 10).honest);
    EXPECT_FALSE(measure::judge_timer(true, 12.1, 10).honest);
    EXPECT_FALSE(measure::judge_timer(true, 0, 0).honest);
}

TEST(FitPrices, recovers_prices_and_never_pays_for_an_effect) {
    using measure::PricePoint;
    const double infinite = std::numeric_limits<double>::infinity();
    const auto prices = measure::fit_prices(std::vector<PricePoint>{
        {model::effect_sun, 4000, 1000, 8, 4000 * 0.001 + 1000 * 0.002},
        {model::effect_fog, 4000, 1000, -3, -5},
        {model::effect_sun, 12, 60'000, 12 * 0.002, 12 * 0.001 + 60'000 * 0.002},
        {model::effect_fog, 12, 60'000, 0.001, 60},
        {model::effect_lamps, 4000, 1000, infinite, 1},
        {model::effect_lamps, 12, 60'000, 0.012, infinite},
        {model::effect_shadow, 4000, 1000, 4, 4},
        {model::effect_shadow, 12, 60'000, 0, -2},
    });
    ASSERT_EQ(prices.size(), 4U);
    EXPECT_EQ(prices[0].effect, model::effect_sun);
    EXPECT_NEAR(prices[0].submit_ns_per_triangle, 2, 1e-3);
    EXPECT_NEAR(prices[0].raster_ns_per_triangle, 1, 1e-3);
    EXPECT_NEAR(prices[0].raster_ns_per_pixel, 2, 1e-3);
    EXPECT_EQ(prices[1].effect, model::effect_fog);
    EXPECT_EQ(prices[1].submit_ns_per_triangle, 0) << "noise below zero";
    EXPECT_EQ(prices[1].raster_ns_per_triangle, 0);
    EXPECT_NEAR(prices[1].raster_ns_per_pixel, 0.769, 1e-3) << "1 by the point of many pixels; the other one counts a little";
    EXPECT_EQ(prices[2].submit_ns_per_triangle, 0) << "no point is a number";
    EXPECT_NEAR(prices[3].raster_ns_per_triangle, 1, 0.05);
    EXPECT_EQ(prices[3].raster_ns_per_pixel, 0) << "of two, the one that would be paid for goes";
    EXPECT_TRUE(measure::fit_prices({}).empty());
}

TEST(Calibrate, measures_a_table_that_predicts_more_for_more) {
    const measure::CalibrateOptions options = measure::test::quick_options();
    const auto probe = gl::open_device(options.device);
    if (!probe) GTEST_SKIP() << probe.error().text();
    const auto& c = measure::test::quick_table();
    ASSERT_TRUE(c.ok()) << c.error().text();
    EXPECT_TRUE(c->costs.calibrated);
    EXPECT_EQ(c->costs.grids.size(), 4U);
    EXPECT_EQ(c->points.size(), 4U * 4U * 6U);
    EXPECT_GE(c->costs.headroom, 1);
    EXPECT_TRUE(c->costs.enlarge_measured);
    EXPECT_GE(c->costs.enlarge_ns_per_pixel, 0.01F);
    EXPECT_LE(c->costs.enlarge_ns_per_pixel, 100);
    EXPECT_FALSE(c->costs.blur_measured) << "blur is of a model";
    gl::DeviceOptions sampled = options.device;
    sampled.samples = 4;
    const auto with_samples = gl::open_device(sampled);
    ASSERT_TRUE(with_samples.ok());
    EXPECT_EQ(c->costs.samples_measured, (*with_samples)->samples() > 1);
    EXPECT_GE(c->costs.sample_share, 0);
    EXPECT_LE(c->costs.sample_share, measure::max_sample_share);
    EXPECT_TRUE(c->costs.trilinear_measured);
    EXPECT_GE(c->costs.trilinear_factor, 1);
    EXPECT_TRUE(std::isfinite(c->frame_error_p99));
    EXPECT_TRUE(c->costs.prices_measured);
    ASSERT_EQ(c->costs.prices.size(), effects::usual_prices().size());
    for (std::size_t i = 0; i < c->costs.prices.size(); ++i) {
        const model::EffectPrice& price = c->costs.prices[i];
        EXPECT_EQ(price.effect, effects::usual_prices()[i].effect);
        EXPECT_LT(price.submit_ns_per_triangle, 1000);
        EXPECT_LT(price.raster_ns_per_pixel, 20);
    }
    const auto& grid = c->costs.grid_for(0);
    const auto less = c->costs.item(10, 100, grid);
    const auto more = c->costs.item(10000, 100000, grid);
    EXPECT_GT(more.submit_us, less.submit_us);
    EXPECT_GT(more.raster_us, less.raster_us);
}

TEST(Calibrate, of_the_null_device_is_refused) {
    measure::CalibrateOptions options;
    options.device.kind = gl::BackendKind::null;
    EXPECT_FALSE(measure::calibrate(options, {}).ok());
}

TEST(Calibrate, stops_when_asked) {
    measure::CalibrateOptions options;
    options.device.viewport = {64, 64};
    std::atomic<bool> stop{true};
    Progress progress;
    progress.stop = &stop;
    if (!gl::open_device(options.device)) GTEST_SKIP() << "no EGL";
    const auto c = measure::calibrate(options, progress);
    ASSERT_FALSE(c.ok());
    EXPECT_NE(c.error().text().find("stopped"), std::string::npos);
}

}  // namespace
}  // namespace surefoot
