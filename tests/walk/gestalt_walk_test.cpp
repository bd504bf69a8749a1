// The setting `gestalt` in a walk: it reaches the values that cuts are made by.
#include <gtest/gtest.h>

#include <memory>

#include "tests/walk/walk_fixture.hpp"

namespace surefoot {
namespace {

walk::WalkOutcome with_gestalt(double gestalt) {
    walk::WalkRequest request = test::Forest::get().virtual_request(40);
    request.gestalt = gestalt;
    request.rest_after_ms = 0;
    auto costs = std::make_shared<model::CostModel>(model::default_costs());
    costs->combine.submit_weight *= 3;  // the small forest is cheap
    costs->combine.raster_weight *= 3;
    request.given_costs = costs;
    return test::walk(request);
}

TEST(GestaltWalk, ShowsGroupsWhole) {
    const walk::WalkOutcome off = with_gestalt(0), again = with_gestalt(0), on = with_gestalt(1);
    std::size_t same = 0, kept = 0, items_off = 0, items_on = 0;
    ASSERT_EQ(off.records.size(), on.records.size());
    for (std::size_t i = 0; i < off.records.size(); ++i) {
        same += off.records[i].cut_hash == on.records[i].cut_hash ? 1 : 0;
        kept += off.records[i].cut_hash == again.records[i].cut_hash ? 1 : 0;
        items_off += off.records[i].items;
        items_on += on.records[i].items;
    }
    EXPECT_EQ(kept, off.records.size());
    EXPECT_LT(same, off.records.size() / 2);
    EXPECT_LT(items_on, items_off) << "groups of alike trees are one item each";
}

}  // namespace
}  // namespace surefoot
