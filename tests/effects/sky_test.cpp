// The sky against its formula, worked out pixel by pixel in double from the page; that all else is drawn over it, that fog meets
// it, and that every kind of picture has it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/backends.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

using gl::BackendKind;

constexpr model::Viewport sky_picture{64, 64};
/// Of 255: up to half a step is added or taken, so that no steps show, and the sum is rounded.
constexpr double sky_steps = 1.2;
constexpr double in_rad = 3.14159265358979 / 180;

double ramp(double from, double to, double value) {
    const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

/// The page's formula, in the light of a moment.
dvec3 reference_sky(const dvec3& direction, const model::Daylight& light) {
    const dvec3 horizon = dvec3(light.background) * dvec3(model::usual_sky[0], model::usual_sky[1], model::usual_sky[2]);
    const dvec3 zenith = horizon * dvec3(0.45, 0.62, 0.92), towards_sun(light.sun_direction);
    const double up = std::max(0.0, direction.y), low = std::pow(1 - up, 3);
    const double s = std::max(0.0, glm::dot(direction, towards_sun)), chord = glm::length(direction - towards_sun);
    const double disc = 1 - ramp(5.9e-5, 9.9e-5, chord * chord);
    const double red = static_cast<double>(light.sun_light.r);  // never less than green and blue
    const dvec3 sun = red > 0 ? dvec3(light.sun_light) / std::sqrt(0.56 * red) : dvec3(0.0);
    const double height_deg = std::asin(std::clamp(towards_sun.y, -1.0, 1.0)) / in_rad;
    const dvec3 dusk = ramp(-8, 0, height_deg) * (1 - ramp(2, 20, height_deg)) * dvec3(0.55, 0.22, 0.02);
    const dvec3 glow = sun * (disc + 0.3 * std::pow(s, 256) + 0.12 * std::pow(s, 8)) + dusk * (low * low * std::pow(s, 4));
    const double haze = std::max(1e-6, 50.0 * static_cast<double>(light.fog_density));
    return glm::clamp(horizon + up / (up + haze) * ((1 - low) * (zenith - horizon) + ramp(0, 0.06, up) * glow), 0.0, 1.0);
}

Pose eye_towards(const dvec3& direction, double fov_y_rad = 1.1) {
    Pose pose;
    pose.position = {4000, 20, -7000};
    pose.orientation = glm::quatLookAt(glm::normalize(direction), std::abs(direction.y) > 0.99 ? dvec3(0, 0, 1) : dvec3(0, 1, 0));
    pose.fov_y_rad = fov_y_rad;
    return pose;
}

dvec3 direction_of(const Pose& pose, std::uint32_t x, std::uint32_t y) {
    const double half = std::tan(0.5 * pose.fov_y_rad);
    const double across = half * ((2.0 * x + 1) / sky_picture.width - 1), up = half * (1 - (2.0 * y + 1) / sky_picture.height);
    return glm::normalize(pose.forward() + across * pose.right() + up * pose.up());
}

/// Towards the compass bearing of the sun, or another way round the vertical.
dvec3 beside_sun(const model::Daylight& light, double height_rad, double turned_rad = 0) {
    const double bearing = std::atan2(static_cast<double>(light.sun_direction.z), static_cast<double>(light.sun_direction.x));
    return {std::cos(height_rad) * std::cos(bearing + turned_rad), std::sin(height_rad),
            std::cos(height_rad) * std::sin(bearing + turned_rad)};
}

int channel(const gl::PixelImage& image, std::uint32_t x, std::uint32_t y, std::size_t c) {
    return image.rgba[4 * (std::size_t{y} * image.width + x) + c];
}

/// The largest difference of two pictures in a channel.
int worst_of(const gl::PixelImage& a, const gl::PixelImage& b) {
    int worst = a.rgba.size() == b.rgba.size() ? 0 : 255;
    for (std::size_t i = 0; i < std::min(a.rgba.size(), b.rgba.size()); ++i)
        worst = std::max(worst, std::abs(int{a.rgba[i]} - int{b.rgba[i]}));
    return worst;
}

/// A red square, and a blue pane before the sky beside it. The eye of eye_towards(-z) sees both.
model::Model with_sky(bool sky = true) {
    test::SmallModel scene;
    scene.square(scene.material(test::plain(1, 0, 0)), test::at(3998.5, 20, -7005), 1);
    scene.square(scene.material(test::plain(0, 0, 1, 0.5F, model::effect_blend)), test::at(4001.5, 20, -7005), 1);
    scene.model().effects.push_back({model::effect_sky, sky, 0, "by hand", true});
    return scene.finish();
}

class Skies : public ::testing::TestWithParam<BackendKind> {
protected:
    void SetUp() override { open({}); }
    void open(gl::DeviceOptions options) {
        options.kind = GetParam();
        options.viewport = sky_picture;
        options.max_items = 256;
        auto device = gl::open_device(options);
        const bool absent = !device.ok() && device.error().kind == ErrorKind::unsupported;
        if (absent) GTEST_SKIP() << device.error().text();
        ASSERT_TRUE(device.ok()) << device.error().text();
        device_ = std::move(*device);
    }
    void load(const model::Model& model) {
        device_->draws.plays();
        device_->bind();
        ASSERT_TRUE(device_->load(model, effects::assemble_program).ok());
    }
    void set_light(const model::Daylight& light) {
        device_->draws.plays();
        device_->set_light(light);
    }
    gl::PixelImage read() {
        device_->draws.plays();
        auto image = device_->read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? *image : gl::PixelImage{64, 64, std::vector<std::uint8_t>(std::size_t{4} * 64 * 64)};
    }
    gl::PixelImage picture(const Pose& pose, const std::vector<gl::DrawItem>& items = {}, float resolution = 1) {
        device_->draws.plays();
        device_->begin_frame(pose, resolution);
        device_->draw(items);
        device_->end_slice();
        device_->end_items();
        device_->finish_frame();
        return read();
    }
    /// The picture at rest, moved by so many pixels.
    gl::PixelImage rest_picture(const Pose& pose, const dvec2& moved_px) {
        device_->draws.plays();
        device_->begin_rest(pose, moved_px);
        device_->draw_rest({}, gl::Parts::all);
        device_->show_rest(1);
        device_->finish_rest_frame();
        return read();
    }
    static double worst_off(const gl::PixelImage& image, const Pose& pose, const model::Daylight& light) {
        double worst = 0;
        for (std::uint32_t y = 0; y < sky_picture.height; ++y)
            for (std::uint32_t x = 0; x < sky_picture.width; ++x) {
                const dvec3 expected = 255.0 * reference_sky(direction_of(pose, x, y), light);
                for (int c = 0; c < 3; ++c)
                    worst = std::max(worst, std::abs(channel(image, x, y, static_cast<std::size_t>(c)) - expected[c]));
            }
        return worst;
    }
    std::unique_ptr<gl::Device> device_;
};

TEST_P(Skies, are_as_the_page_says_at_every_hour) {
    load(with_sky());
    model::LightFacts clear, hazy;
    hazy.fog_visibility_m = 600;
    for (const model::LightFacts& facts : {clear, hazy})
        for (const double hour : {3.8, 4.6, 8.0, 12.0, 18.0, 20.2, 23.0}) {
            const model::Daylight light = model::daylight_at(hour, facts);
            set_light(light);
            std::vector<Pose> poses{eye_towards(beside_sun(light, 0.1)), eye_towards(beside_sun(light, 0.3, 2.5)),
                                    eye_towards(beside_sun(light, -0.4, 1)), eye_towards({0, 1, 0}, 2.2)};
            if (light.sun_direction.y > 0) poses.push_back(eye_towards(dvec3(light.sun_direction), 0.1));
            for (std::size_t i = 0; i < poses.size(); ++i)
                EXPECT_LE(worst_off(picture(poses[i]), poses[i], light), sky_steps) << hour << " h, pose " << i;
        }
}

TEST_P(Skies, have_a_sun_a_degree_wide_by_day) {
    load(with_sky());
    const model::Daylight noon = model::daylight_at(12, {});
    set_light(noon);
    const Pose at_sun = eye_towards(dvec3(noon.sun_direction), 6 * in_rad);
    const gl::PixelImage image = picture(at_sun);
    std::size_t white = 0;
    for (std::uint32_t y = 0; y < sky_picture.height; ++y)
        for (std::uint32_t x = 0; x < sky_picture.width; ++x) white += channel(image, x, y, 0) == 255 ? 1 : 0;
    EXPECT_NEAR(std::sqrt(static_cast<double>(white) * 4 / 3.14159) * 6 / 64, 1.0, 0.15) << "its width in degrees";
    EXPECT_EQ(channel(image, 32, 32, 0), 255);
    EXPECT_LT(channel(image, 32, 2, 0), 250);
}

TEST_P(Skies, are_dark_by_night_and_have_no_sun) {
    load(with_sky());
    const model::Daylight night = model::daylight_at(0.5, {});
    set_light(night);
    ASSERT_LT(night.sun_direction.y, 0);
    for (const double height_rad : {-0.5, 0.1, 0.7}) {
        const gl::PixelImage to_sun = picture(eye_towards(beside_sun(night, height_rad)));
        const gl::PixelImage away = picture(eye_towards(beside_sun(night, height_rad, 3.14159)));
        EXPECT_LE(worst_of(to_sun, away), 1) << "there is no glow on one side";
        for (std::uint32_t y = 0; y < sky_picture.height; ++y)
            for (std::uint32_t x = 0; x < sky_picture.width; ++x)
                for (std::size_t c = 0; c < 3; ++c) ASSERT_LE(channel(to_sun, x, y, c), 22);
    }
}

TEST_P(Skies, meet_the_fog_at_the_horizon) {
    gl::DeviceOptions options;
    options.switches = {model::effect_fog};
    open(options);
    test::SmallModel scene;
    scene.square(scene.material(test::plain(0, 0, 0, 1, model::effect_fog)), test::at(4000, 20, -7400), 60);
    scene.model().effects = {{model::effect_fog, true, 2, "", true}, {model::effect_sky, true, 0, "", true}};
    const model::Model model = scene.finish();
    load(model);
    model::LightFacts foggy;
    foggy.fog_visibility_m = 60;
    for (const double hour : {12.0, 20.0}) {
        const model::Daylight light = model::daylight_at(hour, foggy);
        set_light(light);
        const Pose level = eye_towards({0, 0, -1});
        const gl::PixelImage image = picture(level, {gl::DrawItem{1, 0}});
        for (std::uint32_t y = 31; y < 40; ++y)  // the horizon lies below the first of them
            for (std::size_t c = 0; c < 3; ++c) {
                const double horizon = 255.0 * static_cast<double>(light.background[static_cast<int>(c)] * model::usual_sky[c]);
                EXPECT_NEAR(channel(image, 32, y, c), horizon, 0.6) << "the wall at " << hour << " h, row " << y;
                EXPECT_NEAR(channel(image, 2, y, c), horizon, 1.1) << "the sky at " << hour << " h, row " << y;
            }
        EXPECT_LE(worst_off(picture(level), level, light), sky_steps);
        EXPECT_NEAR(channel(image, 2, 2, 0), channel(image, 2, 32, 0), 25) << "thick fog hides the sky, too";
    }
    device_->draws.plays();
    device_->hide_effects(model::effect_fog);
    const model::Daylight clear = model::daylight_at(12, {});
    const Pose up = eye_towards({0, 0.4, -1});
    set_light(model::daylight_at(12, foggy));
    EXPECT_LE(worst_off(picture(up), up, clear), sky_steps) << "fog that is switched off";
}

TEST_P(Skies, are_behind_all_that_is_drawn_and_can_be_switched_off) {
    gl::DeviceOptions options;
    options.switches = {model::effect_sky};
    open(options);
    const std::vector<gl::DrawItem> items{{1, 0}, {2, 1}};
    const Pose level = eye_towards({0, 0, -1});
    const model::Model plain_model = with_sky(false), sky_model = with_sky();
    load(plain_model);
    EXPECT_EQ(device_->program_text(model::effect_sky), "");
    EXPECT_EQ(device_->program_listing().size(), 2U) << "plain and blended";
    const gl::PixelImage without = picture(level, items);
    load(sky_model);
    EXPECT_EQ(device_->program_listing().size(), 3U);
    EXPECT_NE(device_->program_text(model::effect_sky).find("zenith"), std::string::npos);
    const gl::PixelImage shown = picture(level, items), alone = picture(level);
    EXPECT_GT(worst_of(shown, without), 30);
    const std::uint32_t square_x = 14, pane_x = 49, top = 27;  // within the square and the pane, above the horizon
    for (const std::uint32_t y : {top, 36U}) {
        EXPECT_EQ(channel(shown, square_x, y, 0), 255);
        EXPECT_EQ(channel(shown, square_x, y, 1), 0);
        EXPECT_NEAR(channel(shown, pane_x, y, 0), 0.5 * channel(alone, pane_x, y, 0), 1.5);
        EXPECT_NEAR(channel(shown, pane_x, y, 2), 0.5 * 255 + 0.5 * channel(alone, pane_x, y, 2), 1.5);
    }
    device_->draws.plays();
    device_->hide_effects(model::effect_sky);
    EXPECT_EQ(picture(level, items).rgba, without.rgba);
    device_->hide_effects(0);
    EXPECT_EQ(picture(level, items).rgba, shown.rgba);
    load(plain_model);
    EXPECT_EQ(picture(level, items).rgba, without.rgba) << "loaded after a model with a sky";
    options = {};
    options.background = false;
    open(options);
    load(sky_model);
    EXPECT_EQ(picture(level, items).rgba, without.rgba) << "a device that shows what is before it alone";
}

TEST_P(Skies, are_in_pictures_at_every_resolution_at_rest_and_of_several_samples) {
    gl::DeviceOptions options;
    options.rest = true;
    open(options);
    const model::Model sky_model = with_sky();
    load(sky_model);
    const model::Daylight morning = model::daylight_at(8, {});
    set_light(morning);
    const Pose away = eye_towards(beside_sun(morning, 0.5, 2)), at_sun = eye_towards(dvec3(morning.sun_direction), 0.2);
    const gl::PixelImage whole = picture(away), sun = picture(at_sun);
    for (const float resolution : model::resolution_steps)
        EXPECT_LE(worst_of(picture(away, {}, resolution), whole), 4) << resolution;
    EXPECT_EQ(picture(away).rgba, whole.rgba);
    device_->draws.plays();
    if (device_->rest_support() != gl::RestSupport::none) {
        EXPECT_EQ(rest_picture(away, dvec2(0)).rgba, whole.rgba);
        const gl::PixelImage moved = rest_picture(at_sun, dvec2(3, 0));
        int worst = 0;
        for (std::uint32_t y = 0; y < 64; ++y)
            for (std::uint32_t x = 3; x < 64; ++x)
                for (std::size_t c = 0; c < 3; ++c)
                    worst = std::max(worst, std::abs(channel(moved, x, y, c) - channel(sun, x - 3, y, c)));
        EXPECT_LE(worst, 2) << "the sun moves with all else";
        EXPECT_GT(worst_of(moved, sun), 60);
    }
    options = {};
    options.samples = 4;
    open(options);
    load(sky_model);
    set_light(morning);
    EXPECT_LE(worst_of(picture(away), whole), 1);
}

INSTANTIATE_TEST_SUITE_P(Software, Skies, ::testing::Values(BackendKind::egl, BackendKind::osmesa),
                         [](const auto& kind) { return std::string(gl::backend_of(kind.param).name); });

}  // namespace
}  // namespace surefoot
