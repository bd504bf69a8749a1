// Meshes of depth pictures, by a judge that knows nothing of how they are split.
#include "render/cache/depth_mesh.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <vector>

#include "tests/cache/displacement.hpp"

namespace surefoot::cache {
namespace {

/// A square of inverse depths.
struct DepthPicture {
    int side = 0;
    std::vector<float> depths;

    explicit DepthPicture(int of_side, float all = 0)
        : side(of_side), depths(static_cast<std::size_t>(of_side) * static_cast<std::size_t>(of_side), all) {}
    DepthPicture(int of_side, const std::function<float(int, int)>& depth) : DepthPicture(of_side) {
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) at(x, y) = depth(x, y);
    }
    [[nodiscard]] std::size_t place(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x);
    }
    float& at(int x, int y) { return depths[place(x, y)]; }
    [[nodiscard]] float at(int x, int y) const { return x >= 0 && y >= 0 && x < side && y < side ? depths[place(x, y)] : 0.0F; }
    [[nodiscard]] bool covered(int x, int y) const { return at(x, y) > 0 && std::isfinite(at(x, y)); }
    [[nodiscard]] int count() const {
        int covered_texels = 0;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) covered_texels += covered(x, y) ? 1 : 0;
        return covered_texels;
    }
};

/// A mesh, and the questions that are put to it.
class JudgedMesh {
public:
    explicit JudgedMesh(const DepthMesher& mesher) {
        const std::size_t skins = mesher.indices().size() / 3 - mesher.walls();
        for (std::size_t i = 0; i < skins; ++i) {
            std::array<DepthCorner, 3> triangle;
            for (std::size_t c = 0; c < 3; ++c) triangle[c] = mesher.corners()[mesher.indices()[3 * i + c]];
            const auto [left, right] = std::minmax({triangle[0].x, triangle[1].x, triangle[2].x});
            const auto [low, high] = std::minmax({triangle[0].y, triangle[1].y, triangle[2].y});
            for (auto y = static_cast<std::size_t>(low); y < static_cast<std::size_t>(high); ++y)
                for (auto x = static_cast<std::size_t>(left); x < static_cast<std::size_t>(right); ++x)
                    near_[grid * y + x].push_back(triangles_.size());
            triangles_.push_back(triangle);
        }
    }
    [[nodiscard]] std::size_t size() const { return triangles_.size(); }
    /// In texels.
    [[nodiscard]] double area() const {
        double sum = 0;
        for (const auto& t : triangles_) sum += 0.5 * std::abs(twice_area(t));
        return sum;
    }
    /// The inverse depth at `point`, by the one triangle that holds `in`. Nothing where none does, NaN where several do.
    [[nodiscard]] std::optional<double> depth_at(const dvec2& in, const dvec2& point) const {
        std::optional<double> found;
        for (const std::size_t i : near(in)) {
            const Corners& t = triangles_[i];
            const std::array<double, 3> w = weights(t, in);
            if (std::any_of(w.begin(), w.end(), [](double weight) { return weight < 0; })) continue;
            if (found) return std::numeric_limits<double>::quiet_NaN();
            const std::array<double, 3> v = weights(t, point);
            found = v[0] * t[0].inverse_depth + v[1] * t[1].inverse_depth + v[2] * t[2].inverse_depth;
        }
        return found;
    }
    /// The triangle that holds a point, by number; -1: none.
    [[nodiscard]] int triangle_at(const dvec2& in) const {
        for (const std::size_t i : near(in)) {
            const std::array<double, 3> w = weights(triangles_[i], in);
            if (std::all_of(w.begin(), w.end(), [](double weight) { return weight >= 0; })) return static_cast<int>(i);
        }
        return -1;
    }

private:
    using Corners = std::array<DepthCorner, 3>;
    static constexpr std::size_t grid = 64;
    [[nodiscard]] const std::vector<std::size_t>& near(const dvec2& in) const {
        return near_[grid * static_cast<std::size_t>(in.y) + static_cast<std::size_t>(in.x)];
    }
    static double twice_area(const Corners& t) {
        return 1.0 * (t[1].x - t[0].x) * (t[2].y - t[0].y) - 1.0 * (t[2].x - t[0].x) * (t[1].y - t[0].y);
    }
    static std::array<double, 3> weights(const Corners& t, const dvec2& p) {
        std::array<double, 3> w{};
        for (std::size_t i = 0; i < 3; ++i) {
            const DepthCorner &a = t[(i + 1) % 3], &b = t[(i + 2) % 3];
            w[i] = ((b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y)) / twice_area(t);
        }
        return w;
    }
    std::vector<Corners> triangles_;
    std::vector<std::vector<std::size_t>> near_ = std::vector<std::vector<std::size_t>>(grid * grid);  ///< by texel
};

