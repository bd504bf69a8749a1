// Manual pages: text stays text in troff, and the settings' page holds every key with limits, choices and default.
#include "config/manual.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/config/toy_schema.hpp"

namespace surefoot::config {
namespace {

TEST(Manual, NoWordIsTakenForARequest) {
    const std::string page = troff({"toy", 1, "says -x", "", {{"DESCRIPTION", ".SH is text\n'so is this\nback\\slash", {}}}});
    EXPECT_NE(page.find("toy \\- says \\-x\n"), std::string::npos) << page;
    EXPECT_NE(page.find("\n\\&.SH is text\n\\&'so is this\nback\\eslash\n"), std::string::npos) << page;
}

TEST(Manual, NamesTheVersion) {
    EXPECT_NE(troff({"toy", 1, "x", "", {}}, "1.2").find("\"Surefoot 1.2\""), std::string::npos);
    EXPECT_NE(troff({"toy", 1, "x", "", {}}).find("\"Surefoot\""), std::string::npos);
}

TEST(Manual, IndentedLinesStayLines) {
    const std::string page = troff({"toy", 1, "x", "", {{"EXAMPLES", "first\n  a b\n  c d\nlast", {}}}});
    EXPECT_NE(page.find("first\n.PP\n.nf\n  a b\n  c d\n.fi\n.PP\nlast\n"), std::string::npos) << page;
}

TEST(Manual, HoldsEveryKeyOfTheSchema) {
    const Schema& schema = test::toy_schema();
    const ManualPage page = settings_manual(schema);
    EXPECT_EQ(page.section, 5);
    const auto keys = std::find_if(page.sections.begin(), page.sections.end(), [](const auto& s) { return s.title == "KEYS"; });
    ASSERT_NE(keys, page.sections.end());
    ASSERT_EQ(keys->items.size(), schema.entries().size());
    for (std::size_t i = 0; i < keys->items.size(); ++i) {
        EXPECT_EQ(keys->items[i].term, schema.entries()[i].key);
        EXPECT_NE(keys->items[i].text.find("Default: "), std::string::npos) << keys->items[i].term;
    }
    EXPECT_NE(troff(page).find("drawn by hand"), std::string::npos);
}

}  // namespace
}  // namespace surefoot::config
