// From settings to a request: nothing is forgotten, what the command line names wins, and each rule is told by its option.
#include "tools/walk/settings_request.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/engine.hpp"
#include "render/gl/backends.hpp"
#include "render/select/registry.hpp"

namespace surefoot::walk {
namespace {

/// As a command line would write a value that is not the default.
std::string another_value(const config::Entry& entry) {
    const config::Settings& defaults = settings_schema().defaults();
    switch (entry.kind) {
        case config::Kind::flag:
            return config::value_text(defaults, entry) == "true" ? "false" : "true";
        case config::Kind::choice:
            return std::string(entry.choices.back().name == config::choice_of(defaults, entry) ? entry.choices.front().name
                                                                                               : entry.choices.back().name);
        case config::Kind::colour:
            return "#010203";
        case config::Kind::file:
        case config::Kind::text:
            return "some.file";
        case config::Kind::number:
        case config::Kind::integer:
            break;
    }
    const std::string max = std::to_string(static_cast<long long>(entry.max));
    return config::value_text(defaults, entry) == max ? std::to_string(static_cast<long long>(entry.min)) : max;
}

TEST(SettingsRequest, EverySettingArrives) {
    config::Configuration c(settings_schema());
    for (const config::Entry& entry : settings_schema().entries()) {
        ASSERT_TRUE(config::set_value(c, entry.key, another_value(entry)).ok()) << entry.key;
        EXPECT_NE(config::value_text(c.values, entry), config::value_text(WalkRequest(), entry)) << entry.key;
    }
    WalkRequest request;
    apply_settings(c, request);
    for (const config::Entry& entry : settings_schema().entries())
        EXPECT_EQ(config::value_text(request, entry), config::value_text(c.values, entry)) << entry.key;
}

TEST(SettingsRequest, SelectorsThatLeaveObjectsOutAreRefusedWithTheReason) {
    for (const select::SelectorEntry& entry : select::dropping_selectors()) {
        config::Configuration c(settings_schema());
        const auto loaded = config::load_text(c, "selector = \"" + std::string(entry.name) + "\"\n", "s.toml");
        ASSERT_FALSE(loaded.ok()) << entry.name;
        EXPECT_NE(loaded.error().text().find("leaves visible objects out"), std::string::npos) << loaded.error().text();
    }
}

TEST(SettingsRequest, FilesOfTheCommandLineWinAndThoseOfAFileAreRelativeToIt) {
    config::Configuration c(settings_schema());
    ASSERT_TRUE(config::load_text(c, "model = \"m.walk\"\npath = \"p.csv\"\ninput = \"devices\"\n", "/etc/surefoot/s.toml").ok());
    WalkRequest request;
    request.path_file = "mine.csv";
    apply_settings(c, request);
    EXPECT_EQ(request.model_file, "/etc/surefoot/m.walk");
    EXPECT_EQ(request.path_file, "mine.csv");
    EXPECT_EQ(request.input_file, live_input);
    EXPECT_EQ(request.state_dir, "");
}

TEST(SettingsRequest, TheSchemaHoldsWhatTheRegistriesHold) {
    const auto same = [](const config::Entry& entry, const std::vector<Named>& registry) {
        ASSERT_EQ(entry.choices.size(), registry.size()) << entry.key;
        for (std::size_t i = 0; i < registry.size(); ++i) {
            EXPECT_EQ(entry.choices[i].name, registry[i].name);
            EXPECT_EQ(entry.choices[i].help, registry[i].help);
            EXPECT_NE(config::commented_defaults(settings_schema()).find(registry[i].help), std::string::npos);
        }
    };
    same(*settings_schema().find("selector"), named(select::selectors()));
    same(*settings_schema().find("backend"), named(gl::backends()));
    EXPECT_EQ(WalkRequest().selector, EngineOptions().selector);
    EXPECT_EQ((*gl::backend_named(WalkRequest().backend))->kind, EngineOptions().device.kind);
}

TEST(SettingsRequest, SelectorsThatLeaveObjectsOutAreRefusedByName) {
    for (const select::SelectorEntry& entry : select::dropping_selectors()) {
        config::Configuration c(settings_schema());
        const auto loaded = config::load_text(c, "selector = \"" + std::string(entry.name) + "\"\n", "s.toml");
        ASSERT_FALSE(loaded.ok());
        EXPECT_NE(loaded.error().what.find("leaves visible objects out"), std::string::npos) << loaded.error().what;
        EXPECT_EQ(loaded.error().remedy.find(entry.name), std::string::npos) << "it is not offered";
        EXPECT_TRUE(select::selector_named(entry.name).ok()) << "commands that compare know it";
    }
}

TEST(SettingsRequest, AnUnknownBackendIsRefusedByName) {
    config::Configuration c(settings_schema());
    ASSERT_TRUE(config::load_text(c, "backend = \"kms\"\nscreen = \"DP-1\"\nmode = \"@50\"\nrotation = 180\n", "s.toml").ok());
    EXPECT_EQ(c.values.screen, "DP-1");
    EXPECT_EQ(c.values.rotation_deg, 180);
    const auto loaded = config::load_text(c, "backend = \"vulkan\"\n", "s.toml");
    ASSERT_FALSE(loaded.ok());
    EXPECT_EQ(loaded.error().place, "s.toml:1");
    EXPECT_NE(loaded.error().text().find("vulkan"), std::string::npos) << loaded.error().text();
    EXPECT_NE(loaded.error().text().find("egl"), std::string::npos) << loaded.error().text();
    const auto turned = config::load_text(c, "rotation = 45\n", "s.toml");
    ASSERT_FALSE(turned.ok());
    EXPECT_NE(turned.error().text().find("0, 90, 180, 270"), std::string::npos) << turned.error().text();
}

TEST(SettingsRequest, ARuleThatIsBrokenNamesItsOption) {
    EXPECT_TRUE(check_request({}).ok());
    const auto place = [](auto change) {
        WalkRequest request;
        change(request);
        const auto checked = check_request(request);
        return checked.ok() ? std::string("fine") : checked.error().place;
    };
    const auto on_virtual_time = [](WalkRequest& r) { r.clock = rt::ClockKind::virtual_time; };
    EXPECT_EQ(place(on_virtual_time), "fine");
    EXPECT_EQ(place([&](WalkRequest& r) { on_virtual_time(r), r.control = true; }), "--control");
    EXPECT_EQ(place([&](WalkRequest& r) { on_virtual_time(r), r.strict = true; }), "--strict");
    EXPECT_EQ(place([&](WalkRequest& r) { on_virtual_time(r), r.input_file = live_input; }), "--input devices");
    EXPECT_EQ(place([](WalkRequest& r) { r.control = true, r.input_file = "a.hid"; }), "--control");
    EXPECT_EQ(place([](WalkRequest& r) { r.control = true, r.frames = 5; }), "--frames");
    EXPECT_EQ(place([](WalkRequest& r) { r.control = true, r.seconds = 5; }), "--seconds");
    EXPECT_EQ(place([](WalkRequest& r) { r.cost_noise = 0.1; }), "--cost-noise");
    EXPECT_EQ(place([&](WalkRequest& r) { on_virtual_time(r), r.cost_noise = 0.1; }), "--cost-noise");
    EXPECT_EQ(place([&](WalkRequest& r) { on_virtual_time(r), r.cost_noise = 0.1, r.backend = "null"; }), "fine");
    EXPECT_EQ(place([](WalkRequest& r) { r.steering_file = "s.toml"; }), "--steering");
    EXPECT_EQ(place([](WalkRequest& r) { r.clear_stop = true; }), "--clear-stop");
    EXPECT_EQ(place([](WalkRequest& r) { r.clear_stop = true, r.input_file = live_input; }), "fine");
    EXPECT_EQ(place([](WalkRequest& r) { r.backend = "paper"; }), "backend 'paper'");
    EXPECT_EQ(place([](WalkRequest& r) { r.endless = true, r.frames = 5; }), "endless walk");
    EXPECT_EQ(place([](WalkRequest& r) { r.endless = true, r.ledger_file = "l.csv"; }), "endless walk");
}

TEST(SettingsRequest, AWindowSteersUnlessThePathOrARecordingMust) {
    WalkRequest request;
    EXPECT_FALSE(window_steers(request)) << "no window";
    request.backend = gl::window_backend;
    EXPECT_FALSE(window_steers(request)) << "nor may it, unless the command says so";
    EXPECT_FALSE(request.may_leave);
    request.input_file = window_input;
    EXPECT_EQ(check_request(request).error().what, "Only `surefoot walk` and the service are steered by a window");
    request.input_file.clear();
    request.may_steer = true;
    EXPECT_TRUE(window_steers(request)) << "off the path, once somebody does";
    EXPECT_TRUE(check_request(request).ok());
    request.steering_file = "keys.toml";
    EXPECT_TRUE(check_request(request).ok()) << "it has a device to map";
    request.input_file = live_input;
    EXPECT_TRUE(window_steers(request)) << "both steer";
    request.input_file = window_input;
    EXPECT_TRUE(window_steers(request));
    EXPECT_TRUE(is_steered_live(request));
    request.fullscreen = true;
    EXPECT_TRUE(check_request(request).ok());
    request.input_file = "a.hid";
    EXPECT_FALSE(window_steers(request));
    EXPECT_FALSE(is_steered_live(request));
    request.input_file.clear();
    request.control = true;
    EXPECT_FALSE(window_steers(request)) << "nobody steers the same way twice";
    request.control = false;
    request.clock = rt::ClockKind::virtual_time;
    EXPECT_FALSE(window_steers(request));

    const auto place = [](auto change) {
        WalkRequest wrong;
        change(wrong);
        const auto checked = check_request(wrong);
        return checked.ok() ? std::string("fine") : checked.error().place;
    };
    EXPECT_EQ(place([](WalkRequest& r) { r.input_file = window_input; }), "--input window");
    EXPECT_EQ(place([](WalkRequest& r) { r.input_file = window_input, r.may_steer = true; }), "--input window");
    EXPECT_EQ(place([](WalkRequest& r) { r.fullscreen = true; }), "--fullscreen");
}

TEST(SettingsRequest, TheWindowAsInputIsNoFileName) {
    config::Configuration c(settings_schema());
    ASSERT_TRUE(config::load_text(c, "input = \"window\"\nbackend = \"window\"\nfullscreen = true\n", "/etc/s.toml").ok());
    WalkRequest request;
    apply_settings(c, request);
    EXPECT_EQ(request.input_file, window_input);
    EXPECT_TRUE(request.fullscreen);
}

TEST(SettingsRequest, ALaterWalkKeepsTheProcesssRasterisers) {
    WalkRequest first, later;
    first.rasterisers = 2;
    later.rasterisers = 3;
    const std::string remark = keep_process(first, later);
    EXPECT_NE(remark.find("3 take effect at the next start"), std::string::npos) << remark;
    EXPECT_NE(remark.find("draws with 2"), std::string::npos) << remark;
    EXPECT_EQ(later.rasterisers, 2) << "or the cost table of another machine would be looked for";
    EXPECT_EQ(keep_process(first, later), "");
    // 0 is a number too: the default.
    first.rasterisers = gl::effective_rasterisers(0);
    later.rasterisers = 0;
    EXPECT_EQ(keep_process(first, later), "");
}

}  // namespace
}  // namespace surefoot::walk
