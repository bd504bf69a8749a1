// The light's switches in a walk on the virtual clock, by keys of a window and by settings: pictures change within two frames,
// nothing is compiled, and no frame is late.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "input/devices/no_devices.hpp"
#include "input/live_source.hpp"
#include "input/window/window_keys.hpp"
#include "rt/clock/clock.hpp"
#include "tests/gl/small_models.hpp"
#include "tools/walk/light.hpp"
#include "tools/walk/steered_poses.hpp"
#include "tools/walk/walk_stages.hpp"

namespace surefoot::walk {
namespace {

/// A slope before the eye that has all four parts of the light. Baked shadows take most of its sun; what is 4 m away is in fog.
model::Model slope_in_all_light() {
    test::SmallModel scene;
    constexpr model::EffectMask all = model::effect_sun | model::effect_shadow | model::effect_lamps | model::effect_fog;
    const mat3 tilted(glm::mat3_cast(glm::angleAxis(-0.25F * std::numbers::pi_v<float>, vec3(1, 0, 0))));
    scene.square(scene.material(test::plain(0.8F, 0.7F, 0.6F, 1, all)), test::at(0, 0, -6, tilted), 4);
    model::Model model = scene.finish();
    constexpr std::uint8_t a_fifth = 51;
    model::SunSeen seen{};
    for (std::uint8_t& share : seen.share) share = a_fifth;
    model.sun_seen.assign(model.vertices.size(), seen);
    model.lamp_light.assign(model.vertices.size(), {{200, 180, 120, 0}, {0, 0, 0, 0}});
    model.light.fog_visibility_m = 4;
    for (const model::EffectMask bit : {model::effect_sun, model::effect_shadow, model::effect_lamps, model::effect_fog})
        model.effects.push_back({bit, true, 2, "", true});
    return model;
}

/// A walk before the slope, 30 frames a second. The keyboard of a window steers it, stepped inline.
class KeyedWalk {
public:
    using Picture = std::vector<std::uint8_t>;
    static constexpr std::int64_t slot_ns = 1'000'000'000 / 30;

    KeyedWalk(double hour, const rt::Switches& at_first, bool may_switch) {
        request_.clock = rt::ClockKind::virtual_time;
        request_.correct_costs = false;
        request_.hour = hour;
        static_cast<rt::Switches&>(request_) = at_first;
        path_.samples.resize(2);
        path_.samples[1].time_s = 60;
        model::Model model = slope_in_all_light();
        EngineOptions options;
        options.device.viewport = {64, 48};
        options.device.switches = switch_groups(request_, may_switch, model.called_for());
        auto opened = Engine::open(std::move(model), model::default_costs(), options);
        EXPECT_TRUE(opened.ok()) << opened.error().text();
        if (!opened) return;
        engine_ = std::move(*opened);
        engine_->device().bind();
        for (std::size_t i = 0; i < 3; ++i) engine_->reserve(prepared_.slot(i));
        programs = engine_->device().program_listing();
        snapshots_ = std::make_unique<SnapshotStore>(1, 1, engine_->drawn_capacity());
        begin_input();
        WalkStagesOptions stages{request_};
        stages.period_ns = slot_ns;
        stages.budget_us = stages.limit_us = 20'000;
        stages_ = std::make_unique<WalkStages>(*engine_, *steered_, clock_, poses_, prepared_, *snapshots_, kept_, stages);
    }
    [[nodiscard]] bool opened() const { return stages_ != nullptr; }

    /// The next frame, before which these keys are down.
    rt::FrameRecord frame(std::initializer_list<char> down) {
        input::WindowReport report;
        for (const char key : down)
            report.keys |= std::uint64_t{1} << static_cast<unsigned>(input::window_key_of(static_cast<std::uint32_t>(key)));
        report.stamp_ns = clock_.now_ns();
        feed_->push(report);
        engine_->device().bind();  // another walk may have drawn before
        rt::FrameRecord record;
        record.slot = record.frame = frames_++;
        record.due_ns = static_cast<std::int64_t>(record.slot) * slot_ns;
        record.deadline_ns = record.due_ns + slot_ns;
        clock_.sleep_until_ns(record.due_ns);
        stages_->sample(record);
        stages_->select(record);
        stages_->submit(record);
        stages_->finish(record);
        record.missed = clock_.now_ns() > record.deadline_ns;
        stages_->account(record);
        return record;
    }
    Picture picture() {
        engine_->device().bind();
        auto image = engine_->device().read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? image->rgba : Picture{};
    }
    [[nodiscard]] std::vector<std::string> programs_now() const { return engine_->device().program_listing(); }

