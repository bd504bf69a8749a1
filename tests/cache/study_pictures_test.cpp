// What the studies draw: pictures of the cache beside the scene itself, and the times of frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tools/cache_study/study.hpp"

namespace surefoot::cache_study {
namespace {

/// Full colours: white where on, else black, in columns.
gl::PixelImage stripes(std::uint32_t width, std::uint32_t height, std::uint32_t from, std::uint32_t to) {
    gl::PixelImage image{width, height, std::vector<std::uint8_t>(std::size_t{4} * width * height, 0)};
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = from; x < to; ++x)
            for (std::size_t c = 0; c < 4; ++c) image.rgba[4 * (std::size_t{y} * width + x) + c] = 255;
    return image;
}

TEST(StudyPictures, AreRightUpToAPixelBesideTheScene) {
    const gl::PixelImage fine = stripes(64, 32, 24, 48);  // four samples a pixel: columns 6 to 12 of 16
    EXPECT_EQ(wrong_pixels(stripes(16, 8, 6, 12), fine).wrong, 0U);
    EXPECT_EQ(wrong_pixels(stripes(16, 8, 7, 13), fine).wrong, 0U);
    EXPECT_EQ(wrong_pixels(stripes(16, 8, 5, 11), fine).wrong, 0U);
    EXPECT_EQ(wrong_pixels(stripes(16, 8, 8, 14), fine).wrong, 2U * 6U) << "a column at each edge";
    EXPECT_EQ(wrong_pixels(stripes(16, 8, 0, 0), fine).wrong, 4U * 6U) << "nothing where all is white";
    EXPECT_EQ(wrong_pixels(stripes(16, 8, 6, 12), fine).pixels, 14U * 6U);
    EXPECT_EQ(wrong_pixels(stripes(15, 8, 6, 12), fine).pixels, 0U) << "not as often";
}

/// Whether nothing can draw here. Any other error is a failure.
bool is_absent(const Result<CheckedFrames>& checked) {
    if (checked) return false;
    EXPECT_EQ(checked.error().kind, ErrorKind::unsupported) << checked.error().text();
    return true;
}

CheckRequest narrow_view() {
    CheckRequest request;
    request.width = 128;
    request.height = 96;
    request.fov_y_rad = 0.5;  // a pixel at the corner is nearly as large as in the middle
    return request;
}

/// Posts at the near face of a cube below, and at its far face above: none hides another.
StudyScene posts(std::uint32_t levels, const dvec3& step_m) {
    StudyScene scene;
    const auto post = [&](double x, double low, double z) {
        const double high = low + 1.3, right = x + 0.22;
        scene.triangles.push_back({dvec3(x, low, z), dvec3(right, low, z), dvec3(right, high, z)});
        scene.triangles.push_back({dvec3(x, low, z), dvec3(right, high, z), dvec3(x, high, z)});
        for (int i = 0; i < 2; ++i) {
            scene.colours.push_back({});
            scene.objects.push_back(static_cast<std::uint32_t>(scene.triangles.size() / 2));
            scene.two_sided.push_back(true);
        }
    };
    for (int i = 0; i < 5; ++i) {
        post(-2 + 0.9 * i, -2, 2);
        post(-2 + 0.9 * i, 0.7, -2);
    }
    auto tree = cache::make_boxes(scene.triangles, {.branching = 8, .levels = levels});
    EXPECT_TRUE(tree);
    if (tree) scene.tree = std::move(*tree);
    for (int i = 0; i < 48; ++i) scene.eyes.push_back(dvec3(0, 0.1, 15) + static_cast<double>(i) * step_m);
    return scene;
}

TEST(StudyPictures, MayShowWhatTheyUncover) {
    StudyScene scene = posts(1, dvec3(0));
    for (std::size_t i = 0; i < 2; ++i) {  // a wall before all of it
        scene.triangles.push_back({dvec3(-9, -9, 3), dvec3(9, i == 0 ? -9 : 9, 3), dvec3(i == 0 ? 9 : -9, 9, 3)});
        scene.objects.push_back(6);  // white
    }
    gl::PixelImage image = stripes(128, 96, 0, 128);
    WrongPixels wrong{1, 1, std::vector<bool>(image.rgba.size() / 4)};
    Pose pose;
    pose.position = scene.eyes.front();
    pose.fov_y_rad = 0.5;
    // The first post is object 1, which is green, from -2 to -1.78: columns 35 to 38 of 128.
    const std::size_t at = 128 * 70 + 36, beside = 128 * 70 + 43;
    const std::array<std::uint8_t, 3> green = full_colour(1);
    for (const std::size_t i : {at, beside}) std::copy(green.begin(), green.end(), &image.rgba[4 * i]);
    wrong.at[at] = true;
    EXPECT_EQ(uncovered_pixels(scene, pose, image, wrong), 1U);
    wrong.at[at] = false;
    wrong.at[beside] = true;
    EXPECT_EQ(uncovered_pixels(scene, pose, image, wrong), 0U);
}

TEST(StudyPictures, StandWithinAPixelAndNotWithPlanesAtFarFacesOrByTheTestsOf1996) {
    const StudyScene aside = posts(1, {0.025, 0, 0}), across = posts(1, {0.0125, 0, -0.07});
    CheckRequest request = narrow_view();
    request.fov_y_rad = 0.35;
    request.every = 2;
    const auto checked = [&](const StudyScene& scene) {
        auto result = check_pictures(scene, request, {});
        EXPECT_TRUE(result);
        return result ? *result : CheckedFrames{};
    };
    if (const auto right = check_pictures(aside, request, {}); is_absent(right)) GTEST_SKIP() << right.error().text();
    for (const StudyScene& scene : {aside, across}) {
        const CheckedFrames right = checked(scene);
        EXPECT_EQ(right.frames, 24U);
        EXPECT_EQ(right.wrong, 0U);
        EXPECT_EQ(right.pictures, 24U);
        EXPECT_EQ(right.leaves, 0U);
    }
    EXPECT_LE(checked(posts(2, {0.025, 0, 0})).wrong, 2U) << "pictures of pictures: sampling moves an edge twice";
    request.plane = cache::PlanePlace::far_face;
    EXPECT_GT(checked(aside).wrong_frames, 2U);
    request.plane = cache::PlanePlace::harmonic_mean;
    request.rules = cache::ValidityRules::published;
    EXPECT_GT(checked(across).wrong, 20U);
}

TEST(StudyPictures, OfTheRoomAreRightByBoxAndWrongByObject) {
    const auto scene = make_study("room", 600);
    ASSERT_TRUE(scene);
    CheckRequest request = narrow_view();
    request.frames = 12;
    request.every = 4;
    const auto right = check_pictures(*scene, request, {});
    if (is_absent(right)) GTEST_SKIP() << right.error().text();
    EXPECT_EQ(right->wrong, 0U);
    EXPECT_GT(right->pictures, 15U);
    request.by_object = true;
    const auto by_object = check_pictures(*scene, request, {});
    ASSERT_TRUE(by_object);
    EXPECT_EQ(by_object->wrong_frames, 3U);
    EXPECT_GT(by_object->wrong, 300U) << "a table on a rug, books in the shelf";
}

TEST(StudyPictures, OfChairsUnderATableAreRightByBoxAndWrongByObject) {
    auto scene = make_study("room", 2);
    ASSERT_TRUE(scene);
    scene->eyes = {dvec3(5.6, 1.68, 4.5)};
    scene->forward = glm::normalize(dvec3(2.55, 0.55, 2.15) - scene->eyes.front());
    CheckRequest request = narrow_view();
    const auto right = check_pictures(*scene, request, {});
    if (is_absent(right)) GTEST_SKIP() << right.error().text();
    EXPECT_EQ(right->wrong, 0U);
    EXPECT_GT(right->pictures, 5U);
    request.by_object = true;
    const auto by_object = check_pictures(*scene, request, {});
    ASSERT_TRUE(by_object);
    EXPECT_GT(by_object->wrong, 50U) << "plates and fruit behind the picture of the table";
}

TEST(StudyPictures, OnMeshesStandWithinAPixelAndSoDoTheCheaperOnes) {
    CheckRequest request = narrow_view();
    request.kind = PictureKind::mesh;
    const auto scene = make_study("room", 600);
    ASSERT_TRUE(scene);
    request.frames = 8;
    request.every = 4;
    const auto room = check_pictures(*scene, request, {});
    if (is_absent(room)) GTEST_SKIP() << room.error().text();
    EXPECT_EQ(room->wrong, 0U);
    EXPECT_GT(room->meshes, 5U);
    request.fov_y_rad = 0.35;
    request.frames = 0;
    for (const dvec3& step : {dvec3(0.025, 0, 0), dvec3(0.0125, 0, -0.07)}) {
        const auto meshed = check_pictures(posts(1, step), request, {});
        ASSERT_TRUE(meshed);
        EXPECT_EQ(meshed->frames, 12U);
        EXPECT_EQ(meshed->meshes, 12U);
        EXPECT_EQ(meshed->wrong, 0U);
    }
    request.kind = PictureKind::cheaper;
    const auto of_posts = check_pictures(posts(1, {0.025, 0, 0}), request, {});
    ASSERT_TRUE(of_posts);
    EXPECT_EQ(of_posts->wrong, 0U);
    EXPECT_EQ(of_posts->pictures, 12U);
}

TEST(StudyMeshes, TakeTheKindThatCostsLess) {
    cache::Picture picture = *cache::picture_of({dvec3(-1, -1, -7), dvec3(1, 1, -5)}, dvec3(0));
    gl::CachePicture held;
    held.place.texels = 64;
    held.plane_m = picture.plane_m;
    held.side_m = picture.side_m;
    held.low_m = picture.low_m;
    held.box = {dvec3(-1, -1, -7), dvec3(1, 1, -5)};
    StudyMeshes meshes(2, PictureKind::cheaper);
    const auto fill = [&](cache::Index box, bool noise) {
        const std::span<float> depths = meshes.depths_of(box, 64);
        for (std::size_t i = 0; i < depths.size(); ++i)
            depths[i] = noise         ? (i * 2654435761U % 7 < 3 ? 0.0F : 0.75F + 0.03F * static_cast<float>(i % 7))
                        : i % 64 < 32 ? 0.8F
                                      : 0;
    };
    const StudyMeshes::Seen seen{8192, 1};
    fill(0, false);
    fill(1, true);
    EXPECT_TRUE(meshes.shows(0, held, picture, seen)) << "half of it is empty, and the rest a plane";
    EXPECT_LE(meshes.mesh(0, held).indices.size(), 12U);
    EXPECT_FALSE(meshes.shows(1, held, picture, seen)) << "foliage";
    EXPECT_FALSE(meshes.shows(0, held, picture, {100, 1})) << "from another eye";
    const MeshCounts counts = meshes.take_counts();
    EXPECT_EQ(counts.made, 1U);
    EXPECT_EQ(counts.too_dear, 1U);
    meshes.drop(0);
    EXPECT_FALSE(meshes.shows(0, held, picture, seen)) << "of pictures: it has no depths";
    EXPECT_FALSE(StudyMeshes(1, PictureKind::quad).any());
}

TEST(StudyPictures, AreDrawnAndTimedWhereADeviceIs) {
    StudyRequest request;
    request.study = "room";
    request.frames = 2;
    const auto counted = run_study(request, {});
    ASSERT_TRUE(counted);
    EXPECT_FALSE(counted->no_times.empty());
    EXPECT_FALSE(counted->corrected.front().times);
    request.backend = gl::BackendKind::egl;
    request.width = 160;
    request.height = 120;
    const auto drawn = run_study(request, {});
    ASSERT_TRUE(drawn);
    if (!drawn->no_times.empty()) {
        const auto scene = make_study("room", 2);
        ASSERT_TRUE(scene);
        ASSERT_TRUE(is_absent(check_pictures(*scene, narrow_view(), {}))) << drawn->no_times;
        GTEST_SKIP() << drawn->no_times;
    }
    for (const StudyFrame& frame : drawn->corrected) {
        ASSERT_TRUE(frame.times);
        EXPECT_GT(frame.times->cached.ms, 0);
        EXPECT_GT(frame.times->full.ms, 0);
        EXPECT_GT(frame.times->cached.cpu_ms, 0);
        EXPECT_GT(frame.times->pictures + frame.times->leaves, 0U);
    }
    const StudySums sums = sums_of(drawn->corrected);
    EXPECT_EQ(sums.drawn, 2U);
    EXPECT_GT(sums.full.ms, 0);
    EXPECT_LE(sums.faster, 2U);
    EXPECT_TRUE(drawn->views.empty());
}

TEST(StudyPicturesAtNight, OfTheForestAreWrongOnlyWhereSomethingHiddenComesForth) {
    const auto scene = make_study("forest", 1776);
    ASSERT_TRUE(scene);
    CheckRequest request = narrow_view();
    request.first = 800;
    request.frames = 100;
    request.every = 9;
    const auto right = check_pictures(*scene, request, {});
    if (is_absent(right)) GTEST_SKIP() << right.error().text();
    EXPECT_EQ(right->wrong, right->uncovered);
    EXPECT_LE(right->wrong, right->pixels / 10'000);
    request.by_object = true;
    const auto by_object = check_pictures(*scene, request, {});
    ASSERT_TRUE(by_object);
    EXPECT_GT(by_object->wrong, 10 * std::max<std::uint64_t>(1, right->wrong));
}

}  // namespace
}  // namespace surefoot::cache_study
