// Fits to a model: found by model and table, refused when damaged, and nearer to measured frames than a table that is wrong.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "render/measure/calibrate.hpp"
#include "render/model/walk_file.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/walk/model_costs.hpp"
#include "tools/walk/path_source.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::walk {
namespace {

model::CostModel table(float submit_weight) {
    model::CostModel costs = model::default_costs();
    costs.calibrated = true;
    costs.combine.submit_weight = submit_weight;
    return costs;
}

FitConditions under(std::uint64_t model) { return {model, 1280, 720, "egl"}; }

/// A state folder of its own with a folder for fits.
std::string state_for(const std::string& name) {
    std::string state = test::Forest::get().dir + "/" + name;
    std::filesystem::create_directories(state + "/models");
    return state;
}

const std::string& model_file() { return test::Forest::get().model_file; }

TEST(ModelCosts, a_fit_is_found_by_model_and_table) {
    const std::string state = state_for("found");
    const model::CostModel machine = table(1), fit = table(2);
    ASSERT_TRUE(measure::write_costs(model_costs_file(state, machine, under(7)), fit).ok());
    const auto weight = [&](const model::CostModel& of, std::uint64_t model) {
        auto costs = fitted_costs(state, of, under(model));
        return costs ? costs->combine.submit_weight : -1;
    };
    EXPECT_EQ(weight(machine, 7), 2);
    EXPECT_EQ(weight(machine, 8), 1);
    auto smaller = fitted_costs(state, machine, {7, 640, 480, "egl"});
    ASSERT_TRUE(smaller.ok());
    EXPECT_EQ(smaller->combine.submit_weight, 1);
    auto elsewhere = fitted_costs(state, machine, {7, 1280, 720, "osmesa"});
    ASSERT_TRUE(elsewhere.ok());
    EXPECT_EQ(elsewhere->combine.submit_weight, 1);
    EXPECT_EQ(weight(table(1.5F), 7), 1.5F);  // measured anew: the old fit is of another table
    model::CostModel built_in = machine;
    built_in.calibrated = false;
    EXPECT_EQ(weight(built_in, 7), 1);
}

TEST(ModelCosts, fits_to_an_old_table_are_dropped_and_nothing_else) {
    const std::string state = state_for("dropped");
    const std::string kept = model_costs_file(state, table(1), under(7)), old = model_costs_file(state, table(2), under(7));
    const std::string other = state + "/models/notes.toml";
    ASSERT_TRUE(measure::write_costs(kept, table(1)).ok());
    ASSERT_TRUE(measure::write_costs(old, table(2)).ok());
    ASSERT_TRUE(write_text(other, "mine").ok());
    EXPECT_EQ(drop_old_fits(state, table(1)), 1U);
    EXPECT_TRUE(std::filesystem::exists(kept));
    EXPECT_FALSE(std::filesystem::exists(old));
    EXPECT_TRUE(std::filesystem::exists(other));
    EXPECT_EQ(drop_old_fits(state + "/none", table(1)), 0U);
}

TEST(ModelCosts, a_damaged_fit_is_an_error) {
    const std::string state = state_for("damaged");
    const std::string fit = model_costs_file(state, table(1), under(7));
    ASSERT_TRUE(measure::write_costs(fit, table(2)).ok());
    std::fstream(fit, std::ios::in | std::ios::out).seekp(200).put('#');
    auto costs = fitted_costs(state, table(1), under(7));
    ASSERT_FALSE(costs.ok());
    EXPECT_NE(costs.error().text().find(fit), std::string::npos);
}

TEST(ModelCosts, a_file_of_a_model_has_a_hash_of_its_own) {
    model::WalkFileInfo written, read;
    auto model = model::read_walk(model_file(), &read);
    ASSERT_TRUE(model.ok());
    const std::string other = test::Forest::get().dir + "/other.walk";
    model->materials[0].colour[0] = 0.125F;
    ASSERT_TRUE(model::write_walk(other, *model).ok());
    ASSERT_TRUE(model::read_walk(other, &written).ok());
    EXPECT_NE(read.hash, 0U);
    EXPECT_NE(read.hash, written.hash);
    auto again = model::read_walk(model_file());
    ASSERT_TRUE(again.ok());
    again->provenance.sources = {"elsewhere"};  // the same bake, from another folder
    ASSERT_TRUE(model::write_walk(other, *again).ok());
    ASSERT_TRUE(model::read_walk(other, &written).ok());
    EXPECT_EQ(read.hash, written.hash);
}

TEST(ModelCosts, a_fit_is_nearer_to_measured_frames_than_a_table_five_times_off) {
    auto model = model::read_walk(model_file());
    ASSERT_TRUE(model.ok());
    auto path = choose_path("", model_file(), *model, 0);
    ASSERT_TRUE(path.ok());
    model::CostModel wrong = table(5);
    wrong.combine.fixed_us *= 5;
    wrong.combine.raster_weight *= 5;
    ModelFitOptions options;
    options.device.viewport = {320, 180};
    options.poses = 60;
    auto fit = fit_to_model(std::move(*model), path->path, wrong, options, {});
    if (!fit && fit.error().text().find("libEGL") != std::string::npos) GTEST_SKIP() << fit.error().text();
    ASSERT_TRUE(fit.ok()) << fit.error().text();
    EXPECT_EQ(fit->frames, 60U);
    EXPECT_LT(fit->after.p50, fit->before.p50);
    EXPECT_GE(fit->costs.headroom, 1);
    EXPECT_EQ(fit->costs.grids.size(), wrong.grids.size());
    EXPECT_TRUE(fit->costs.blur_measured);
    EXPECT_EQ(fit->blur_poses, options.blur_poses);
    EXPECT_NE(fit->costs.blur_loss, wrong.blur_loss);
    EXPECT_GT(fit->costs.blur_loss[1], 0) << "leaves are finer than pixels";
    EXPECT_GT(fit->costs.blur_loss[4], fit->costs.blur_loss[1]);
}

/// A fit on the null backend, which charges by `combine`, by a price of every pixel, and for a sky.
ModelFit fit_without_gl(const model::FrameCombine& combine, float ns_per_pixel = 0, bool sky = false) {
    auto model = model::read_walk(model_file());
    for (model::EffectFinding& finding : model->effects)
        if (finding.bit == model::effect_sky) finding.called_for = sky;
    auto path = choose_path("", model_file(), *model, 0);
    model::CostModel costs = table(1);
    costs.combine = combine;
    costs.ns_per_pixel = ns_per_pixel;
    costs.slice_us = 0;
    ModelFitOptions options;
    options.device.kind = gl::BackendKind::null;
    options.poses = 24;
    options.rounds = 2;
    auto fit = fit_to_model(std::move(*model), path->path, costs, options, {});
    EXPECT_TRUE(fit.ok());
    return fit ? std::move(*fit) : ModelFit{};
}

measure::CostErrors error_of(const ModelFit& fit, std::string_view formula) {
    for (const measure::PublishedCost& p : fit.published)
        if (p.name == formula) return p.as_published;
    ADD_FAILURE() << formula << " is missing";
    return {};
}

TEST(ModelCosts, a_published_formula_is_exact_on_a_machine_that_charges_by_it) {
    const ModelFit pipeline = fit_without_gl({0, 0, 0, 1}), software = fit_without_gl({0, 1, 1, 0});
    EXPECT_LT(error_of(pipeline, "max_of_sums").p99, 1e-3);
    EXPECT_GT(error_of(pipeline, "sum_of_stages").p50, 0.05);
    EXPECT_GT(error_of(pipeline, "max_of_sums").r2, 0.999);
    EXPECT_GE(error_of(pipeline, "sum_of_max").bias, 0) << "a sum of larger ones is never below the larger sum";
    EXPECT_LT(error_of(software, "sum_of_stages").p99, 1e-3);
    EXPECT_GT(error_of(software, "max_of_sums").p50, 0.05);
    EXPECT_LT(software.before.p99, 1e-3) << "the table is the machine";
    EXPECT_LT(software.after.p99, 0.02);
    EXPECT_FALSE(software.costs.blur_measured) << "there are no pictures without GL";
    EXPECT_EQ(software.costs.blur_loss, model::CostModel{}.blur_loss);
}

TEST(ModelCosts, a_fit_finds_the_price_of_pixels_and_keeps_the_cells_where_they_are_the_machine) {
    const ModelFit priced = fit_without_gl({200, 1, 1, 0}, 2), plain = fit_without_gl({200, 1, 1, 0});
    EXPECT_EQ(priced.costs.ns_per_pixel, 2);
    EXPECT_LT(priced.before.p99, 1e-3) << "the table is the machine";
    EXPECT_LT(priced.after.p90, 0.02);
    EXPECT_EQ(plain.costs.ns_per_pixel, 0);
    EXPECT_LT(plain.after.p99, 0.02);
    EXPECT_GT(error_of(priced, "sum_of_stages").p50, error_of(plain, "sum_of_stages").p50) << "formulas are by the cells";
}

TEST(ModelCosts, a_fit_leaves_out_the_sky_that_an_engine_adds) {
    const ModelFit plain = fit_without_gl({200, 1, 1, 0}), sky = fit_without_gl({200, 1, 1, 0}, 0, true);
    EXPECT_NEAR(sky.costs.combine.fixed_us, plain.costs.combine.fixed_us, 20) << "the pass takes a hundred times that";
    EXPECT_NEAR(sky.after.p90, plain.after.p90, 0.005);
}

TEST(ModelCosts, stopping_a_fit_is_an_error) {
    auto model = model::read_walk(model_file());
    ASSERT_TRUE(model.ok());
    const std::atomic<bool> stop{true};
    auto fit = fit_to_model(std::move(*model), Path{{PathSample{}}}, table(1), {}, {.report = {}, .stop = &stop, .notify = {}});
    ASSERT_FALSE(fit.ok());
}

}  // namespace
}  // namespace surefoot::walk
