// Paths: every bad row is refused with its line, recorded drives are read, and poses in between are unit and clamped.
#include "rt/base/path.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>

#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot {
namespace {

namespace fs = std::filesystem;
constexpr double sixty_degrees = 1.0471975511965976;

class PathTest : public ::testing::Test {
protected:
    Result<Path> read(const std::string& text) {
        file_ = folder_ / "p.csv";
        EXPECT_TRUE(write_text(file_, text).ok());
        return read_path(file_);
    }
    void refused(const std::string& text, const std::string& place, const std::string& what) {
        const auto path = read(text);
        ASSERT_FALSE(path.ok()) << text;
        EXPECT_EQ(path.error().place, place.empty() ? file_ : file_ + place) << text;
        EXPECT_NE(path.error().what.find(what), std::string::npos) << path.error().text();
    }
    test::TemporaryFolder folder_;
    std::string file_;
};

TEST_F(PathTest, HeaderNamingFovIsUsed) {
    const auto path = read("time_s,x,y,z,qx,qy,qz,qw,fov_y_deg\n0,1,2,3,0,0,0,1,90\n");
    ASSERT_TRUE(path.ok()) << path.error().text();
    EXPECT_NEAR(path->samples[0].pose.fov_y_rad, std::acos(0.0), 1e-12);
    EXPECT_EQ(path->samples[0].pose.position, dvec3(1, 2, 3));
}

TEST_F(PathTest, CommentNamingFovIsUsed) {
    const auto path = read("# time_s,x,y,z,qx,qy,qz,qw,fov_y_deg\n0,1,2,3,0,0,0,1,90\n");
    ASSERT_TRUE(path.ok());
    EXPECT_NEAR(path->samples[0].pose.fov_y_rad, std::acos(0.0), 1e-12);
}

TEST_F(PathTest, SpeedInTheLastColumnIsNotTakenForAnAngle) {
    const auto path = read("# time_s,x,y,z,qx,qy,qz,qw,speed_mps\r\n0,1,2,3,0,0,0,1,0.0\r\n1,1,2,3,0,0,0,1,fast\r\n");
    ASSERT_TRUE(path.ok()) << path.error().text();
    EXPECT_EQ(path->samples[1].pose.fov_y_rad, sixty_degrees);
}

TEST_F(PathTest, MissingLastColumnMeansSixtyDegrees) {
    const auto path = read("0,1,2,3,0,0,0,2\n");
    ASSERT_TRUE(path.ok());
    EXPECT_EQ(path->samples[0].pose.fov_y_rad, sixty_degrees);
    EXPECT_EQ(path->samples[0].pose.orientation.w, 1.0);  // renormalised
}

TEST_F(PathTest, BadRowsAreRefusedWithTheirLine) {
    refused("0,0,0,0,0,0,0,1\n1,0,abc,0,0,0,0,1\n", ":2", "Column 3 holds 'abc', which is not a number");
    refused("# c\n\n0,0,0,nan,0,0,0,1\n", ":3", "not finite");
    refused("0,0,0,inf,0,0,0,1\n", ":1", "not finite");
    refused("0,0,0,1e999,0,0,0,1\n", ":1", "not finite");
    refused("0,0,0,0,0,0,0,1\n1e300,0,0,0,0,0,0,1\n", ":2", "Column 1 holds 1e300, which is beyond");
    refused("0,0,-1e300,0,0,0,0,1\n", ":1", "Column 3 holds -1e300, which is beyond");
    refused("0,0,0,0,1e300,0,0,1\n", ":1", "Column 5 holds 1e300, which is beyond");
    refused("0,0,0,0,0,0,0,0\n", ":1", "quaternion");
    refused("0,0,0,0,0,0,0\n", ":1", "7 columns");
    refused("0,0,0,0,0,0,0,1,60,4\n", ":1", "10 columns");
    refused("0,0,0,0,0,0,0,1\n0,0,0,0,0,0,0,1\n", ":2", "does not come after");
    refused("# fov_y_deg\n0,0,0,0,0,0,0,1,180\n", ":2", "fov_y_deg");
    refused("0,0,0,0,0,0,0,\n", ":1", "Column 8");
    refused("", "", "no poses");
    refused("# only a comment\n", "", "no poses");
}

TEST_F(PathTest, WrittenPathReadsBackTheSame) {
    Path path;
    for (int i = 0; i < 5; ++i) {
        PathSample s;
        s.time_s = 0.1 * i;
        s.pose.position = {1.0 / 3.0 * i, 1e6 + 0.001 * i, -7.25};
        s.pose.orientation = glm::angleAxis(0.3 * i, dvec3(0, 1, 0));
        s.pose.fov_y_rad = 0.9;
        path.samples.push_back(s);
    }
    const auto file = folder_ / "w.csv";
    ASSERT_TRUE(write_path(file, path).ok());
    const auto back = read_path(file);
    ASSERT_TRUE(back.ok()) << back.error().text();
    ASSERT_EQ(back->samples.size(), path.samples.size());
    for (std::size_t i = 0; i < path.samples.size(); ++i) {
        EXPECT_EQ(back->samples[i].time_s, path.samples[i].time_s);
        EXPECT_EQ(back->samples[i].pose.position, path.samples[i].pose.position);
        EXPECT_NEAR(glm::dot(back->samples[i].pose.orientation, path.samples[i].pose.orientation), 1.0, 1e-12);
        EXPECT_NEAR(back->samples[i].pose.fov_y_rad, 0.9, 1e-12);
    }
}

TEST_F(PathTest, SamplingClampsAtBothEndsAndCountsFromTheStart) {
    const auto path = read("10,0,0,0,0,0,0,1\n12,4,0,0,0,1,0,0\n");
    ASSERT_TRUE(path.ok());
    EXPECT_EQ(path->duration_s(), 2.0);
    EXPECT_EQ(sample_path(*path, -1).position.x, 0.0);
    EXPECT_EQ(sample_path(*path, 1).position.x, 2.0);
    EXPECT_EQ(sample_path(*path, 99).position.x, 4.0);
    EXPECT_EQ(sample_path(*path, std::numeric_limits<double>::quiet_NaN()).position.x, 0.0);
    EXPECT_EQ(sample_path(*path, std::numeric_limits<double>::infinity()).position.x, 4.0);
    EXPECT_NEAR(glm::length(sample_path(*path, 0.7).orientation), 1.0, 1e-12);
    EXPECT_EQ(sample_path(Path{}, 1).position, dvec3(0));
}

TEST_F(PathTest, OppositeQuaternionsTakeTheShortWay) {
    const auto path = read("0,0,0,0,0,0,0,1\n1,0,0,0,0,-0.0871557,0,-0.9961947\n");  // 10 degrees about y, written negated
    ASSERT_TRUE(path.ok());
    const dvec3 forward = sample_path(*path, 0.5).forward();
    EXPECT_NEAR(forward.z, -std::cos(5 * 0.0174532925), 1e-6);
}

TEST_F(PathTest, RecordedDrivesAreRead) {
    const char* data = std::getenv("SUREFOOT_DATA");
    if (data == nullptr) GTEST_SKIP() << "SUREFOOT_DATA is not set: no recorded drives";
    int found = 0;
    for (const auto& entry : fs::recursive_directory_iterator(data)) {
        if (entry.path().filename() != "recorded_path.csv") continue;
        const auto path = read_path(entry.path().string());
        ASSERT_TRUE(path.ok()) << path.error().text();
        EXPECT_GT(path->samples.size(), 100U);
        EXPECT_EQ(path->samples.front().pose.fov_y_rad, sixty_degrees);
        ++found;
    }
    if (found == 0) GTEST_SKIP() << "no recorded_path.csv under " << data;
}

}  // namespace
}  // namespace surefoot
