// What the image cache does to a device: order, samples, resolution, limits, losses, and nothing at all where it is not
// requested.
#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "render/gl/cache_pictures.hpp"
#include "render/gl/gl_device.hpp"
#include "tests/gl/fake_gl.hpp"
#include "tests/gl/picture_scene.hpp"

namespace surefoot::test {
namespace {

const Box pictured{dvec3(-1, -1, -7), dvec3(1, 1, -5)};

/// In the box a red wall; behind it a green one; a half transparent blue pane before the box and one in it.
PictureScene panes() {
    SmallModel small;
    const auto red = small.material(plain(1, 0, 0)), green = small.material(plain(0, 1, 0));
    const auto glass = small.material(plain(0, 0, 1, 0.4F, model::effect_blend));
    PictureScene scene;
    for (const auto& [material, z, half] :
         {std::tuple{red, -6.0, 0.5F}, {green, -9.0, 3.0F}, {glass, -4.0, 0.15F}, {glass, -5.5, 0.4F}}) {
        const auto node = small.square(material, at(0, 0, z), half);
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    return scene;
}

std::array<int, 3> colour_at(const gl::PixelImage& image, int x, int y) {
    const std::uint8_t* pixel = pixel_of(image, x, y);
    return {pixel[0], pixel[1], pixel[2]};
}

TEST(PictureDevice, draws_pictures_after_opaque_parts_and_before_blended_ones) {
    const PictureScene scene = panes();
    for (const std::uint32_t samples : {1U, 4U}) {
        auto options = with_layers(96, 96);
        options.samples = samples;
        options.rest = true;
        options.smaller = true;
        const auto device = open_with_pictures(scene, options);
        if (!device) GTEST_SKIP() << "no EGL";
        const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 0, 0, 128});
        const std::vector<gl::DrawItem> all = scene.items, others{all[1], all[2]}, in_box{all[0], all[3]};
        capture(*device, picture, in_box);
        const Pose pose = pose_along(dvec3(0), picture, 0.5);
        for (const float resolution : model::resolution_steps) {
            const gl::PixelImage shown = frame_of(*device, pose, others, {&picture, 1}, resolution);
            const std::vector<gl::DrawItem> without{all[0], all[1], all[2]};
            const gl::PixelImage direct = frame_of(*device, pose, without, {}, resolution);
            EXPECT_LT(difference(pixel_of(shown, 48, 48), pixel_of(direct, 48, 48)), 3) << "blended over red, once";
            EXPECT_EQ(colour_at(shown, 48, 36), (std::array{255, 0, 0})) << resolution << ": a capture has no blended part";
            EXPECT_EQ(colour_at(shown, 48, 12), (std::array{0, 255, 0})) << resolution << ": holes show what is behind";
            EXPECT_LE(misplaced_pixels(in_two_colours(direct), in_two_colours(shown), 2, 0), 8) << resolution << ": corners";
            for (std::size_t i = 3; i < shown.rgba.size(); i += 4) ASSERT_EQ(shown.rgba[i], 255);
            gl::CachePicture beside = picture_from(pictured, dvec3(1, 2, 3), {0, 128, 128, 64});
            device->draws.plays();
            EXPECT_TRUE(device->capture_picture(beside, all));
            EXPECT_EQ(frame_of(*device, pose, others, {&picture, 1}, resolution).rgba, shown.rgba) << "captures change no frame";
        }
        device->draws.plays();
        if (device->rest_support() == gl::RestSupport::none) continue;
        const gl::PixelImage before = frame_of(*device, pose, all, {});
        frame_of(*device, pose, others, {&picture, 1}, 0.5F);
        device->begin_rest(pose, dvec2(0));
        device->draw_rest(all, gl::Parts::opaque);
        device->draw_rest(all, gl::Parts::blended);
        device->show_rest(1);
        device->finish_rest_frame();
        EXPECT_EQ(device->read_pixels()->rgba, before.rgba) << "at rest, after pictures";
    }
}

TEST(PictureDevice, draws_the_latest_capture_of_a_square_and_later_pictures_over_earlier_ones) {
    const PictureScene scene = squares({{vec3(1, 0, 0), dvec3(0, 0, -6), 0.9F}, {vec3(0, 1, 0), dvec3(0, 0, -6), 0.4F}});
    const auto device = open_with_pictures(scene, with_layers(64, 64));
    if (!device) GTEST_SKIP() << "no EGL";
    const gl::CachePicture one = picture_from(pictured, dvec3(0), {0, 0, 0, 128});
    gl::CachePicture two = one;
    two.place.column = 128;
    const Pose pose = pose_along(dvec3(0), one, 0.5);
    const std::span<const gl::DrawItem> items(scene.items);
    device->draws.plays();
    EXPECT_TRUE(device->capture_picture(one, items.first(1)));
    EXPECT_TRUE(device->capture_picture(two, items.last(1)));
    device->begin_frame(Pose{});
    EXPECT_EQ(device->stats().captures, 2U);
    device->finish_frame();
    for (const bool turned : {false, true}) {
        const std::array order{turned ? two : one, turned ? one : two};
        const gl::PixelImage shown = frame_of(*device, pose, {}, order);
        EXPECT_EQ(colour_at(shown, 32, 32), turned ? (std::array{255, 0, 0}) : (std::array{0, 255, 0}));
        EXPECT_EQ(device->stats().pictures, 2U);
        EXPECT_EQ(device->stats().batches, 1U) << "one draw call";
    }
    capture(*device, one, items.last(1));
    const gl::PixelImage anew = frame_of(*device, pose, {}, {&one, 1});
    EXPECT_EQ(colour_at(anew, 32, 32), (std::array{0, 255, 0}));
    EXPECT_EQ(colour_at(anew, 32, 12), (std::array{0, 0, 0})) << "nothing of the earlier capture is left";
    const std::vector<gl::CachePicture> many(500, one);  // more corners than the buffer has
    const gl::PixelImage again = frame_of(*device, pose, {}, many);
    EXPECT_EQ(colour_at(again, 32, 32), (std::array{0, 255, 0}));
    EXPECT_EQ(colour_at(again, 32, 12), (std::array{0, 0, 0}));
    EXPECT_EQ(device->stats().pictures, 500U);
    EXPECT_GT(device->stats().batches, 1U);
}

TEST(PictureDevice, draws_no_seam_where_a_picture_ends_before_its_own_colour) {
    const vec3 colour(0.8F, 0.6F, 0.4F);
    const PictureScene scene = squares({{colour, dvec3(0, 0, -6), 0.7F}, {colour, dvec3(0, 0, -9), 9}});
    const auto device = open_with_pictures(scene, with_layers(64, 64));
    if (!device) GTEST_SKIP() << "no EGL";
    const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 0, 0, 100});
    const std::span<const gl::DrawItem> items(scene.items);
    capture(*device, picture, items.first(1));
    for (int i = 0; i < 8; ++i) {
        const Pose pose = pose_along(dvec3(0.02 * i, 0.013 * i, 0.1 * i), picture, 0.5);
        const gl::PixelImage wall = frame_of(*device, pose, items.last(1), {});
        const gl::PixelImage shown = frame_of(*device, pose, items.last(1), {&picture, 1});
        EXPECT_EQ(misplaced_pixels(shown, wall, 0, 3), 0) << i;
    }
}

