// The cost table as a file: it comes back as it was written, and refuses what is not this machine's or was changed.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "render/measure/calibrate.hpp"
#include "rt/base/file.hpp"
#include "rt/base/hash.hpp"
#include "rt/base/random.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot {
namespace {

class CostFile : public ::testing::Test {
protected:
    void SetUp() override {
        costs_ = model::default_costs();
        costs_.machine = "a \"machine\" \\ of tests";
        costs_.calibrated = true;
        costs_.combine = {123.456F, 0.1F, 0.3333333F, 1e-7F};
        ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
    }
    test::TemporaryFolder folder_;
    std::string file_ = folder_ / "costs.toml";
    model::CostModel costs_;
};

TEST_F(CostFile, comes_back_bit_for_bit) {
    const auto read = measure::read_costs(file_, costs_.machine);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->combine.raster_weight, costs_.combine.raster_weight);
    EXPECT_EQ(read->combine.max_weight, costs_.combine.max_weight);
    EXPECT_EQ(read->headroom, costs_.headroom);
    ASSERT_EQ(read->grids.size(), costs_.grids.size());
    for (std::size_t g = 0; g < costs_.grids.size(); ++g) {
        EXPECT_EQ(read->grids[g].effects, costs_.grids[g].effects);
        ASSERT_EQ(read->grids[g].cells.size(), costs_.grids[g].cells.size());
        for (std::size_t i = 0; i < costs_.grids[g].cells.size(); ++i) {
            ASSERT_EQ(read->grids[g].cells[i].submit_us, costs_.grids[g].cells[i].submit_us);
            ASSERT_EQ(read->grids[g].cells[i].raster_us, costs_.grids[g].cells[i].raster_us);
        }
    }
}

TEST_F(CostFile, holds_blur_and_enlarging_where_they_were_measured) {
    costs_.enlarge_ns_per_pixel = 2.3456789F;
    costs_.blur_loss = {0, 0.0012345678F, 0.002F, 0.002F, 0.9F};
    const auto unmeasured = measure::hash_of(costs_);
    costs_.enlarge_measured = costs_.blur_measured = true;
    EXPECT_NE(measure::hash_of(costs_), unmeasured);
    ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
    const auto read = measure::read_costs(file_, costs_.machine);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->enlarge_ns_per_pixel, costs_.enlarge_ns_per_pixel);
    EXPECT_EQ(read->blur_loss, costs_.blur_loss);
    EXPECT_TRUE(read->enlarge_measured && read->blur_measured);
    EXPECT_EQ(measure::hash_of(*read), measure::hash_of(costs_)) << "a fit is found by the table as it was read";
}

TEST_F(CostFile, holds_samples_and_the_filter_where_they_were_measured) {
    costs_.sample_share = 0.61234567F;
    costs_.sample_pass_ns_per_pixel = 1.2345678F;
    costs_.trilinear_factor = 1.3456789F;
    EXPECT_EQ(read_text(file_).value().find("sample_share"), std::string::npos);
    EXPECT_EQ(read_text(file_).value().find("trilinear"), std::string::npos);
    EXPECT_FALSE(measure::read_costs(file_, "")->samples_measured || measure::read_costs(file_, "")->trilinear_measured);
    costs_.samples_measured = costs_.trilinear_measured = true;
    ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
    const auto read = measure::read_costs(file_, costs_.machine);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->sample_share, costs_.sample_share);
    EXPECT_EQ(read->sample_pass_ns_per_pixel, costs_.sample_pass_ns_per_pixel);
    EXPECT_EQ(read->trilinear_factor, costs_.trilinear_factor);
    EXPECT_TRUE(read->samples_measured && read->trilinear_measured);
    EXPECT_EQ(measure::hash_of(*read), measure::hash_of(costs_));
}

TEST_F(CostFile, holds_the_price_of_a_sky_where_it_was_measured) {
    costs_.background_ns_per_pixel = 0.12345678F;
    EXPECT_EQ(read_text(file_).value().find("background"), std::string::npos);
    costs_.background_measured = true;
    ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
    const auto read = measure::read_costs(file_, costs_.machine);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->background_ns_per_pixel, costs_.background_ns_per_pixel);
    EXPECT_TRUE(read->background_measured);
    EXPECT_EQ(measure::hash_of(*read), measure::hash_of(costs_));
}

