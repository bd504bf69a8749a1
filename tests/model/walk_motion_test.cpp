// Motions in the .walk file: they come back, a file without them is as it was, and wrong ones are refused by place.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <span>
#include <string>

#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/model/two_triangles.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::model {
namespace {

struct WalkMotion : testing::Test {
    surefoot::test::TemporaryFolder folder;
    std::string file = folder / "m.walk";
    Model model = two_triangles();

    void add_motions() {
        model.motions = {{{1, 2, 3}, 0, 3, 2.5, none}, {{0, 1, 0}, 3, 2, 7, 0}};
        model.motion_keys = {{0, {0, 0, 0}, {0, 0, 0, 1}},
                             {1, {0, 4, 0}, {0, 0.6F, 0, 0.8F}},
                             {2.5, {0, 0, 0}, {0, 0, 0, 1}},
                             {0, {0, 0, 0}, {0, 0, 0, 1}},
                             {7, {1, 0, 0}, {1, 0, 0, 0}}};
        model.placements.push_back(model.placements[0]);
        model.placements[1].motion = 1;
        model.reps[3].placement = 1;
    }
};

TEST_F(WalkMotion, ComesBackAsItWent) {
    add_motions();
    ASSERT_TRUE(write_walk(file, model).ok());
    const auto read = read_walk(file);
    ASSERT_TRUE(read.ok()) << read.error().text();
    ASSERT_EQ(read->motions.size(), 2U);
    ASSERT_EQ(read->motion_keys.size(), model.motion_keys.size());
    EXPECT_EQ(read->placements[0].motion, none);
    EXPECT_EQ(read->placements[1].motion, 1U);
    for (Index m = 0; m < 2; ++m) {
        EXPECT_EQ(read->motions[m].pivot, model.motions[m].pivot);
        EXPECT_EQ(read->motions[m].period_s, model.motions[m].period_s);
        EXPECT_EQ(read->motions[m].outer, model.motions[m].outer);
        for (const double t : {0.1, 1.7, 33.0})
            EXPECT_EQ(pose_at(*read, m, t)(dvec3(1, 2, 3)), pose_at(model, m, t)(dvec3(1, 2, 3)));
    }
}

TEST_F(WalkMotion, TakesNoByteAndNoHashOfAFileThatHasNone) {
    WalkFileInfo without, with;
    ASSERT_TRUE(write_walk(file, model).ok());
    ASSERT_TRUE(read_walk(file, &without).ok());
    const auto before = *read_file(file);
    std::uint32_t sections = 0;
    std::memcpy(&sections, before.data() + 12, sizeof(sections));
    EXPECT_EQ(sections, 9U) << "those of the oldest files, and no other";
    add_motions();
    ASSERT_TRUE(write_walk(file, model).ok());
    ASSERT_TRUE(read_walk(file, &with).ok());
    EXPECT_NE(with.hash, without.hash);
    std::memcpy(&sections, read_file(file)->data() + 12, sizeof(sections));
    EXPECT_EQ(sections, 10U);
    model = two_triangles();
    ASSERT_TRUE(write_walk(file, model).ok());
    EXPECT_EQ(*read_file(file), before);
}

struct WrongMotion {
    const char* name;
    const char* place;
    std::function<void(Model&)> make;
};

class WrongMotions : public WalkMotion, public testing::WithParamInterface<WrongMotion> {};

TEST_P(WrongMotions, AreRefusedByTheirPlace) {
    add_motions();
    const auto valid = validate(model);
    ASSERT_TRUE(valid.ok()) << valid.error().text();
    GetParam().make(model);
    ASSERT_TRUE(write_walk(file, model).ok());
    const auto read = read_walk(file);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().place.find(GetParam().place), std::string::npos) << read.error().text();
}

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Each, WrongMotions,
    testing::Values(WrongMotion{"Placement", "placements[1]", [](Model& m) { m.placements[1].motion = 2; }},
                    WrongMotion{"Keys", "motions[1]", [](Model& m) { ++m.motions[1].key_count; }},
                    WrongMotion{"NoKeys", "motions[0]", [](Model& m) { m.motions[0].key_count = 0; }},
                    WrongMotion{"KeysThatWrap", "motions[0]", [](Model& m) { m.motions[0].first_key = 0xffffffffU; }},
                    WrongMotion{"SharedKeys", "motions", [](Model& m) { m.motions.resize(40, m.motions[0]); }},
                    WrongMotion{"OuterOfItself", "motions[1]", [](Model& m) { m.motions[1].outer = 1; }},
                    WrongMotion{"OuterBehind", "motions[0]", [](Model& m) { m.motions[0].outer = 1; }},
                    WrongMotion{"Pivot", "motions[0]", [](Model& m) { m.motions[0].pivot.y = not_a_number; }},
                    WrongMotion{"Period", "motions[0]", [](Model& m) { m.motions[0].period_s = not_a_number; }},
                    WrongMotion{"NoPeriod", "motions[0]", [](Model& m) { m.motions[0].period_s = 0; }},
                    WrongMotion{"OtherPeriod", "motions[0]", [](Model& m) { m.motions[0].period_s *= 1.5; }},
                    WrongMotion{"Translation", "motion_keys[1]", [](Model& m) { m.motion_keys[1].translation.z = not_a_number; }},
                    WrongMotion{"Rotation", "motion_keys[1]",
                                [](Model& m) {
                                    m.motion_keys[1].rotation = {0, 0, 0, 2};
                                }},
                    WrongMotion{"NoRotation", "motion_keys[0]",
                                [](Model& m) { m.motion_keys[0].rotation[0] = static_cast<float>(not_a_number); }},
                    WrongMotion{"LateStart", "motion_keys[0]", [](Model& m) { m.motion_keys[0].time_s = 1e-3; }},
                    WrongMotion{"TimeFalls", "motion_keys[1]", [](Model& m) { m.motion_keys[1].time_s = -1; }},
                    WrongMotion{"TimeIsNone", "motion_keys[1]", [](Model& m) { m.motion_keys[1].time_s = not_a_number; }},
                    WrongMotion{"FormsMoveApart", "nodes[0]", [](Model& m) { m.reps[0].placement = 1; }},
                    WrongMotion{"TooDeep", "motions[",
                                [](Model& m) {
                                    for (std::uint32_t i = 0; i < max_motion_depth; ++i) {
                                        m.motions.push_back(m.motions.back());
                                        m.motions.back().outer = static_cast<Index>(m.motions.size() - 2);
                                    }
                                }}),
    [](const auto& one) { return std::string(one.param.name); });

TEST_F(WalkMotion, AnyByteFlippedIsAnError) {
    add_motions();
    ASSERT_TRUE(write_walk(file, model).ok());
    const auto good = *read_file(file);
    for (std::size_t i = 0; i < good.size(); ++i) {
        auto bad = good;
        bad[i] ^= std::byte{4};
        std::ofstream(file, std::ios::binary | std::ios::trunc)
            .write(reinterpret_cast<const char*>(bad.data()), static_cast<std::streamsize>(bad.size()));
        EXPECT_FALSE(read_walk(file).ok()) << "byte " << i;
    }
}

}  // namespace
}  // namespace surefoot::model