constexpr std::uint32_t many = 20'000;
/// From the middle of a texel, so that a point lies in one triangle.
constexpr dvec2 beside(1e-4, 2.3e-4);

/// All that a mesh promises.
void expect_right(const DepthPicture& picture, float tolerance, const DepthMesher& mesher) {
    const JudgedMesh mesh(mesher);
    ASSERT_NEAR(mesh.area(), picture.count(), 1e-9) << "covered squares and nothing else";
    EXPECT_EQ(mesher.covered(), static_cast<std::uint32_t>(picture.count()));
    const double allowed = 1.0001 * static_cast<double>(tolerance) + 1e-7;
    const auto joined = [&](int x, int y, int to_x, int to_y) {
        return picture.covered(to_x, to_y) && std::abs(picture.at(x, y) - picture.at(to_x, to_y)) <= 2.0F / 3 * tolerance;
    };
    for (int y = 0; y < picture.side; ++y) {
        for (int x = 0; x < picture.side; ++x) {
            const dvec2 middle(x + 0.5, y + 0.5);
            const auto shown = mesh.depth_at(middle + beside, middle);
            ASSERT_EQ(shown.has_value(), picture.covered(x, y)) << x << ", " << y;
            if (!shown) continue;
            ASSERT_NEAR(*shown, static_cast<double>(picture.at(x, y)), allowed) << x << ", " << y;
            for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}}) {
                if (!picture.covered(x + dx, y + dy)) continue;
                const dvec2 line = middle + 0.5 * dvec2(dx, dy), along = 0.24 * dvec2(dy, dx), across = 0.01 * dvec2(dx, dy);
                if (!joined(x, y, x + dx, y + dy)) {
                    EXPECT_NE(mesh.triangle_at(line - across + along), mesh.triangle_at(line + across + along));
                    continue;
                }
                for (const double side : {-1.0, 1.0}) {
                    const auto before = mesh.depth_at(line - across + side * along, line + side * along);
                    const auto after = mesh.depth_at(line + across + side * along, line + side * along);
                    ASSERT_TRUE(before && after);
                    ASSERT_NEAR(*before, *after, 1e-5 * static_cast<double>(picture.at(x, y)) + 1e-7) << "a crack";
                }
            }
        }
    }
}

DepthMeshResult judged(const DepthPicture& picture, float tolerance, DepthMesher& mesher) {
    const auto result = mesher.make(picture.depths, static_cast<std::uint32_t>(picture.side), {tolerance, many});
    if (result == DepthMeshResult::made) expect_right(picture, tolerance, mesher);
    return result;
}

TEST(DepthMesh, OfAPlaneIsTwoTriangles) {
    DepthMesher mesher(64, many);
    const DepthPicture slope(64,
                             [](int x, int y) { return 0.2F + 0.001F * static_cast<float>(x) + 0.002F * static_cast<float>(y); });
    ASSERT_EQ(judged(slope, 0.01F, mesher), DepthMeshResult::made);
    EXPECT_LE(mesher.indices().size() / 3, 24U) << "at the sides a corner is a mean of what is inside";
    ASSERT_EQ(judged(DepthPicture(64, 0.25F), 1e-6F, mesher), DepthMeshResult::made);
    EXPECT_EQ(mesher.indices().size() / 3, 2U);
    EXPECT_EQ(mesher.corners().size(), 4U);
    EXPECT_EQ(mesher.walls(), 0U);
}