TEST(PictureDevice, captures_no_shadow_of_what_moves) {
    SmallModel small;
    const auto lawn = small.material(plain(1, 1, 1, 1, model::effect_sun | model::effect_moving_shadow));
    const auto node = small.square(lawn, at(0, 0, -6), 0.8F), mover = small.square(lawn, at(0, 0, -5.5), 0.5F);
    PictureScene scene{small.finish(), {{node, node - 1}, {mover, mover - 1}}};
    scene.model.motions.push_back({dvec3(0), 0, 1, 1, model::none});
    scene.model.motion_keys.emplace_back();
    scene.model.placements[scene.model.reps[mover - 1].placement].motion = 0;
    const auto device = open_with_pictures(scene, with_layers(64, 64));
    if (!device) GTEST_SKIP() << "no EGL";
    const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 0, 0, 128});
    const Pose pose = pose_along(dvec3(0), picture, 0.4);
    const std::span<const gl::DrawItem> items(scene.items);
    device->draws.plays();
    ASSERT_TRUE(device->receives_shadows());
    const auto lit = colour_at(frame_of(*device, pose, items.first(1), {}), 32, 32);
    gl::ShadowView view;  // the sun stands behind the eye
    view.origin = dvec3(0, 0, -6);
    view.from_origin = mat4(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 0.25F, 0), vec4(0, 0, 0.5F, 1));
    view.towards = vec3(0, 0, 1);
    view.texel_m = 0.01F;
    view.depth_m = 4;
    device->refresh_shadow(view, items.last(1));
    device->show_shadow(true);
    EXPECT_TRUE(device->capture_picture(picture, items.first(1)));
    const auto dark = colour_at(frame_of(*device, pose, items.first(1), {}), 32, 32);
    EXPECT_LT(dark[0], lit[0] - 20) << "the map is read";
    EXPECT_EQ(colour_at(frame_of(*device, pose, {}, {&picture, 1}), 32, 32), lit);
}

