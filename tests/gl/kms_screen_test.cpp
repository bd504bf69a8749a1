// A screen that is held, unplugged, refused, without a word, or gone: what the frame thread shows, and what the user is told.
#include "render/gl/kms_screen.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <vector>

namespace surefoot::gl {
namespace {

std::int64_t test_now_ns = 0;
std::int64_t test_now() { return test_now_ns; }
constexpr std::int64_t ms = 1'000'000;

/// A card by hand: each call's answer is set before.
struct TestCard final : ScreenPort {
    int take_error = 0, mode_error = 0, flip_error = 0;
    bool timed_out = false, counts = true, plugged = true, knows_mode = true, link_bad = false;
    int busy_flips = 0;  ///< refused, because the one before is in flight
    std::vector<std::string> calls;
    ShownBuffer shown = 0;

    int take() override {
        calls.emplace_back("take");
        return take_error;
    }
    int set_mode(ShownBuffer buffer) override {
        calls.emplace_back("mode");
        if (mode_error == 0) shown = buffer;
        return mode_error;
    }
    int flip(ShownBuffer buffer) override {
        calls.emplace_back("flip");
        if (busy_flips > 0 && busy_flips-- > 0) return EBUSY;
        if (flip_error == 0) shown = buffer;
        return flip_error;
    }
    Flip wait_flip(std::int64_t timeout_ns) override {
        calls.emplace_back("wait");
        if (timed_out) {
            test_now_ns += timeout_ns;
            return {};
        }
        test_now_ns += 3 * ms;
        return {true, test_now_ns - ms};
    }
    [[nodiscard]] bool counts_refreshes() const override { return counts; }
    bool connected(bool probe) override {
        calls.emplace_back(probe ? "probe" : "status");
        return plugged;
    }
    bool has_mode() override { return knows_mode; }
    bool link_failed() override { return link_bad; }
    std::string holders() override { return "Xorg (412)"; }

