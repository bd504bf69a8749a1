// The frame's own code allocates nothing. operator new is counted: our code and the standard library use it, and so
// does the driver's compiler, while the driver's C code calls malloc.

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "render/gl/window_events.hpp"
#include "tests/gl/small_models.hpp"
#include "tests/gl/x_server.hpp"

namespace {
thread_local bool counting = false;
std::atomic<long> counted{0};
}  // namespace

#ifndef SUREFOOT_SANITIZED  // sanitizers have a hook of their own: these tests count nothing there, and say so
#pragma GCC diagnostic ignored "-Wmismatched-new-delete"  // the pair below is matched; inlining hides it
// operator new is what our code and the standard library allocate with; the driver, in C, calls malloc.
void* operator new(std::size_t size) {
    if (counting) counted.fetch_add(1);
    if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
    throw std::bad_alloc();
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace surefoot {
namespace {

struct Counted {
    model::Model model;
    std::vector<gl::DrawItem> items;
};

/// Behind the eye of Pose{}, where the warm-up at load draws; in front of the eye of frame().
Counted many_squares() {
    test::SmallModel scene;
    auto glass = test::plain(1, 0, 0, 0.5F, model::effect_blend);
    const auto a = scene.material(test::plain(1, 0, 0));
    const auto b = scene.material(test::plain(0, 1, 0, 1, model::effect_sun));
    const auto c = scene.material(glass);
    Counted counted_scene;
    for (int i = 0; i < 500; ++i) {
        const auto node = scene.square(i % 3 == 0 ? a : i % 3 == 1 ? b : c, test::at(0.01 * i - 2, 0, 8.0 - 0.01 * i), 0.1F);
        counted_scene.items.push_back({node, node - 1});
    }
    counted_scene.model = scene.finish();
    return counted_scene;
}

void frame(gl::Device& device, const std::vector<gl::DrawItem>& items, float resolution = 1) {
    Pose pose;
    pose.position.z = 11;
    device.draws.plays();
    device.begin_frame(pose, resolution);
    const std::span<const gl::DrawItem> all(items);
    for (std::size_t i = 0; i < items.size(); i += 100) {
        device.draw(all.subspan(i, std::min<std::size_t>(100, items.size() - i)));
        device.end_slice();
        device.wait_slices(2);
    }
    device.end_items();
    device.finish_frame();
}

/// False where allocations cannot be counted.
/// No such library, or a sanitizer that allows no GL. Anything else is a failure.
bool is_absent(const Result<std::unique_ptr<gl::Device>>& device) {
    return !device.ok() && device.error().kind == ErrorKind::unsupported;
}

bool can_count() {
#ifdef SUREFOOT_SANITIZED
    return false;
#else
    return true;
#endif
}

long allocations_of_a_frame(gl::Device& device, const Counted& scene) {
    frame(device, scene.items);
    counted = 0;
    counting = true;
    frame(device, scene.items);
    counting = false;
    return counted;
}

TEST(Allocation, a_frame_on_gl_makes_none_of_its_own) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    const auto scene = many_squares();
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    // The JIT of a software driver is C++: anything left here after the warm-up frame would be a compilation in a frame.
    EXPECT_EQ(allocations_of_a_frame(**device, scene), 0);
}

TEST(Allocation, a_frame_with_several_samples_a_pixel_makes_none_of_its_own) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    const auto scene = many_squares();
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    options.samples = 4;
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    EXPECT_EQ(allocations_of_a_frame(**device, scene), 0);
}

TEST(Allocation, a_shadow_map_makes_none_and_compiles_nothing) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    test::SmallModel small;
    model::Material leaf = test::plain(1, 1, 1, 1, model::effect_texture | model::effect_alpha_mask);
    leaf.texture = small.texture({255, 0, 0, 255}, {0, 0, 255, 0}, 64);
    const auto lawn = small.material(test::plain(0, 1, 0, 1, model::effect_sun | model::effect_moving_shadow));
    const auto red = small.material(test::plain(1, 0, 0)), leaves = small.material(leaf);
    Counted scene;
    for (int i = 0; i < 99; ++i) {
        const auto node = small.square(i % 3 == 0   ? lawn
                                       : i % 3 == 1 ? red
                                                    : leaves,
                                       test::at(0.02 * i - 1, 0, 8.0 - 0.01 * i), 0.1F);
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    scene.model.motions.push_back({dvec3(0), 0, 1, 1, model::none});
    scene.model.motion_keys.emplace_back();
    std::vector<gl::DrawItem> casters;
    for (const gl::DrawItem& item : scene.items) {
        if (item.node % 3 == 1) continue;
        scene.model.placements[scene.model.reps[item.rep].placement].motion = 0;
        casters.push_back(item);
    }
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    ASSERT_TRUE((*device)->receives_shadows());
    frame(**device, scene.items);
    gl::ShadowView view;
    view.origin = dvec3(0, 0, 7);
    view.texel_m = 0.01F;
    counted = 0;
    counting = true;
    (*device)->refresh_shadow(view, casters);
    (*device)->show_shadow(true);
    frame(**device, scene.items);
    counting = false;
    EXPECT_EQ(counted, 0);
}

TEST(Allocation, pictures_of_the_image_cache_make_none_and_compile_nothing) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    test::SmallModel small;
    model::Material leaf = test::plain(1, 1, 1, 1, model::effect_texture | model::effect_alpha_mask);
    leaf.texture = small.texture({255, 0, 0, 255}, {0, 0, 255, 0}, 64);
    const std::array materials{small.material(leaf), small.material(test::plain(0, 1, 0, 1, model::effect_sun)),
                               small.material(test::plain(0, 1, 0, 0.5F, model::effect_blend))};
    Counted scene;
    for (int i = 0; i < 99; ++i) {
        const auto node =
            small.square(materials[static_cast<std::size_t>(i) % 3], test::at(0.02 * i - 1, 0, 8.0 - 0.01 * i), 0.1F);
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    for (const std::uint32_t samples : {1U, 4U}) {
        gl::DeviceOptions options;
        options.viewport = {64, 64};
        options.picture_layers = 2;
        options.mesh_triangles = 64;
        options.samples = samples;
        options.second_filter = options.smaller = true;
        options.switches = {model::effect_sun, model::effect_blend};
        auto device = gl::open_device(options);
        if (is_absent(device)) GTEST_SKIP() << device.error().text();
        ASSERT_TRUE(device.ok()) << device.error().text();
        (*device)->draws.plays();
        ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
        ASSERT_EQ((*device)->picture_layers(), 2U);
        std::array<gl::CachePicture, 2> pictures;
        for (std::uint16_t i = 0; i < 2; ++i) {
            pictures[i].place = {i, static_cast<std::uint16_t>(128 * i), 0, static_cast<std::uint16_t>(256 - 128 * i)};
            pictures[i].eye = dvec3(0, 0, 11);
            pictures[i].plane_m = 3;
            pictures[i].low_m = dvec2(-1);
            pictures[i].side_m = 2;
            pictures[i].box = {dvec3(-0.9, -0.9, 7), dvec3(0.9, 0.9, 8 + i)};
        }
        Pose pose;
        pose.position.z = 11;
        std::vector<float> depths(std::size_t{256} * 256);
        const std::array<gl::MeshCorner, 3> corners{
            gl::MeshCorner{vec3(0, 0, -3), vec2(1)}, {vec3(1, 0, -3), vec2(9)}, {vec3(1), vec2(4)}};
        const std::array<std::uint16_t, 3> indices{0, 1, 2};
        const gl::PictureMesh mesh{pictures[0].place, pose.position, corners, indices};
        counted = 0;
        counting = true;
        for (unsigned i = 0; i < 8; ++i) {
            (*device)->set_filter(i < 4 ? rt::TextureFilter::bilinear : rt::TextureFilter::trilinear);
            (*device)->hide_effects((i & 1U) != 0 ? model::effect_sun | model::effect_blend : 0);
            (*device)->capture_picture(pictures[0], scene.items);
            (*device)->capture_depths(pictures[1], scene.items, depths);
            (*device)->begin_frame(pose, (i & 2U) != 0 ? 0.625F : 1.0F);
            (*device)->draw(scene.items);
            (*device)->draw_picture_meshes({&mesh, 1});
            (*device)->draw_pictures(pictures);
            (*device)->end_slice();
            (*device)->end_items();
            (*device)->finish_frame();
            counting = false;
            EXPECT_EQ((*device)->stats().captures, 2U);
            EXPECT_EQ((*device)->stats().meshes, 1U);
            EXPECT_EQ((*device)->stats().pictures, 2U);
            counting = true;
        }
        counting = false;
        EXPECT_EQ(counted, 0) << samples << " samples";
    }
}

TEST(Allocation, a_sky_makes_none_and_compiles_nothing) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    auto scene = many_squares();
    scene.model.effects.push_back({model::effect_sky, true, 0, "by hand", true});
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    options.rest = true;
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    ASSERT_NE((*device)->program_text(model::effect_sky), "");
    counted = 0;
    counting = true;
    for (const float resolution : model::resolution_steps) frame(**device, scene.items, resolution);
    (*device)->begin_rest(Pose{}, dvec2(0.3));
    (*device)->draw_rest(scene.items, gl::Parts::all);
    (*device)->show_rest(1);
    (*device)->finish_rest_frame();
    counting = false;
    EXPECT_EQ(counted, 0);
}