TEST(DepthMesh, OfNothingAOneAndWhatIsNoNumber) {
    DepthMesher mesher(16, many);
    EXPECT_EQ(judged(DepthPicture(16), 0.1F, mesher), DepthMeshResult::empty);
    EXPECT_TRUE(mesher.indices().empty());
    DepthPicture one(16);
    one.at(5, 11) = 0.5F;
    ASSERT_EQ(judged(one, 0.1F, mesher), DepthMeshResult::made);
    EXPECT_EQ(mesher.indices().size(), 6U);
    ASSERT_EQ(judged(DepthPicture(1, 0.5F), 0.1F, mesher), DepthMeshResult::made);
    EXPECT_EQ(mesher.indices().size(), 6U);
    DepthPicture bad(16, 0.5F);
    bad.at(3, 3) = std::numeric_limits<float>::quiet_NaN();
    bad.at(4, 3) = std::numeric_limits<float>::infinity();
    bad.at(5, 3) = -1;
    ASSERT_EQ(judged(bad, 0.1F, mesher), DepthMeshResult::made);
    EXPECT_EQ(mesher.covered(), 253U);
    for (const DepthCorner& corner : mesher.corners()) EXPECT_EQ(corner.inverse_depth, 0.5F);
}

TEST(DepthMesh, IsCutAtJumpsAndWallsShowWhatIsFarther) {
    DepthMesher mesher(32, many);
    const DepthPicture post(32, [](int x, int) { return x >= 10 && x < 13 ? 0.5F : 0.25F; });
    ASSERT_EQ(judged(post, 0.06F, mesher), DepthMeshResult::made);
    EXPECT_EQ(mesher.walls(), 2U * 2U * 32U);
    const std::size_t first = mesher.indices().size() - std::size_t{3} * mesher.walls();
    for (std::size_t i = 0; i < mesher.indices().size(); ++i) {
        const DepthCorner& corner = mesher.corners()[mesher.indices()[i]];
        EXPECT_TRUE(corner.inverse_depth == 0.5F || corner.inverse_depth == 0.25F) << "none between";
        if (i < first) continue;
        EXPECT_TRUE(corner.x == 10 || corner.x == 13);
        EXPECT_EQ(corner.at_x, corner.x == 10 ? 9.5F : 13.5F);
    }
    ASSERT_EQ(judged(post, 0.5F, mesher), DepthMeshResult::made);
    EXPECT_EQ(mesher.walls(), 0U) << "within the tolerance it is one skin";
}

/// A few skins with slopes, holes, noise and a step across.
DepthPicture any_depths(Random& random, int side) {
    const float low = static_cast<float>(random.range(0.1, 0.2)), slope = static_cast<float>(random.range(-0.1, 0.1)) / 64;
    const float noise = random.below(3) == 0 ? 0.03F : random.below(2) == 0 ? 0.001F : 0.0F;
    const auto holes = static_cast<std::uint32_t>(random.below(4) == 0 ? 2 : random.below(2) == 0 ? 40 : 1'000'000);
    const int cut = static_cast<int>(random.below(static_cast<std::uint32_t>(side))),
              period = 3 + static_cast<int>(random.below(20));
    return {side, [&](int x, int y) {
                if (random.below(holes) == 0) return 0.0F;
                const float wave = 0.02F * std::sin(static_cast<float>(x * x + y) / static_cast<float>(period * 7));
                const float step = x + y / 2 > cut && y > cut / 2 ? 0.05F : 0.0F;
                return low + slope * static_cast<float>(x + y) + wave + step + noise * static_cast<float>(random.range(-1, 1)) +
                       0.1F;
            }};
}

TEST(DepthMesh, StaysWithinItsToleranceWithoutCracksOverRandomDepths) {
    Random random(5);
    DepthMesher mesher(32, many);
    int made = 0;
    for (int i = 0; i < 40; ++i) {
        const DepthPicture picture = any_depths(random, i % 3 == 0 ? 8 : i % 3 == 1 ? 16 : 32);
        for (const float tolerance : {0.002F, 0.02F}) {
            made += judged(picture, tolerance, mesher) == DepthMeshResult::made ? 1 : 0;
            if (HasFatalFailure()) return;
        }
    }
    EXPECT_GT(made, 70);
}

TEST(DepthMesh, HasFewerTrianglesTheMoreErrorItMayHave) {
    DepthMesher mesher(64, many);
    const DepthPicture hill(64, [](int x, int y) {
        return 0.3F + 0.05F * std::cos(0.05F * static_cast<float>(x - 30)) * std::cos(0.05F * static_cast<float>(y - 20));
    });
    std::size_t before = many;
    for (const float tolerance : {0.004F, 0.008F, 0.03F}) {
        ASSERT_EQ(judged(hill, tolerance, mesher), DepthMeshResult::made);
        EXPECT_LT(mesher.indices().size() / 3, before / 2) << tolerance;
        before = mesher.indices().size() / 3;
    }
}