TEST(PictureDevice, captures_by_the_light_and_effects_of_the_frame_that_draws_them) {
    SmallModel small;
    auto board = plain(1, 1, 1, 1, model::effect_texture | model::effect_sun);
    board.texture = small.texture({255, 0, 0, 255}, {255, 0, 0, 255}, 16);
    const auto node = small.square(small.material(board), at(0, 0, -6), 0.8F);
    PictureScene scene{small.finish(), {{node, node - 1}}};
    auto options = with_layers(64, 64);
    options.switches = {model::effect_texture, model::effect_sun};
    const auto device = open_with_pictures(scene, options);
    if (!device) GTEST_SKIP() << "no EGL";
    const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 64, 64, 64});
    const Pose pose = pose_along(dvec3(0), picture, 0.4);
    std::vector<std::array<int, 3>> colours;
    constexpr model::EffectMask picture_bit = model::effect_texture, sun_bit = model::effect_sun;
    for (const model::EffectMask hidden : std::array<model::EffectMask, 4>{0, picture_bit, sun_bit, picture_bit | sun_bit}) {
        device->draws.plays();
        device->hide_effects(hidden);
        const auto direct = colour_at(frame_of(*device, pose, scene.items, {}), 32, 32);
        capture(*device, picture, scene.items);
        EXPECT_EQ(colour_at(frame_of(*device, pose, {}, {&picture, 1}), 32, 32), direct) << hidden;
        for (const auto& other : colours) EXPECT_NE(direct, other);
        colours.push_back(direct);
    }
}

TEST(PictureDevice, without_layers_has_nothing_of_it_and_with_them_changes_no_other_program) {
    const PictureScene scene = panes();
    const auto without = open_with_pictures(scene, with_layers(64, 64, 0));
    if (!without) GTEST_SKIP() << "no EGL";
    const auto with = open_with_pictures(scene, with_layers(64, 64, 1));
    const auto few = without->program_listing(), more = with->program_listing();
    ASSERT_EQ(more.size(), few.size() + 1) << "one for opaque leaves, none for blended ones";
    for (std::size_t i = 0; i < few.size(); ++i) EXPECT_EQ(few[i], more[i]);
    for (const model::EffectMask mask : std::array<model::EffectMask, 2>{0, model::effect_blend}) {
        const gl::ProgramSource source = effects::assemble_program(mask);
        EXPECT_EQ(without->program_text(mask), source.vertex + source.fragment);
        EXPECT_EQ(with->program_text(mask), without->program_text(mask));
        EXPECT_EQ(source.vertex.find("gl_ClipDistance"), std::string::npos);
        EXPECT_EQ(source.vertex.find("box_low"), std::string::npos);
        EXPECT_NE(source.vertex_in_box.find("gl_ClipDistance"), std::string::npos);
    }
    EXPECT_EQ(without->picture_reason(), "");
    const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 0, 0, 128});
    without->draws.plays();
    EXPECT_FALSE(without->capture_picture(picture, scene.items));
    EXPECT_EQ(lit_pixels(frame_of(*without, Pose{}, {}, {&picture, 1})), 0);
    EXPECT_EQ(without->stats().pictures, 0U);
}

