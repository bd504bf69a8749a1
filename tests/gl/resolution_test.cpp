// Frames below full resolution: the right steps, enlarged without a shift and without colours from outside of the picture.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/model/resolution.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

TEST(ResolutionStep, is_the_largest_that_is_not_above_what_is_wanted) {
    const auto drawn = [](float wanted) { return model::resolution_steps[model::resolution_step(wanted)]; };
    EXPECT_EQ(drawn(1), 1);
    EXPECT_EQ(drawn(0.99F), 0.875F);
    EXPECT_EQ(drawn(0.875F), 0.875F);
    EXPECT_EQ(drawn(0.8F), 0.75F);
    EXPECT_EQ(drawn(0.5F), 0.5F);
}

TEST(ResolutionStep, is_whole_for_nonsense_and_the_least_below_it) {
    const auto drawn = [](float wanted) { return model::resolution_steps[model::resolution_step(wanted)]; };
    EXPECT_EQ(drawn(std::numeric_limits<float>::quiet_NaN()), 1);
    EXPECT_EQ(drawn(0), 1);
    EXPECT_EQ(drawn(-3), 1);
    EXPECT_EQ(drawn(std::numeric_limits<float>::infinity()), 1);
    EXPECT_EQ(drawn(1e-9F), 0.5F);
}

TEST(ResolutionStep, sizes_are_never_empty) {
    for (std::size_t step = 0; step < model::resolution_steps.size(); ++step) {
        const model::Viewport size = model::viewport_of_step({1, 1}, step);
        EXPECT_EQ(size.width, 1U);
        EXPECT_EQ(size.height, 1U);
    }
    EXPECT_EQ(model::viewport_of_step({1280, 720}, 2).width, 960U);
}

Pose looking() {
    Pose pose;
    pose.fov_y_rad = 1.5707963267948966;
    return pose;
}

Result<std::unique_ptr<gl::Device>> open_at(model::Viewport size, std::array<float, 3> sky = {0, 0, 1}) {
    gl::DeviceOptions options;
    options.viewport = size;
    options.max_items = 4096;
    options.sky = sky;
    return gl::open_device(options);
}

gl::PixelImage drawn(gl::Device& device, const std::vector<gl::DrawItem>& items, float resolution) {
    device.draws.plays();
    device.begin_frame(looking(), resolution);
    device.draw(items);
    device.end_slice();
    device.wait_slices(1);
    device.end_items();
    device.finish_frame();
    auto image = device.read_pixels();
    EXPECT_TRUE(image.ok());
    return image.ok() ? *image : gl::PixelImage{};
}

/// Bilinear, pixel centre on pixel centre, clamped at the edges.
gl::PixelImage enlarged(const gl::PixelImage& small, std::uint32_t width, std::uint32_t height) {
    gl::PixelImage out;
    out.width = width;
    out.height = height;
    out.rgba.resize(4ULL * width * height);
    const auto at = [&](double x, double y, std::size_t channel) {
        const auto cx = static_cast<std::size_t>(std::clamp(x, 0.0, small.width - 1.0));
        const auto cy = static_cast<std::size_t>(std::clamp(y, 0.0, small.height - 1.0));
        return static_cast<double>(small.rgba[4 * (cy * small.width + cx) + channel]);
    };
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const double u = (x + 0.5) * small.width / width - 0.5, v = (y + 0.5) * small.height / height - 0.5;
            const double fu = u - std::floor(u), fv = v - std::floor(v), iu = std::floor(u), iv = std::floor(v);
            for (std::size_t c = 0; c < 4; ++c) {
                const double top = (1 - fu) * at(iu, iv, c) + fu * at(iu + 1, iv, c);
                const double low = (1 - fu) * at(iu, iv + 1, c) + fu * at(iu + 1, iv + 1, c);
                out.rgba[4 * (static_cast<std::size_t>(y) * width + x) + c] =
                    static_cast<std::uint8_t>(std::lround((1 - fv) * top + fv * low));
            }
        }
    }
    return out;
}

int worst_difference(const gl::PixelImage& a, const gl::PixelImage& b) {
    int worst = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) worst = std::max(worst, std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
    return worst;
}

double psnr_db(const gl::PixelImage& a, const gl::PixelImage& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::pow(int{a.rgba[i]} - int{b.rgba[i]}, 2);
    return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.rgba.size()) / std::max(sum, 1e-9));
}

constexpr model::Viewport whole{160, 96};  // each step is a whole number of pixels

