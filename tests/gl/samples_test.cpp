// Several samples a pixel, and the texture filter: what of the picture they change.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "render/effects/effects.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

constexpr model::Viewport samples_size{160, 96};

struct QualityScene {
    model::Model model;
    std::vector<gl::DrawItem> items;
};

Pose straight_ahead() {
    Pose pose;
    pose.fov_y_rad = 1.5707963267948966;
    return pose;
}

/// White before a black sky: a square that is turned about the view direction.
QualityScene turned_square(bool alpha_tested) {
    test::SmallModel scene;
    model::Material material = test::plain(1, 1, 1);
    if (alpha_tested) {
        material.texture = scene.texture({255, 255, 255, 255}, {255, 255, 255, 0}, 64);
        scene.model().textures.back().clamp = 1;  // else the far side bleeds in at its edges
        material.effects = model::effect_texture | model::effect_alpha_mask;
    }
    const mat3 turn(glm::mat3_cast(glm::angleAxis(0.3F, vec3(0, 0, 1))));
    const auto node = scene.square(scene.material(material), test::at(0, 0, -2, turn));
    return {scene.finish(), {{node, node - 1}}};
}

std::unique_ptr<gl::Device> opened(const QualityScene& scene, const gl::DeviceOptions& options) {
    auto device = gl::open_device(options);
    if (!device) return nullptr;
    (*device)->draws.plays();
    EXPECT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    return std::move(*device);
}

std::unique_ptr<gl::Device> opened(const QualityScene& scene, std::uint32_t samples, bool rest = false) {
    gl::DeviceOptions options;
    options.viewport = samples_size;
    options.sky = {0, 0, 0};
    options.samples = samples;
    options.rest = rest;
    return opened(scene, options);
}

gl::PixelImage frame_of(gl::Device& device, const QualityScene& scene, float resolution = 1) {
    device.draws.plays();
    device.bind();
    device.begin_frame(straight_ahead(), resolution);
    device.draw(scene.items);
    device.end_slice();
    device.end_items();
    device.finish_frame();
    auto image = device.read_pixels();
    EXPECT_TRUE(image.ok());
    device.release();
    return image.ok() ? *image : gl::PixelImage{};
}

int red_at(const gl::PixelImage& image, int x, int y) {
    const int w = static_cast<int>(image.width), h = static_cast<int>(image.height);
    x = std::clamp(x, 0, w - 1);
    y = std::clamp(y, 0, h - 1);
    return image.rgba[4 * static_cast<std::size_t>(y * w + x)];
}

/// Both colours are within a pixel of (x, y).
bool near_edge(const gl::PixelImage& image, int x, int y) {
    int least = 255, most = 0;
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            least = std::min(least, red_at(image, x + dx, y + dy));
            most = std::max(most, red_at(image, x + dx, y + dy));
        }
    }
    return least == 0 && most == 255;
}

TEST(Samples, change_edges_only_and_an_edge_is_between_its_two_colours) {
    for (const bool alpha_tested : {false, true}) {
        const QualityScene scene = turned_square(alpha_tested);
        const auto plain = opened(scene, 1);
        if (!plain) GTEST_SKIP() << "no EGL";
        const auto one = frame_of(*plain, scene);
        const auto smooth = opened(scene, 4);
        ASSERT_TRUE(smooth);
        EXPECT_EQ(plain->samples(), 1U);
        if (smooth->samples() == 1) GTEST_SKIP() << "the driver has no samples";
        const auto four = frame_of(*smooth, scene);
        smooth->draws.plays();
        EXPECT_EQ(smooth->stats().samples, smooth->samples());
        int edges = 0, between = 0, within = 0;  // the square's middle: there the alpha test is the only edge
        double sum_one = 0, sum_four = 0;
        for (int y = 0; y < 96; ++y) {
            for (int x = 0; x < 160; ++x) {
                const int before = red_at(one, x, y), after = red_at(four, x, y);
                ASSERT_TRUE(before == 0 || before == 255);
                const bool edge = near_edge(one, x, y);
                ASSERT_TRUE(edge || before == after) << x << " " << y;
                edges += edge ? 1 : 0;
                const bool mixed = after > 20 && after < 235;
                between += mixed ? 1 : 0;
                within += mixed && std::abs(x - 80) < 12 && std::abs(y - 48) < 12 ? 1 : 0;
                sum_one += before;
                sum_four += after;
                ASSERT_EQ(four.rgba[4 * static_cast<std::size_t>(y * 160 + x) + 3], 255) << "the picture is opaque";
            }
        }
        EXPECT_GT(between, edges / 8) << (alpha_tested ? "alpha-tested" : "geometry");
        EXPECT_EQ(within > 5, alpha_tested) << within;
        EXPECT_NEAR(sum_four / sum_one, 1.0, 0.03) << "the surface keeps its size";
    }
}

