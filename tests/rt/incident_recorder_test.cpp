// The service's flight recorder: what is a burst, what is kept, what is suppressed, and that the writer never holds it up.
#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "rt/monitor/incident_recorder.hpp"

namespace surefoot::rt {
namespace {

constexpr std::int64_t box_period_ns = 10'000'000;

/// Frames on a grid of 10 ms; those that are named miss.
class BoxFeeder {
public:
    explicit BoxFeeder(IncidentRecorder& box) : box_(box) { box_.begin(box_period_ns); }
    void run(int frames, int every_misses = 0, std::uint32_t skipped = 0) {
        for (int i = 0; i < frames; ++i) {
            FrameRecord r;
            r.frame = r.slot = frame_;
            r.due_ns = 1'000'000'000 + static_cast<std::int64_t>(frame_) * box_period_ns;
            r.deadline_ns = r.due_ns + box_period_ns;
            r.missed = every_misses > 0 && i % every_misses == 0;
            r.skipped_before = r.missed ? skipped : 0;
            r.complete_ns = r.due_ns + (r.missed ? 12'000'000 : 5'000'000);
            r.control = control_;
            r.cause = r.missed ? Cause::raster : Cause::none;
            ++frame_;
            box_.add(r);
        }
    }
    void control(bool on) { control_ = on; }

private:
    IncidentRecorder& box_;
    std::uint64_t frame_ = 0;
    bool control_ = false;
};

IncidentRecorderOptions box_options() {
    IncidentRecorderOptions o;
    o.keep_s = 5;
    o.after_s = 0.5;
    o.between_s = 20;
    return o;
}

TEST(IncidentRecorder, KeepsTheLastSecondsAroundABurst) {
    IncidentRecorder box(box_options());
    BoxFeeder feed(box);
    feed.run(2000);
    feed.run(3, 1);
    feed.run(60);
    EXPECT_EQ(box.bursts(), 1U);
    const auto* incident = box.wait();
    ASSERT_NE(incident, nullptr);
    EXPECT_EQ(incident->first_frame, 2000U);
    EXPECT_EQ(incident->records.size(), 500U);
    EXPECT_GE(incident->records.back().frame, 2002U + 50U);
    for (std::size_t i = 1; i < incident->records.size(); ++i)
        ASSERT_EQ(incident->records[i].frame, incident->records[i - 1].frame + 1);
    box.done();
    EXPECT_EQ(box.suppressed(), 0U);
}

TEST(IncidentRecorder, ASingleMissIsNoBurstAndSkippedSlotsCount) {
    IncidentRecorder box(box_options());
    BoxFeeder feed(box);
    feed.run(1000, 100);  // one a second
    EXPECT_EQ(box.bursts(), 0U);
    feed.run(200);
    feed.run(1, 1, 2);  // a late frame after two skipped slots
    EXPECT_EQ(box.bursts(), 1U);
}

TEST(IncidentRecorder, MissesOfTheControlAreNoBurst) {
    IncidentRecorder box(box_options());
    BoxFeeder feed(box);
    feed.control(true);
    feed.run(500, 1);
    EXPECT_EQ(box.bursts(), 0U);
}

TEST(IncidentRecorder, AStormIsWrittenAtItsRateAndTheRestIsCounted) {
    IncidentRecorder box(box_options());
    BoxFeeder feed(box);
    std::uint64_t handed = 0;
    for (int s = 0; s < 100; ++s) {
        feed.run(100, 1);  // a hundred misses a second
        if (box.bursts() > 0 && box.suppressed() + handed < box.bursts() - 1) {
            const auto* incident = box.wait();
            ASSERT_NE(incident, nullptr);
            ++handed;
            box.done();
        }
    }
    EXPECT_GE(handed, 4U);
    EXPECT_LE(handed, 6U) << "one in 20 s of 100";
    EXPECT_GT(box.suppressed(), 1000U);
}

TEST(IncidentRecorder, AWriterThatNeverComesBackCostsNothingButIncidents) {
    IncidentRecorderOptions o = box_options();
    o.between_s = 0;
    IncidentRecorder box(o);
    BoxFeeder feed(box);
    feed.run(3, 1);
    feed.run(100);
    const auto* held = box.wait();
    ASSERT_NE(held, nullptr);
    const std::size_t size = held->records.size();
    const std::uint64_t first = held->records.front().frame;
    for (int i = 0; i < 20; ++i) {
        feed.run(3, 1);
        feed.run(100);
    }
    EXPECT_EQ(box.bursts(), 21U);
    EXPECT_EQ(box.suppressed(), 20U);
    EXPECT_EQ(held->records.size(), size) << "what the writer holds stays as it is";
    EXPECT_EQ(held->records.front().frame, first);
    box.done();
    feed.run(3, 1);
    feed.run(100);
    EXPECT_EQ(box.wait()->number, 22U);
    EXPECT_EQ(box.wait()->suppressed, 20U);
}

TEST(IncidentRecorder, TheEndOfAWalkHandsOverWhatIsOpenAndStopEndsTheWriter) {
    IncidentRecorder box(box_options());
    BoxFeeder feed(box);
    feed.run(100);
    feed.run(3, 1);
    box.finish();
    std::atomic<int> got{0};
    std::thread writer([&] {
        while (const auto* incident = box.wait()) {
            EXPECT_EQ(incident->records.size(), 103U);
            ++got;
            box.done();
        }
    });
    box.stop();
    writer.join();
    EXPECT_EQ(got.load(), 1) << "what waits is written before the end";
    EXPECT_EQ(box.wait(), nullptr);
}

}  // namespace
}  // namespace surefoot::rt
