// Making a device's objects step by step: where a step fails, nothing that was made before is left.
#include "render/gl/resources.hpp"

#include <gtest/gtest.h>

#include "render/draw/tables.hpp"
#include "render/effects/effects.hpp"
#include "render/gl/gl_device.hpp"
#include "render/gl/rest_targets.hpp"
#include "render/gl/sample_targets.hpp"
#include "render/gl/targets.hpp"
#include "tests/gl/fake_gl.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

using test::FakeGl;

class ResourceObjects : public ::testing::Test {
protected:
    void SetUp() override { FakeGl::get() = {}; }
    /// Two state classes, so that a program is there when the next one fails; and two arrays of textures.
    static model::Model two_programs_two_textures() {
        test::SmallModel scene;
        for (const std::uint32_t size : {4U, 8U}) {
            model::Material material = test::plain(1, 1, 1);
            material.texture = scene.texture({255, 255, 255, 255}, {0, 0, 0, 255}, size);
            material.effects = model::effect_texture;
            scene.square(scene.material(material), test::at(0, 0, -5));
        }
        scene.square(scene.material(test::plain(1, 0, 0)), test::at(1, 0, -5));
        return scene.finish();
    }
    static Result<gl::Resources> load() {
        const model::Model model = two_programs_two_textures();
        const draw::DrawTables tables = draw::make_tables(model);
        EXPECT_EQ(tables.masks.size(), 2U);
        EXPECT_EQ(tables.textures.arrays.size(), 2U);
        return gl::load_resources(test::fake_api(), model, tables.masks, tables.textures, effects::assemble_program, {}, {});
    }
};

TEST_F(ResourceObjects, what_is_loaded_is_freed_whole) {
    auto loaded = load();
    ASSERT_TRUE(loaded.ok()) << loaded.error().text();
    EXPECT_EQ(FakeGl::get().buffers, 2);
    EXPECT_EQ(FakeGl::get().textures, 2);
    EXPECT_EQ(FakeGl::get().programs, 2);
    EXPECT_EQ(FakeGl::get().vertex_arrays, 2);
    gl::free_resources(test::fake_api(), *loaded);
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, nothing_is_left_where_geometry_does_not_fit) {
    FakeGl::get().bad_error = 1;
    EXPECT_FALSE(load().ok());
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, nothing_is_left_where_a_later_texture_is_too_large) {
    FakeGl::get().max_texture_size = 4;
    EXPECT_FALSE(load().ok());
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, nothing_is_left_where_textures_do_not_fit) {
    FakeGl::get().bad_error = 2;
    EXPECT_FALSE(load().ok());
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, nothing_is_left_where_a_later_program_does_not_compile) {
    FakeGl::get().bad_compile = 3;  // the second program's first shader
    EXPECT_FALSE(load().ok());
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, nothing_is_left_of_a_target_that_cannot_be_drawn_into) {
    FakeGl::get().framebuffer_status = GL_FRAMEBUFFER_UNSUPPORTED;
    EXPECT_FALSE(gl::make_targets(test::fake_api(), {64, 64}).ok());
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, targets_are_freed_whole_also_where_the_enlarging_pass_does_not_link) {
    FakeGl::get().links = false;
    EXPECT_FALSE(gl::make_targets(test::fake_api(), {64, 64}).ok());
    EXPECT_EQ(FakeGl::get().objects(), 0);
    FakeGl::get().links = true;
    auto targets = gl::make_targets(test::fake_api(), {64, 64});
    ASSERT_TRUE(targets.ok());
    EXPECT_EQ(FakeGl::get().framebuffers, static_cast<int>(model::resolution_steps.size()));
    gl::free_targets(test::fake_api(), *targets);
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, a_driver_without_a_target_for_rest_still_opens) {
    using gl::RestSupport;
    const int steps = static_cast<int>(model::resolution_steps.size());
    for (const auto& [bad, expected] :
         {std::pair{0, RestSupport::samples}, {steps + 1, RestSupport::none}, {steps + 2, RestSupport::picture}}) {
        auto context = std::make_unique<test::FakeContext>();
        FakeGl::get().bad_framebuffer = bad;
        gl::DeviceOptions options;
        options.viewport = {64, 64};
        options.rest = true;
        auto device = gl::GlDevice::make(std::move(context), options);
        ASSERT_TRUE(device.ok()) << bad;
        (*device)->draws.plays();
        EXPECT_EQ((*device)->rest_support(), expected) << bad;
        const int more = expected == RestSupport::samples ? 2 : expected == RestSupport::picture ? 1 : 0;
        EXPECT_EQ(FakeGl::get().framebuffers, steps + more) << "what cannot be used is freed";
        (*device)->begin_rest(Pose{}, {0.25, 0.25});
        (*device)->add_sample(true);
        (*device)->show_rest(1);
        (*device)->finish_rest_frame();
        EXPECT_EQ(FakeGl::get().syncs, 0);
    }
}

