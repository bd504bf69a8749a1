// What the graphics driver allocates in a frame cannot be changed here, but is recorded: it may not grow.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <string_view>

#include "tests/walk/walk_fixture.hpp"
#include "tools/walk/settings_request.hpp"

namespace surefoot {
namespace {

/// Allocations a frame of the walk below, as recorded on Debian 12 (Mesa 22.3), by the renderer's name.
struct Baseline {
    std::string_view renderer;
    double allocations = 0;
};
constexpr std::array<Baseline, 1> baselines{{{"llvmpipe (LLVM 15.0.6, 256 bits)", 1754}}};

TEST(DriverBaseline, AFramesAllocationsInTheDriverDoNotGrow) {
#ifdef SUREFOOT_SANITIZED
    GTEST_SKIP() << "a sanitizer's own hooks count nothing";
#endif
    walk::WalkRequest request = test::Forest::get().virtual_request(240);  // the same cuts on every machine
    request.backend = "egl";
    request.width = 320;
    request.height = 240;
    request.rasterisers = 2;
    request.budget_ms = 0.7 * 1e3 / request.rate_hz;  // today's forms give about as many draws as the recorded walk had
    walk::prepare_process(request);
    const auto outcome = walk::run_walk(request, {}, {});
    if (!outcome && outcome.error().text().find("libEGL") != std::string::npos) GTEST_SKIP() << outcome.error().text();
    ASSERT_TRUE(outcome.ok()) << outcome.error().text();
    const report::WalkSummary& s = outcome->summary;
    std::cout << s.renderer << ": " << s.driver_allocations_per_frame << " allocations a frame\n";
    double draws = 0;
    for (const rt::FrameRecord& r : outcome->records) draws += r.draws;
    constexpr double recorded_draws = 770;  // a frame: f25674b made 1820 allocations for them
    EXPECT_GE(draws, recorded_draws * static_cast<double>(outcome->records.size())) << "or less work is compared";
    const auto known =
        std::find_if(baselines.begin(), baselines.end(), [&](const Baseline& b) { return b.renderer == s.renderer; });
    if (known == baselines.end()) GTEST_SKIP() << "no baseline of this renderer is recorded";
    EXPECT_GT(s.driver_allocations_per_frame, 0) << "the counter sees nothing";
    EXPECT_LE(s.driver_allocations_per_frame, 1.05 * known->allocations);
}

}  // namespace
}  // namespace surefoot
