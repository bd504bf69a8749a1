// The GL device on small pictures: right pixels, right order, nothing lost. Skipped with the reason where there is no EGL.
#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/backends.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

using gl::BackendKind;
using test::at;
using test::plain;
using test::SmallModel;
using Pixel = std::array<int, 3>;

constexpr std::uint32_t side = 100;

Result<std::unique_ptr<gl::Device>> open(BackendKind kind, std::uint32_t max_items = 4096) {
    gl::DeviceOptions options;
    options.kind = kind;
    options.viewport = {side, side};
    options.max_items = max_items;
    options.sky = {0, 0, 1};
    return gl::open_device(options);
}

Pixel pixel(const gl::PixelImage& image, std::uint32_t x, std::uint32_t y) {
    const std::size_t i = 4 * (static_cast<std::size_t>(y) * image.width + x);
    return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
}

constexpr Pixel red{255, 0, 0}, green{0, 255, 0}, blue{0, 0, 255};

void show(gl::Device& device, const std::vector<gl::DrawItem>& items, const Pose& pose) {
    device.draws.plays();
    device.begin_frame(pose);
    device.draw(items);
    device.end_slice();
    device.wait_slices(1);
    device.end_items();
    device.finish_frame();
}

/// A 90 degree view from the origin along -z: at depth 1 the picture spans -1..1.
Pose straight() {
    Pose pose;
    pose.fov_y_rad = 1.5707963267948966;
    return pose;
}

class DeviceTest : public ::testing::Test {
protected:
    void SetUp() override {
        auto device = open(BackendKind::egl);
        if (!device) GTEST_SKIP() << "no EGL: " << device.error().text();
        device_ = std::move(*device);
    }
    gl::PixelImage picture(const model::Model& model, const std::vector<model::Index>& nodes, const Pose& pose = straight()) {
        device_->draws.plays();
        const auto loaded = device_->load(model, effects::assemble_program);
        EXPECT_TRUE(loaded.ok()) << (loaded.ok() ? "" : loaded.error().text());
        std::vector<gl::DrawItem> items;
        for (const model::Index node : nodes) items.push_back({node, model.nodes[node].first_rep});
        show(*device_, items, pose);
        auto image = device_->read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? *image : gl::PixelImage{};
    }
    std::unique_ptr<gl::Device> device_;
};

TEST_F(DeviceTest, a_triangle_covers_its_pixels_and_no_others) {
    SmallModel scene;
    const auto node = scene.triangle(scene.material(plain(1, 0, 0)), {vec3(-1, -1, -1), vec3(0, -1, -1), vec3(-1, 0, -1)});
    const auto image = picture(scene.finish(), {node});
    EXPECT_EQ(pixel(image, 2, 97), red);  // lower left
    EXPECT_EQ(pixel(image, 2, 53), red);  // its upper corner: row 50 is the horizon
    EXPECT_EQ(pixel(image, 2, 47), blue);
    EXPECT_EQ(pixel(image, 53, 97), blue);
    EXPECT_EQ(pixel(image, 40, 60), blue);  // beyond the diagonal
}

TEST_F(DeviceTest, the_nearer_plane_wins_in_either_order) {
    SmallModel scene;
    const auto far = scene.square(scene.material(plain(1, 0, 0)), at(0, 0, -5000), 5000);
    const auto near = scene.square(scene.material(plain(0, 1, 0)), at(0, 0, -4999.9), 2500);
    const auto model = scene.finish();
    for (const auto& order : {std::vector<model::Index>{far, near}, std::vector<model::Index>{near, far}}) {
        const auto image = picture(model, order);
        EXPECT_EQ(pixel(image, 50, 50), green);
        EXPECT_EQ(pixel(image, 10, 50), red);
    }
}

