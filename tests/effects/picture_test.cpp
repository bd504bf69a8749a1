// Pictures against the reference: every effect alone and every pair of them, on each back end that opens here. Each is drawn in
// the model's own light, and in that of an evening.
// To add an effect: its definition in reference_shading.hpp, its line in `tolerances`, and something for it in effect_scene.hpp.
// What is behind everything has a test of its own: sky_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/backends.hpp"
#include "tests/effects/effect_scene.hpp"
#include "tests/effects/reference_picture.hpp"

namespace surefoot {
namespace {

using gl::BackendKind;
using model::EffectMask;

constexpr std::uint32_t side = 64;
constexpr EffectMask all_bits = ((1U << model::effect_count) - 1) & ~model::background_effects;  // that a material may have

/// By how much a channel may differ from the reference, in 1/255, where a material has the effect.
struct Tolerance {
    EffectMask bit;
    double steps;
};
constexpr double bare_steps = 1;  ///< the material's colour is rounded to bytes, and so is the picture
constexpr std::array<Tolerance, std::popcount(all_bits)> tolerances{{
    {model::effect_texture, 3},          // the weights of texels have few bits
    {model::effect_vertex_colour, 1.5},  // light and colours at vertices multiply the rounded colour
    {model::effect_sun, 1.5},
    {model::effect_alpha_mask, 1},
    {model::effect_blend, 2.5},  // the picture is rounded under each pane
    {model::effect_openness, 1.5},
    {model::effect_shadow, 1.5},
    {model::effect_lamps, 2},  // more light than white: it multiplies the rounded colour as well
    {model::effect_fog, 1.5},
    {model::effect_water, 1.5},
    {model::effect_moving_shadow, 1.5},  // as the sun; without a map it is no shadow (moving_shadow_test.cpp has one)
    {model::effect_light_by_pixel, 1.5},
    {model::effect_lit_picture, 4},  // as lamps; it multiplies errors of texels, too
}};
/// Pixels at edges that may differ. Corners are rounded to a part of a pixel, and a driver may take one mip level for 2 x 2
/// pixels.
constexpr std::size_t max_at_edges = side * side / 100;

/// Of several effects, the largest.
double steps_of(EffectMask mask) {
    double steps = bare_steps;
    for (const Tolerance& tolerance : tolerances)
        if ((mask & tolerance.bit) != 0) steps = std::max(steps, tolerance.steps);
    return steps;
}

/// What differs between a device's picture and the reference.
struct Difference {
    std::size_t interior = 0, at_edges = 0;  ///< pixels beyond the tolerance
    double worst = 0;                        ///< in the interior, in 1/255
    std::size_t interior_pixels = 0;
};

Difference compare(const gl::PixelImage& image, const reference::Picture& expected, double steps) {
    Difference difference;
    for (std::uint32_t y = 0; y < side; ++y) {
        for (std::uint32_t x = 0; x < side; ++x) {
            const std::size_t at = std::size_t{y} * side + x;
            double off = 0;
            for (int i = 0; i < 3; ++i)
                off = std::max(off, std::abs(image.rgba[4 * at + static_cast<std::size_t>(i)] - 255 * expected.colours[at][i]));
            const bool edge = expected.is_edge(x, y);
            if (off > steps) ++(edge ? difference.at_edges : difference.interior);
            if (edge) continue;
            ++difference.interior_pixels;
            difference.worst = std::max(difference.worst, off);
        }
    }
    return difference;
}

/// Low sun, lamps and fog: no number is the one that a device has after load.
reference::Light evening() {
    reference::Light light;
    light.towards_sun = {-0.64, 0.6, 0.48};
    light.sun = {0.6, 0.45, 0.25};
    light.ground = {0.2, 0.22, 0.28};
    light.sky = {0.3, 0.34, 0.5};
    light.moment = 3;
    light.between = 0.3;
    light.lamps = 1.7;
    light.rooms = 0.7;
    light.fog_density = 0.11;
    light.background = {0.5, 0.4, 0.65};
    light.pictures = {0.83, 0.66, 0.71};
    light.time_s = 12.75;
    return light;
}

model::Daylight for_device(const reference::Light& light) {
    model::Daylight out;
    out.sun_direction = vec3(light.towards_sun);
    out.sun_light = vec3(light.sun);
    out.ground_light = vec3(light.ground);
    out.sky_light = vec3(light.sky);
    out.sun_moment = light.moment;
    out.sun_between = static_cast<float>(light.between);
    out.lamp_strength = static_cast<float>(light.lamps);
    out.room_light = static_cast<float>(light.rooms);
    out.fog_density = static_cast<float>(light.fog_density);
    out.background = vec3(light.background);
    out.pictures = vec3(light.pictures);
    return out;
}

class Pictures : public ::testing::TestWithParam<BackendKind> {
protected:
    void SetUp() override {
        gl::DeviceOptions options;
        options.kind = GetParam();
        options.viewport = {side, side};
        options.max_items = 256;
        options.filter = rt::TextureFilter::bilinear;
        options.switches = switches();
        auto device = gl::open_device(options);
        const bool absent = !device.ok() && device.error().kind == ErrorKind::unsupported;
        if (absent) GTEST_SKIP() << device.error().text();  // no such library, or a sanitizer that allows no GL
        ASSERT_TRUE(device.ok()) << device.error().text();
        device_ = std::move(*device);
    }
    [[nodiscard]] virtual std::vector<EffectMask> switches() const { return {}; }
    void load(const model::Model& model, const gl::ProgramFactory& programs = effects::assemble_program) {
        device_->draws.plays();
        const auto loaded = device_->load(model, programs);
        ASSERT_TRUE(loaded.ok()) << loaded.error().text();
    }
    void set_light(const reference::Light& light) {
        device_->draws.plays();
        device_->set_light(for_device(light));
        device_->set_time(light.time_s);
    }
    /// Of every object, or of each step-th.
    gl::PixelImage picture(const model::Model& model, const Pose& pose, model::Index step = 1) {
        std::vector<gl::DrawItem> items;
        for (model::Index n = 1; n < model.nodes.size(); n += step)
            items.push_back({n, model.nodes[n].first_rep + model.nodes[n].rep_count - 1});
        device_->draws.plays();
        device_->begin_frame(pose);
        device_->draw(items);
        device_->end_slice();
        device_->end_items();
        device_->finish_frame();
        auto image = device_->read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? *image : gl::PixelImage{side, side, std::vector<std::uint8_t>(std::size_t{4} * side * side)};
    }
    Difference difference(const model::Model& model, const Pose& pose, const reference::Light& light, double steps) {
        const dvec3 sky(model::usual_sky[0], model::usual_sky[1], model::usual_sky[2]);
        const reference::Picture expected = reference::draw({model, pose, {side, side}, sky, light});
        return compare(picture(model, pose), expected, steps);
    }
    /// Of all poses in the light that the device has after load, or in another.
    std::vector<Difference> differences(const model::Model& model, double steps, const reference::Light* other = nullptr) {
        if (other != nullptr) set_light(*other);
        std::vector<Difference> all;
        for (const Pose& pose : scene_.poses())
            all.push_back(difference(model, pose, other != nullptr ? *other : reference::own_light(model), steps));
        return all;
    }
    void expect_equal(const model::Model& model, EffectMask mask) {
        load(model);
        expect_equal(differences(model, steps_of(mask)), mask, " by its own light");
        const reference::Light other = evening();
        expect_equal(differences(model, steps_of(mask), &other), mask, " in the evening");
    }
    static void expect_equal(const std::vector<Difference>& poses, EffectMask mask, const std::string& light) {
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const std::string where = effects::effects_text(mask) + light + ", pose " + std::to_string(i);
            EXPECT_EQ(poses[i].interior, 0U) << where << ": " << poses[i].worst << " steps off, " << steps_of(mask) << " allowed";
            EXPECT_LE(poses[i].at_edges, max_at_edges) << where;
            EXPECT_GT(poses[i].interior_pixels, side * side / 4U) << where << ": nearly all is edges";
        }
    }
    test::EffectScene scene_;
    std::unique_ptr<gl::Device> device_;
};

/// With the switches of a walk.
class SwitchedPictures : public Pictures {
protected:
    [[nodiscard]] std::vector<EffectMask> switches() const override {
        return {model::effect_sun | model::effect_shadow, model::effect_shadow, model::effect_lamps, model::effect_fog};
    }
};

/// Every effect alone and with every other.
std::vector<EffectMask> pairs() {
    std::vector<EffectMask> masks;
    for (int a = 0; a < model::effect_count; ++a)
        for (int b = a; b < model::effect_count; ++b) masks.push_back(1U << a | 1U << b);
    std::erase_if(masks, [](EffectMask mask) { return (mask & ~all_bits) != 0; });
    return masks;
}

/// All materials have these effects, also where they make little sense together.
model::Model uniform_scene(test::EffectScene scene, EffectMask mask) {
    return scene.build([&](model::Index) { return mask; });
}

TEST_P(SwitchedPictures, are_the_references_without_what_is_hidden) {
    const model::Model model = scene_.build(test::EffectScene::own_effects);
    load(model);
    set_light(evening());
    const dvec3 sky(model::usual_sky[0], model::usual_sky[1], model::usual_sky[2]);
    std::set<EffectMask> programs;
    for (const unsigned turn : {0U, 15U, 5U, 10U, 1U, 2U, 3U, 4U, 6U, 7U, 8U, 9U, 11U, 12U, 13U, 14U, 0U}) {
        EffectMask hidden = 0;
        for (std::size_t i = 0; i < switches().size(); ++i)
            if ((turn >> i & 1U) != 0) hidden |= switches()[i];
        model::Model without = model;
        for (model::Material& material : without.materials) {
            material.effects &= ~hidden;
            programs.insert(material.effects);
        }
        reference::Light light = evening();
        if ((hidden & model::effect_sun) != 0) light.pictures = dvec3(1);  // what was captured is not darkened either
        light.sun_on_pictures = (hidden & model::effect_sun) == 0;
        light.lamps_on_pictures = (hidden & model::effect_lamps) == 0;
        device_->draws.plays();
        device_->hide_effects(hidden);
        std::vector<Difference> all;
        for (const Pose& pose : scene_.poses())
            all.push_back(compare(picture(model, pose), reference::draw({without, pose, {side, side}, sky, light}), 3));
        expect_equal(all, ~hidden & all_bits, " with the rest hidden");
    }
    EXPECT_EQ(device_->program_listing().size(), programs.size()) << "compiled in advance, and no other";
}

TEST_P(SwitchedPictures, are_refused_where_there_are_too_many_switches) {
    gl::DeviceOptions options;
    options.kind = GetParam();
    options.viewport = {side, side};
    options.switches.assign(gl::max_switches + 1, model::effect_sun);
    const auto device = gl::open_device(options);
    ASSERT_FALSE(device.ok());
    EXPECT_EQ(device.error().kind, ErrorKind::misuse);
}

TEST_P(Pictures, of_every_effect_and_every_pair_are_the_references) {
    for (const EffectMask pair : pairs()) expect_equal(uniform_scene(scene_, pair), pair);
}

TEST_P(Pictures, of_all_effects_but_one_or_a_pair_are_the_references) {
    for (const EffectMask pair : pairs()) expect_equal(uniform_scene(scene_, all_bits & ~pair), all_bits & ~pair);
}

TEST_P(Pictures, of_no_effect_of_all_and_of_each_materials_own_are_the_references) {
    expect_equal(uniform_scene(scene_, 0), 0);
    expect_equal(uniform_scene(scene_, all_bits), all_bits);
    expect_equal(scene_.build(test::EffectScene::own_effects), all_bits);
}

TEST_P(Pictures, differ_from_the_reference_where_a_program_leaves_an_effect_out) {
    const model::Model model = scene_.build(test::EffectScene::own_effects);
    for (const auto& module : effects::all_effects()) {
        if (module.bit == model::effect_moving_shadow) continue;      // nothing moves here: moving_shadow_test.cpp
        if ((module.bit & model::background_effects) != 0) continue;  // no material has it: sky_test.cpp
        const auto without = [&](EffectMask mask) { return effects::assemble_program(mask & ~module.bit); };
        load(model, without);
        const auto expect_wrong = [&](const std::vector<Difference>& poses, const char* light) {
            std::size_t wrong = 0;
            for (const Difference& difference : poses) wrong += difference.interior;
            EXPECT_GT(wrong, 20U) << module.name << light;
        };
        if (module.bit != model::effect_lamps) expect_wrong(differences(model, steps_of(all_bits)), " by its own light");
        const reference::Light other = evening();
        expect_wrong(differences(model, steps_of(all_bits), &other), " in the evening");
    }
}

TEST_P(Pictures, differ_from_the_reference_where_the_light_is_another_in_one_number) {
    const model::Model model = scene_.build(test::EffectScene::own_effects);
    load(model);
    const std::vector<std::pair<const char*, void (*)(reference::Light&)>> changes{
        {"sun's direction", [](auto& l) { l.towards_sun.x = 0.64; }},
        {"sun", [](auto& l) { l.sun.g += 0.1; }},
        {"ground", [](auto& l) { l.ground.b += 0.1; }},
        {"sky", [](auto& l) { l.sky.r += 0.1; }},
        {"moment", [](auto& l) { l.moment = 4; }},
        {"between", [](auto& l) { l.between = 0.7; }},
        {"lamps", [](auto& l) { l.lamps = 1.5; }},
        {"rooms", [](auto& l) { l.rooms = 0.5; }},
        {"fog", [](auto& l) { l.fog_density = 0.09; }},
        {"background", [](auto& l) { l.background.r += 0.1; }},
        {"pictures", [](auto& l) { l.pictures.g += 0.1; }},
        {"time", [](auto& l) { l.time_s += 0.4; }},
    };
    for (const auto& [name, change] : changes) {
        reference::Light other = evening();
        change(other);
        set_light(other);
        std::size_t wrong = 0;
        for (const Pose& pose : scene_.poses()) wrong += difference(model, pose, evening(), steps_of(all_bits)).interior;
        EXPECT_GT(wrong, 20U) << name;
    }
}

// Each program reads the shares of its moment from one buffer. Pictures of another moment between draw every third object: their
// programs are at that moment, and the others are behind.
TEST_P(Pictures, follow_the_moment_from_frame_to_frame_with_every_program) {
    const model::Model model = scene_.build(test::EffectScene::own_effects);
    load(model);
    const std::vector<Pose> poses = scene_.poses();
    std::size_t frame = 0;
    for (const std::uint32_t moment : {0U, 14U, 3U, 14U, 14U, 1U, 0U, 13U, 0U, 14U}) {
        reference::Light light = evening();
        light.moment = (moment + 5) % 15;
        set_light(light);
        picture(model, poses[0], 3);
        light.moment = moment;
        light.between = 0.1 * static_cast<double>(frame);
        set_light(light);
        const Difference found = difference(model, poses[frame++ % poses.size()], light, steps_of(all_bits));
        EXPECT_EQ(found.interior, 0U) << "frame " << frame << ", moment " << moment << ": " << found.worst << " steps off";
        EXPECT_LE(found.at_edges, max_at_edges) << "frame " << frame;
    }
}

TEST_P(Pictures, of_water_at_a_time_that_is_no_number_are_those_of_the_start) {
    const model::Model model = uniform_scene(scene_, model::effect_water);
    load(model);
    const Pose pose = scene_.poses()[0];
    const gl::PixelImage start = picture(model, pose);
    device_->draws.plays();
    device_->set_time(std::numeric_limits<double>::quiet_NaN());
    EXPECT_EQ(picture(model, pose).rgba, start.rgba);
    device_->draws.plays();
    device_->set_time(0.7);
    EXPECT_NE(picture(model, pose).rgba, start.rgba);
}

INSTANTIATE_TEST_SUITE_P(Software, Pictures, ::testing::Values(BackendKind::egl, BackendKind::osmesa),
                         [](const auto& kind) { return std::string(gl::backend_of(kind.param).name); });
INSTANTIATE_TEST_SUITE_P(Software, SwitchedPictures, ::testing::Values(BackendKind::egl, BackendKind::osmesa),
                         [](const auto& kind) { return std::string(gl::backend_of(kind.param).name); });

}  // namespace
}  // namespace surefoot
