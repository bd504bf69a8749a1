// Screens and modes: reading what a user wrote, and choosing.
#include "render/gl/kms_modes.hpp"

#include <gtest/gtest.h>

namespace surefoot::gl {
namespace {

ScreenMode mode(std::uint32_t width, std::uint32_t height, double rate, bool preferred = false) {
    ScreenMode one;
    one.width = width;
    one.height = height;
    one.refresh_ns = static_cast<std::int64_t>(1e9 / rate);
    one.preferred = preferred;
    return one;
}

Screen screen() {
    Screen one;
    one.name = "HDMI-A-1";
    one.connected = true;
    one.modes = {mode(1920, 1200, 59.95, true), mode(1920, 1080, 50), mode(1920, 1080, 59.94), mode(1920, 1080, 60),
                 mode(1280, 720, 60)};
    one.modes.push_back(mode(1920, 1080, 100));
    one.modes.back().interlaced = true;
    return one;
}

std::string chosen(std::string_view text) {
    const auto request = read_mode(text);
    if (!request) return request.error().what;
    const auto found = choose_mode(screen(), *request);
    return found ? in_words(*found) : found.error().text();
}

TEST(KmsModes, AModeIsReadAsItIsWritten) {
    const auto all = read_mode("1920x1080@59.94");
    ASSERT_TRUE(all.ok());
    EXPECT_EQ(all->width, 1920U);
    EXPECT_EQ(all->height, 1080U);
    EXPECT_EQ(all->rate_hz, 59.94);
    EXPECT_EQ(read_mode("640x480")->rate_hz, 0);
    EXPECT_EQ(read_mode("@50")->rate_hz, 50);
    EXPECT_EQ(read_mode("")->width, 0U);
    for (const char* wrong : {"x", "1920", "1920x", "1920x1080@", "1920x1080@0", "1920x1080@nan", "0x0", "1920x1080 ", "-1x5",
                              "1x1@1e9", "99999999999x1", "1920*1080"}) {
        const auto read = read_mode(wrong);
        ASSERT_FALSE(read.ok()) << wrong;
        EXPECT_EQ(read.error().kind, ErrorKind::misuse) << wrong;
        EXPECT_NE(read.error().place.find(wrong), std::string::npos) << wrong;
    }
}

TEST(KmsModes, TheScreensPreferenceCountsUnlessTheUserSaysOtherwise) {
    EXPECT_EQ(chosen(""), "1920x1200@59.95");
    EXPECT_EQ(chosen("1920x1080"), "1920x1080@60") << "the fastest that is no interlaced one";
    EXPECT_EQ(chosen("1920x1080@60"), "1920x1080@60");
    EXPECT_EQ(chosen("1920x1080@59.94"), "1920x1080@59.94");
    EXPECT_EQ(chosen("1920x1080@50"), "1920x1080@50");
    Screen reversed = screen();
    std::swap(reversed.modes[2], reversed.modes[3]);
    EXPECT_EQ(in_words(*choose_mode(reversed, *read_mode("1920x1080@59.94"))), "1920x1080@59.94") << "whichever comes first";
    EXPECT_EQ(in_words(*choose_mode(reversed, *read_mode("1920x1080@60"))), "1920x1080@60");
    EXPECT_EQ(chosen("@60"), "1920x1200@59.95") << "half a per cent is the same rate";
}

TEST(KmsModes, AModeThatIsNotThereListsThoseThatAre) {
    for (const char* wrong : {"1920x1080@75", "800x600", "@30", "1920x1080@100"}) {
        const std::string text = chosen(wrong);
        EXPECT_NE(text.find("HDMI-A-1"), std::string::npos) << text;
        EXPECT_NE(text.find("1920x1200@59.95, 1920x1080@50"), std::string::npos) << text;
    }
}

TEST(KmsModes, AScreenIsChosenByItsNameOrTheFirstThatIsThere) {
    Screen dark = screen();
    dark.name = "DP-1";
    dark.connected = false;
    const std::vector<Screen> screens{dark, screen()};
    EXPECT_EQ((*choose_screen(screens, ""))->name, "HDMI-A-1");
    EXPECT_EQ((*choose_screen(screens, "HDMI-A-1"))->name, "HDMI-A-1");
    const auto unplugged = choose_screen(screens, "DP-1");
    ASSERT_FALSE(unplugged.ok());
    EXPECT_EQ(unplugged.error().kind, ErrorKind::no_device) << "it may be plugged in later";
    const auto wrong = choose_screen(screens, "DP-7");
    ASSERT_FALSE(wrong.ok());
    EXPECT_EQ(wrong.error().kind, ErrorKind::no_device) << "its card may come later";
    EXPECT_NE(wrong.error().what.find("DP-1 (nothing on it), HDMI-A-1 (connected)"), std::string::npos) << wrong.error().text();
    EXPECT_EQ(choose_screen({}, "").error().kind, ErrorKind::no_device);
    EXPECT_FALSE(choose_screen(std::vector<Screen>{dark}, "").ok());
}

}  // namespace
}  // namespace surefoot::gl