// Two things in exactly one place: which one shows must not follow the order of slices, which follows the eye.
TEST_F(DeviceTest, of_two_in_one_place_the_same_one_shows_in_either_order) {
    for (const double distance : {0.7, 33.3, 4711.0}) {
        SmallModel scene;
        const mat3 turned(glm::mat3_cast(glm::angleAxis(0.7F, glm::normalize(vec3(1, 2, 0.5F)))));
        const auto half = static_cast<float>(0.5 * distance);
        const auto a = scene.square(scene.material(plain(1, 0, 0)), at(0, 0, -distance, turned), half);
        const auto b = scene.square(scene.material(plain(0, 1, 0)), at(0, 0, -distance, turned), half);
        const auto model = scene.finish();
        device_->draws.plays();
        ASSERT_TRUE(device_->load(model, effects::assemble_program).ok());
        std::vector<std::vector<std::uint8_t>> pictures;
        for (const auto& order : {std::vector<model::Index>{a, b}, std::vector<model::Index>{b, a}}) {
            device_->begin_frame(straight());
            for (const model::Index node : order) {
                const gl::DrawItem item{node, model.nodes[node].first_rep};
                device_->draw({&item, 1});
                device_->end_slice();
            }
            device_->finish_frame();
            const auto image = device_->read_pixels();
            ASSERT_TRUE(image.ok());
            pictures.push_back(image->rgba);
            EXPECT_NE(pixel(*image, 50, 50), blue);
        }
        EXPECT_EQ(pictures[0], pictures[1]) << distance;
    }
}

TEST_F(DeviceTest, far_from_the_origin_nothing_moves) {
    const dvec3 away(6.4e6, 1.2e6, -3.3e6);
    SmallModel here;
    const auto a = here.triangle(here.material(plain(1, 0, 0)), {vec3(-1, -1, -1), vec3(0.3F, -1, -1), vec3(-1, 0.2F, -1)});
    SmallModel there;
    const auto b = there.triangle(there.material(plain(1, 0, 0)), {vec3(-1, -1, -1), vec3(0.3F, -1, -1), vec3(-1, 0.2F, -1)},
                                  at(away.x, away.y, away.z));
    Pose pose = straight();
    const auto near_picture = picture(here.finish(), {a}, pose);
    pose.position = away;
    EXPECT_EQ(near_picture.rgba, picture(there.finish(), {b}, pose).rgba);
}

TEST_F(DeviceTest, a_mirrored_placement_shows_its_front) {
    SmallModel scene;
    mat3 mirror(1.0F);
    mirror[0][0] = -1;
    const auto node = scene.square(scene.material(plain(1, 0, 0)), at(0, 0, -1, mirror), 0.5F);
    EXPECT_EQ(pixel(picture(scene.finish(), {node}), 50, 50), red);
}

TEST_F(DeviceTest, a_back_face_shows_only_if_two_sided) {
    mat3 turned(1.0F);
    turned[0][0] = -1;
    turned[2][2] = -1;
    for (const bool two_sided : {false, true}) {
        SmallModel scene;
        auto material = plain(1, 0, 0);
        material.two_sided = two_sided;
        const auto node = scene.square(scene.material(material), at(0, 0, -1, turned), 0.5F);
        EXPECT_EQ(pixel(picture(scene.finish(), {node}), 50, 50), two_sided ? red : blue);
    }
}

TEST_F(DeviceTest, mirrored_and_two_sided_surfaces_are_lit_as_their_originals) {
    const auto shade = [&](const mat3& linear, bool two_sided, dvec3 sun) {
        SmallModel scene;
        auto material = plain(0.5F, 0.5F, 0.5F, 1, model::effect_sun);
        material.two_sided = two_sided;
        const auto node = scene.square(scene.material(material), at(0, 0, -1, linear), 0.5F);
        auto model = scene.finish();
        model.sun_direction = sun;
        return pixel(picture(model, {node}), 50, 50)[0];
    };
    mat3 mirror(1.0F);
    mirror[0][0] = -1;
    mat3 turned = mirror;
    turned[2][2] = -1;
    const int front = shade(mat3(1.0F), false, {0, 0, 1});
    EXPECT_GT(front, shade(mat3(1.0F), false, {0, 0, -1}) + 40);
    EXPECT_EQ(front, shade(mirror, false, {0, 0, 1}));
    EXPECT_EQ(front, shade(turned, true, {0, 0, 1}));
    EXPECT_EQ(front, shade(mat3(3.0F), true, {0, 0, 1}));
}

