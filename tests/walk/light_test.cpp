// Switches and the hour: what each hides, which groups a device needs, how the hour runs, and that pictures of snapshots have the
// light of their frames.
#include "tools/walk/light.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "rt/clock/clock.hpp"
#include "tests/gl/small_models.hpp"
#include "tools/walk/walk_stages.hpp"

namespace surefoot::walk {
namespace {

using model::EffectMask;
using Groups = std::vector<EffectMask>;

constexpr EffectMask sun = model::effect_sun, shadow = model::effect_shadow, lamps = model::effect_lamps, fog = model::effect_fog;
constexpr EffectMask moving_shadow = model::effect_moving_shadow;

TEST(Light, EachSwitchHidesItsEffectsAndSunlightItsShadows) {
    const auto hidden = [](bool rt::Switches::*off) {
        rt::Switches on;
        on.*off = false;
        return hidden_effects(on);
    };
    EXPECT_EQ(hidden_effects({}), 0U);
    EXPECT_EQ(hidden(&rt::Switches::sunlight), sun | shadow | moving_shadow);
    EXPECT_EQ(hidden(&rt::Switches::shadows), shadow | moving_shadow);
    EXPECT_EQ(hidden(&rt::Switches::lamps), lamps);
    EXPECT_EQ(hidden(&rt::Switches::fog), fog);
    EXPECT_EQ(hidden_effects({false, false, false, false}), sun | shadow | moving_shadow | lamps | fog);
}

TEST(Light, EveryGroupIsHiddenWholeByItsSwitch) {
    for (const EffectMask called_for :
         {sun | shadow | lamps | fog, sun | fog, shadow | lamps, EffectMask{sun}, sun | shadow | moving_shadow | lamps | fog,
          sun | moving_shadow, shadow | moving_shadow, EffectMask{moving_shadow}}) {
        const Groups groups = switch_groups({}, true, called_for);
        for (const rt::Switch& one : rt::light_switches) {
            rt::Switches on;
            on.*one.on = false;
            EffectMask left_out = 0;  // as gl::Device::hide_effects() says
            for (const EffectMask group : groups)
                if ((group & ~hidden_effects(on)) == 0) left_out |= group;
            EXPECT_EQ(left_out, hidden_effects(on) & called_for) << one.name;
        }
    }
}

TEST(Light, GroupsAreOfTheModelsEffectsAndOfWhatMaySwitch) {
    constexpr EffectMask others = model::effect_texture | model::effect_blend | model::effect_openness;
    EXPECT_EQ(switch_groups({}, true, others | sun | shadow | lamps | fog), (Groups{sun | shadow, shadow, lamps, fog}));
    EXPECT_EQ(switch_groups({}, true, others | sun), (Groups{sun}));
    EXPECT_EQ(switch_groups({}, true, others | shadow), (Groups{shadow})) << "one for two switches";
    EXPECT_EQ(switch_groups({}, true, others), Groups{}) << "a model without an effect compiles nothing for it";
    EXPECT_EQ(switch_groups({}, false, others | sun | shadow | lamps | fog), Groups{}) << "nobody may switch";
    const rt::Switches no_fog{true, true, true, false};
    EXPECT_EQ(switch_groups(no_fog, false, others | sun | fog), (Groups{fog})) << "off at first";
    EXPECT_EQ(switch_groups(no_fog, false, others | sun), Groups{});
    EXPECT_EQ(switch_groups({false, true, true, true}, false, sun | shadow), (Groups{sun | shadow}));
}

TEST(Light, EverySecondPressSwitchesBackAndOthersStay) {
    for (const rt::Switch& one : rt::light_switches) {
        for (const bool at_first : {true, false}) {
            rt::Switches before, expected;
            before.*one.on = at_first;
            rt::SwitchPresses presses;
            for (const std::uint32_t count : {0U, 1U, 2U, 7U, 0xFFFFFFFFU}) {
                presses.*one.presses = count;
                expected.*one.on = at_first == (count % 2 == 0);
                EXPECT_EQ(rt::switched(before, presses), expected) << one.name << " " << count;
            }
        }
    }
}

float hour_of(double hour, double speed, double walk_s) {
    config::Settings settings;
    settings.hour = hour;
    settings.hour_speed = speed;
    return hour_at(settings, walk_s);
}

TEST(Light, TheHourRunsInStepsOfTwoMinutes) {
    EXPECT_TRUE(std::isnan(hour_at({}, 100))) << "the model's own light stays";
    EXPECT_EQ(hour_of(8, 0, 1e6), 8);
    EXPECT_EQ(hour_of(8.51, 0, 0), 8.5F);
    EXPECT_EQ(hour_of(8, 1, 60), 9);
    EXPECT_EQ(hour_of(8, 1, 0.9), 8) << "less than half a step";
    EXPECT_EQ(hour_of(8, 1, 1.1), static_cast<float>(8 + 1.0 / 30));
    EXPECT_EQ(hour_of(8, -1, 1.1), static_cast<float>(8 - 1.0 / 30));
    int changes = 0;
    for (int frame = 1; frame <= 1800; ++frame)
        changes += hour_of(8, 1, frame / 30.0) != hour_of(8, 1, (frame - 1) / 30.0) ? 1 : 0;
    EXPECT_EQ(changes, 30) << "steps in an hour";
}

TEST(Light, TheHourComesRoundAtMidnightEitherWay) {
    EXPECT_EQ(hour_of(24, 0, 0), 0);
    EXPECT_EQ(hour_of(23, 60, 0.5), 23.5F);
    EXPECT_EQ(hour_of(23, 60, 1), 0);
    EXPECT_EQ(hour_of(23, 60, 2), 1);
    EXPECT_EQ(hour_of(0.5, -60, 1), 23.5F);
    EXPECT_EQ(hour_of(12, 600, 24 * 6 * 100 + 3), 18) << "hours later";
    for (double speed : {600.0, -600.0}) {
        for (int frame = 0; frame < 20'000; ++frame) {
            const float hour = hour_of(12, speed, frame / 60.0);
            ASSERT_TRUE(hour >= 0 && hour < 24) << hour;
        }
    }
}

/// Frames of a walk on the virtual clock, 30 a second. The eye stands before a square in sun and fog.
class LightWalk : public ::testing::Test {
protected:
    using Pixels = std::vector<std::uint8_t>;
    static constexpr std::int64_t period_ns = 1'000'000'000 / 30;

