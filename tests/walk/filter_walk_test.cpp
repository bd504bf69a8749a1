// The second mip level in a walk: bought where time is left, for a while, and never at the cost of a deadline.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "render/model/cost.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tests/temporary_folder.hpp"
#include "tests/walk/walk_fixture.hpp"
#include "tools/report/report.hpp"

namespace surefoot {
namespace {

using rt::TextureFilter;

/// The small forest, with a picture on all that it has. Its frames take from a fifth of the budget to more than all of it.
class FilterWalk : public ::testing::Test {
protected:
    void SetUp() override {
        auto model = model::read_walk(test::Forest::get().model_file, nullptr);
        ASSERT_TRUE(model.ok());
        model::Texture texture;
        texture.width = texture.height = 1;
        texture.levels = 1;
        texture.first_byte = model->texels.size();
        model->texels.resize(model->texels.size() + 4);
        model->textures.push_back(texture);
        for (model::Material& material : model->materials) {
            material.texture = static_cast<model::Index>(model->textures.size() - 1);
            material.effects |= model::effect_texture;
        }
        for (model::Representation& rep : model->reps) rep.effects |= model::effect_texture;
        for (model::EffectFinding& finding : model->effects)
            finding.called_for = finding.called_for || finding.bit == model::effect_texture;
        request_ = test::Forest::get().virtual_request(frames);
        request_.filter = TextureFilter::adaptive;
        request_.model_file = folder_ / "textured.walk";
        ASSERT_TRUE(model::write_walk(request_.model_file, *model).ok());
        auto costs = std::make_shared<model::CostModel>(model::default_costs());
        costs->combine.submit_weight *= scale;
        costs->combine.raster_weight *= scale;
        request_.given_costs = costs;
    }
    static std::uint64_t trilinear(const walk::WalkOutcome& outcome) {
        return static_cast<std::uint64_t>(
            std::count_if(outcome.records.begin(), outcome.records.end(),
                          [](const rt::FrameRecord& r) { return r.filter == TextureFilter::trilinear; }));
    }
    static std::uint64_t changes(const walk::WalkOutcome& outcome) {
        std::uint64_t count = 0;
        for (std::size_t i = 1; i < outcome.records.size(); ++i)
            count += outcome.records[i].filter != outcome.records[i - 1].filter ? 1 : 0;
        return count;
    }
    static constexpr float scale = 0.55F;
    static constexpr std::uint64_t frames = 450;
    test::TemporaryFolder folder_;
    walk::WalkRequest request_;
};

TEST_F(FilterWalk, BuysItWhereTimeIsLeftAndSaysSo) {
    request_.ledger_file = folder_ / "ledger.csv";
    const walk::WalkOutcome outcome = test::walk(request_);
    const std::uint64_t bought = trilinear(outcome);
    EXPECT_GT(bought, 60U);
    EXPECT_LT(bought, frames - 60) << "or the test does not show that it leaves";
    EXPECT_LE(changes(outcome), 12U);
    EXPECT_EQ(outcome.summary.misses, 0U);
    EXPECT_EQ(outcome.summary.downgrades, 0U);
    EXPECT_EQ(outcome.summary.trilinear_frames, bought);
    EXPECT_EQ(nlohmann::json::parse(report::to_json(outcome.summary))["trilinear_frames"], bought);
    for (const rt::FrameRecord& r : outcome.records) {
        const bool has = r.filter == TextureFilter::trilinear;
        ASSERT_EQ(r.bought_items, has ? 1U : 0U) << r.frame;
        ASSERT_EQ(r.bought_us > 0, has) << r.frame;
        ASSERT_EQ(r.refused_items, 0U);
        ASSERT_EQ(r.guard_violations, 0U);
        if (has) {
            ASSERT_GT(r.value, 0.9999F) << "all is in full detail, frame " << r.frame;
        }
    }
    const auto ledger = read_text(request_.ledger_file);
    ASSERT_TRUE(ledger.ok());
    std::uint64_t rows = 0;
    for (std::size_t at = ledger->find(",trilinear,"); at != std::string::npos; at = ledger->find(",trilinear,", at + 1)) ++rows;
    EXPECT_EQ(rows, bought);
}

TEST_F(FilterWalk, FormsAreThoseOfAWalkWithoutIt) {
    request_.correct_costs = false;
    const walk::WalkOutcome with = test::walk(request_);
    request_.filter = TextureFilter::automatic;
    const walk::WalkOutcome without = test::walk(request_);
    EXPECT_GT(trilinear(with), 60U);
    EXPECT_EQ(trilinear(without), 0U) << "nobody asked for it";
    for (std::size_t i = 0; i < with.records.size(); ++i) ASSERT_EQ(with.records[i].cut_hash, without.records[i].cut_hash) << i;
}

TEST_F(FilterWalk, IsBitEqualAtAnyWorkerCount) {
    request_.frames = 200;
    request_.workers = 1;
    const walk::WalkOutcome one = test::walk(request_);
    EXPECT_GT(trilinear(one), 60U);
    for (const int workers : {2, 4}) {
        request_.workers = workers;
        const walk::WalkOutcome more = test::walk(request_);
        EXPECT_EQ(more.summary.cut_hash, one.summary.cut_hash) << workers;
        ASSERT_EQ(more.records.size(), one.records.size());
        for (std::size_t i = 0; i < one.records.size(); ++i) ASSERT_EQ(more.records[i].filter, one.records[i].filter) << i;
    }
}

TEST_F(FilterWalk, MakesNoFrameLateWhereCostsAreUnderPredictedTwofold) {
    request_.cost_scale = 2;
    request_.correct_costs = false;  // the check alone must hold
    const walk::WalkOutcome outcome = test::walk(request_);
    EXPECT_GT(trilinear(outcome), 60U);
    EXPECT_EQ(outcome.summary.misses, 0U);
}

TEST_F(FilterWalk, HoldsAtALowerResolutionToo) {
    request_.resolution_pct = 75;
    const walk::WalkOutcome outcome = test::walk(request_);
    EXPECT_GT(trilinear(outcome), 60U);
    EXPECT_EQ(outcome.summary.misses, 0U);
    for (const rt::FrameRecord& r : outcome.records)
        ASSERT_EQ(r.bought_items, r.filter == TextureFilter::trilinear ? 2U : 1U) << "the enlarging is one, frame " << r.frame;
}

}  // namespace
}  // namespace surefoot