TEST(PictureDevice, refuses_places_outside_of_its_layers_and_more_captures_than_wait) {
    const PictureScene scene = panes();
    auto null_options = with_layers(64, 64, 2);
    for (const bool null : {false, true}) {
        null_options.kind = null ? gl::BackendKind::null : gl::BackendKind::egl;
        const auto device = open_with_pictures(scene, null_options);
        if (!device) continue;
        device->draws.plays();
        gl::CachePicture picture = picture_from(pictured, dvec3(0), {1, 128, 128, 128});
        for (const gl::PicturePlace& bad : {gl::PicturePlace{2, 0, 0, 64},
                                            {0, 193, 0, 64},
                                            {0, 0, 193, 64},
                                            {0, 0, 0, 0},
                                            {0, 0, 0, 257},
                                            {0, 65535, 65535, 65535}}) {
            gl::CachePicture wrong = picture;
            wrong.place = bad;
            EXPECT_FALSE(device->capture_picture(wrong, scene.items));
        }
        for (std::uint32_t i = 0; i < gl::max_captures; ++i) EXPECT_TRUE(device->capture_picture(picture, {}));
        EXPECT_FALSE(device->capture_picture(picture, {}));
        device->begin_frame(Pose{});
        EXPECT_EQ(device->stats().captures, gl::max_captures);
        device->draw_pictures({&picture, 1});
        EXPECT_EQ(device->stats().pictures, 1U);
        device->end_items();
        device->finish_frame();
        device->begin_frame(Pose{});
        EXPECT_EQ(device->stats().captures, 0U);
        EXPECT_EQ(device->stats().pictures, 0U);
        device->finish_frame();
        EXPECT_TRUE(device->capture_picture(picture, {}));
    }
}

TEST(PictureDevice, leaves_out_pictures_that_an_eye_cannot_see) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    std::array<gl::PictureVertex, gl::max_picture_vertices> to;
    const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 0, 0, 128});
    EXPECT_GT(gl::add_picture(picture, dvec3(0.1, 0.2, 0.3), to), 0U);
    for (const dvec3& eye : {dvec3(0, 0, -6), dvec3(0, 0, -5), dvec3(0, 0, -5.96), dvec3(0, 0, -8), dvec3(3, 0, -6), dvec3(nan),
                             dvec3(infinite), dvec3(0, 0, -infinite), dvec3(1e300, 0, 0)})
        EXPECT_EQ(gl::add_picture(picture, eye, to), 0U) << eye.x << " " << eye.z;
    for (const auto& change : std::array<void (*)(gl::CachePicture&), 6>{
             [](gl::CachePicture& p) { p.side_m = 0; }, [](gl::CachePicture& p) { p.side_m = nan; },
             [](gl::CachePicture& p) { p.plane_m = nan; }, [](gl::CachePicture& p) { p.box = Box{}; },
             [](gl::CachePicture& p) { p.low_m.x = nan; }, [](gl::CachePicture& p) { p.forward = dvec3(nan); }}) {
        gl::CachePicture wrong = picture;
        change(wrong);
        EXPECT_EQ(gl::add_picture(wrong, dvec3(0), to), 0U);
    }
    gl::CachePicture small_square = picture;  // its square holds a part of the box
    small_square.low_m = dvec2(0);
    const std::size_t count = gl::add_picture(small_square, dvec3(0.1, -0.2, 0), to);
    EXPECT_GT(count, 0U);
    for (std::size_t i = 0; i < count; ++i)
        for (const float at : {to[i].at[0], to[i].at[1]}) EXPECT_TRUE(at >= 0.5F / 256 && at <= 127.5F / 256) << at;
}

/// A device on the fake, with four red squares.
class PicturesOnFake : public ::testing::Test {
protected:
    std::unique_ptr<gl::Device> open(std::uint32_t layers, auto prepare) {
        auto options = with_layers(64, 64, layers);
        auto device = gl::GlDevice::make(std::make_unique<FakeContext>(), options);
        EXPECT_TRUE(device.ok());
        prepare(FakeGl::get());
        (*device)->draws.plays();
        EXPECT_TRUE((*device)->load(scene_.model, effects::assemble_program).ok());
        return std::move(*device);
    }
    PictureScene scene_ = panes();
};

