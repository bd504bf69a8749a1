// What a driver does that no driver here does on demand: fences that time out or fail, shaders that do not compile or link.
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/gl_device.hpp"
#include "render/gl/program.hpp"
#include "tests/gl/fake_gl.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

using test::FakeGl;

class LostDevice : public ::testing::Test {
protected:
    void SetUp() override {
        gl::DeviceOptions options;
        options.viewport = {64, 64};
        options.max_items = 16;
        auto device = gl::GlDevice::make(std::make_unique<test::FakeContext>(), options);
        ASSERT_TRUE(device.ok()) << device.error().text();
        device_ = std::move(*device);
        test::SmallModel scene;
        const auto material = scene.material(test::plain(1, 0, 0));
        for (int i = 0; i < 4; ++i) nodes_.push_back(scene.square(material, test::at(i, 0, -5)));
        model_ = scene.finish();
        device_->draws.plays();
        const auto loaded = device_->load(model_, effects::assemble_program);
        ASSERT_TRUE(loaded.ok()) << loaded.error().text();
        FakeGl::get().waits = FakeGl::get().presents = 0;
    }
    void draw(std::size_t from, std::size_t count) {
        std::vector<gl::DrawItem> items;
        for (std::size_t i = from; i < from + count; ++i) items.push_back({nodes_[i], model_.nodes[nodes_[i]].first_rep});
        device_->draws.plays();
        device_->draw(items);
        device_->end_slice();
    }
    void frame(std::size_t from = 0) {
        device_->draws.plays();
        device_->begin_frame(Pose{});
        draw(from, 2);
        device_->end_items();
        device_->finish_frame();
        device_->present();
    }
    std::unique_ptr<gl::Device> device_;
    model::Model model_;
    std::vector<model::Index> nodes_;
};

TEST_F(LostDevice, a_fence_that_takes_longer_than_a_wait_is_waited_for_again) {
    FakeGl::get().wait_results = {GL_TIMEOUT_EXPIRED, GL_TIMEOUT_EXPIRED, GL_CONDITION_SATISFIED};
    device_->draws.plays();
    device_->begin_frame(Pose{});
    draw(0, 2);
    device_->wait_slices(0);
    EXPECT_EQ(FakeGl::get().waits, 3);
    EXPECT_FALSE(device_->lost());
    device_->finish_frame();
    EXPECT_EQ(FakeGl::get().presents, 0) << "a whole picture waits for its time";
    device_->present();
    EXPECT_EQ(FakeGl::get().presents, 1);
}

TEST_F(LostDevice, a_fence_that_never_passes_is_given_up_within_a_bound) {
    FakeGl::get().wait_results = {GL_TIMEOUT_EXPIRED};
    frame();
    device_->draws.plays();
    EXPECT_TRUE(device_->lost());
    EXPECT_GT(FakeGl::get().waits, 1);
    EXPECT_LE(FakeGl::get().waits, 100);
    EXPECT_EQ(FakeGl::get().presents, 0) << "a picture that was not finished is shown";
    EXPECT_EQ(FakeGl::get().syncs, 0) << "fences are left behind";
    EXPECT_FALSE(device_->read_pixels().ok());
}

TEST_F(LostDevice, a_wait_that_fails_loses_the_device_at_once) {
    FakeGl::get().wait_results = {GL_WAIT_FAILED};
    frame();
    device_->draws.plays();
    EXPECT_TRUE(device_->lost());
    EXPECT_EQ(FakeGl::get().waits, 1);
}

TEST_F(LostDevice, mapped_buffers_stay_as_they_are_once_it_is_lost) {
    FakeGl::get().wait_results = {GL_TIMEOUT_EXPIRED};
    frame();
    const auto before = FakeGl::get().mapped;
    frame(2);  // other items: what is written would differ
    EXPECT_EQ(FakeGl::get().mapped, before) << "rewritten while the GPU may read them";
}

TEST_F(LostDevice, a_frame_that_was_abandoned_is_waited_for_before_its_buffers_are_written) {
    device_->draws.plays();
    device_->begin_frame(Pose{});
    draw(0, 2);
    const auto before = FakeGl::get().mapped;
    FakeGl::get().wait_results = {GL_TIMEOUT_EXPIRED};
    frame(2);
    EXPECT_TRUE(device_->lost());
    EXPECT_EQ(FakeGl::get().mapped, before) << "rewritten while the GPU may read them";
}

TEST_F(LostDevice, a_driver_that_hangs_while_a_model_is_loaded_is_an_error) {
    FakeGl::get().wait_results = {GL_TIMEOUT_EXPIRED};
    device_->draws.plays();
    EXPECT_FALSE(device_->load(model_, effects::assemble_program).ok());
}

class ProgramObjects : public ::testing::Test {
protected:
    void SetUp() override { FakeGl::get() = {}; }
    static Result<gl::Program> make() { return gl::make_program(test::fake_api(), 0, {"vertex", "fragment", "name"}, false, {}); }
};

TEST_F(ProgramObjects, a_program_that_links_keeps_no_shader) {
    const auto program = make();
    ASSERT_TRUE(program.ok());
    EXPECT_EQ(FakeGl::get().shaders, 0);
    EXPECT_EQ(FakeGl::get().programs, 1);
}

TEST_F(ProgramObjects, nothing_is_left_where_the_first_shader_does_not_compile) {
    FakeGl::get().bad_compile = 1;
    EXPECT_FALSE(make().ok());
    EXPECT_EQ(FakeGl::get().shaders, 0);
    EXPECT_EQ(FakeGl::get().programs, 0);
}

TEST_F(ProgramObjects, nothing_is_left_where_the_second_shader_does_not_compile) {
    FakeGl::get().bad_compile = 2;
    EXPECT_FALSE(make().ok());
    EXPECT_EQ(FakeGl::get().shaders, 0);
    EXPECT_EQ(FakeGl::get().programs, 0);
}

TEST_F(ProgramObjects, nothing_is_left_where_the_program_does_not_link) {
    FakeGl::get().links = false;
    EXPECT_FALSE(make().ok());
    EXPECT_EQ(FakeGl::get().shaders, 0);
    EXPECT_EQ(FakeGl::get().programs, 0);
}

}  // namespace
}  // namespace surefoot