TEST(Allocation, a_change_of_the_filter_makes_none_and_compiles_nothing) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    test::SmallModel small;
    model::Material picture = test::plain(1, 1, 1, 1, model::effect_texture);
    picture.texture = small.texture({255, 0, 0, 255}, {0, 0, 255, 255}, 64);
    model::Material leaf = picture;
    leaf.effects |= model::effect_alpha_mask;
    const auto a = small.material(picture), b = small.material(leaf);
    Counted scene;
    for (int i = 0; i < 100; ++i) {
        const auto node = small.square(i % 2 == 0 ? a : b, test::at(0.02 * i - 1, 0, 8.0 - 0.01 * i), 0.1F);
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    options.second_filter = true;
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    if (!(*device)->switches_filter()) GTEST_SKIP() << "no software driver";
    counted = 0;
    counting = true;
    for (int i = 0; i < 6; ++i) {
        (*device)->set_filter(i % 3 == 0 ? rt::TextureFilter::trilinear : rt::TextureFilter::bilinear);
        frame(**device, scene.items, i < 3 ? 1 : 0.5F);
    }
    counting = false;
    EXPECT_EQ(counted, 0);
}

TEST(Allocation, a_change_of_the_resolution_makes_none_and_compiles_nothing) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    test::SmallModel small;
    model::Material picture = test::plain(1, 1, 1, 1, model::effect_texture);
    picture.texture = small.texture({255, 0, 0, 255}, {0, 0, 255, 255}, 64);
    const auto material = small.material(picture);
    Counted scene;
    for (int i = 0; i < 100; ++i) {
        const auto node = small.square(material, test::at(0.02 * i - 1, 0, 8.0 - 0.01 * i), 0.1F);
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    options.smaller = true;
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    counted = 0;
    counting = true;
    for (const float resolution : {1.0F, 0.5F, 0.75F, 1.0F, 0.875F}) frame(**device, scene.items, resolution);
    counting = false;
    EXPECT_EQ(counted, 0);
}

