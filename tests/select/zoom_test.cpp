// The field of view changes from frame to frame: cuts stay legal and within the budget, with what was shown before.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/select/scene.hpp"

namespace surefoot::select {
namespace {

TEST(Zoom, CutsStayLegalAndWithinTheBudgetWhileTheFieldOfViewChanges) {
    for (const SelectorEntry& entry : selectors()) {
        test::Scene s(test::town(4));
        std::size_t widest = 0, narrowest = s.model.nodes.size();
        for (int i = 0; i < 40; ++i) {
            prepare::Region region{{}, 0.2, 0.1};
            region.centre.position = dvec3(0, 10, 60);
            region.centre.fov_y_rad = (5 + 3.0 * (i < 20 ? i : 40 - i)) * std::numbers::pi / 180;
            s.look(region);
            ASSERT_FALSE(s.frame.candidates.empty());
            const double budget_us = 4000;
            const Cut& cut = s.run(entry.name, budget_us);
            ASSERT_EQ(check_legal(s.frame, cut), "") << entry.name << " frame " << i;
            if (entry.goes_by == GoesBy::budget) {
                EXPECT_LE(cut.predicted_us, std::max(4000.0F, cut.floor_us)) << entry.name << " frame " << i;
            }
            widest = std::max(widest, s.frame.candidates.size());
            narrowest = std::min(narrowest, s.frame.candidates.size());
        }
        EXPECT_GT(widest, 2 * narrowest) << "or little comes into view and goes";
    }
}

}  // namespace
}  // namespace surefoot::select
