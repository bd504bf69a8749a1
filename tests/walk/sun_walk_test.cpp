// Sunlight as a setting: no frame has it, its pictures are compared without it, and its cuts are those with it.
#include <gtest/gtest.h>

#include "tests/walk/walk_fixture.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
namespace {

TEST(SunWalk, WithoutItNoFrameHasItAndPicturesAreComparedWithoutIt) {
    walk::WalkRequest request = test::Forest::get().virtual_request(12);
    request.backend = "egl";
    request.width = 160;
    request.height = 90;
    request.pictures = 3;
    const walk::WalkOutcome with = test::walk(request);
    request.sunlight = false;
    const walk::WalkOutcome without = test::walk(request);
    ASSERT_EQ(with.records.size(), without.records.size());
    for (std::size_t i = 0; i < with.records.size(); ++i) {
        EXPECT_TRUE(with.records[i].sunlight);
        EXPECT_FALSE(without.records[i].sunlight);
        EXPECT_EQ(with.records[i].cut_hash, without.records[i].cut_hash) << "light changes no choice";
        EXPECT_EQ(without.records[i].guard_violations, 0U);
    }
    EXPECT_GT(without.summary.picture.psnr_db, 15) << "full detail is drawn without it too";
    EXPECT_NE(with.summary.picture.psnr_db, without.summary.picture.psnr_db);
}

}  // namespace
}  // namespace surefoot