TEST_F(CostFile, holds_the_prices_of_pictures_where_they_were_measured) {
    EXPECT_EQ(read_text(file_).value().find("picture"), std::string::npos);
    EXPECT_FALSE(measure::read_costs(file_, "")->pictures_measured) << "a table of before has none";
    costs_.picture_us = 1.2345678F;
    costs_.picture_ns_per_pixel = 2.3456789F;
    costs_.capture_us = 34.567891F;
    costs_.capture_ns_per_texel = 0.45678912F;
    costs_.pictures_measured = true;
    ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
    const auto read = measure::read_costs(file_, costs_.machine);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->picture_us, costs_.picture_us);
    EXPECT_EQ(read->picture_ns_per_pixel, costs_.picture_ns_per_pixel);
    EXPECT_EQ(read->capture_us, costs_.capture_us);
    EXPECT_EQ(read->capture_ns_per_texel, costs_.capture_ns_per_texel);
    EXPECT_TRUE(read->pictures_measured);
    EXPECT_EQ(measure::hash_of(*read), measure::hash_of(costs_));
    costs_.capture_us = -1;
    ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
    const auto wrong = measure::read_costs(file_, "");
    ASSERT_FALSE(wrong.ok());
    EXPECT_NE(wrong.error().text().find("capture_us"), std::string::npos) << wrong.error().text();
}

TEST_F(CostFile, names_the_filter_that_it_was_measured_by) {
    EXPECT_EQ(read_text(file_).value().find("filter"), std::string::npos);
    EXPECT_EQ(measure::read_costs(file_, "")->filter, rt::TextureFilter::automatic) << "a table of before does not know";
    for (const rt::TextureFilter filter : {rt::TextureFilter::bilinear, rt::TextureFilter::trilinear}) {
        const auto before = measure::hash_of(costs_);
        costs_.filter = filter;
        EXPECT_NE(measure::hash_of(costs_), before);
        ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
        const auto read = measure::read_costs(file_, costs_.machine);
        ASSERT_TRUE(read.ok()) << read.error().text();
        EXPECT_EQ(read->filter, filter);
        EXPECT_EQ(measure::hash_of(*read), measure::hash_of(costs_));
    }
}

TEST_F(CostFile, holds_the_price_of_a_pixel_where_a_fit_found_one) {
    EXPECT_EQ(read_text(file_).value().find("ns_per_pixel"), std::string::npos);
    EXPECT_EQ(measure::read_costs(file_, "")->ns_per_pixel, 0) << "a table of before has none";
    const auto before = measure::hash_of(costs_);
    costs_.ns_per_pixel = 0.333333343F;
    EXPECT_NE(measure::hash_of(costs_), before);
    ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
    const auto read = measure::read_costs(file_, costs_.machine);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->ns_per_pixel, costs_.ns_per_pixel);
    EXPECT_EQ(measure::hash_of(*read), measure::hash_of(costs_));
}

TEST_F(CostFile, holds_the_prices_of_effects_where_they_were_measured) {
    EXPECT_EQ(read_text(file_).value().find("price"), std::string::npos);
    EXPECT_TRUE(measure::read_costs(file_, "")->prices.empty()) << "a table of before has none";
    const auto before = measure::hash_of(costs_);
    costs_.prices = {{model::effect_shadow, 1.5F, 0.25F, 0.125F}, {model::effect_fog, 0, 0, 0.333333343F}};
    EXPECT_EQ(measure::hash_of(costs_), before) << "built-in figures are not the machine's";
    costs_.prices_measured = true;
    EXPECT_NE(measure::hash_of(costs_), before);
    ASSERT_TRUE(measure::write_costs(file_, costs_).ok());
    const auto read = measure::read_costs(file_, costs_.machine);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_TRUE(read->prices_measured);
    ASSERT_EQ(read->prices.size(), 2U);
    EXPECT_EQ(read->prices[0].effect, model::effect_shadow);
    EXPECT_EQ(read->prices[0].submit_ns_per_triangle, 1.5F);
    EXPECT_EQ(read->prices[0].raster_ns_per_triangle, 0.25F);
    EXPECT_EQ(read->prices[1].raster_ns_per_pixel, 0.333333343F);
    EXPECT_EQ(measure::hash_of(*read), measure::hash_of(costs_));
}

