// The nearest word: what is proposed for a slip of the hand, and that a word with nothing in common is never proposed.
#include "rt/base/text.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <string_view>

#include "rt/base/random.hpp"

namespace surefoot {
namespace {

constexpr std::array<std::string_view, 6> words = {"walk", "bake", "rate_hz", "top", "ab", "calibrate"};

TEST(NearestWord, IsProposedForASlip) {
    EXPECT_EQ(nearest_word("wlak", words), "walk");
    EXPECT_EQ(nearest_word("bak", words), "bake");
    EXPECT_EQ(nearest_word("rate", words), "rate_hz") << "a part of a word";
    EXPECT_EQ(nearest_word("tpo", words), "top");
    EXPECT_EQ(nearest_word("calibrat", words), "calibrate");
    EXPECT_EQ(nearest_word("walk", words), "walk");
    EXPECT_EQ(nearest_word("calibrtae", words), "calibrate");
    constexpr std::array<std::string_view, 2> keys = {"cost_scale", "frames"};
    EXPECT_EQ(nearest_word("most_scenes", keys), "") << "more than a third of the letters differ";
}

TEST(NearestWord, HasALetterInCommonInItsPlace) {
    EXPECT_EQ(nearest_word("xy", words), "") << "two letters, both others than those of \"ab\"";
    EXPECT_EQ(nearest_word("x", words), "");
    EXPECT_EQ(nearest_word("", words), "");
    EXPECT_EQ(nearest_word("zzz", words), "");
    EXPECT_EQ(nearest_word(std::string(65, 'w'), words), "");
    EXPECT_EQ(nearest_word("walk", {}), "");
    Random random(1);
    for (int i = 0; i < 10000; ++i) {
        std::string word(1 + random.below(12), ' ');
        for (char& c : word) c = "cdfghijmnqsuvxy"[random.below(15)];  // some letters of "calibrate" and "rate_hz" are among them
        const std::string_view nearest = nearest_word(word, words);
        EXPECT_TRUE(nearest.empty() || nearest.find_first_of(word) != std::string_view::npos) << word << ": " << nearest;
    }
}

}  // namespace
}  // namespace surefoot