TEST(Samples, are_resolved_before_a_smaller_picture_is_enlarged) {
    const QualityScene scene = turned_square(false);
    const auto plain = opened(scene, 1), smooth = opened(scene, 4);
    if (!plain || smooth->samples() == 1) GTEST_SKIP() << "no EGL with samples";
    for (const float resolution : model::resolution_steps) {
        const auto one = frame_of(*plain, scene, resolution), four = frame_of(*smooth, scene, resolution);
        double sum_one = 0, sum_four = 0, squares = 0;
        for (std::size_t i = 0; i < one.rgba.size(); i += 4) {
            sum_one += one.rgba[i];
            sum_four += four.rgba[i];
            squares += std::pow(int{one.rgba[i]} - int{four.rgba[i]}, 2);
        }
        EXPECT_NE(one.rgba, four.rgba) << resolution;
        EXPECT_NEAR(sum_four / sum_one, 1.0, 0.05) << resolution;
        EXPECT_LT(std::sqrt(squares / (160 * 96)), 40) << resolution << ": the same picture";
    }
}

TEST(Samples, of_a_picture_at_rest_are_those_of_a_frame) {
    std::vector<gl::DrawItem> items;
    const model::Model mixed = test::mixed_scene(items);
    const QualityScene scene{mixed, items};
    const auto device = opened(scene, 4, true);
    if (!device || device->samples() == 1) GTEST_SKIP() << "no EGL with samples";
    const auto frame = frame_of(*device, scene);
    device->draws.plays();
    device->bind();
    ASSERT_NE(device->rest_support(), gl::RestSupport::none);
    device->begin_frame(straight_ahead());  // an empty picture is shown
    device->finish_frame();
    device->begin_rest(straight_ahead(), dvec2(0));
    device->draw_rest(scene.items, gl::Parts::opaque);
    device->draw_rest(scene.items, gl::Parts::blended);
    device->show_rest(1);
    device->finish_rest_frame();
    const auto rested = device->read_pixels();
    ASSERT_TRUE(rested.ok());
    EXPECT_EQ(rested->rgba, frame.rgba);
    device->add_sample(true);
    device->add_sample(false);
    device->show_rest(2);
    device->finish_rest_frame();
    const auto mean = device->read_pixels();
    ASSERT_TRUE(mean.ok());
    int worst = 0;
    for (std::size_t i = 0; i < frame.rgba.size(); ++i)
        worst = std::max(worst, std::abs(int{mean->rgba[i]} - int{frame.rgba[i]}));
    EXPECT_LE(worst, 1) << "the mean of equal samples";
}

