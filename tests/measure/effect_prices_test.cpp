// Prices of effects against what they take: another scene than that of the calibration, which has all effects at once.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <utility>
#include <vector>

#include "render/gl/device.hpp"
#include "render/measure/calibrate.hpp"
#include "render/measure/calibrate_run.hpp"
#include "render/measure/calibrate_scene.hpp"
#include "render/model/item_costs.hpp"
#include "rt/base/statistics.hpp"
#include "tests/measure/quick_table.hpp"

namespace surefoot::measure {
namespace {

using test::quick_view;

/// Its lit textured items have all effects with a price, and light at the vertices: by the pixel, others would cost more than
/// their prices say. Sizes lie between those that were measured.
CalibrationScene with_all_effects() {
    CalibrationScene scene = make_calibration_scene(quick_view, true, 77);
    for (model::Material& material : scene.model.materials)
        if (material.effects == (model::effect_texture | model::effect_sun))
            for (const model::EffectPrice& price : effects::usual_prices())
                material.effects |= price.effect & ~model::effect_light_by_pixel;
    return scene;
}

/// What an effect takes of frames of the same items: busiest thread and rasteriser together, us.
struct Measured {
    std::span<const gl::DrawItem> items;
    model::EffectMask effect = 0;
    std::vector<double> more;  ///< with it, more than without: of pairs of frames

    void add_pairs(gl::Device& device, RasteriserClocks& clocks, int pairs) {
        const auto draw = [&](bool hide) {
            device.draws.plays();
            device.hide_effects(hide ? effect : 0);
            run_frame(device, clocks, Pose{}, items, items.size());
            const FrameTiming timing = run_frame(device, clocks, Pose{}, items, items.size());
            return timing.submit_us + timing.raster_us;
        };
        for (int i = 0; i < pairs; ++i) {
            const bool first = more.size() % 2 == 0;
            const double one = draw(first), other = draw(!first);
            more.push_back(first ? other - one : one - other);
        }
    }
    [[nodiscard]] double median_us() const { return median_of(std::vector<double>(more)); }
};

/// Of the scene's items with all effects the one of the most pixels, and those.
std::pair<gl::DrawItem, float> largest_item(const CalibrationScene& scene, const model::ItemCosts& costs) {
    std::pair<gl::DrawItem, float> largest{};
    for (const CalibrationCell& cell : scene.cells) {
        if (cell.effects != (model::effect_texture | model::effect_sun)) continue;
        for (const gl::DrawItem& item : cell.items) {
            float pixels = 0;
            static_cast<void>(costs.of(item.rep, scene.model.nodes[item.node].box, dvec3(0),
                                       model::make_view_scale(Pose{}, quick_view), pixels));
            if (pixels > largest.second) largest = {item, pixels};
        }
    }
    return largest;
}

TEST(EffectPrices, PredictWhatEachAddsToASceneWithAllOfThem) {
    const CalibrateOptions options = test::quick_options();
    {
        const auto probe = gl::open_device(options.device);
        if (!probe && probe.error().kind == ErrorKind::unsupported) GTEST_SKIP() << probe.error().text();
        ASSERT_TRUE(probe.ok()) << probe.error().text();
    }
    const auto& table = test::quick_table();
    ASSERT_TRUE(table.ok()) << table.error().text();
    const CalibrationScene scene = with_all_effects();
    const model::ItemCosts costs(scene.model, table->costs);
    gl::DeviceOptions how = options.device;
    how.switches = {model::effect_openness, model::effect_shadow, model::effect_lamps, model::effect_fog};
    auto device = gl::open_device(how);
    ASSERT_TRUE(device.ok());
    (*device)->draws.plays();
    ASSERT_TRUE((*device)->load(scene.model, effects::assemble_program).ok());
    std::vector<const CalibrationCell*> cells;
    for (const CalibrationCell& cell : scene.cells)
        if (cell.effects == (model::effect_texture | model::effect_sun) && cell.triangles >= 50 && cell.pixels >= 500)
            cells.push_back(&cell);
    const std::pair<gl::DrawItem, float> alone = largest_item(scene, costs);
    const model::ItemCost fog = costs.of_effects(alone.first.rep, alone.second, model::effect_fog);
    std::vector<Measured> measured;
    for (const model::EffectMask effect : how.switches)
        for (const CalibrationCell* cell : cells) measured.push_back({cell->items, effect, {}});
    measured.push_back({{&alone.first, 1}, model::effect_fog, {}});
    RasteriserClocks clocks;
    for (int round = 0; round < 3; ++round)  // far apart: a bad second is no more than a third of each
        for (Measured& one : measured) one.add_pairs(**device, clocks, 5);
    auto next = measured.begin();
    for (const model::EffectMask effect : how.switches) {
        double predicted = 0, takes = 0, all = 0;
        for (const CalibrationCell* cell : cells) {
            for (const gl::DrawItem& item : cell->items) {
                float pixels = 0;
                static_cast<void>(costs.of(item.rep, scene.model.nodes[item.node].box, dvec3(0),
                                           model::make_view_scale(Pose{}, quick_view), pixels));
                const model::ItemCost added = costs.of_effects(item.rep, pixels, effect);
                predicted += static_cast<double>(added.submit_us + added.raster_us);
            }
            takes += (next++)->median_us();
            (*device)->draws.plays();
            (*device)->hide_effects(0);
            const FrameTiming whole = run_frame(**device, clocks, Pose{}, cell->items, cell->items.size());
            all += whole.submit_us + whole.raster_us;
        }
        std::printf("%s: predicted %.0f us, measured %.0f us of %.0f us\n", effects::effects_text(effect).c_str(), predicted,
                    takes, all);
        EXPECT_NEAR(predicted, takes, 0.5 * std::max(predicted, takes) + 0.03 * all) << effects::effects_text(effect);
        EXPECT_LT(predicted, 0.5 * all);
        // It takes less of a frame than the tolerance above, so a price of nothing would pass that.
        if (effect == model::effect_fog) {
            EXPECT_GT(predicted, std::max(0.0, 0.5 * takes));
        }
    }
    // Nothing hides its pixels. Of those that hide each other only a part was priced.
    const double measured_fog = measured.back().median_us();
    std::printf("fog over %.0f px: predicted %.1f us, measured %.1f us\n", static_cast<double>(alone.second),
                static_cast<double>(fog.submit_us + fog.raster_us), measured_fog);
    EXPECT_GT(static_cast<double>(fog.raster_us), 0.4 * measured_fog);
}

}  // namespace
}  // namespace surefoot::measure