TEST_F(DeviceTest, the_alpha_mask_cuts_holes_and_the_texture_colours) {
    SmallModel scene;
    auto material = plain(1, 1, 1, 1, model::effect_texture | model::effect_alpha_mask);
    material.texture = scene.texture({0, 255, 0, 255}, {0, 255, 0, 0});
    material.alpha = model::AlphaMode::mask;
    const auto node = scene.square(scene.material(material), at(0, 0, -1), 0.8F);
    const auto image = picture(scene.finish(), {node});
    EXPECT_EQ(pixel(image, 30, 50), green);
    EXPECT_EQ(pixel(image, 70, 50), blue);
}

TEST_F(DeviceTest, blended_items_are_drawn_back_to_front_whatever_their_order) {
    SmallModel scene;
    const auto wall = scene.square(scene.material(plain(0, 0, 0)), at(0, 0, -4), 10);
    auto glass = plain(1, 0, 0, 0.5F, model::effect_blend);
    glass.alpha = model::AlphaMode::blend;
    auto other = glass;
    other.colour = {0, 1, 0, 0.5F};
    const auto back = scene.square(scene.material(glass), at(0, 0, -3), 10);
    const auto front = scene.square(scene.material(other), at(0, 0, -2), 10);
    const auto model = scene.finish();
    for (const auto& order : {std::vector<model::Index>{front, back, wall}, std::vector<model::Index>{wall, back, front}}) {
        const Pixel seen = pixel(picture(model, order), 50, 50);
        EXPECT_NEAR(seen[0], 64, 1);  // red under half of green
        EXPECT_NEAR(seen[1], 128, 1);
        EXPECT_EQ(seen[2], 0);
    }
}

TEST_F(DeviceTest, blended_parts_of_one_item_are_drawn_back_to_front_whatever_their_order) {
    auto red_glass = plain(1, 0, 0, 0.5F, model::effect_blend), green_glass = plain(0, 1, 0, 0.5F, model::effect_blend);
    red_glass.alpha = green_glass.alpha = model::AlphaMode::blend;
    const auto pane = [](float z) { return std::array<vec3, 3>{vec3(-30, -20, z), vec3(30, -20, z), vec3(0, 40, z)}; };
    for (const bool front_first : {true, false}) {
        SmallModel scene;
        const auto red_pane = scene.material(red_glass), green_pane = scene.material(green_glass);
        const auto both = scene.triangle(front_first ? green_pane : red_pane, pane(front_first ? -2.0F : -3.0F));
        scene.triangle(front_first ? red_pane : green_pane, pane(front_first ? -3.0F : -2.0F));
        const auto wall = scene.square(scene.material(plain(0, 0, 0)), at(0, 0, -4), 10);
        model::Model model = scene.finish();
        model.reps[model.nodes[both].first_rep].part_count = 2;  // the second pane is a part of the first one's object
        const Pixel seen = pixel(picture(model, {both, wall}), 50, 50);
        EXPECT_NEAR(seen[0], 64, 1) << front_first;
        EXPECT_NEAR(seen[1], 128, 1) << front_first;
    }
}

TEST_F(DeviceTest, vertex_colours_multiply_the_material) {
    SmallModel scene;
    const auto node =
        scene.square(scene.material(plain(1, 0.5F, 1, 1, model::effect_vertex_colour)), at(0, 0, -1), 0.5F, {255, 255, 0, 255});
    const Pixel seen = pixel(picture(scene.finish(), {node}), 50, 50);
    EXPECT_NEAR(seen[1], 128, 1);
    EXPECT_EQ(seen[0], 255);
    EXPECT_EQ(seen[2], 0);
}

TEST_F(DeviceTest, more_parts_than_the_arrays_hold_are_all_drawn) {
    auto small = open(BackendKind::egl, 3);
    ASSERT_TRUE(small.ok());
    device_ = std::move(*small);
    SmallModel scene;
    const auto material = scene.material(plain(1, 0, 0));
    std::vector<model::Index> nodes;
    for (int i = 0; i < 10; ++i) nodes.push_back(scene.square(material, at(-0.9 + 0.2 * i, 0, -1), 0.05F));
    const auto image = picture(scene.finish(), nodes);
    for (std::uint32_t i = 0; i < 10; ++i) EXPECT_EQ(pixel(image, 5 + 10 * i, 50), red) << i;
}