TEST_F(CostFile, with_a_wrong_price_is_refused_by_its_key) {
    costs_.prices_measured = true;
    const auto wrong = [&](std::vector<model::EffectPrice> prices) {
        costs_.prices = std::move(prices);
        EXPECT_TRUE(measure::write_costs(file_, costs_).ok());
        const auto read = measure::read_costs(file_, "");
        return read ? std::string("ok") : read.error().what;
    };
    EXPECT_EQ(wrong({{model::effect_fog, 1, 1, 1}}), "ok");
    EXPECT_NE(wrong({{model::effect_fog | model::effect_sun, 1, 1, 1}}).find("'price.effect'"), std::string::npos);
    EXPECT_NE(wrong({{0, 1, 1, 1}}).find("'price.effect'"), std::string::npos);
    EXPECT_NE(wrong({{model::effect_fog, 1, 1, 1}, {model::effect_fog, 1, 1, 1}}).find("'price.effect'"), std::string::npos);
    EXPECT_NE(wrong({{model::effect_fog, -1, 1, 1}}).find("'price.submit_ns_per_triangle'"), std::string::npos);
    EXPECT_NE(wrong({{model::effect_fog, 1, 1, 1e9F}}).find("'price.raster_ns_per_pixel'"), std::string::npos);
}

TEST_F(CostFile, without_blur_and_enlarging_keeps_the_constants_and_its_hash) {
    EXPECT_EQ(read_text(file_).value().find("blur_loss"), std::string::npos);
    EXPECT_EQ(read_text(file_).value().find("enlarge"), std::string::npos);
    const auto read = measure::read_costs(file_, "");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->blur_loss, model::CostModel{}.blur_loss);
    EXPECT_EQ(read->enlarge_ns_per_pixel, model::CostModel{}.enlarge_ns_per_pixel);
    EXPECT_FALSE(read->enlarge_measured || read->blur_measured);
    EXPECT_EQ(measure::hash_of(*read), measure::hash_of(costs_));
}

TEST_F(CostFile, of_another_machine_is_refused_by_name_unless_any_will_do) {
    const auto read = measure::read_costs(file_, "this one");
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().what.find("this one"), std::string::npos);
    EXPECT_NE(read.error().what.find("another machine"), std::string::npos);
    EXPECT_TRUE(measure::read_costs(file_, "").ok());
}

TEST_F(CostFile, of_another_estimate_names_no_machine) {
    std::string body = read_text(file_).value();
    body.erase(0, body.find('\n') + 1);
    const std::string_view line = "estimate = 2\n";
    const std::size_t at = body.find(line);
    ASSERT_NE(at, std::string::npos);
    body.erase(at, line.size());  // as the first versions wrote it
    const std::uint64_t hash = hash_bytes(std::as_bytes(std::span<const char>(body)));
    ASSERT_TRUE(write_text(file_, fmt::format("hash = \"{:016x}\"\n{}", hash, body)).ok());
    const auto read = measure::read_costs(file_, "");
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->machine, costs_.machine + ", by another version of the estimate");
    EXPECT_FALSE(measure::read_costs(file_, costs_.machine).ok());
}

