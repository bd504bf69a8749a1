// Preparing on one thread allocates nothing, from the first set on. (The counter of allocations is in this program.)
#include <gtest/gtest.h>

#include <cmath>

#include "render/model/cost.hpp"
#include "render/prepare/prepared.hpp"
#include "tests/prepare/random_model.hpp"
#include "tests/select/count_malloc.hpp"

namespace surefoot::prepare {
namespace {

TEST(PrepareAllocation, NoSetNeedsOne) {
    const model::Model m = test::town(6);
    const model::CostModel costs = model::default_costs();
    Preparer preparer(m, costs, {});
    PreparedFrame frame;
    preparer.reserve(frame);
    const std::uint64_t before = test::allocations();
    std::size_t most = 0;
    for (int i = 0; i < 40; ++i) {
        Region region;
        region.centre.position = dvec3(20 * std::sin(0.3 * i), 3, 200 - 8 * i);  // from beside the town into it
        region.radius_m = 0.1 * i;
        region.angle_rad = 0.01 * i;
        frame.resolution = i % 3 == 0 ? 0.5F : 1.0F;
        preparer.run(region, {1280, 720}, static_cast<std::uint64_t>(i), 0.2 * i, 0.1 * i, frame);
        (void)preparer.value_at(0.75F);
        most = std::max(most, frame.candidates.size());
    }
    EXPECT_GT(most, 1000U);
    EXPECT_EQ(test::allocations(), before);
}

}  // namespace
}  // namespace surefoot::prepare