TEST(DepthMesh, OfNoiseIsTooDearAndNothingAllocates) {
    Random random(6);
    DepthMesher mesher(64, 500);
    const DepthPicture noise(64,
                             [&](int, int) { return random.below(2) == 0 ? 0.0F : static_cast<float>(random.range(0.1, 0.9)); });
    const DepthCorner* const corners = mesher.corners().data();
    const std::uint16_t* const indices = mesher.indices().data();
    EXPECT_EQ(mesher.make(noise.depths, 64, {0.001F, many}), DepthMeshResult::too_dear);
    EXPECT_TRUE(mesher.indices().empty());
    const DepthPicture flat(64, 0.5F);
    EXPECT_EQ(mesher.make(flat.depths, 64, {0.001F, 1}), DepthMeshResult::too_dear);
    EXPECT_EQ(mesher.make(flat.depths, 64, {0.001F, 2}), DepthMeshResult::made);
    EXPECT_EQ(mesher.corners().data(), corners);
    EXPECT_EQ(mesher.indices().data(), indices);
}

TEST(DepthMeshDeathTest, RefusesSidesThatAreNoPowerOfTwo) {
    DepthMesher mesher(16, many);
    const std::vector<float> depths(144, 0.5F);
    EXPECT_DEATH((void)mesher.make(depths, 12, {0.1F, many}), "power of two");
    EXPECT_DEATH((void)mesher.make(depths, 16, {0.1F, many}), "a depth for each texel");
}

TEST(DepthMesh, DisplacesNoPointByMoreThanThePlaneMay) {
    Random random(7);
    DepthMesher mesher(16, many);
    int compared = 0;
    double worst = 0;
    for (int i = 0; i < 200; ++i) {
        const auto of_box = picture_of(any_box(random), dvec3(0));
        if (!of_box || !(of_box->far_m > 1.001 * of_box->near_m)) continue;
        const Picture& picture = *of_box;
        const double share = random.below(3) == 0 ? 1.0 : random.range(0.1, 1);
        const auto depth_between = [&](double t) { return 1 / picture.far_m + t * (1 / picture.near_m - 1 / picture.far_m); };
        DepthPicture depths(16, [&](int x, int y) {
            return static_cast<float>(depth_between(0.5 + 0.5 * std::sin(0.3 * x + 0.2 * y * (i % 5)) * random.range(0.8, 1)));
        });
        const double tolerance = mesh_tolerance(picture, share);
        if (mesher.make(depths.depths, 16, {static_cast<float>(tolerance), many}) != DepthMeshResult::made) continue;
        const JudgedMesh mesh(mesher);
        for (int e = 0; e < 6; ++e) {
            const dvec3 eye = any_direction(random) * picture.near_m * random.range(0, 0.7);
            const double bound = picture_errors(picture, eye).total(), by_mesh = mesh_error(picture, tolerance, eye);
            if (!std::isfinite(bound)) continue;
            for (int p = 0; p < 20; ++p) {
                const int x = static_cast<int>(random.below(16)), y = static_cast<int>(random.below(16));
                const dvec2 middle(x + 0.5, y + 0.5);
                const auto shown = mesh.depth_at(middle + beside, middle);
                ASSERT_TRUE(shown);
                const dvec2 ray = (picture.low_m + middle * (picture.side_m / 16)) / picture.plane_m;
                if (glm::length(ray) > picture.tangent) continue;  // no point of the box is there
                const dvec3 along = picture.right * ray.x + picture.up * ray.y + picture.forward;
                const dvec3 a = along / static_cast<double>(depths.at(x, y)) - eye, b = along / *shown - eye;
                const double angle = std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
                ASSERT_LE(angle, 1.0001 * bound + 1e-6);
                ASSERT_LE(angle, 1.0001 * by_mesh + 1e-6);
                worst = std::max(worst, angle / (bound + 1e-6));
                ++compared;
            }
        }
    }
    EXPECT_GT(compared, 2000);
    EXPECT_GT(worst, 0.2) << "the bound means something";
}

}  // namespace
}  // namespace surefoot::cache