    void SetUp() override {
        request_.clock = rt::ClockKind::virtual_time;
        request_.correct_costs = false;
        PathSample sample;
        path_.samples = {sample};
#ifdef SUREFOOT_WATCHES_THREADS
        GTEST_SKIP() << "no GL is opened where the thread sanitizer watches";
#endif
    }
    void open(double rest_after_ms = 0) {
        test::SmallModel scene;
        scene.square(scene.material(test::plain(0.8F, 0.7F, 0.6F, 1, sun | fog | shadows_)), test::at(0, 0, -2), 1);
        if (shadows_ != 0) add_what_moves(scene);
        model::Model model = scene.finish();
        model.light.fog_visibility_m = 4;
        model.effects = {{sun, true, 2, "", true}, {fog, true, 2, "", true}};
        if (shadows_ != 0) model.effects.push_back({shadows_, true, 2, "", true});
        EngineOptions options;
        options.device.viewport = {64, 48};
        options.device.switches = switch_groups(request_, true, sun | fog | shadows_);
        options.rest_after_ms = rest_after_ms;
        options.buys_effects = request_.buy_effects;
        options.effect_hours = effect_hours(request_);
        auto opened = Engine::open(std::move(model), costs_, options);
        ASSERT_TRUE(opened.ok()) << opened.error().text();
        engine_ = std::move(*opened);
        engine_->device().bind();
        for (std::size_t i = 0; i < 3; ++i) engine_->reserve(prepared_.slot(i));
        snapshots_ = std::make_unique<SnapshotStore>(1, 16, engine_->drawn_capacity());
        poses_source_ = std::make_unique<PathPoses>(path_, period_ns);
        WalkStagesOptions options_of_stages{request_};
        options_of_stages.period_ns = period_ns;
        options_of_stages.budget_us = options_of_stages.limit_us = 20'000;
        stages_ = std::make_unique<WalkStages>(*engine_, *poses_source_, clock_, poses_, prepared_, *snapshots_, kept_,
                                               options_of_stages);
    }
    /// A square behind the eye. Of the other one, baked shadows take most of the sun.
    static void add_what_moves(test::SmallModel& scene) {
        model::Model& model = scene.model();
        model.motions.push_back({dvec3(0), 0, 1, 1});
        model.motion_keys.emplace_back();
        model::Placement placement = test::at(0.3, 0.3, 1.5);
        placement.motion = 0;
        scene.square(scene.material(test::plain(0.2F, 0.4F, 0.6F, 1, sun)), placement, 0.2F);
        model.sun_seen.assign(model.vertices.size(), {{51, 51}});
    }
    /// Returns the frame's record; picture() is what it shows.
    rt::FrameRecord frame(std::uint64_t slot) {
        rt::FrameRecord record;
        record.slot = slot;
        record.frame = frames_++;
        record.due_ns = static_cast<std::int64_t>(slot) * period_ns;
        record.deadline_ns = record.due_ns + period_ns;
        clock_.sleep_until_ns(record.due_ns);
        stages_->sample(record);
        stages_->select(record);
        stages_->submit(record);
        stages_->finish(record);
        stages_->account(record);
        return record;
    }
    Pixels picture() {
        engine_->device().draws.plays();
        auto image = engine_->device().read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? image->rgba : Pixels{};
    }

