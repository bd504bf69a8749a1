// Making a device's objects step by step: where a step fails, nothing that was made before is left.
#include "render/gl/resources.hpp"

#include <gtest/gtest.h>

#include "render/draw/tables.hpp"
#include "render/effects/effects.hpp"
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
        return gl::load_resources(test::fake_api(), model, tables.masks, tables.textures, effects::assemble_program, {}, false);
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
