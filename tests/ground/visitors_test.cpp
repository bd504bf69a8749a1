// Visitors of whole scenes, and the classes of their triangles, judged by code that shares nothing with the product's.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <deque>

#include "tests/ground/judged_scene.hpp"

namespace surefoot::test {

namespace {

const JudgedScene& room() {
    static const JudgedScene scene = generated("room");
    return scene;
}

dvec3 start_of(const JudgedScene& of) { return of.path.samples.front().pose.position; }

/// Squares whose middle a body reaches from the start by straight level moves from middle to middle that touch nothing.
std::set<Square> reachable(const JudgedScene& of, const dvec3& start) {
    const model::Walker walker(of.ground, {});
    std::set<Square> seen;
    std::deque<dvec3> open;
    const auto middle = [&](int x, int z, double near_y) -> std::optional<dvec3> {
        const double px = (x + 0.5) * 0.25, pz = (z + 0.5) * 0.25;
        double best = -1e9;
        for (const double y : of.judge->floors_at(px, pz, 0.7071))
            if (y <= near_y + 0.26 && y >= near_y - 0.99) best = std::max(best, y);
        if (best < -1e8) return {};
        return dvec3(px, best, pz);
    };
    const auto add = [&](int x, int z, const dvec3& from, bool first) {
        const auto feet = middle(x, z, from.y);
        if (!feet || seen.contains(square_of(*feet))) return;
        const model::Capsule body = walker.capsule_at(*feet);
        if (of.judge->penetration(body.low, body.length, body.radius) > 0) return;
        const model::Capsule before = walker.capsule_at({from.x, feet->y, from.z});
        if (!first && of.judge->first_contact(before.low, before.length, before.radius, body.low - before.low) <= 1) return;
        seen.insert(square_of(*feet));
        open.push_back(*feet);
    };
    const auto index = [](double v) { return static_cast<int>(std::floor(v / 0.25)); };
    for (int dx = -2; dx <= 2; ++dx)
        for (int dz = -2; dz <= 2; ++dz) add(index(start.x) + dx, index(start.z) + dz, start - dvec3(0, 1.7, 0), true);
    while (!open.empty()) {
        const dvec3 from = open.front();
        open.pop_front();
        for (const auto& [dx, dz] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
            add(index(from.x) + dx, index(from.z) + dz, from, false);
    }
    return seen;
}

void expect_good(const Walked& walked, const std::string& what) {
    EXPECT_LE(walked.worst_overlap_m, 0.01) << what;
    EXPECT_EQ(walked.crossings, 0U) << what;
    EXPECT_LE(walked.uncarried, 3U) << what;
}

/// Ten visitors of six minutes; prints what they did. At most one return an hour of visitors.
void ten_visitors(const std::string& name, const JudgedScene& of, const dvec3& start) {
    Walked all;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Walked one = visitor(of, start, seed, 360);
        expect_good(one, name + ", seed " + std::to_string(seed));
        all.walked_m += one.walked_m, all.returns += one.returns, all.freed += one.freed;
        all.worst_overlap_m = std::max(all.worst_overlap_m, one.worst_overlap_m);
        all.trodden.insert(one.trodden.begin(), one.trodden.end());
    }
    EXPECT_LE(all.returns + all.freed, 1U) << name << ": an hour of visitors";
    EXPECT_GT(all.walked_m, 1000) << name;
    EXPECT_GT(all.trodden.size(), 400U) << name;
    std::printf("%s: %.0f m, %zu squares of 0.25 m, worst overlap %.5f m, %llu returns, %llu times freed\n", name.c_str(),
                all.walked_m, all.trodden.size(), all.worst_overlap_m, static_cast<unsigned long long>(all.returns),
                static_cast<unsigned long long>(all.freed));
}

struct File {
    const char* name;
    const char* path;
    dvec3 start;
};
// Places in the middle of a corridor or street.
constexpr std::array<File, 5> files = {{
    {"hospital", "interior/hospital/hospital_three_floors.glb", {5, 1.7, 3}},
    {"candela", "outdoor/candela-city/candela_city.glb", {-16.73, -9.08, -108.82}},
    {"ravenbridge", "interior/ravenbridge-mansion/ravenbridge_mansion.glb", {-3.17, 0.14, 69.90}},
    {"cocoa-temple", "outdoor/cocoa-temple/cocoa_temple.glb", {21.32, 0.21, -43.81}},
    {"keflavik", "outdoor/flightgear-keflavik/keflavik.glb", {0, 0, 0}},
}};

}  // namespace

TEST(Classes, AgreeWithTheJudgeTriangleByTriangle) {
    for (const char* name : {"room", "garden", "forest"}) EXPECT_EQ(disagreements(generated(name)), 0U) << name;
    EXPECT_EQ(disagreements(generated("town", 0.05)), 0U);
}

TEST(Visitors, OfTheRoomNeverEnterAWall) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const Walked one = visitor(room(), start_of(room()), seed, 60);
        expect_good(one, std::to_string(seed));
        EXPECT_GT(one.walked_m, 5) << seed;
        EXPECT_EQ(one.returns, 0U) << seed;
    }
}