    std::vector<std::string> programs;  ///< after the model was loaded

private:
    void begin_input() {
        input::LiveOptions live;
        live.window = feed_;
        live.devices = false;
        live.stamps = 1000;
        source_ = std::make_unique<input::LiveSource>(std::move(live), std::make_unique<input::NoDevices>());
        tour_ = std::make_unique<TourController>(path_);
        stepper_ = std::make_unique<InputStepper>(*source_, steering_, *tour_, walking_, samples_, jumps_);
        steered_ = std::make_unique<SteeredPoses>(samples_, input::MotionLimits{}, slot_ns, stepper_.get());
        stepper_->begin(0);
    }

    WalkRequest request_;
    Path path_;
    std::unique_ptr<Engine> engine_;
    rt::VirtualClock clock_;
    rt::TripleBuffer<PoseSample> poses_;
    rt::TripleBuffer<prepare::PreparedFrame> prepared_;
    std::unique_ptr<SnapshotStore> snapshots_;
    KeptFrame kept_;
    std::shared_ptr<input::WindowFeed> feed_ = std::make_shared<input::WindowFeed>();
    input::Steering steering_{input::MotionLimits{}, input::SafetyLimits{}};
    std::unique_ptr<input::LiveSource> source_;
    model::Ground ground_;
    Walking walking_{ground_, model::Body{}, rt::WalkingMode::fly};
    std::unique_ptr<TourController> tour_;
    rt::TripleBuffer<SteeredSample> samples_;
    JumpBuffer jumps_;
    std::unique_ptr<InputStepper> stepper_;
    std::unique_ptr<SteeredPoses> steered_;
    std::unique_ptr<WalkStages> stages_;
    std::uint64_t frames_ = 0;
};

constexpr rt::Switches all_parts_on{};
constexpr std::uint64_t frames_to_show = 2;  ///< after the press, at most

/// A key of the light, its part, and an hour at which that shows.
struct KeyOfLight {
    char key;
    bool rt::Switches::*part;
    double hour;
};
constexpr std::array<KeyOfLight, 4> keys_of_light{{{'l', &rt::Switches::sunlight, 12},
                                                   {'j', &rt::Switches::shadows, 12},
                                                   {'h', &rt::Switches::fog, 12},
                                                   {'k', &rt::Switches::lamps, 22}}};

class SwitchKeys : public ::testing::Test {
protected:
    void SetUp() override {
#ifdef SUREFOOT_WATCHES_THREADS
        GTEST_SKIP() << "no GL is opened where the thread sanitizer watches";
#endif
    }
};

/// W is held, so that both walk. In one of them, keys of the light are pressed: each twice, four frames apart.
TEST_F(SwitchKeys, ShowWithinTwoFramesWithoutCompilingOrALateFrame) {
    for (const double hour : {12.0, 22.0}) {
        KeyedWalk plain(hour, all_parts_on, true), pressed(hour, all_parts_on, true);
        ASSERT_TRUE(plain.opened() && pressed.opened());
        for (KeyedWalk* each : {&plain, &pressed}) each->frame({});  // the keyboard is seen at rest
        const KeyedWalk::Picture first = pressed.picture();
        for (const KeyOfLight& one : keys_of_light) {
            if (one.hour != hour) continue;
            for (std::uint64_t i = 0; i < 8; ++i) {
                plain.frame({'w'});
                const bool press = i % 4 == 0;
                const rt::FrameRecord record = press ? pressed.frame({'w', one.key}) : pressed.frame({'w'});
                EXPECT_FALSE(record.missed) << one.key << " " << i;
                if (i % 4 < frames_to_show) continue;
                EXPECT_EQ(record.light.on.*one.part, i >= 4) << one.key << " " << i;
                EXPECT_EQ(pressed.picture() == plain.picture(), i >= 4) << one.key << " " << i;
            }
        }
        EXPECT_NE(pressed.picture(), first) << "the eye went on";
        EXPECT_EQ(pressed.programs_now(), pressed.programs) << "compiled when the model was loaded, and no more since";
    }
}

TEST_F(SwitchKeys, ASettingShowsFromTheFirstFrameWhatItsKeyShows) {
    for (const double hour : {12.0, 22.0}) {
        KeyedWalk keyed(hour, all_parts_on, true);
        ASSERT_TRUE(keyed.opened());
        keyed.frame({});
        for (const KeyOfLight& one : keys_of_light) {
            if (one.hour != hour) continue;
            rt::Switches without;
            without.*one.part = false;
            KeyedWalk set(hour, without, false);
            ASSERT_TRUE(set.opened());
            const rt::FrameRecord first = set.frame({});
            EXPECT_FALSE(first.light.on.*one.part);
            EXPECT_FALSE(first.missed);
            keyed.frame({one.key});
            keyed.frame({});
            EXPECT_EQ(set.picture(), keyed.picture()) << one.key;
            keyed.frame({one.key});
            keyed.frame({});
            EXPECT_NE(set.picture(), keyed.picture()) << one.key << ": on again";
        }
    }
}

}  // namespace
}  // namespace surefoot::walk
