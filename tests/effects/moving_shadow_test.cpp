// The shadow of a moving box on a floor, against a ray to the sun for every pixel; and that nothing is left of it elsewhere.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/backends.hpp"
#include "tests/effects/effect_scene.hpp"
#include "tests/effects/reference_shadow.hpp"

namespace surefoot {
namespace {

using gl::BackendKind;
using model::EffectMask;
using model::Index;

constexpr model::Viewport shadow_picture{240, 180};
constexpr double shadow_steps = 3;  ///< of 255: the largest of the effects that the floor may have
const dvec3 shadow_site{4000, 20, -7000}, box_half{1.5, 0.25, 0.6};

/// A quarter turn about the vertical and 3 m aside in 2 s, and back.
struct BoxOverFloor {
    model::Model model;
    Index box = 0, floor = 0;

    explicit BoxOverFloor(EffectMask floor_effects) {
        test::SmallModel scene;
        test::Shape ground;
        for (int i = -4; i < 4; ++i)
            for (int k = -4; k < 4; ++k) {
                const auto x = 2.0F * static_cast<float>(i), z = 2.0F * static_cast<float>(k);
                ground.quad({vec3(x, 0, z + 2), vec3(x + 2, 0, z + 2), vec3(x + 2, 0, z), vec3(x, 0, z)});
            }
        const auto at_site = [](double y, const mat3& linear = mat3(1.0F)) {
            return test::at(shadow_site.x, shadow_site.y + y, shadow_site.z, linear);
        };
        model::Material lawn = test::plain(0.5F, 0.8F, 0.4F, 1, floor_effects);
        if ((floor_effects & model::effect_texture) != 0) lawn.texture = scene.texture({255, 255, 255, 255}, {90, 160, 200, 255});
        floor = scene.object(ground.vertices, ground.indices, scene.material(lawn), at_site(0));
        mat3 size(1.0F);
        for (int i = 0; i < 3; ++i) size[i][i] = static_cast<float>(box_half[i]);
        const test::Shape shape = test::cube();
        box = scene.object(shape.vertices, shape.indices, scene.material(test::plain(0.9F, 0.2F, 0.1F)), at_site(1.2, size));
        model = scene.finish();
        for (const model::Vertex& v : model.vertices) {
            model::SunSeen seen{};
            for (auto& share : seen.share) share = static_cast<std::uint8_t>(160 + v.hidden[0] % 90);
            model.sun_seen.push_back(seen);
            model.lamp_light.push_back({{40, 30, 20, 0}, {0, 0, 0, 0}});
        }
        const auto s = static_cast<float>(std::sin(0.25 * 3.14159265358979));
        model.motions.push_back({shadow_site, 0, 3, 4, model::none});
        model.motion_keys = {{0, dvec3(0), {0, 0, 0, 1}}, {2, dvec3(3, 0, 0), {0, s, 0, s}}, {4, dvec3(0), {0, 0, 0, 1}}};
        model.placements[model.reps[model.nodes[box].first_rep].placement].motion = 0;
        model.light.fog_visibility_m = 60;
    }
    /// Where it is before the turn is half done.
    [[nodiscard]] static reference::TurnedBox box_at(double time_s) {
        const double share = time_s / 2;
        return {shadow_site + dvec3(3 * share, 1.2, 0), box_half, share * 0.5 * 3.14159265358979};
    }
    /// The model with the box where it is then.
    [[nodiscard]] model::Model placed_at(double time_s) const {
        model::Model still = model;
        model::Placement& p = still.placements[still.reps[still.nodes[box].first_rep].placement];
        const reference::TurnedBox now = box_at(time_s);
        const auto c = static_cast<float>(std::cos(now.angle_rad)), s = static_cast<float>(std::sin(now.angle_rad));
        p.linear = mat3(vec3(c, 0, -s), vec3(0, 1, 0), vec3(s, 0, c)) * p.linear;
        p.origin = now.middle;
        p.motion = model::none;
        return still;
    }
    [[nodiscard]] gl::DrawItem item(Index node) const { return {node, model.nodes[node].first_rep}; }
};

Pose over_the_floor() {
    Pose pose;
    pose.position = shadow_site + dvec3(2, 5, 6);
    pose.orientation = glm::quatLookAt(glm::normalize(shadow_site + dvec3(1, 0, -0.5) - pose.position), dvec3(0, 1, 0));
    return pose;
}

/// 4 m to each side of the box's way.
gl::ShadowView view_of_sun(const vec3& towards) {
    gl::ShadowView view;
    view.origin = shadow_site + dvec3(1.5, 1.2, 0);
    view.towards = glm::normalize(towards);
    const vec3 x = glm::normalize(glm::cross(vec3(0, 1, 0), view.towards)), y = glm::cross(view.towards, x);
    view.from_origin = mat4(glm::transpose(mat3(x / 4.0F, y / 4.0F, view.towards / 12.0F)));
    view.from_origin[3] = vec4(0, 0, 0.5F, 1);
    view.texel_m = 8.0F / static_cast<float>(gl::shadow_map_px);
    view.depth_m = 12;
    return view;
}

class MovingShadows : public ::testing::TestWithParam<BackendKind> {
protected:
    void SetUp() override {
        gl::DeviceOptions options;
        options.kind = GetParam();
        options.viewport = shadow_picture;
        options.max_items = 256;
        options.filter = rt::TextureFilter::bilinear;
        options.switches = {model::effect_moving_shadow};
        auto device = gl::open_device(options);
        const bool absent = !device.ok() && device.error().kind == ErrorKind::unsupported;
        if (absent) GTEST_SKIP() << device.error().text();
        ASSERT_TRUE(device.ok()) << device.error().text();
        device_ = std::move(*device);
        device_->draws.plays();
    }
    void load(const BoxOverFloor& scene) {
        device_->draws.plays();
        ASSERT_TRUE(device_->load(scene.model, effects::assemble_program).ok());
    }
    gl::PixelImage picture(const BoxOverFloor& scene) {
        device_->draws.plays();
        const std::vector<gl::DrawItem> items{scene.item(scene.floor), scene.item(scene.box)};
        device_->begin_frame(over_the_floor());
        device_->draw(items);
        device_->end_slice();
        device_->end_items();
        device_->finish_frame();
        auto image = device_->read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? *image : gl::PixelImage{};
    }
    void refresh(const BoxOverFloor& scene, double time_s) {
        device_->draws.plays();
        casters_ = {scene.item(scene.box)};
        device_->set_time(time_s);
        device_->refresh_shadow(view_of_sun(vec3(scene.model.sun_direction)), casters_);
        device_->show_shadow(true);
    }
    std::vector<gl::DrawItem> casters_;
    std::unique_ptr<gl::Device> device_;
};

/// What differs from the reference: the sunlit picture, or that without the sun where a ray meets the box. Texels of the map
/// decide within two of them of the shadow's edge: such pixels are left out.
struct ShadowDifference {
    std::size_t in_sun = 0, in_shadow = 0, wrong = 0;
    double worst = 0;
};

/// Corners of neighbouring fields of the floor differ, in colours and in what they see.
bool is_between_fields(const dvec3& point) {
    const auto near = [](double along) { return std::abs(along / 2 - std::round(along / 2)) < 1e-3; };
    return near(point.x - shadow_site.x) || near(point.z - shadow_site.z);
}

ShadowDifference against_rays(const gl::PixelImage& image, const BoxOverFloor& scene, double time_s) {
    const model::Model still = scene.placed_at(time_s);
    const dvec3 sky(model::usual_sky[0], model::usual_sky[1], model::usual_sky[2]);
    reference::View with{still, over_the_floor(), shadow_picture, sky, reference::own_light(still)};
    with.light.time_s = time_s;  // for water
    reference::View without = with;
    without.light.sun = dvec3(0);
    const reference::Picture sunlit = reference::draw(with), sunless = reference::draw(without);
    const reference::TurnedBox box = BoxOverFloor::box_at(time_s);
    const double texels_m = 2 * 8.0 / gl::shadow_map_px;
    ShadowDifference out;
    for (std::uint32_t y = 0; y < shadow_picture.height; ++y) {
        for (std::uint32_t x = 0; x < shadow_picture.width; ++x) {
            const std::size_t at = std::size_t{y} * shadow_picture.width + x;
            if (sunlit.is_edge(x, y) || !(sunlit.nearness[at] > 0)) continue;
            const dvec3 point = reference::point_of(with, sunlit, x, y);
            const bool floor = std::abs(point.y - shadow_site.y) < 1e-6;
            if (floor && is_between_fields(point)) continue;
            const bool surely = floor && box.is_met(point, still.sun_direction, -texels_m);
            if (floor && !surely && box.is_met(point, still.sun_direction, texels_m)) continue;
            const dvec3& expected = surely ? sunless.colours[at] : sunlit.colours[at];
            double off = 0;
            for (int i = 0; i < 3; ++i)
                off = std::max(off, std::abs(image.rgba[4 * at + static_cast<std::size_t>(i)] - 255 * expected[i]));
            out.worst = std::max(out.worst, off);
            out.wrong += off > shadow_steps ? 1 : 0;
            ++(surely ? out.in_shadow : out.in_sun);
        }
    }
    return out;
}

constexpr EffectMask of_floor = model::effect_sun | model::effect_moving_shadow;

TEST_P(MovingShadows, of_a_box_are_where_rays_say_with_every_other_effect) {
    for (const auto& module : effects::all_effects()) {
        if (module.bit == model::effect_blend || module.bit == model::effect_alpha_mask) continue;
        if ((module.bit & model::background_effects) != 0) continue;  // no floor has it
        const BoxOverFloor scene(of_floor | module.bit);
        load(scene);
        for (const double time_s : {0.0, 0.7, 1.6}) {
            refresh(scene, time_s);
            const ShadowDifference d = against_rays(picture(scene), scene, time_s);
            EXPECT_EQ(d.wrong, 0U) << module.name << " at " << time_s << ": " << d.worst << " steps off";
            EXPECT_GT(d.in_shadow, 150U);
            EXPECT_GT(d.in_sun, 10000U);
        }
    }
}

TEST_P(MovingShadows, stay_where_the_map_was_drawn_until_it_is_drawn_again) {
    const BoxOverFloor scene(of_floor);
    load(scene);
    refresh(scene, 0);
    picture(scene);
    device_->draws.plays();
    device_->set_time(1.6);
    EXPECT_GT(against_rays(picture(scene), scene, 1.6).wrong, 300U) << "the box went on, its shadow did not";
    refresh(scene, 1.6);
    EXPECT_EQ(against_rays(picture(scene), scene, 1.6).wrong, 0U);
}

TEST_P(MovingShadows, that_are_not_shown_or_switched_off_leave_no_trace) {
    BoxOverFloor scene(of_floor);
    load(scene);
    const std::vector<std::uint8_t> never = picture(scene).rgba;
    refresh(scene, 0);
    const std::vector<std::uint8_t> shown = picture(scene).rgba;
    EXPECT_NE(never, shown);
    device_->draws.plays();
    device_->hide_effects(model::effect_moving_shadow);
    EXPECT_EQ(picture(scene).rgba, never);
    device_->hide_effects(0);
    EXPECT_EQ(picture(scene).rgba, shown);
    device_->show_shadow(false);
    EXPECT_EQ(picture(scene).rgba, never);
    for (model::Material& material : scene.model.materials) material.effects &= ~model::effect_moving_shadow;
    for (model::Representation& rep : scene.model.reps) rep.effects &= ~model::effect_moving_shadow;
    load(scene);
    EXPECT_FALSE(device_->receives_shadows());
    EXPECT_EQ(picture(scene).rgba, never) << "and without the effect";
}

INSTANTIATE_TEST_SUITE_P(Software, MovingShadows, ::testing::Values(BackendKind::egl, BackendKind::osmesa),
                         [](const auto& kind) { return std::string(gl::backend_of(kind.param).name); });

}  // namespace
}  // namespace surefoot
