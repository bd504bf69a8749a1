// What is made for a scene that calls for no effect, for one, and for all: steps of the bake, bytes, programs, uniforms and
// passes.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "render/bake/bake.hpp"
#include "render/effects/effects.hpp"
#include "render/gl/gl_device.hpp"
#include "tests/bake/moving_scene.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/gl/fake_gl.hpp"

namespace surefoot {
namespace {

using test::FakeContext;
using test::FakeGl;

/// A yard and a roof over a part of it, unlit and of one colour.
importer::Scene bare_yard() {
    importer::Scene scene;
    scene.materials.resize(1);
    scene.materials[0].unlit = true;
    scene.materials[0].colour = {0.4F, 0.6F, 0.3F, 1};
    const auto sheet = [](float size, float height) {
        return bake::grid_surface(12, 12, [=](float u, float v) { return vec3(size * (u - 0.5F), height, size * (0.5F - v)); });
    };
    bake::place(scene, bake::add_mesh(scene, sheet(20, 0), "yard"), dvec3(0));
    bake::place(scene, bake::add_mesh(scene, sheet(6, 2.5F), "roof"), dvec3(0));
    return scene;
}

/// The same with all that is called for by a file.
importer::Scene rich_yard() {
    importer::Scene scene = bare_yard();
    scene.materials[0].unlit = false;
    scene.materials[0].two_sided = true;
    image::Image image;
    image.width = image.height = 4;
    for (int i = 0; i < 16; ++i) image.rgba.insert(image.rgba.end(), {200, 90, 60, static_cast<std::uint8_t>(i % 2 * 255)});
    scene.images.push_back(image);
    scene.materials.resize(4, scene.materials[0]);
    scene.materials[0].image = 0;
    scene.materials[1].image = 0;
    scene.materials[1].alpha = model::AlphaMode::mask;
    scene.materials[2].alpha = model::AlphaMode::blend;
    scene.materials[2].colour[3] = 0.5F;
    scene.materials[3].water = true;
    scene.materials[1].light = importer::LightPlace::pixel;
    for (std::uint32_t m = 1; m < 4; ++m) {
        importer::Primitive ball = bake::ball(6, 0.6F);
        ball.material = m;
        if (m == 1) ball.colours.assign(ball.positions.size(), {255, 200, 150, 255});
        bake::place(scene, bake::add_mesh(scene, ball, "ball " + std::to_string(m)), dvec3(2.0 * m - 4, 1.2, 0));
    }
    importer::Primitive ball = bake::ball(6, 0.5F);
    bake::place_moving(scene, bake::add_mesh(scene, ball, "mill"), dvec3(6, 1, 6),
                       bake::add_turn(scene, dvec3(6, 1, 5), dvec3(0, 1, 0), 8));
    importer::Lamp lamp;
    lamp.at = dvec3(0, 2.2, 0);
    lamp.candela = 200;
    scene.lamps.push_back(lamp);
    scene.fog_visibility_m = 100;
    scene.sky = true;
    return scene;
}

/// What a scene is made of.
struct Made {
    model::EffectMask called_for = 0;
    std::set<std::string> stages;  ///< of the bake
    std::size_t light_bytes = 0;   ///< of arrays beside the vertices, with the textures' texels
    std::size_t vertices = 0, texel_bytes = 0;
    int state_classes = 0;  ///< different sets of effects among the parts
    int programs = 0, textures = 0, buffers = 0;
    std::set<std::string> uniforms;
    int blended_passes = 0;  ///< of a frame of all objects
    int array_draws = 0;     ///< of the same frame: passes over the picture
};

Made make(const importer::Scene& scene) {
    Made made;
    Progress progress;
    progress.report = [&](std::string_view stage, double) { made.stages.insert(std::string(stage)); };
    bake::BakeOptions options;
    options.quality = bake::Quality::full;
    const auto model = bake::bake(scene, options, progress);
    EXPECT_TRUE(model.ok()) << (model.ok() ? "" : model.error().text());
    if (!model) return made;
    made.called_for = model->called_for();
    made.light_bytes = model->sun_seen.size() * sizeof(model::SunSeen) + model->lamp_light.size() * sizeof(model::LampLight) +
                       model->texels.size();
    made.vertices = model->vertices.size();
    made.texel_bytes = model->texels.size();
    std::set<model::EffectMask> classes;
    for (const model::Part& part : model->parts) classes.insert(model->materials[part.material].effects);
    made.state_classes = static_cast<int>(classes.size());
    gl::DeviceOptions how;
    how.viewport = {64, 64};
    how.max_items = 4096;
    auto device = gl::GlDevice::make(std::make_unique<FakeContext>(), how);
    EXPECT_TRUE(device.ok());
    if (!device) return made;
    (*device)->draws.plays();
    const FakeGl before = FakeGl::get();
    EXPECT_TRUE((*device)->load(*model, effects::assemble_program).ok());
    made.programs = FakeGl::get().programs - before.programs;
    made.textures = FakeGl::get().textures - before.textures;
    made.buffers = FakeGl::get().buffers - before.buffers;
    made.uniforms = FakeGl::get().uniforms;
    for (const std::string& name : before.uniforms) made.uniforms.erase(name);
    FakeGl::get().blended_passes = FakeGl::get().array_draws = 0;
    std::vector<gl::DrawItem> items;
    for (model::Index n = 0; n < model->nodes.size(); ++n)
        if (model->nodes[n].child_count == 0) items.push_back({n, model->nodes[n].first_rep + model->nodes[n].rep_count - 1});
    (*device)->begin_frame(Pose{});
    (*device)->draw(items);
    (*device)->end_slice();
    (*device)->end_items();
    (*device)->finish_frame();
    made.blended_passes = FakeGl::get().blended_passes;
    made.array_draws = FakeGl::get().array_draws;
    return made;
}

TEST(ScenesPay, ForNoEffectWhereNoneIsCalledFor) {
    const Made made = make(bare_yard());
    EXPECT_EQ(made.called_for, 0U);
    for (const char* stage : {"cutting for light", "sky", "light", "shadows"}) EXPECT_FALSE(made.stages.contains(stage)) << stage;
    EXPECT_EQ(made.light_bytes, 0U);
    EXPECT_EQ(made.programs, 1);
    EXPECT_EQ(made.uniforms, std::set<std::string>{"view_projection"});
    EXPECT_EQ(made.textures, 0);
    EXPECT_EQ(made.buffers, 2) << "vertices and indices";
    EXPECT_EQ(made.blended_passes, 0);
    EXPECT_EQ(made.array_draws, 0);
}

TEST(ScenesPay, ForOneEffectWithItsUniformsAlone) {
    importer::Scene scene = bare_yard();
    scene.fog_visibility_m = 80;
    const Made made = make(scene);
    EXPECT_EQ(made.called_for, model::effect_fog);
    for (const char* stage : {"cutting for light", "sky", "light", "shadows"}) EXPECT_FALSE(made.stages.contains(stage)) << stage;
    EXPECT_EQ(made.light_bytes, 0U);
    EXPECT_EQ(made.programs, 1);
    EXPECT_EQ(made.uniforms, (std::set<std::string>{"view_projection", "fog_colour", "fog_density"}));
    EXPECT_EQ(made.buffers, 2);
    EXPECT_EQ(made.blended_passes, 0);
}

// Its own text in the program, and no more: no step of the bake, no array, no uniform, no other program.
TEST(ScenesPay, ForLightByThePixelWithTextAlone) {
    importer::Scene scene = bare_yard();
    scene.materials[0].unlit = false;
    const Made at_vertices = make(scene);
    scene.materials[0].light = importer::LightPlace::pixel;
    const Made by_pixel = make(scene);
    EXPECT_EQ(at_vertices.called_for & model::effect_light_by_pixel, 0U);
    EXPECT_EQ(by_pixel.called_for, at_vertices.called_for | model::effect_light_by_pixel);
    EXPECT_EQ(by_pixel.stages, at_vertices.stages);
    EXPECT_EQ(by_pixel.light_bytes, at_vertices.light_bytes);
    EXPECT_EQ(by_pixel.uniforms, at_vertices.uniforms);
    EXPECT_EQ(by_pixel.buffers, at_vertices.buffers);
    EXPECT_EQ(by_pixel.textures, at_vertices.textures);
    EXPECT_GE(at_vertices.programs, 1);
    EXPECT_EQ(by_pixel.programs, at_vertices.programs);
    EXPECT_EQ(by_pixel.blended_passes, 0);
}

TEST(ScenesPay, ForASkyWithAProgramAndAPassOfItsOwn) {
    importer::Scene scene = bare_yard();
    scene.sky = true;
    const Made made = make(scene);
    EXPECT_EQ(made.called_for, model::effect_sky);
    for (const char* stage : {"cutting for light", "sky", "light", "shadows"}) EXPECT_FALSE(made.stages.contains(stage)) << stage;
    EXPECT_EQ(made.light_bytes, 0U);
    EXPECT_EQ(made.programs, 2) << "that of the yard, and its own";
    std::set<std::string> own{"view_projection"};
    for (const effects::EffectModule& module : effects::all_effects())
        for (const gl::UniformSource& uniform : module.uniforms)
            if (module.bit == model::effect_sky) own.insert(uniform.name);
    EXPECT_GT(own.size(), 3U);
    EXPECT_EQ(made.uniforms, own);
    EXPECT_EQ(made.textures, 0);
    EXPECT_EQ(made.buffers, 2);
    EXPECT_EQ(made.blended_passes, 0);
    EXPECT_EQ(made.array_draws, 1);
}

TEST(ScenesPay, ForAllWhereAllAreCalledFor) {
    const Made made = make(rich_yard());
    for (const effects::EffectModule& module : effects::all_effects()) EXPECT_NE(made.called_for & module.bit, 0U) << module.name;
    for (const char* stage : {"cutting for light", "light", "shadows"}) EXPECT_TRUE(made.stages.contains(stage)) << stage;
    EXPECT_GT(made.light_bytes, 0U);
    EXPECT_GT(made.programs, 4);
    EXPECT_EQ(made.light_bytes, made.vertices * (sizeof(model::SunSeen) + sizeof(model::LampLight)) + made.texel_bytes)
        << "a share of the sun and light of lamps for each vertex, and no more";
    EXPECT_GT(made.vertices, 0U);
    EXPECT_EQ(made.programs, made.state_classes + 2)
        << "one for each state class, the sky's, and that of what casts moving shadows";
    std::set<std::string> all{"view_projection"};
    for (const effects::EffectModule& module : effects::all_effects()) {
        for (const gl::UniformSource& uniform : module.uniforms) all.insert(uniform.name);
        for (const gl::SamplerSource& sampler : module.samplers) all.insert(sampler.name);
    }
    EXPECT_EQ(made.uniforms, all);
    EXPECT_GT(made.textures, 0);
    EXPECT_EQ(made.buffers, 4) << "shadows and lamps have their own";
    EXPECT_EQ(made.blended_passes, 1);
    EXPECT_EQ(made.array_draws, 1) << "the sky";
}

}  // namespace
}  // namespace surefoot