    std::string take_calls() {
        std::string text;
        for (const std::string& call : calls) text += (text.empty() ? "" : " ") + call;
        calls.clear();
        return text;
    }
};

class KmsScreens : public ::testing::Test {
protected:
    void SetUp() override { test_now_ns = 1'000'000 * ms; }
    /// All lines of watch(), called for so long.
    std::string watched(std::int64_t for_ns) {
        std::string text;
        for (const std::int64_t until = test_now_ns + for_ns; test_now_ns <= until; test_now_ns += 100 * ms)
            for (const std::string& line : screen.watch()) text += line + "\n";
        return text;
    }
    TestCard card;
    KmsScreen screen{card, "HDMI-A-1", 16'666'667, test_now};
};

TEST_F(KmsScreens, TheFirstPictureSetsTheModeAndLaterOnesFlip) {
    EXPECT_EQ(screen.present(5).by, rt::ShownBy::hand_over);
    EXPECT_EQ(card.take_calls(), "take mode");
    const std::int64_t before = test_now_ns;
    const rt::Shown shown = screen.present(6);
    EXPECT_EQ(card.take_calls(), "flip wait");
    EXPECT_EQ(shown.by, rt::ShownBy::display);
    EXPECT_EQ(shown.time_ns, before + 2 * ms) << "the display's stamp, not the time of the return";
    EXPECT_EQ(shown.queued_ns, before);
    EXPECT_EQ(card.shown, 6U);
    EXPECT_EQ(watched(300 * ms), "") << "nothing to report";
}

TEST_F(KmsScreens, ACardThatCountsNoRefreshesTellsNoTime) {
    card.counts = false;
    screen.present(5);
    const rt::Shown shown = screen.present(6);
    EXPECT_EQ(shown.by, rt::ShownBy::hand_over);
    EXPECT_EQ(shown.time_ns, 0);
}

TEST_F(KmsScreens, AnotherProgramsScreenIsTriedTwiceASecondAndNamed) {
    screen.present(5);
    watched(0);
    card.flip_error = EACCES;
    card.take_error = EBUSY;
    EXPECT_EQ(screen.present(6).by, rt::ShownBy::nothing);
    EXPECT_EQ(screen.state(), ScreenState::held);
    card.take_calls();
    for (int i = 0; i < 100; ++i) {  // 1.6 seconds of frames
        EXPECT_EQ(screen.present(6).by, rt::ShownBy::nothing);
        test_now_ns += 16 * ms;
    }
    EXPECT_EQ(card.take_calls(), "take take take");
    EXPECT_NE(watched(0).find("HDMI-A-1: Another program holds it: Xorg (412)"), std::string::npos);
    EXPECT_EQ(watched(0), "") << "once";
    card.take_error = card.flip_error = 0;
    test_now_ns += 500 * ms;
    EXPECT_EQ(screen.present(7).by, rt::ShownBy::hand_over);
    EXPECT_NE(card.take_calls().find("take mode"), std::string::npos) << "the other one may have left any mode";
    EXPECT_EQ(screen.present(8).by, rt::ShownBy::display);
    EXPECT_NE(watched(0).find("shows pictures again"), std::string::npos);
}

TEST_F(KmsScreens, ARefusedFlipSetsTheModeAtOnceAndARefusedModeIsTriedAgain) {
    screen.present(5);
    watched(0);
    card.flip_error = EINVAL;  // a second master died without a word
    EXPECT_EQ(screen.present(6).by, rt::ShownBy::nothing);
    card.take_calls();
    card.flip_error = 0;
    EXPECT_EQ(screen.present(7).by, rt::ShownBy::hand_over);
    EXPECT_EQ(card.take_calls(), "take mode") << "in the next frame, not half a second later";
    EXPECT_EQ(watched(0), "") << "one dropped picture is no news";

    card.flip_error = card.mode_error = EINVAL;
    for (int i = 0; i < 60; ++i) {
        screen.present(8);
        test_now_ns += 16 * ms;
    }
    EXPECT_EQ(screen.state(), ScreenState::refused);
    EXPECT_NE(watched(0).find("refuses its mode (Invalid argument)"), std::string::npos);
    card.flip_error = card.mode_error = 0;
    test_now_ns += 500 * ms;
    screen.present(9);
    EXPECT_EQ(card.shown, 9U);
    EXPECT_NE(watched(0).find("shows pictures again"), std::string::npos);
}

TEST_F(KmsScreens, AFlipWithoutAWordIsGivenUpAfterAQuarterSecond) {
    screen.present(5);
    card.timed_out = true;
    const std::int64_t before = test_now_ns;
    EXPECT_EQ(screen.present(6).by, rt::ShownBy::nothing);
    EXPECT_EQ(test_now_ns - before, 250 * ms);
    card.timed_out = false;
    EXPECT_EQ(screen.present(7).by, rt::ShownBy::hand_over) << "by a whole modeset";
    EXPECT_EQ(screen.present(8).by, rt::ShownBy::display);
}

TEST_F(KmsScreens, AFlipThatMeetsTheOneBeforeWaitsForIt) {
    screen.present(5);
    card.take_calls();
    card.busy_flips = 1;
    EXPECT_EQ(screen.present(6).by, rt::ShownBy::display);
    EXPECT_EQ(card.take_calls(), "flip wait flip wait");
    card.busy_flips = 2;
    EXPECT_EQ(screen.present(7).by, rt::ShownBy::nothing);
    EXPECT_EQ(screen.present(8).by, rt::ShownBy::hand_over) << "by a whole modeset";
}

TEST_F(KmsScreens, WithoutWaitingOneFlipIsInFlightAndNoTimeIsTold) {
    screen.wait_for_flips(false);
    screen.present(5);
    card.take_calls();
    const rt::Shown shown = screen.present(6);
    EXPECT_EQ(shown.by, rt::ShownBy::hand_over);
    EXPECT_EQ(card.take_calls(), "flip") << "the refresh is not waited for";
    screen.present(7);
    EXPECT_EQ(card.take_calls(), "wait flip") << "but for the flip before";
    card.timed_out = true;
    EXPECT_EQ(screen.present(8).by, rt::ShownBy::nothing);
    card.timed_out = false;
    EXPECT_EQ(screen.present(9).by, rt::ShownBy::hand_over);
    EXPECT_NE(card.take_calls().find("take mode"), std::string::npos);
}

TEST_F(KmsScreens, AFailedLinkSetsTheModeAtMostEveryTenSeconds) {
    screen.present(5);
    watched(0);
    card.link_bad = true;
    EXPECT_NE(watched(1000 * ms).find("link failed"), std::string::npos);
    card.take_calls();
    screen.present(6);
    EXPECT_EQ(card.take_calls(), "take mode");
    EXPECT_EQ(watched(8000 * ms), "");
    EXPECT_NE(watched(3000 * ms).find("link failed"), std::string::npos);
}

TEST_F(KmsScreens, ACardThatIsGoneIsNeverAskedAgain) {
    screen.present(5);
    card.flip_error = ENODEV;
    EXPECT_EQ(screen.present(6).by, rt::ShownBy::nothing);
    EXPECT_EQ(screen.state(), ScreenState::gone);
    card.take_calls();
    test_now_ns += 60'000 * ms;
    EXPECT_EQ(screen.present(7).by, rt::ShownBy::nothing);
    EXPECT_EQ(card.take_calls(), "");
    EXPECT_NE(watched(0).find("The card is gone"), std::string::npos);
}

TEST_F(KmsScreens, AScreenThatIsPluggedInAgainGetsItsMode) {
    screen.present(5);
    watched(0);
    card.plugged = false;
    EXPECT_NE(watched(1000 * ms).find("HDMI-A-1: It was unplugged"), std::string::npos);
    EXPECT_EQ(screen.present(6).by, rt::ShownBy::display) << "flips go on";
    card.plugged = true;
    EXPECT_NE(watched(1000 * ms).find("plugged in again, so its mode is set"), std::string::npos);
    card.take_calls();
    EXPECT_EQ(screen.present(7).by, rt::ShownBy::hand_over);
    EXPECT_EQ(card.take_calls(), "take mode");
}

TEST_F(KmsScreens, AnotherScreenInItsPlaceIsOpenedAnew) {
    screen.present(5);
    card.plugged = false;
    watched(1000 * ms);
    card.plugged = true;
    card.knows_mode = false;
    EXPECT_NE(watched(1000 * ms).find("has other modes"), std::string::npos);
    EXPECT_EQ(screen.present(7).by, rt::ShownBy::nothing);
    EXPECT_EQ(screen.state(), ScreenState::gone);
}

TEST_F(KmsScreens, TheScreenItselfIsAskedEveryTenSecondsAndTheDriverTwiceASecond) {
    screen.present(5);
    card.take_calls();
    watched(20'000 * ms);
    const auto count = [&](const char* name) { return std::count(card.calls.begin(), card.calls.end(), name); };
    EXPECT_NEAR(static_cast<double>(count("probe")), 2, 1);
    EXPECT_NEAR(static_cast<double>(count("status")), 38, 3);
}

}  // namespace
}  // namespace surefoot::gl