TEST_F(CostFile, with_a_wrong_key_is_refused_by_its_name) {
    std::string body = read_text(file_).value();
    body.erase(0, body.find('\n') + 1);
    const auto problem = [&](std::string_view line_begins, std::string_view instead) {
        std::string changed = body;
        const std::size_t at = changed.find(line_begins);
        changed.replace(at, changed.find('\n', at) - at, instead);
        const std::uint64_t hash = hash_bytes(std::as_bytes(std::span<const char>(changed)));
        EXPECT_TRUE(write_text(file_, fmt::format("hash = \"{:016x}\"\n{}", hash, changed)).ok());
        const auto read = measure::read_costs(file_, "");
        if (read) return std::string("nothing");
        EXPECT_EQ(read.error().place, file_);
        return read.error().what;
    };
    EXPECT_EQ(problem("slice_us", ""), "The key 'slice_us' is missing or out of range");
    EXPECT_EQ(problem("upper_factor", "upper_factor = 101"), "The key 'upper_factor' is missing or out of range");
    EXPECT_EQ(problem("max_weight =", "max_weight = \"1\""), "The key 'combine.max_weight' is missing or out of range");
    EXPECT_EQ(problem("pixel_steps", "pixel_steps = 0"), "The key 'class.triangle_steps' is missing or out of range");
    EXPECT_EQ(problem("effects", "effects = -1"), "The key 'class.effects' is missing or out of range");
    EXPECT_EQ(problem("submit_us = [", "submit_us = [ -1,"), "The key 'class.submit_us' is missing or out of range");
    EXPECT_EQ(problem("version", "version = 9"), "The key 'version' is missing or out of range");
    EXPECT_EQ(problem("version", "version = 1"), "nothing");
    for (const std::string bad : {"nan", "-0.1", "inf", "101", "\"2\""}) {
        EXPECT_EQ(problem("slice_us", "slice_us = 30\nenlarge_ns_per_pixel = " + bad),
                  "The key 'enlarge_ns_per_pixel' is missing or out of range");
    }
    for (const std::string bad :
         {"0, 0.1, 0.2, nan, 0.3", "0, -0.1, 0.2, 0.3, 0.4", "0, 0.1, 0.2, 0.3, 1.01", "0, 0.2, 0.1, 0.3, 0.4",
          "0.1, 0.1, 0.2, 0.3, 0.4", "0, 0.1, 0.2, 0.3", "0, 0.1, 0.2, 0.3, 0.4, 0.5", "0, 0.1, 0.2, 0.3, inf"}) {
        EXPECT_EQ(problem("slice_us", "slice_us = 30\nblur_loss = [" + bad + "]"),
                  "The key 'blur_loss' is missing or out of range")
            << bad;
    }
    EXPECT_EQ(problem("slice_us", "slice_us = 30\nblur_loss = 0.1"), "The key 'blur_loss' is missing or out of range");
    EXPECT_EQ(problem("slice_us", "slice_us = 30\nblur_loss = [0, 0.1, 0.1, 0.3, 1]\nenlarge_ns_per_pixel = 0"), "nothing");
    for (const std::string bad : {"nan", "-0.1", "inf", "101", "\"2\""}) {
        EXPECT_EQ(problem("slice_us", "slice_us = 30\nns_per_pixel = " + bad),
                  "The key 'ns_per_pixel' is missing or out of range");
        EXPECT_EQ(problem("slice_us", "slice_us = 30\nsample_pass_ns_per_pixel = 1\nsample_share = " + bad),
                  "The key 'sample_share' is missing or out of range");
        EXPECT_EQ(problem("slice_us", "slice_us = 30\nsample_share = 1\nsample_pass_ns_per_pixel = " + bad),
                  "The key 'sample_pass_ns_per_pixel' is missing or out of range");
        EXPECT_EQ(problem("slice_us", "slice_us = 30\ntrilinear_factor = " + bad),
                  "The key 'trilinear_factor' is missing or out of range");
    }
    for (const std::string bad : {"\"auto\"", "\"cubic\"", "1"})
        EXPECT_EQ(problem("slice_us", "slice_us = 30\nfilter = " + bad), "The key 'filter' is missing or out of range");
    EXPECT_EQ(problem("slice_us", "slice_us = 30\nsample_share = 1"),
              "The key 'sample_pass_ns_per_pixel' is missing or out of range");
    const std::string torn = "slice_us = = 1\n";
    ASSERT_TRUE(
        write_text(file_, fmt::format("hash = \"{:016x}\"\n{}", hash_bytes(std::as_bytes(std::span<const char>(torn))), torn))
            .ok());
    const auto read = measure::read_costs(file_, "");
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.error().place, file_ + ":2") << "the line as an editor counts it";
    EXPECT_NE(read.error().remedy.find("calibrate"), std::string::npos) << read.error().remedy;
}

TEST_F(CostFile, with_any_byte_changed_is_refused) {
    const std::string good = read_text(file_).value();
    Random random(9);
    for (int i = 0; i < 300; ++i) {
        std::string bad = good;
        const std::size_t at = i < 40 ? static_cast<std::size_t>(i) : random.below(static_cast<std::uint32_t>(good.size()));
        bad[at] = static_cast<char>(bad[at] ^ (1 << random.below(7)));
        ASSERT_TRUE(write_text(file_, bad).ok());
        const auto read = measure::read_costs(file_, costs_.machine);
        ASSERT_FALSE(read.ok()) << at;
        EXPECT_FALSE(read.error().remedy.empty());
    }
    ASSERT_TRUE(write_text(file_, good.substr(0, good.size() / 2)).ok());
    EXPECT_FALSE(measure::read_costs(file_, costs_.machine).ok());
    EXPECT_FALSE(measure::read_costs(file_ + ".absent", costs_.machine).ok());
}

TEST(MachineIdentity, names_renderer_and_rasterisers) {
    EXPECT_NE(measure::machine_identity("llvmpipe", 1), measure::machine_identity("llvmpipe", 2));
    EXPECT_NE(measure::machine_identity("llvmpipe", 1), measure::machine_identity("other", 1));
    EXPECT_EQ(measure::machine_identity("llvmpipe", 0), measure::machine_identity("llvmpipe", gl::effective_rasterisers(0)));
}

}  // namespace
}  // namespace surefoot
