// The null device: the virtual cost clock gives the same numbers on every run, and exactly those that were predicted.
#include <gtest/gtest.h>

#include <array>
#include <memory>

#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/pixels.hpp"
#include "tests/gl/small_models.hpp"

namespace surefoot {
namespace {

using test::at;
using test::plain;
using test::SmallModel;

struct Scene {
    model::Model model;
    std::vector<gl::DrawItem> items;
};

Scene scene_of_squares(int count) {
    SmallModel small;
    const auto material = small.material(plain(1, 0, 0));
    Scene scene;
    for (int i = 0; i < count; ++i) {
        const auto node = small.square(material, at(0.1 * i, 0, -3.0 - i), 1);
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    return scene;
}

std::unique_ptr<gl::Device> null_device(const Scene& scene, const gl::NullOptions& options) {
    auto device = gl::open_null_device({}, options);
    EXPECT_TRUE(device.ok());
    (*device)->draws.plays();
    EXPECT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    return std::move(*device);
}

double charge_of(gl::Device& device, const Scene& scene, int frames) {
    device.draws.plays();
    for (int i = 0; i < frames; ++i) {
        Pose pose;
        pose.position.z = 0.01 * i;
        device.begin_frame(pose);
        device.draw(scene.items);
        device.end_slice();
        device.end_items();
        device.finish_frame();
    }
    return device.charged_us();
}

TEST(NullDevice, charges_exactly_what_the_table_predicts) {
    const auto scene = scene_of_squares(5);
    const model::CostModel costs = model::default_costs();
    gl::NullOptions options;
    options.costs = &costs;
    options.cost_scale = 2;
    const auto device = null_device(scene, options);
    const double charged = charge_of(*device, scene, 1);
    const auto scale = model::make_view_scale(Pose{}, {1280, 720});
    double submit = 0;
    double raster = 0;
    for (const auto& item : scene.items) {
        const auto& rep = scene.model.reps[item.rep];
        const float pixels = model::rasterised_pixels(rep, scene.model.nodes[item.node].box, Pose{}.position, scale);
        const auto cost = costs.item(static_cast<float>(rep.triangles), pixels, costs.grid_for(rep.effects));
        submit += static_cast<double>(cost.submit_us);
        raster += static_cast<double>(cost.raster_us);
    }
    submit += static_cast<double>(costs.slice_us);
    EXPECT_DOUBLE_EQ(charged,
                     2.0 * static_cast<double>(costs.combine.frame_us(static_cast<float>(submit), static_cast<float>(raster))));
}

TEST(NullDevice, charges_samples_and_the_filter_as_the_table_at_that_quality_predicts) {
    const auto scene = scene_of_squares(5);
    const model::CostModel costs = model::default_costs();
    gl::DeviceOptions how;
    how.samples = 4;
    how.filter = rt::TextureFilter::trilinear;
    gl::NullOptions plain, dearer;
    plain.costs = &costs;
    auto device = gl::open_null_device(how, plain);
    ASSERT_TRUE(device.ok());
    (*device)->draws.plays();
    EXPECT_EQ((*device)->samples(), 4U);
    EXPECT_EQ((*device)->filter(), rt::TextureFilter::trilinear);
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    const model::CostModel of_quality = model::at_quality(costs, gl::quality_of(**device, costs));
    dearer.costs = &of_quality;
    const double charged = charge_of(**device, scene, 3);
    EXPECT_EQ(charged, charge_of(*null_device(scene, dearer), scene, 3));
    EXPECT_GT(charged, charge_of(*null_device(scene, plain), scene, 3));
    EXPECT_EQ((*device)->stats().samples, 4U);
}

TEST(NullDevice, charges_passes_over_samples_at_the_size_that_is_drawn) {
    const auto scene = scene_of_squares(1);
    model::CostModel costs = model::default_costs();
    costs.sample_pass_ns_per_pixel = 5;
    gl::NullOptions options;
    options.costs = &costs;
    gl::DeviceOptions how;
    how.samples = 2;
    auto device = gl::open_null_device(how, options);
    ASSERT_TRUE(device.ok());
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    const double pixels = static_cast<double>(how.viewport.width) * static_cast<double>(how.viewport.height);
    for (const float resolution : {1.0F, 0.5F}) {
        const double before = (*device)->charged_us();
        (*device)->begin_frame(Pose{}, resolution);
        (*device)->finish_frame();
        const auto share = static_cast<double>(resolution * resolution);
        EXPECT_NEAR((*device)->charged_us() - before, static_cast<double>(costs.combine.fixed_us) + 5e-3 * share * pixels, 0.01);
    }
}

TEST(NullDevice, takes_a_table_as_measured_by_the_filter_that_it_names) {
    const auto scene = scene_of_squares(2);
    model::CostModel costs = model::default_costs();
    costs.grids.resize(1);
    costs.grids[0].effects = model::effect_texture;
    costs.trilinear_factor = 1.5F;
    gl::NullOptions options;
    options.costs = &costs;
    const auto charged = [&](rt::TextureFilter by, rt::TextureFilter drawn) {
        costs.filter = by;
        gl::DeviceOptions how;
        how.filter = drawn;
        auto device = gl::open_null_device(how, options);
        EXPECT_TRUE(device.ok());
        gl::Device& opened = **device;
        opened.draws.plays();
        EXPECT_TRUE(opened.load(scene.model, effects::assemble_program).ok());
        EXPECT_NE(opened.filter(), rt::TextureFilter::automatic);
        return charge_of(opened, scene, 1);
    };
    using rt::TextureFilter;
    const double table = charged(TextureFilter::automatic, TextureFilter::automatic);
    EXPECT_EQ(charged(TextureFilter::bilinear, TextureFilter::bilinear), table);
    EXPECT_EQ(charged(TextureFilter::trilinear, TextureFilter::trilinear), table);
    EXPECT_EQ(charged(TextureFilter::trilinear, TextureFilter::automatic), table) << "as the machine of the table draws";
    EXPECT_LT(charged(TextureFilter::trilinear, TextureFilter::bilinear), table);
    EXPECT_GT(charged(TextureFilter::bilinear, TextureFilter::trilinear), table);
    EXPECT_GT(charged(TextureFilter::automatic, TextureFilter::trilinear), table) << "a table of before is a software driver's";
}

TEST(NullDevice, charges_the_filter_that_is_set_from_picture_to_picture) {
    test::SmallModel small;
    const auto textured = small.material(plain(1, 1, 1, 1, model::effect_texture));
    const auto bare = small.material(plain(1, 1, 1));
    Scene scene{{}, {}};
    for (const auto material : {textured, bare}) {
        const auto node = small.square(material, at(0, 0, -3));
        scene.items.push_back({node, node - 1});
    }
    scene.model = small.finish();
    const model::CostModel costs = model::default_costs();
    gl::NullOptions null;
    null.costs = &costs;
    const auto charged = [&](const gl::DeviceOptions& how, std::initializer_list<rt::TextureFilter> filters) {
        auto device = gl::open_null_device(how, null);
        EXPECT_TRUE(device.ok());
        (*device)->draws.plays();
        EXPECT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
        for (const auto filter : filters) (*device)->set_filter(filter);
        return charge_of(**device, scene, 1);
    };
    using F = rt::TextureFilter;
    gl::DeviceOptions both, trilinear;
    both.second_filter = true;
    trilinear.filter = F::trilinear;
    const double one = charged({}, {}), two = charged(trilinear, {});
    EXPECT_GT(two, one);
    EXPECT_EQ(charged(both, {}), one);
    EXPECT_EQ(charged(both, {F::trilinear}), two);
    EXPECT_EQ(charged(both, {F::trilinear, F::bilinear}), one);
    EXPECT_EQ(charged({}, {F::trilinear}), one) << "a device that was not prepared for it keeps its filter";
}

TEST(NullDevice, charges_no_effect_that_is_hidden) {
    SmallModel small;
    model::Material lit = plain(1, 1, 1);
    lit.effects = model::effect_fog | model::effect_openness;
    const auto node = small.square(small.material(lit), at(0, 0, -3));
    Scene scene{small.finish(), {{node, node - 1}}};
    model::CostModel costs = model::default_costs();
    costs.prices = {{model::effect_fog, 10'000, 0, 5}, {model::effect_openness, 2000, 0, 0}};
    gl::NullOptions null;
    null.costs = &costs;
    gl::DeviceOptions how;
    how.switches = {model::effect_fog};
    auto device = gl::open_null_device(how, null);
    ASSERT_TRUE(device.ok());
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    const double all = charge_of(**device, scene, 1);
    (*device)->hide_effects(~model::EffectMask{0});
    const double both = charge_of(**device, scene, 1), less = both - all;  // it adds up
    const model::ItemCosts item_costs(scene.model, costs);
    const auto scale = model::make_view_scale(Pose{}, {1280, 720});
    float pixels = 0;
    const model::ItemCost of_item = item_costs.of(node - 1, scene.model.nodes[node].box, dvec3(0), scale, pixels);
    EXPECT_GT(of_item.raster_us, 0.005F * pixels) << "fog is in it";
    const model::FrameCombine& k = costs.combine;
    EXPECT_NEAR(all - less, static_cast<double>(20 * k.submit_weight + 0.005F * pixels * k.raster_weight), 0.01 * (all - less))
        << "two triangles; openness is no switch, and stays";
    (*device)->hide_effects(0);
    EXPECT_NEAR(charge_of(**device, scene, 1) - both, all, 1e-6 * all);
}

// Near, and of two state classes: the virtual clock is what prepare predicts, to the bit.
TEST(NullDevice, charges_exactly_what_prepare_predicts_of_parts) {
    SmallModel small;
    const auto bare = small.material(plain(1, 0, 0));
    model::Material sunny = plain(0, 1, 0);
    sunny.effects = model::effect_sun;
    const auto lit = small.material(sunny);
    const auto node = small.square(bare, at(0, 0, -1));
    small.square(lit, at(0, 0, -1));
    Scene scene{small.finish(), {{node, node - 1}}};
    model::Representation& rep = scene.model.reps[node - 1];
    rep.part_count = 2;  // both squares
    rep.triangles = 4;
    rep.effects = model::effect_sun;
    model::CostModel costs = model::default_costs();
    model::CostGrid dear = costs.grids[0];
    for (model::ItemCost& cell : dear.cells) cell.raster_us *= 5;
    costs.grids[0].effects = 0;
    dear.effects = model::effect_sun;
    costs.ns_per_pixel = 0.25F;
    costs.grids = {costs.grids[0], dear};
    gl::NullOptions options;
    options.costs = &costs;
    const double charged = charge_of(*null_device(scene, options), scene, 1);
    const auto scale = model::make_view_scale(Pose{}, {1280, 720});
    const Box& box = scene.model.nodes[node].box;
    const model::ItemCosts item_costs(scene.model, costs);
    const auto frame_us = [&](const model::ItemCost& item) {
        const double submit_us = static_cast<double>(item.submit_us) + static_cast<double>(costs.slice_us);
        return static_cast<double>(costs.combine.frame_us(static_cast<float>(submit_us), item.raster_us));
    };
    EXPECT_DOUBLE_EQ(charged, frame_us(item_costs.of(node - 1, box, dvec3(0), scale)));
    std::array<float, 2> of_part{};
    ASSERT_TRUE(model::PixelEstimator(scene.model).part_pixels(scene.model, node - 1, box, dvec3(0), scale, of_part));
    const float whole = of_part[0] + of_part[1];
    ASSERT_GT(whole, 1e5F);
    EXPECT_LT(charged, 0.8 * frame_us(costs.item(4, whole, dear))) << "not all of it by the dear class";
}

TEST(NullDevice, the_same_seed_charges_the_same_noise) {
    const auto scene = scene_of_squares(5);
    gl::NullOptions options;
    options.noise = 0.3;
    options.seed = 7;
    const double first = charge_of(*null_device(scene, options), scene, 50);
    EXPECT_EQ(first, charge_of(*null_device(scene, options), scene, 50));
    options.seed = 8;
    EXPECT_NE(first, charge_of(*null_device(scene, options), scene, 50));
}

TEST(NullDevice, the_charge_grows_within_the_frame) {
    const auto scene = scene_of_squares(4);
    const auto device = null_device(scene, {});
    device->draws.plays();
    double before = device->charged_us();
    device->begin_frame(Pose{});
    for (const auto& item : scene.items) {
        device->draw({&item, 1});
        EXPECT_GT(device->charged_us(), before);
        before = device->charged_us();
    }
    device->end_slice();
    EXPECT_GT(device->charged_us(), before);
}

TEST(NullDevice, enlarging_is_charged_once_a_frame_and_only_below_full_resolution) {
    const auto scene = scene_of_squares(4);
    gl::NullOptions options;
    options.enlarge_us = 1300;
    options.cost_scale = 2;
    const auto device = null_device(scene, options);
    device->draws.plays();
    double before = 0;
    for (const float resolution : {1.0F, 0.75F, 0.5F}) {
        device->begin_frame(Pose{}, resolution);
        const double drawn = device->charged_us();
        EXPECT_EQ(device->stats().resolution, resolution);
        device->finish_frame();
        EXPECT_DOUBLE_EQ(device->charged_us() - drawn, resolution < 1 ? 2600.0 : 0.0);
        EXPECT_GE(drawn, before);
        before = device->charged_us();
    }
}

TEST(NullDevice, counts_and_lists_but_has_no_picture) {
    const auto scene = scene_of_squares(4);
    const auto device = null_device(scene, {});
    charge_of(*device, scene, 1);
    device->draws.plays();
    EXPECT_EQ(device->stats().items, 4U);
    EXPECT_EQ(device->stats().triangles, 8U);
    EXPECT_EQ(device->program_listing(), std::vector<std::string>{"0: bare"});
    EXPECT_FALSE(device->read_pixels().ok());
}

}  // namespace
}  // namespace surefoot