TEST(Filter, trilinear_blends_two_mip_levels_and_bilinear_shows_one) {
    test::SmallModel small;
    model::Material material = test::plain(1, 1, 1);
    material.texture = small.texture({255, 255, 255, 255}, {255, 255, 255, 255}, 64);
    material.effects = model::effect_texture;
    const auto node = small.square(small.material(material), test::at(0, 0, -2.12));  // 45 pixels: half way from level 0 to 1
    QualityScene scene{small.finish(), {{node, node - 1}}};
    const auto first = scene.model.texels.begin() + static_cast<std::ptrdiff_t>(scene.model.textures[0].first_byte);
    std::fill(first + 4 * 64 * 64, scene.model.texels.end(), std::byte{0});  // levels 1 and up are black
    const auto middle = [&](rt::TextureFilter filter, rt::TextureFilter& drawn) {
        gl::DeviceOptions options;
        options.viewport = samples_size;
        options.filter = filter;
        const auto device = opened(scene, options);
        if (!device) return -1;
        drawn = device->filter();
        return red_at(frame_of(*device, scene), 80, 48);
    };
    rt::TextureFilter drawn{};
    const int blended = middle(rt::TextureFilter::trilinear, drawn);
    if (blended < 0) GTEST_SKIP() << "no EGL";
    EXPECT_EQ(drawn, rt::TextureFilter::trilinear);
    EXPECT_NEAR(blended, 128, 40);
    const int nearest = middle(rt::TextureFilter::bilinear, drawn);
    EXPECT_EQ(drawn, rt::TextureFilter::bilinear);
    EXPECT_TRUE(nearest == 0 || nearest == 255) << nearest;
    gl::DeviceOptions options;
    options.viewport = samples_size;
    options.second_filter = true;
    const auto device = opened(scene, options);
    device->draws.plays();
    if (device->switches_filter()) {
        EXPECT_EQ(device->filter(), rt::TextureFilter::bilinear);
        for (const auto filter : {rt::TextureFilter::trilinear, rt::TextureFilter::bilinear, rt::TextureFilter::trilinear}) {
            device->bind();
            device->set_filter(filter);
            const bool two = filter == rt::TextureFilter::trilinear;
            EXPECT_EQ(red_at(frame_of(*device, scene), 80, 48), two ? blended : nearest) << "from picture to picture";
            device->draws.plays();
            EXPECT_EQ(device->stats().filter, filter);
        }
    }
    options.second_filter = false;
    EXPECT_FALSE(opened(scene, options)->switches_filter());
    const int automatic = middle(rt::TextureFilter::automatic, drawn);
    EXPECT_NE(drawn, rt::TextureFilter::automatic);
    EXPECT_EQ(automatic, drawn == rt::TextureFilter::trilinear ? blended : nearest);
}

TEST(Filter, a_smaller_picture_shows_the_mip_levels_of_the_whole_one) {
    test::SmallModel small;
    model::Material material = test::plain(1, 1, 1);
    material.texture = small.texture({255, 255, 255, 255}, {255, 255, 255, 255}, 64);
    material.effects = model::effect_texture;
    const auto node = small.square(small.material(material), test::at(0, 0, -1.7));  // 56 pixels: level 0
    QualityScene scene{small.finish(), {{node, node - 1}}};
    const auto first = scene.model.texels.begin() + static_cast<std::ptrdiff_t>(scene.model.textures[0].first_byte);
    std::fill(first + 4 * 64 * 64, scene.model.texels.end(), std::byte{0});  // levels 1 and up are black
    gl::DeviceOptions options;
    options.viewport = samples_size;
    options.filter = rt::TextureFilter::bilinear;
    options.rest = true;
    for (const bool smaller : {false, true}) {
        options.smaller = smaller;
        const auto device = opened(scene, options);
        if (!device) GTEST_SKIP() << "no EGL";
        EXPECT_EQ(red_at(frame_of(*device, scene), 80, 48), 255);
        EXPECT_EQ(red_at(frame_of(*device, scene, 0.5F), 80, 48), smaller ? 255 : 0);
        EXPECT_EQ(red_at(frame_of(*device, scene, 0.625F), 80, 48), smaller ? 255 : 0);
        const gl::PixelImage full = frame_of(*device, scene);
        EXPECT_EQ(red_at(full, 80, 48), 255);
        frame_of(*device, scene, 0.5F);
        device->draws.plays();
        device->bind();
        if (device->rest_support() == gl::RestSupport::none) continue;
        device->begin_rest(straight_ahead(), dvec2(0));
        device->draw_rest(scene.items, gl::Parts::all);
        device->show_rest(1);
        device->finish_rest_frame();
        const auto rested = device->read_pixels();
        ASSERT_TRUE(rested.ok());
        EXPECT_EQ(rested->rgba, full.rgba) << "at rest, after a smaller picture";
    }
}

}  // namespace
}  // namespace surefoot