TEST_F(DeviceTest, equal_state_goes_out_in_one_batch) {
    SmallModel scene;
    const auto a = scene.material(plain(1, 0, 0));
    const auto b = scene.material(plain(0, 1, 0));  // a colour is data, not state
    std::vector<model::Index> nodes;
    for (int i = 0; i < 10; ++i) nodes.push_back(scene.square(i % 2 == 0 ? a : b, at(-0.9 + 0.2 * i, 0, -1), 0.05F));
    picture(scene.finish(), nodes);
    device_->draws.plays();
    EXPECT_EQ(device_->stats().batches, 1U);
    EXPECT_EQ(device_->stats().draws, 10U);
    EXPECT_EQ(device_->stats().items, 10U);
    EXPECT_EQ(device_->stats().triangles, 20U);
}

TEST_F(DeviceTest, images_of_one_form_share_a_batch_and_show_their_own_texels) {
    SmallModel scene;
    std::vector<model::Index> nodes;
    const std::array<std::array<std::uint8_t, 4>, 3> colours{{{255, 0, 0, 255}, {0, 255, 0, 255}, {255, 0, 255, 255}}};
    for (std::size_t i = 0; i < 3; ++i) {
        auto material = plain(1, 1, 1, 1, model::effect_texture);
        material.texture = scene.texture(colours[i], colours[i], i == 2 ? 16 : 8);
        nodes.push_back(scene.square(scene.material(material), at(-0.6 + 0.6 * static_cast<double>(i), 0, -1), 0.2F));
    }
    const auto image = picture(scene.finish(), nodes);
    EXPECT_EQ(pixel(image, 20, 50), red);
    EXPECT_EQ(pixel(image, 50, 50), green);
    EXPECT_EQ(pixel(image, 80, 50), (Pixel{255, 0, 255}));
    device_->draws.plays();
    EXPECT_EQ(device_->stats().batches, 2U);  // the third is of another size
}

TEST_F(DeviceTest, only_the_scenes_programs_are_compiled) {
    SmallModel scene;
    const auto node = scene.square(scene.material(plain(1, 0, 0)), at(0, 0, -1));
    picture(scene.finish(), {node});
    EXPECT_EQ(device_->program_listing(), std::vector<std::string>{"0: bare"});
    EXPECT_FALSE(device_->program_text(0).empty());
    EXPECT_TRUE(device_->program_text(model::effect_texture).empty());
}

TEST_F(DeviceTest, what_is_hidden_from_the_sky_has_the_light_of_a_room) {
    const auto shade = [&](model::EffectMask effects, std::uint8_t sky, std::uint8_t room, bool from_behind = false) {
        SmallModel scene;
        auto material = plain(0.5F, 0.5F, 0.5F, 1, effects);
        material.two_sided = true;
        mat3 turned(1.0F);
        if (from_behind) turned[0][0] = turned[2][2] = -1;
        const auto node = scene.square(scene.material(material), at(0, 0, -1, turned), 0.5F);
        auto model = scene.finish();
        for (model::Vertex& v : model.vertices) v.hidden[0] = sky, v.hidden[2] = room;
        return pixel(picture(model, {node}), 50, 50);
    };
    constexpr model::EffectMask sun = model::effect_sun, both = model::effect_sun | model::effect_openness;
    EXPECT_EQ(shade(both, 0, 0), shade(sun, 0, 0)) << "in the open";
    EXPECT_EQ(shade(both, 255, 0), shade(model::effect_openness, 255, 0)) << "no sky: the same with and without the sun's code";
    EXPECT_NE(shade(both, 255, 0), shade(both, 0, 0));
    EXPECT_LT(shade(both, 255, 255)[0], shade(both, 255, 0)[0] - 30) << "what is near shades";
    EXPECT_EQ(shade(both, 255, 255, true), shade(sun, 0, 0, true)) << "behind it nothing is hidden";
}

