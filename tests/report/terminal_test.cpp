// Text for a terminal: places, cutting, wrapping, columns and bars.
#include "tools/report/terminal.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace surefoot::report {
namespace {

using Lines = std::vector<std::string>;

TEST(Terminal, EscapesTakeNoPlaceAndEndWithTheLine) {
    EXPECT_EQ(cut_to("\033[31mabc\033[0mdef", 2), "\033[31mab\033[0m");
    EXPECT_EQ(cut_to("äöü", 2), "äö");
    EXPECT_EQ(places("\033[31mäb\033[0m"), 2U);
    EXPECT_EQ(inked({.colour = true}, Ink::bad, "x"), "\033[31mx\033[0m");
    EXPECT_EQ(inked({.colour = true}, strong(Ink::bad), "x"), "\033[1;31mx\033[0m");
    EXPECT_EQ(inked({}, Ink::bad, "x"), "x");
}

TEST(Terminal, WordsAreWrappedByPlaces) {
    EXPECT_EQ(wrapped("", 5), Lines{""});
    EXPECT_EQ(wrapped("ab cd ef", 5), (Lines{"ab cd", "ef"}));
    EXPECT_EQ(wrapped("äb cd ef", 5), (Lines{"äb cd", "ef"})) << "a letter of two bytes is one place";
    EXPECT_EQ(wrapped("a  b", 5), Lines{"a  b"}) << "two spaces stay two";
    EXPECT_EQ(wrapped("a longword b", 5), (Lines{"a", "longword", "b"}));
}

TEST(Terminal, LabelsStandOnceAndLongWordsKeepTheirEnd) {
    LabelledText text(false);
    text.row("model", std::string(90, 'a') + "/end.walk");
    text.row("words", std::string(80, 'b') + " " + std::string(10, 'c'));
    EXPECT_EQ(text.text(), "model           …" + std::string(74, 'a') + "/end.walk\n" + "words           " +
                               std::string(80, 'b') + "\n" + std::string(label_columns, ' ') + std::string(10, 'c') + "\n");
}

TEST(Terminal, ColumnsAlignTheirCells) {
    const Columns columns({{"name", 6}, {"count", -6}, {"why", 0, 2}});
    EXPECT_EQ(columns.heading(), "name    count  why");
    EXPECT_EQ(columns.row({"one", "1", "so"}), "one         1  so");
    EXPECT_EQ(columns.row({"two", "2"}), "two         2");
    EXPECT_EQ(columns.row({"a long name", "3", ""}), "a long name      3  ");
}

TEST(Terminal, BarsHoldTheirWidth) {
    EXPECT_EQ(share_bar({}, 0.5, 4), "##--");
    EXPECT_EQ(share_bar({}, std::nan(""), 4), "----");
    EXPECT_EQ(share_bar({}, 7, 4), "####");
    EXPECT_EQ(share_bar({.unicode = true}, 0.5, 4), "██░░");
    EXPECT_EQ(deflection_bar(0.5, 5), "--|--");
    EXPECT_EQ(deflection_bar(1, 5), "--|##");
    EXPECT_EQ(deflection_bar(0, 5), "##|--");
    EXPECT_EQ(progress_line("bake", 0.25, "3 s left"), "bake                   [######                  ]  25 %  3 s left");
}

}  // namespace
}  // namespace surefoot::report