TEST_F(ResourceObjects, a_driver_without_samples_still_opens_and_says_what_it_draws) {
    const int steps = static_cast<int>(model::resolution_steps.size());
    for (const auto& [most, requested, drawn] :
         {std::tuple{4, 4U, 4U}, {4, 2U, 2U}, {4, 1U, 1U}, {2, 4U, 2U}, {1, 4U, 1U}, {0, 2U, 1U}}) {
        auto context = std::make_unique<test::FakeContext>();
        FakeGl::get().max_samples = most;
        gl::DeviceOptions options;
        options.viewport = {64, 64};
        options.samples = requested;
        auto device = gl::GlDevice::make(std::move(context), options);
        ASSERT_TRUE(device.ok()) << most;
        (*device)->draws.plays();
        EXPECT_EQ((*device)->samples(), drawn) << most;
        EXPECT_EQ(FakeGl::get().framebuffers, drawn > 1 ? 2 * steps : steps) << most;
        (*device)->begin_frame(Pose{}, 0.5F);
        (*device)->finish_frame();
        EXPECT_EQ((*device)->stats().samples, drawn);
    }
}

TEST_F(ResourceObjects, a_change_of_the_filter_takes_two_calls_for_each_array_with_mip_levels) {
    static int calls, blended;
    calls = blended = 0;
    gl::Api api = test::fake_api();
    api.BindTexture = [](GLenum, GLuint) { ++calls; };
    api.TexParameteri = [](GLenum, GLenum what, GLint value) {
        ++calls;
        blended += what == GL_TEXTURE_MIN_FILTER && value == GL_LINEAR_MIPMAP_LINEAR ? 1 : 0;
    };
    draw::TextureLayout layout;
    layout.arrays.resize(3);
    for (const auto& [i, levels] : {std::pair{0U, 4U}, {1U, 1U}, {2U, 7U}}) layout.arrays[i].levels = levels;
    gl::Resources resources;
    resources.textures = {11, 12, 13};
    gl::set_mip_levels(api, layout, resources, true);
    EXPECT_EQ(calls, 4);
    EXPECT_EQ(blended, 2);
    gl::set_mip_levels(api, layout, resources, false);
    EXPECT_EQ(calls, 8);
    EXPECT_EQ(blended, 2);
}

TEST_F(ResourceObjects, a_bias_of_mip_levels_is_set_for_each_array_that_has_them) {
    static int biased;
    biased = 0;
    gl::Api api = test::fake_api();
    api.TexParameterf = [](GLenum, GLenum what, GLfloat value) {
        biased += what == GL_TEXTURE_LOD_BIAS && value == -0.5F ? 1 : 0;
    };
    draw::TextureLayout layout;
    layout.arrays.resize(3);
    for (const auto& [i, levels] : {std::pair{0U, 4U}, {1U, 1U}, {2U, 7U}}) layout.arrays[i].levels = levels;
    gl::Resources resources;
    resources.textures = {11, 12, 13};
    gl::set_mip_bias(api, layout, resources, -0.5F);
    EXPECT_EQ(biased, 2);
}

TEST_F(ResourceObjects, fewer_samples_are_tried_where_more_do_not_fit_and_nothing_is_left_of_them) {
    FakeGl::get().bad_framebuffer = 3;  // of those with four
    auto targets = gl::make_sample_targets(test::fake_api(), {64, 64}, 4);
    EXPECT_EQ(targets.samples, 2U);
    EXPECT_EQ(FakeGl::get().framebuffers, static_cast<int>(model::resolution_steps.size()));
    gl::free_sample_targets(test::fake_api(), targets);
    EXPECT_EQ(FakeGl::get().objects(), 0);
    FakeGl::get().framebuffer_status = GL_FRAMEBUFFER_UNSUPPORTED;
    targets = gl::make_sample_targets(test::fake_api(), {64, 64}, 4);
    EXPECT_EQ(targets.samples, 1U);
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, errors_without_end_are_asked_for_a_few_times_only) {
    FakeGl::get().lost_error = GL_CONTEXT_LOST;
    EXPECT_EQ(gl::take_errors(test::fake_api()), static_cast<GLenum>(GL_CONTEXT_LOST));
    EXPECT_LE(FakeGl::get().errors_asked, 16);
    EXPECT_FALSE(gl::check_errors(test::fake_api(), "here", "none").ok());
    EXPECT_LE(FakeGl::get().errors_asked, 32);
    EXPECT_EQ(gl::make_sample_targets(test::fake_api(), {64, 64}, 4).samples, 1U);
    EXPECT_LE(FakeGl::get().errors_asked, 64) << "for four samples, and for two";
    EXPECT_EQ(FakeGl::get().objects(), 0);
}

TEST_F(ResourceObjects, targets_for_rest_are_freed_whole_where_a_pass_does_not_link) {
    auto targets = gl::make_targets(test::fake_api(), {64, 64});
    ASSERT_TRUE(targets.ok());
    const int before = FakeGl::get().objects();
    FakeGl::get().links = false;
    auto rest = gl::make_rest_targets(test::fake_api(), *targets);
    EXPECT_NE(rest.picture.framebuffer, 0U);
    EXPECT_EQ(rest.sum.framebuffer, 0U) << "no samples without their passes";
    EXPECT_EQ(FakeGl::get().objects(), before + 2);
    gl::free_rest_targets(test::fake_api(), rest);
    EXPECT_EQ(FakeGl::get().objects(), before);
}

TEST_F(ResourceObjects, nothing_is_left_where_a_frame_buffer_cannot_be_mapped) {
    for (const int bad : {1, 2}) {
        FakeGl::get() = {};
        FakeGl::get().bad_map = bad;
        EXPECT_FALSE(gl::make_frame_buffers(test::fake_api(), 16).ok());
        EXPECT_EQ(FakeGl::get().objects(), 0) << bad;
    }
}

}  // namespace
}  // namespace surefoot