TEST_F(DeviceTest, a_side_that_sees_no_sky_is_drawn_without_the_sun) {
    // Programs without the sun draw red here. The front of the square sees no sky, its back does.
    const auto red_without_sun = [](model::EffectMask mask) {
        gl::ProgramSource source = effects::assemble_program(mask);
        const std::string shown = "vec4(colour.rgb, opacity)";
        if ((mask & model::effect_sun) == 0)
            source.fragment.replace(source.fragment.find(shown), shown.size(), "vec4(1, 0, 0, 1)");
        return source;
    };
    const mat3 as_it_is(1.0F), turned(vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1)),
        mirrored(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, -1));
    for (const auto& [linear, shows_front] : {std::pair{as_it_is, true}, {turned, false}, {mirrored, false}}) {
        SmallModel scene;
        model::Material wall = plain(0, 0.8F, 0, 1, model::effect_sun | model::effect_openness);
        wall.two_sided = true;
        const auto node = scene.square(scene.material(wall), at(0, 0, -3, linear));
        for (model::Vertex& v : scene.model().vertices) v.hidden[0] = 255;
        const model::Model model = scene.finish();
        const auto usual = pixel(picture(model, {node}), 50, 50);
        model::Model indoors = model;
        indoors.materials[0].effects = model::effect_openness;
        EXPECT_EQ(usual == pixel(picture(indoors, {node}), 50, 50), shows_front) << "the light of a room, bit by bit";
        ASSERT_TRUE(device_->load(model, red_without_sun).ok());
        show(*device_, {{node, model.nodes[node].first_rep}}, straight());
        EXPECT_EQ(pixel(*device_->read_pixels(), 50, 50) == red, shows_front);
    }
}

TEST_F(DeviceTest, a_switched_off_sun_leaves_no_trace_and_comes_back) {
    gl::DeviceOptions options;
    options.kind = BackendKind::egl;
    options.viewport = {side, side};
    options.sky = {0, 0, 1};
    options.switches = {model::effect_sun};
    auto opened = gl::open_device(options);
    ASSERT_TRUE(opened.ok()) << opened.error().text();
    device_ = std::move(*opened);
    SmallModel scene;
    const auto lit = scene.square(scene.material(plain(0.5F, 0.5F, 0.5F, 1, model::effect_sun)), at(-0.5, 0, -1), 0.4F);
    const auto plain_one = scene.square(scene.material(plain(1, 0, 0)), at(0.5, 0, -1), 0.4F);
    const auto model = scene.finish();
    const auto with = picture(model, {lit, plain_one});
    EXPECT_EQ(device_->program_listing(), (std::vector<std::string>{"0: bare", "4: sun"})) << "one for both";
    device_->draws.plays();
    const std::vector<gl::DrawItem> items = {{lit, model.nodes[lit].first_rep}, {plain_one, model.nodes[plain_one].first_rep}};
    for (const bool off : {true, false, false, true, true}) {
        device_->hide_effects(off ? model::EffectMask{model::effect_sun} : 0);
        show(*device_, items, straight());
        const auto image = device_->read_pixels();
        ASSERT_TRUE(image.ok());
        EXPECT_EQ(pixel(*image, 75, 50), red);
        const Pixel grey{128, 128, 128};
        EXPECT_EQ(pixel(*image, 25, 50) == grey, off);
        EXPECT_EQ(pixel(*image, 25, 50) == pixel(with, 25, 50), !off);
    }
    EXPECT_EQ(picture(model, {lit, plain_one}).rgba, [&] {
        device_->draws.plays();
        show(*device_, items, straight());
        return device_->read_pixels()->rgba;
    }()) << "loading anew keeps it off";
}

TEST_F(DeviceTest, a_program_that_does_not_compile_is_an_error_with_its_name) {
    SmallModel scene;
    scene.square(scene.material(plain(1, 0, 0)), at(0, 0, -1));
    device_->draws.plays();
    const auto loaded = device_->load(scene.finish(), [](model::EffectMask) {
        return gl::ProgramSource{"nonsense", "nonsense", "bare"};
    });
    ASSERT_FALSE(loaded.ok());
    EXPECT_NE(loaded.error().text().find("bare"), std::string::npos);
}

TEST_F(DeviceTest, the_context_moves_between_threads) {
    SmallModel scene;
    const auto node = scene.square(scene.material(plain(1, 0, 0)), at(0, 0, -1), 0.5F);
    const auto model = scene.finish();
    device_->draws.plays();
    ASSERT_TRUE(device_->load(model, effects::assemble_program).ok());
    device_->release();
    gl::PixelImage image;
    std::thread frame_thread([&] {
        device_->bind();
        show(*device_, {{node, 0}}, straight());
        image = *device_->read_pixels();
        device_->release();
    });
    frame_thread.join();
    EXPECT_EQ(pixel(image, 50, 50), red);
    device_->bind();
}

