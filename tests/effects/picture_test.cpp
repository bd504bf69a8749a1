// Pictures against the reference: every effect alone and every pair of them, on each back end that opens here.
// To add an effect: its definition in reference_shading.hpp, its line in `tolerances`, and something for it in effect_scene.hpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
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
constexpr EffectMask all_bits = (1U << model::effect_count) - 1;

/// By how much a channel may differ from the reference, in 1/255, where a material has the effect.
struct Tolerance {
    EffectMask bit;
    double steps;
};
constexpr double bare_steps = 1;  ///< the material's colour is rounded to bytes, and so is the picture
constexpr std::array<Tolerance, model::effect_count> tolerances{{
    {model::effect_texture, 3},          // the weights of texels have few bits
    {model::effect_vertex_colour, 1.5},  // light and colours at vertices multiply the rounded colour
    {model::effect_sun, 1.5},
    {model::effect_alpha_mask, 1},
    {model::effect_blend, 2.5},  // the picture is rounded under each pane
    {model::effect_openness, 1.5},
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

class Pictures : public ::testing::TestWithParam<BackendKind> {
protected:
    void SetUp() override {
        gl::DeviceOptions options;
        options.kind = GetParam();
        options.viewport = {side, side};
        options.max_items = 256;
        options.filter = rt::TextureFilter::bilinear;
        auto device = gl::open_device(options);
        if (!device) GTEST_SKIP() << device.error().text();
        device_ = std::move(*device);
    }
    void load(const model::Model& model, const gl::ProgramFactory& programs = effects::assemble_program) {
        device_->draws.plays();
        const auto loaded = device_->load(model, programs);
        ASSERT_TRUE(loaded.ok()) << loaded.error().text();
    }
    gl::PixelImage picture(const model::Model& model, const Pose& pose) {
        std::vector<gl::DrawItem> items;
        for (model::Index n = 1; n < model.nodes.size(); ++n)
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
    std::vector<Difference> differences(const model::Model& model, double steps,
                                        const gl::ProgramFactory& programs = effects::assemble_program) {
        load(model, programs);
        std::vector<Difference> all;
        for (const Pose& pose : scene_.poses()) {
            const dvec3 sky(model::usual_sky[0], model::usual_sky[1], model::usual_sky[2]);
            const reference::Picture expected = reference::draw({model, pose, {side, side}, sky});
            all.push_back(compare(picture(model, pose), expected, steps));
        }
        return all;
    }
    void expect_equal(const model::Model& model, EffectMask mask) {
        const std::vector<Difference> poses = differences(model, steps_of(mask));
        for (std::size_t i = 0; i < poses.size(); ++i) {
            const std::string where = effects::effects_text(mask) + ", pose " + std::to_string(i);
            EXPECT_EQ(poses[i].interior, 0U) << where << ": " << poses[i].worst << " steps off, " << steps_of(mask) << " allowed";
            EXPECT_LE(poses[i].at_edges, max_at_edges) << where;
            EXPECT_GT(poses[i].interior_pixels, side * side / 4U) << where << ": nearly all is edges";
        }
    }
    test::EffectScene scene_;
    std::unique_ptr<gl::Device> device_;
};

/// Every effect alone and with every other.
std::vector<EffectMask> pairs() {
    std::vector<EffectMask> masks;
    for (int a = 0; a < model::effect_count; ++a)
        for (int b = a; b < model::effect_count; ++b) masks.push_back(1U << a | 1U << b);
    return masks;
}

/// All materials have these effects, also where they make little sense together.
model::Model uniform_scene(test::EffectScene scene, EffectMask mask) {
    return scene.build([&](model::Index) { return mask; });
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
        const auto without = [&](EffectMask mask) { return effects::assemble_program(mask & ~module.bit); };
        std::size_t wrong = 0;
        for (const Difference& difference : differences(model, steps_of(all_bits), without)) wrong += difference.interior;
        EXPECT_GT(wrong, 20U) << module.name;
    }
}

INSTANTIATE_TEST_SUITE_P(Software, Pictures, ::testing::Values(BackendKind::egl, BackendKind::osmesa),
                         [](const auto& kind) { return std::string(gl::backend_of(kind.param).name); });

}  // namespace
}  // namespace surefoot