TEST(Allocation, a_picture_at_rest_makes_none_and_compiles_nothing) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    const auto scene = many_squares();
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    options.rest = true;
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    ASSERT_EQ((*device)->rest_support(), gl::RestSupport::samples);
    Pose pose;
    pose.position.z = 11;
    counted = 0;
    counting = true;
    for (std::uint32_t sample = 0; sample < 3; ++sample) {
        (*device)->begin_rest(pose, dvec2(0.1 * sample));
        (*device)->draw_rest(scene.items, gl::Parts::opaque);
        (*device)->draw_rest(scene.items, gl::Parts::blended);
        (*device)->add_sample(sample == 0);
        (*device)->show_rest(sample + 1);
        (*device)->finish_rest_frame();
    }
    counting = false;
    EXPECT_EQ(counted, 0);
}

TEST(Allocation, a_window_of_another_size_makes_none_and_compiles_nothing) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    auto server = test::XServer::start();
    if (!server) GTEST_SKIP() << server.error().text();
    auto visitor = test::XVisitor::come();
    if (!visitor) GTEST_SKIP() << visitor.error().text();
    const auto scene = many_squares();
    gl::DeviceOptions options;
    options.kind = gl::BackendKind::window;
    options.viewport = {64, 64};
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    const auto window = (*device)->window();
    for (const unsigned width : {64U, 200U}) {
        (*visitor)->resize(window->id(), width, 100);
        for (int i = 0; i < 200 && window->size() != gl::WindowSize{width, 100}; ++i) {
            test::wait_ms(5);
            for (WindowEvent event; window->next(event);) {
            }
        }
        ASSERT_EQ(window->size(), (gl::WindowSize{width, 100}));
        counted = 0;
        counting = true;
        for (int i = 0; i < 3; ++i) {
            frame(**device, scene.items);
            (*device)->present();
        }
        counting = false;
        EXPECT_EQ(counted, 0) << "in a window of " << width << " pixels";
    }
}

TEST(Allocation, a_frame_on_null_makes_none) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    const auto scene = many_squares();
    auto device = gl::open_null_device({}, {});
    ASSERT_TRUE(device.ok());
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    EXPECT_EQ(allocations_of_a_frame(**device, scene), 0);
}

TEST(Allocation, the_first_frame_after_load_compiles_nothing) {
    if (!can_count()) GTEST_SKIP() << "built with sanitizers: operator new is theirs";
    const auto scene = many_squares();
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    auto device = gl::open_device(options);
    if (is_absent(device)) GTEST_SKIP() << device.error().text();
    ASSERT_TRUE(device.ok()) << device.error().text();
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    for (const float resolution : model::resolution_steps) {
        counted = 0;
        counting = true;
        frame(**device, scene.items, resolution);
        counting = false;
        EXPECT_EQ(counted, 0) << "a state combination was not warmed up: LLVM ran inside the frame, at " << resolution;
    }
}

}  // namespace
}  // namespace surefoot