TEST(Backends, osmesa_and_egl_agree_within_one_step) {
    std::vector<gl::DrawItem> items;
    const auto model = test::mixed_scene(items);
    std::vector<gl::PixelImage> images;
    for (const auto kind : {BackendKind::egl, BackendKind::osmesa}) {
        auto device = open(kind);
        if (!device) GTEST_SKIP() << device.error().text();
        (*device)->draws.plays();
        ASSERT_TRUE((*device)->load(model, effects::assemble_program).ok());
        show(**device, items, straight());
        auto image = (*device)->read_pixels();
        ASSERT_TRUE(image.ok());
        images.push_back(*image);
    }
    int worst = 0;
    for (std::size_t i = 0; i < images[0].rgba.size(); ++i) {
        worst = std::max(worst, std::abs(static_cast<int>(images[0].rgba[i]) - static_cast<int>(images[1].rgba[i])));
    }
    EXPECT_LE(worst, 1);
}

TEST(Backends, two_devices_live_side_by_side_and_one_after_the_other) {
    SmallModel scene;
    const auto node = scene.square(scene.material(plain(1, 0, 0)), at(0, 0, -1), 0.5F);
    const auto model = scene.finish();
    auto first = open(BackendKind::egl);
    if (!first) GTEST_SKIP() << first.error().text();
    {
        auto second = open(BackendKind::egl);
        ASSERT_TRUE(second.ok());
        (*second)->draws.plays();
        ASSERT_TRUE((*second)->load(model, effects::assemble_program).ok());
    }
    (*first)->bind();
    ASSERT_TRUE((*first)->load(model, effects::assemble_program).ok());
    show(**first, {{node, 0}}, straight());
    EXPECT_EQ(pixel(*(*first)->read_pixels(), 50, 50), red);
}

TEST(Backends, names_are_parsed_and_unknown_ones_refused) {
    EXPECT_EQ(gl::backend_named("osmesa").value()->kind, BackendKind::osmesa);
    const auto wrong = gl::backend_named("vulkan");
    ASSERT_FALSE(wrong.ok());
    EXPECT_NE(wrong.error().remedy.find("egl"), std::string::npos);
    EXPECT_NE(wrong.error().remedy.find("kms"), std::string::npos);
}

TEST(Backends, every_kind_has_its_entry_and_a_line_of_help) {
    for (const auto kind :
         {BackendKind::egl, BackendKind::device, BackendKind::window, BackendKind::kms, BackendKind::osmesa, BackendKind::null}) {
        const gl::Backend& backend = gl::backend_of(kind);
        EXPECT_EQ(backend.kind, kind);
        EXPECT_EQ(gl::backend_named(backend.name).value(), &backend);
        EXPECT_GT(backend.help.size(), 10U) << backend.name;
        EXPECT_EQ(backend.draws(), kind != BackendKind::null);
        EXPECT_EQ(gl::drawing_backends().find(backend.name) != std::string::npos, backend.draws()) << backend.name;
    }
    EXPECT_EQ(gl::backend_named(gl::usual_backend).value()->kind, gl::DeviceOptions{}.kind);
    EXPECT_EQ(gl::backends().size(), 6U);
}

TEST(Backends, a_window_without_a_display_names_the_remedy) {
#ifdef SUREFOOT_WATCHES_THREADS
    GTEST_SKIP() << "nothing is opened where the thread sanitizer watches";
#endif
    const char* display = std::getenv("DISPLAY");
    const std::string before = display != nullptr ? display : "";
    unsetenv("DISPLAY");
    const auto device = open(BackendKind::window);
    if (display != nullptr) setenv("DISPLAY", before.c_str(), 1);
    ASSERT_FALSE(device.ok());
    EXPECT_NE(device.error().text().find("DISPLAY"), std::string::npos);
    EXPECT_FALSE(device.error().remedy.empty());
}

}  // namespace
}  // namespace surefoot
