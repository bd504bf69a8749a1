// The rehearsal before a walk: what frames cost is known from the first frame on. The null backend takes a part of what is
// predicted.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>

#include "render/model/cost.hpp"
#include "rt/base/progress.hpp"
#include "rt/clock/clock.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

using test::walk;

float first_correction(rt::ClockKind clock, bool correct_costs) {
    walk::WalkRequest request = test::Forest::get().virtual_request(3);
    request.clock = clock;
    request.fifo = false;
    request.rate_hz = 60;
    request.in_frame_check = false;
    request.correct_costs = correct_costs;
    const walk::WalkOutcome outcome = walk(request);
    EXPECT_EQ(outcome.records.size(), 3U);
    return outcome.records.empty() ? 0 : outcome.records.front().correction;
}

TEST(Rehearsal, TheFirstFrameKnowsWhatFramesCost) {
    const float correction = first_correction(rt::ClockKind::real, true);
    EXPECT_GT(correction, 0.0F);
    EXPECT_LT(correction, 0.9F) << "three frames alone would leave it at 1";
}

/// Of the first frame, by a table whose pixels are so dear that a softer picture would win.
float first_resolution(bool correct_costs) {
    walk::WalkRequest request = test::Forest::get().virtual_request(3);
    request.clock = rt::ClockKind::real;
    request.fifo = false;
    request.rate_hz = 15;  // a slow host's frame takes a small part of a long period too
    request.correct_costs = correct_costs;
    auto costs = std::make_shared<model::CostModel>(model::default_costs());
    costs->combine.submit_weight *= 0.4F;
    costs->combine.raster_weight *= 28.0F;
    request.given_costs = costs;
    const walk::WalkOutcome outcome = walk(request);
    EXPECT_EQ(outcome.records.size(), 3U);
    return outcome.records.empty() ? 0 : outcome.records.front().resolution;
}

TEST(Rehearsal, TheFirstFrameHasTheResolutionThatItsTimeAllows) {
    EXPECT_LT(first_resolution(false), 1);
    EXPECT_EQ(first_resolution(true), 1) << "frames take a small part of what the table says";
}

TEST(Rehearsal, AStopEndsItAtOnce) {
    walk::WalkRequest request = test::Forest::get().virtual_request(3);
    request.clock = rt::ClockKind::real;
    request.fifo = false;
    request.rate_hz = 10;  // else it would take a second and a half
    std::atomic<bool> stop{false};
    std::chrono::steady_clock::time_point started;
    walk::WalkObserver observer;
    observer.on_started = [&](const walk::WalkStart& /*start*/) {
        started = std::chrono::steady_clock::now();
        stop.store(true);
    };
    Progress progress;
    progress.stop = &stop;
    const auto outcome = walk::run_walk(request, progress, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::milliseconds(900));
    EXPECT_TRUE(outcome->stopped);
    EXPECT_TRUE(outcome->records.empty());
}

// At 10 Hz a rehearsal takes 1.2 s. A busy machine only makes what is left until the first slot shorter.
TEST(Rehearsal, AWalkWithoutOneBeginsAtOnce) {
    walk::WalkRequest request = test::Forest::get().virtual_request(1);
    request.clock = rt::ClockKind::real;
    request.fifo = false;
    request.rate_hz = 10;
    request.correct_costs = false;
    std::int64_t started_ns = 0;
    walk::WalkObserver observer;
    observer.on_started = [&](const walk::WalkStart& /*start*/) { started_ns = rt::monotonic_ns(); };
    const auto outcome = walk::run_walk(request, {}, observer);
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    ASSERT_EQ(outcome->records.size(), 1U);
    const rt::FrameRecord& first = outcome->records.front();
    const std::int64_t first_slot_ns = first.due_ns - static_cast<std::int64_t>(first.slot) * 100'000'000;
    EXPECT_LT(first_slot_ns - started_ns, 400'000'000);
}

TEST(Rehearsal, ThereIsNoneOnTheVirtualClockOrWithoutCorrection) {
    EXPECT_EQ(first_correction(rt::ClockKind::virtual_time, true), 1.0F);
    EXPECT_EQ(first_correction(rt::ClockKind::real, false), 1.0F);
}

}  // namespace
}  // namespace surefoot