TEST_F(PicturesOnFake, a_device_that_cannot_have_them_opens_without_and_has_a_reason) {
    const auto nothing = [](FakeGl&) {};
    open(0, nothing);
    const int objects = FakeGl::get().objects(), compiles = FakeGl::get().compiles, maps = FakeGl::get().maps;
    const int checks = FakeGl::get().framebuffers_asked;
    EXPECT_EQ(open(3, nothing)->picture_layers(), 3U);
    EXPECT_GT(FakeGl::get().objects(), objects + 3);
    for (const auto& prepare : std::array<std::function<void(FakeGl&)>, 5>{
             [](FakeGl& fake) { fake.max_texture_size = 2; },  // of everything that it is requested for: layers, clip distances
             [&](FakeGl& fake) { fake.bad_framebuffer = checks + 2; }, [&](FakeGl& fake) { fake.bad_map = maps + 1; },
             [&](FakeGl& fake) { fake.bad_compile = compiles + 1; },     // what draws pictures
             [&](FakeGl& fake) { fake.bad_compile = compiles + 4; }}) {  // what captures
        const auto device = open(3, prepare);
        EXPECT_EQ(device->picture_layers(), 0U);
        EXPECT_NE(device->picture_reason(), "");
        EXPECT_EQ(FakeGl::get().objects(), objects) << "what cannot be used is freed";
        device->draws.plays();
        const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 0, 0, 128});
        EXPECT_FALSE(device->capture_picture(picture, scene_.items));
        draw_frame(*device, Pose{}, scene_.items, {&picture, 1});
    }
    const auto device = open(3, nothing);
    const int once = FakeGl::get().objects();
    device->draws.plays();
    EXPECT_TRUE(device->load(scene_.model, effects::assemble_program).ok());
    EXPECT_EQ(FakeGl::get().objects(), once) << "a second load frees the first";
}

TEST_F(PicturesOnFake, on_a_lost_device_all_calls_are_safe_and_draw_nothing) {
    const auto device = open(1, [](FakeGl&) {});
    const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 0, 0, 128});
    device->draws.plays();
    EXPECT_TRUE(device->capture_picture(picture, scene_.items));
    FakeGl::get().wait_results = {GL_WAIT_FAILED};
    draw_frame(*device, Pose{}, scene_.items, {&picture, 1});
    ASSERT_TRUE(device->lost());
    const auto before = FakeGl::get().mapped;
    const int draws = FakeGl::get().array_draws;
    EXPECT_FALSE(device->capture_picture(picture, scene_.items));
    draw_frame(*device, Pose{}, scene_.items, {&picture, 1});
    EXPECT_EQ(device->stats().captures, 0U);
    EXPECT_EQ(device->stats().pictures, 0U);
    EXPECT_EQ(FakeGl::get().array_draws, draws);
    EXPECT_EQ(FakeGl::get().mapped, before) << "rewritten while the GPU may read them";
}

/// Once too many targets have waited, llvmpipe never again draws beside what hands over.
TEST_F(PicturesOnFake, few_targets_wait_at_once) {
    const auto device = open(128, [](FakeGl&) {});
    EXPECT_LE(FakeGl::get().max_cleared, 8) << "a layer each is cleared";
    device->draws.plays();
    device->begin_frame(Pose{});
    device->finish_frame();
    FakeGl::get().cleared = FakeGl::get().max_cleared = 0;
    for (std::uint16_t i = 0; i < gl::max_captures; ++i)
        EXPECT_TRUE(device->capture_picture(picture_from(pictured, dvec3(0), {i, 0, 0, 128}), scene_.items));
    draw_frame(*device, Pose{}, scene_.items, {});
    EXPECT_EQ(device->stats().captures, gl::max_captures);
    EXPECT_LE(FakeGl::get().max_cleared, 32);
    EXPECT_GE(FakeGl::get().max_cleared, 8) << "a walk's new pictures of a frame need no wait";
}

TEST_F(PicturesOnFake, captures_that_wait_are_drawn_once_and_end_with_a_load) {
    const auto device = open(1, [](FakeGl&) {});
    const gl::CachePicture picture = picture_from(pictured, dvec3(0), {0, 0, 0, 128});
    device->draws.plays();
    EXPECT_TRUE(device->capture_picture(picture, scene_.items));
    EXPECT_TRUE(device->load(scene_.model, effects::assemble_program).ok());
    device->begin_frame(Pose{});
    EXPECT_EQ(device->stats().captures, 0U);
    device->finish_frame();
    EXPECT_TRUE(device->capture_picture(picture, scene_.items));
    FakeGl::get().clip_planes = 0;
    device->begin_rest(Pose{}, dvec2(0));
    EXPECT_EQ(FakeGl::get().clip_planes, 6U);
    EXPECT_EQ(FakeGl::get().enabled.count(GL_SCISSOR_TEST), 0U);
    for (GLenum plane = 0; plane < 6; ++plane) EXPECT_EQ(FakeGl::get().enabled.count(GL_CLIP_DISTANCE0 + plane), 0U);
    device->finish_rest_frame();
    device->begin_frame(Pose{});
    EXPECT_EQ(device->stats().captures, 0U) << "a picture at rest has drawn it";
    device->finish_frame();
}

}  // namespace
}  // namespace surefoot::test