    WalkRequest request_;
    EffectMask shadows_ = 0;  ///< that the large square has as well
    model::CostModel costs_ = model::default_costs();
    Path path_;
    std::unique_ptr<Engine> engine_;
    rt::VirtualClock clock_;
    rt::TripleBuffer<PoseSample> poses_;
    rt::TripleBuffer<prepare::PreparedFrame> prepared_;
    std::unique_ptr<SnapshotStore> snapshots_;
    std::unique_ptr<PathPoses> poses_source_;
    KeptFrame kept_;
    std::unique_ptr<WalkStages> stages_;
    std::uint64_t frames_ = 0;
};

TEST_F(LightWalk, FramesShowTheirHourAndSnapshotsTheSame) {
    request_.hour = 12;
    request_.hour_speed = 360;  // a day in four seconds
    ASSERT_NO_FATAL_FAILURE(open());
    const std::vector<std::uint64_t> slots = {0, 30, 60, 61, 120};
    const std::vector<float> hours = {12, 18, 0, 0.2F, 12};
    std::vector<Pixels> shown;
    for (std::size_t i = 0; i < slots.size(); ++i) {
        const rt::FrameRecord record = frame(slots[i]);
        EXPECT_EQ(record.light.hour, hours[i]);
        EXPECT_EQ(record.light.on, rt::Switches{});
        shown.push_back(picture());
    }
    EXPECT_NE(shown[0], shown[1]);
    EXPECT_NE(shown[1], shown[2]);
    EXPECT_EQ(shown[0], shown[4]) << "noon of the next day";
    ASSERT_EQ(snapshots_->used(), slots.size());
    for (const std::size_t i : {2U, 0U, 4U, 1U, 3U}) {  // in another order: each brings its own light
        const FrameSnapshot& snapshot = snapshots_->snapshots()[i];
        EXPECT_EQ(snapshot.light.hour, hours[i]);
        auto again = render_snapshot(*engine_, snapshot);
        ASSERT_TRUE(again.ok()) << again.error().text();
        EXPECT_EQ(again->walk, shown[i]) << "frame " << i;
        EXPECT_EQ(again->full, shown[i]) << "its full detail is compared in the same light";
    }
}

TEST_F(LightWalk, WithoutAnHourTheModelsOwnLightStays) {
    ASSERT_NO_FATAL_FAILURE(open());
    const rt::FrameRecord first = frame(0);
    EXPECT_FALSE(rt::has_hour(first.light));
    const Pixels shown = picture();
    frame(9000);
    EXPECT_EQ(picture(), shown);
    engine_->set_light(model::daylight_of_model(engine_->model().sun_direction, engine_->model().light));
    frame(9001);
    EXPECT_EQ(picture(), shown);
    engine_->set_light(model::daylight_at(0, engine_->model().light));
    frame(9002);
    EXPECT_NE(picture(), shown) << "the test would see another light";
}

TEST_F(LightWalk, AWalkThatBeginsWithoutFogShowsNone) {
    const auto shown = [&] {
        frame(0);
        return picture();
    };
    ASSERT_NO_FATAL_FAILURE(open());
    const Pixels with = shown();
    request_.fog = false;
    stages_.reset();
    ASSERT_NO_FATAL_FAILURE(open());
    const Pixels without = shown();
    EXPECT_NE(with, without);
    EXPECT_FALSE(snapshots_->snapshots()[0].light.on.fog);
    EXPECT_EQ(render_snapshot(*engine_, snapshots_->snapshots()[0])->full, without);
}

TEST_F(LightWalk, WhereThingsMoveSnapshotsHaveTheSunAndShadowsOfTheirFrames) {
    shadows_ = shadow | moving_shadow;
    std::vector<Pixels> shown;
    for (const auto& [sunlight, shadows] : {std::pair{true, true}, {true, false}, {false, true}}) {
        request_.sunlight = sunlight;
        request_.shadows = shadows;
        stages_.reset();
        ASSERT_NO_FATAL_FAILURE(open());
        frame(0);
        shown.push_back(picture());
        if (sunlight && shadows) continue;  // full detail has no shadow of what moves
        auto again = render_snapshot(*engine_, snapshots_->snapshots()[0]);
        ASSERT_TRUE(again.ok()) << again.error().text();
        EXPECT_EQ(again->walk, shown.back()) << (sunlight ? "without shadows" : "without sunlight");
        EXPECT_EQ(again->full, shown.back()) << "its full detail is compared in the same light";
    }
    EXPECT_NE(shown[0], shown[1]) << "the test would see a shadow";
    EXPECT_NE(shown[1], shown[2]) << "and the sun";
}

TEST_F(LightWalk, AnHourThatRunsIsShownAtRestToo) {
    request_.hour = 6;
    request_.hour_speed = 60;  // a step in each frame
    ASSERT_NO_FATAL_FAILURE(open(100));
    for (std::uint64_t slot = 0; slot < 90; ++slot) {
        const rt::FrameRecord record = frame(slot);
        if (slot % 30 != 29) continue;
        const Pixels shown = picture();
        show_light(*engine_, record.light);
        engine_->draw_unbudgeted(path_.samples[0].pose, engine_->full_detail(path_.samples[0].pose));
        EXPECT_EQ(picture(), shown) << "slot " << slot << " shows the light of another hour";
    }
}

/// A set that was prepared before its frame's light was known would value effects at midnight, the first light of the day.
TEST_F(LightWalk, TheFirstSetValuesEffectsAtTheHourOfTheStart) {
    request_.hour = 12;
    request_.hour_speed = 1;
    request_.buy_effects = true;
    open();
    frame(0);
    const auto first = prepared_.front().effect_value;
    EXPECT_GT(first[0], 0) << "sunlight";
    frame(1);
    EXPECT_EQ(prepared_.front().effect_value, first) << "the same view in the same light";
    stages_.reset();
    request_.hour = 0;
    open();
    frame(0);
    EXPECT_NE(prepared_.front().effect_value, first) << "midnight is another light";
}

TEST_F(LightWalk, APartThatIsTooDearIsDroppedAndSnapshotsDrawTheirFramesPicture) {
    request_.fog = false;
    open();
    frame(0);
    const Pixels foggy_off = picture();
    request_.fog = true;
    request_.buy_effects = true;
    costs_.prices = {{fog, 0, 0, 1e5F}};
    open();
    const rt::FrameRecord dropping = frame(0);
    constexpr std::size_t fog_part = 3;
    EXPECT_TRUE(dropping.dropped_parts[fog_part].dropped);
    EXPECT_TRUE(dropping.dropped_parts[fog_part].fell);
    EXPECT_GT(dropping.dropped_parts[fog_part].fell_at, 0);
    EXPECT_FALSE(dropping.dropped_parts[0].dropped) << "the sun costs nothing";
    EXPECT_TRUE(dropping.light.on.fog) << "nobody switched it off";
    EXPECT_EQ(picture(), foggy_off);
    const rt::FrameRecord later = frame(1);
    EXPECT_TRUE(later.dropped_parts[fog_part].dropped);
    EXPECT_FALSE(later.dropped_parts[fog_part].fell) << "it was gone";
    EXPECT_EQ(later.dropped_parts[fog_part].fell_at, dropping.dropped_parts[fog_part].fell_at);
    ASSERT_EQ(snapshots_->used(), 2U);
    const auto drawn_again = render_snapshot(*engine_, snapshots_->snapshots()[1]);
    ASSERT_TRUE(drawn_again.ok());
    EXPECT_EQ(drawn_again->walk, foggy_off);
    EXPECT_NE(drawn_again->full, foggy_off) << "full detail has all that is switched on";
    EXPECT_GT(drawn_again->mse, 0) << "what was dropped counts as lost";
}

TEST(Light, AWalkValuesItsEffectsAtItsHours) {
    config::Settings settings;
    EXPECT_TRUE(effect_hours(settings).empty()) << "the model's own light";
    settings.hour = 18.51;
    EXPECT_EQ(effect_hours(settings), std::vector<double>{18.5});
    settings.hour_speed = 1;
    const std::vector<double> all = effect_hours(settings);
    ASSERT_EQ(all.size(), 25U);
    EXPECT_EQ(all.front(), 0);
    EXPECT_EQ(all.back(), 24);
}

TEST(Light, DroppedPartsAreThoseOfTheModelsGroups) {
    const model::EffectMask called_for = sun | shadow | fog;
    const std::vector<EffectSale> sales{{sun | shadow, 2, false, false}, {shadow, 0.5F, true, true}, {fog, 1, true, false}};
    const auto parts = dropped_parts(sales, called_for);
    EXPECT_FALSE(parts[0].dropped);
    EXPECT_TRUE(parts[1].dropped);
    EXPECT_EQ(parts[1].fell_at, 0.5F);
    EXPECT_FALSE(parts[2].dropped) << "it has no lamps";
    EXPECT_TRUE(parts[3].dropped);
    EXPECT_FALSE(parts[3].fell) << "in an earlier frame";
    EXPECT_EQ(parts[3].fell_at, 1);
    EXPECT_EQ(rt::parts_left({true, true, false, true}, parts), (rt::Switches{true, false, false, false}));
}

}  // namespace
}  // namespace surefoot::walk
