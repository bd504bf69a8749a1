// Light in the .walk file: shares of the sun and light of lamps come back, and a file without them is as small as it was.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "rt/base/random.hpp"
#include "tests/model/two_triangles.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::model {
namespace {

struct WalkLight : testing::Test {
    test::TemporaryFolder folder;
    std::string file = folder / "m.walk";
    Model model = two_triangles();

    [[nodiscard]] std::uint64_t bytes_of_file(WalkFileInfo* info = nullptr) const {
        const auto written = write_walk(file, model);
        EXPECT_TRUE(written.ok()) << written.error().text();
        const auto read = read_walk(file, info);
        EXPECT_TRUE(read.ok()) << read.error().text();
        return written->bytes;
    }
    void expect_that_it_comes_back() const {
        const auto written = write_walk(file, model);
        ASSERT_TRUE(written.ok()) << written.error().text();
        const auto read = read_walk(file);
        ASSERT_TRUE(read.ok()) << read.error().text();
        EXPECT_EQ(read->light, model.light);
        const auto bytes = [](const auto& list) {
            const auto span = std::as_bytes(std::span(list));
            return std::vector<std::byte>(span.begin(), span.end());
        };
        EXPECT_EQ(bytes(read->sun_seen), bytes(model.sun_seen));
        EXPECT_EQ(bytes(read->lamp_light), bytes(model.lamp_light));
        EXPECT_EQ(bytes(read->vertices), bytes(model.vertices));
        EXPECT_EQ(read->texels, model.texels);
    }
    /// Hard to pack, and more than a page of each.
    void fill(std::size_t vertices) {
        Random random(9);
        model.vertices.resize(vertices);
        model.parts[0].vertex_count = static_cast<std::uint32_t>(vertices);
        model.sun_seen.resize(vertices);
        model.lamp_light.resize(vertices);
        for (SunSeen& sun : model.sun_seen)
            for (auto& share : sun.share) share = static_cast<std::uint8_t>(random.below(256));
        for (LampLight& lamps : model.lamp_light) {
            for (std::size_t i = 0; i < 3; ++i) {
                lamps.before[i] = static_cast<std::uint8_t>(random.below(256));
                lamps.behind[i] = static_cast<std::uint8_t>(random.below(256));
            }
        }
    }
};

TEST_F(WalkLight, ComesBackAsItWent) {
    fill(140000);
    model.light = {80.5, -33.25, 2.5F, 350.0F};
    expect_that_it_comes_back();
}

TEST_F(WalkLight, ComesBackWhereThereIsOnlyOneOfThem) {
    fill(300);
    const std::vector<LampLight> lamps = model.lamp_light;
    model.lamp_light.clear();
    expect_that_it_comes_back();
    model.lamp_light = lamps;
    model.sun_seen.clear();
    expect_that_it_comes_back();
    model.lamp_light.clear();
    for (const LightFacts& facts :
         {LightFacts{1}, {366, 90}, {172, -90}, {172, 50, 1e-6F}, {172, 50, 1, 0.5F}, {172, 50, 1, 0, 0.4F}}) {
        model.light = facts;
        expect_that_it_comes_back();
    }
}

TEST_F(WalkLight, TakesNoByteOfAFileThatHasNone) {
    WalkFileInfo without, with_facts, with_shares;
    const std::uint64_t bytes = bytes_of_file(&without);
    const auto before = *read_file(file);
    std::uint32_t sections = 0;
    std::memcpy(&sections, before.data() + 12, sizeof(sections));
    EXPECT_EQ(sections, 9U) << "those of the oldest files, and no other";
    model.light.fog_visibility_m = 100;
    EXPECT_EQ(bytes_of_file(&with_facts), bytes + 20 + 8 + 8 + 4 + 4 + 4) << "an entry of the table, and the facts";
    model.light = {};
    fill(model.vertices.size());
    EXPECT_GT(bytes_of_file(&with_shares), bytes);
    EXPECT_NE(with_facts.hash, without.hash);
    EXPECT_NE(with_shares.hash, without.hash);
    model.sun_seen.clear();
    model.lamp_light.clear();
    EXPECT_EQ(bytes_of_file(), bytes);
    EXPECT_EQ(*read_file(file), before);
}

// What was measured of a model is found by this number: a program that knows of light must not lose it.
TEST_F(WalkLight, LeavesTheHashOfAnOlderFileAsItWas) {
    WalkFileInfo old;
    ASSERT_TRUE(read_walk(std::string(SUREFOOT_SOURCE_DIR) + "/tests/model/golden/yard.walk", &old).ok());
    EXPECT_EQ(old.hash, 815661158384376007U);
}

TEST_F(WalkLight, OfAnotherNumberOfVerticesIsRefused) {
    for (const std::size_t size : {299U, 301U}) {
        fill(300);
        model.sun_seen.resize(size);
        ASSERT_TRUE(write_walk(file, model).ok());
        const auto sun = read_walk(file);
        ASSERT_FALSE(sun.ok()) << size;
        EXPECT_NE(sun.error().place.find("light"), std::string::npos) << sun.error().text();
        fill(300);
        model.lamp_light.resize(size);
        ASSERT_TRUE(write_walk(file, model).ok());
        EXPECT_FALSE(read_walk(file).ok()) << size;
    }
}

TEST_F(WalkLight, FactsThatAreNoNumbersAreRefused) {
    constexpr float no_number = std::numeric_limits<float>::quiet_NaN();
    for (const LightFacts& facts : {LightFacts{no_number}, {172, no_number}, {172, 50, no_number}, {172, 50, 1, no_number}}) {
        model.light = facts;
        ASSERT_TRUE(write_walk(file, model).ok());
        const auto read = read_walk(file);
        ASSERT_FALSE(read.ok());
        EXPECT_NE(read.error().place.find("light"), std::string::npos) << read.error().text();
    }
}

TEST_F(WalkLight, AnyByteFlippedIsAnError) {
    fill(3);
    model.light = {80.5, -33.25, 2.5F, 350.0F};
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