TEST(Visitors, WhoRepeatWhatTheyDidEndAtTheSameBits) {
    const dvec3 once = visitor(room(), start_of(room()), 7, 20).end, twice = visitor(room(), start_of(room()), 7, 20).end;
    EXPECT_EQ(once, twice);
}

TEST(Moves, OfCapsulesAgreeWithTheJudge) {
    std::vector<dvec3> places;
    for (const PathSample& sample : room().path.samples) places.push_back(sample.pose.position - dvec3(0, 1, 0));
    EXPECT_EQ(wrong_moves(room(), places, 1000, 3), 0U);
}

TEST(Nightly, TenVisitorsOfEachScene) {
    ten_visitors("room", room(), start_of(room()));
    const JudgedScene town = generated("town");
    ten_visitors("town", town, start_of(town));
    for (const File& file : files) {
        if (file.start == dvec3(0.0)) continue;
        const auto of = imported(file.path);
        if (!of) GTEST_SKIP() << "SUREFOOT_DATA is not set, or lacks " << file.path;
        ten_visitors(file.name, *of, file.start);
    }
}

TEST(Nightly, TenVisitorsTreadAThirdOfTheRoom) {
    const std::set<Square> all = reachable(room(), start_of(room()));
    std::set<Square> trodden;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Walked one = visitor(room(), start_of(room()), seed, 360);
        for (const Square& s : one.trodden)
            if (all.contains(s)) trodden.insert(s);
    }
    std::printf("%zu of %zu reachable squares\n", trodden.size(), all.size());
    EXPECT_GT(all.size(), 100U);
    EXPECT_GT(3 * trodden.size(), all.size());
}

TEST(Nightly, AnHourInTheRoom) {
    const Walked one = visitor(room(), start_of(room()), 42, 3600);
    expect_good(one, "an hour");
    EXPECT_LE(one.returns, 1U);
}

TEST(Nightly, ClassesOfFilesAgree) {
    const JudgedScene town = generated("town");
    EXPECT_LT(disagreements(town), 200U);
    for (const File& file : files) {
        const auto of = imported(file.path);
        if (!of) GTEST_SKIP() << "SUREFOOT_DATA is not set, or lacks " << file.path;
        std::printf("%s\n", file.name);
        EXPECT_LT(disagreements(*of), 20U) << file.name;
    }
}

// The judge takes 5 ms for a move in the room, so a million would take longer than half a night.
TEST(Nightly, ManyMovesAgree) {
    std::vector<dvec3> places;
    for (const PathSample& sample : room().path.samples) places.push_back(sample.pose.position - dvec3(0, 1, 0));
    EXPECT_EQ(wrong_moves(room(), places, 100'000, 3), 0U);
    for (const File& file : {files[0], files[1]}) {
        const auto of = imported(file.path);
        if (!of) GTEST_SKIP() << "SUREFOOT_DATA is not set, or lacks " << file.path;
        std::vector<dvec3> around;
        for (std::uint64_t seed = 1; seed <= 5; ++seed) around.push_back(visitor(*of, file.start, seed, 60).end - dvec3(0, 1, 0));
        EXPECT_EQ(wrong_moves(*of, around, 10'000, 3), 0U) << file.name;
    }
}

}  // namespace surefoot::test
