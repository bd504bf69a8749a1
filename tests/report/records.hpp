// Frame records made up for the report's tests.
#pragma once

#include <cstdint>
#include <vector>

#include "rt/frame/record.hpp"

namespace surefoot::report {

constexpr std::int64_t period_ns = 33'333'333;

/// On time: woken 50 us late, 20 ms in all, budget 25 ms, predicted 18 ms.
inline rt::FrameRecord good_frame(std::uint64_t slot, std::uint64_t frame) {
    rt::FrameRecord f;
    f.slot = slot;
    f.frame = frame;
    f.due_ns = 5'000'000'000 + static_cast<std::int64_t>(slot) * period_ns;
    f.deadline_ns = f.due_ns + period_ns;
    f.woken_ns = f.due_ns + 50'000;
    f.selected_ns = f.woken_ns + 500'000;
    f.submitted_ns = f.selected_ns + 10'000'000;
    f.rastered_ns = f.submitted_ns + 9'000'000;
    f.complete_ns = f.due_ns + 20'000'000;
    f.cpu_ns = 10'000'000;
    f.raster_cpu_ns = 16'000'000;
    f.predicted_us = 18'000;
    f.actual_us = 20'000;
    f.budget_us = 25'000;
    f.items = 40;
    f.draws = 4;
    f.triangles = 1000;
    f.accuracy = 500;
    f.value = 0.5F;
    f.switches = 2;
    f.prepared_age = 1;
    f.cut_hash = 0x1234 + frame;
    f.eye = {static_cast<double>(frame), 1.7, 0};
    f.orientation = {0, 0, 0, 1};
    return f;
}

inline std::vector<rt::FrameRecord> good_frames(std::size_t count) {
    std::vector<rt::FrameRecord> records;
    for (std::size_t i = 0; i < count; ++i) records.push_back(good_frame(i, i));
    return records;
}

/// Frame 1 of 4 takes 50 ms (own, raster); the slot after it is skipped.
inline std::vector<rt::FrameRecord> frames_with_a_miss() {
    std::vector<rt::FrameRecord> records = {good_frame(0, 0), good_frame(1, 1), good_frame(3, 2), good_frame(4, 3)};
    records[1].complete_ns = records[1].due_ns + 50'000'000;
    records[1].rastered_ns = records[1].complete_ns;
    records[1].missed = records[1].own_miss = true;
    records[1].cause = rt::Cause::raster;
    records[1].triangles = 5000;
    records[1].accuracy = 100;
    records[2].skipped_before = 1;
    return records;
}

}  // namespace surefoot::report