// Blended squares are in the scene: they too are drawn at the step.
TEST(Resolution, a_frame_at_each_step_is_the_small_picture_enlarged_to_the_pixel) {
    std::vector<gl::DrawItem> items;
    const auto model = test::mixed_scene(items);
    auto device = open_at(whole);
    if (!device) GTEST_SKIP() << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(model, effects::assemble_program).ok());
    for (std::size_t step = 1; step < model::resolution_steps.size(); ++step) {
        const auto picture = drawn(**device, items, model::resolution_steps[step]);
        EXPECT_EQ((*device)->stats().resolution, model::resolution_steps[step]);
        auto small = open_at(model::viewport_of_step(whole, step));
        ASSERT_TRUE(small.ok());
        (*small)->draws.plays();
        ASSERT_TRUE((*small)->load(model, effects::assemble_program).ok());
        const auto expected = enlarged(drawn(**small, items, 1), whole.width, whole.height);
        ASSERT_EQ(picture.rgba.size(), expected.rgba.size());
        EXPECT_LE(worst_difference(picture, expected), 3) << "step " << step;  // filters of drivers have few bits
        (*device)->bind();
    }
}

// A software driver's picture is enlarged by the processor, others by a pass.
TEST(Resolution, a_pass_enlarges_as_the_processor_does) {
    std::vector<gl::DrawItem> items;
    const auto model = test::mixed_scene(items);
    std::vector<gl::PixelImage> pictures;
    for (const bool by_processor : {true, false}) {
        gl::DeviceOptions options;
        options.viewport = whole;
        options.max_items = 4096;
        options.processor_enlarges = by_processor;
        auto device = gl::open_device(options);
        if (!device && pictures.empty()) GTEST_SKIP() << device.error().text();
        ASSERT_TRUE(device.ok()) << device.error().text();
        (*device)->draws.plays();
        ASSERT_TRUE((*device)->load(model, effects::assemble_program).ok());
        pictures.push_back(drawn(**device, items, 0.5F));
    }
    EXPECT_LE(worst_difference(pictures[0], pictures[1]), 3);
}

TEST(Resolution, half_is_near_the_whole_picture_and_farther_where_it_is_shifted_by_a_pixel) {
    std::vector<gl::DrawItem> items;
    const auto model = test::mixed_scene(items);
    auto device = open_at(whole);
    if (!device) GTEST_SKIP() << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(model, effects::assemble_program).ok());
    const auto full = drawn(**device, items, 1), half = drawn(**device, items, 0.5F);
    const double here_db = psnr_db(half, full);
    for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        gl::PixelImage moved = half;
        for (int y = 0; y < static_cast<int>(whole.height); ++y) {
            for (int x = 0; x < static_cast<int>(whole.width); ++x) {
                const int sx = std::clamp(x + dx, 0, static_cast<int>(whole.width) - 1);
                const int sy = std::clamp(y + dy, 0, static_cast<int>(whole.height) - 1);
                std::copy_n(&half.rgba[4 * (static_cast<std::size_t>(sy) * whole.width + static_cast<std::size_t>(sx))], 4,
                            &moved.rgba[4 * (static_cast<std::size_t>(y) * whole.width + static_cast<std::size_t>(x))]);
            }
        }
        EXPECT_GT(here_db, psnr_db(moved, full) + 0.5) << dx << " " << dy;
    }
}

TEST(Resolution, edges_hold_no_colour_from_outside_of_the_picture_nor_of_earlier_frames) {
    test::SmallModel scene;
    const auto far = scene.square(scene.material(test::plain(1, 0, 0)), test::at(0, 0, -1), 5);
    const auto model = scene.finish();
    auto device = open_at({101, 67}, {0, 1, 0});  // steps are no whole number of pixels
    if (!device) GTEST_SKIP() << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(model, effects::assemble_program).ok());
    for (const float resolution : model::resolution_steps) {
        drawn(**device, {}, resolution);  // the sky
        const auto picture = drawn(**device, {{far, model.nodes[far].first_rep}}, resolution);
        for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
            ASSERT_TRUE(picture.rgba[i] == 255 && picture.rgba[i + 1] == 0) << resolution << " pixel " << i / 4;
    }
}

TEST(Resolution, a_whole_frame_after_a_small_one_is_as_before) {
    std::vector<gl::DrawItem> items;
    const auto model = test::mixed_scene(items);
    auto device = open_at(whole);
    if (!device) GTEST_SKIP() << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(model, effects::assemble_program).ok());
    const auto before = drawn(**device, items, 1);
    const auto small = drawn(**device, items, 0.5F);
    EXPECT_NE(small.rgba, before.rgba);
    EXPECT_EQ(drawn(**device, items, 1).rgba, before.rgba);
}

}  // namespace
}  // namespace surefoot
