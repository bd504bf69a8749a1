// The rows of `surefoot selftest --hard`, a test each: the same code with fewer samples (share_of_samples).
#include "tools/selftest/hard.hpp"

#include <gtest/gtest.h>

#include <set>

namespace surefoot::selftest {

/// How GoogleTest names a row where it would print its bytes.
void PrintTo(const Row& row, std::ostream* out);
void PrintTo(const Row& row, std::ostream* out) { *out << row.id; }

namespace {

/// Of what the command tries. Every check is made; what is random is tried less often.
#ifdef SUREFOOT_SANITIZED
constexpr double share_of_samples = 0.004;
#else
constexpr double share_of_samples = 0.04;
#endif

class Hard : public testing::TestWithParam<Row> {};

TEST_P(Hard, Holds) {
    const RowResult result = run_row(GetParam(), {share_of_samples});
    if (result.verdict == Verdict::not_run) GTEST_SKIP() << result.outcome.not_run;
    EXPECT_EQ(result.verdict, Verdict::holds) << text_of(result);
}

INSTANTIATE_TEST_SUITE_P(Rows, Hard, testing::ValuesIn(rows().begin(), rows().end()),
                         [](const auto& row) { return std::string(row.param.id); });

void none(const Effort&, Outcome&) {}
void broken(const Effort&, Outcome& out) { out.at_most("one", 1, 0); }
void not_a_number(const Effort&, Outcome& out) { out.at_least("nothing", 0.0 / 0.0, 0); }
void fine(const Effort&, Outcome& out) { out.exactly("two", 2, 2); }
void absent(const Effort&, Outcome& out) { out.not_run = "no GL"; }
void thrown(const Effort&, Outcome&) { throw std::runtime_error("oh"); }

TEST(Rows, AVerdictNeedsAFigureThatHolds) {
    const auto verdict = [](void (*run)(const Effort&, Outcome&)) { return run_row({"T1", "", "", "", run}, {}).verdict; };
    EXPECT_EQ(verdict(none), Verdict::broken);
    EXPECT_EQ(verdict(broken), Verdict::broken);
    EXPECT_EQ(verdict(not_a_number), Verdict::broken);
    EXPECT_EQ(verdict(thrown), Verdict::broken);
    EXPECT_EQ(verdict(fine), Verdict::holds);
    EXPECT_EQ(verdict(absent), Verdict::not_run);
}

TEST(Rows, AreNamedOnceAndFoundByIdOrNumber) {
    std::set<std::string_view> ids;
    for (const Row& row : rows()) EXPECT_TRUE(ids.insert(row.id).second) << row.id;
    EXPECT_GE(ids.size(), 25U);
    EXPECT_EQ(select_rows({})->size(), rows().size());
    const std::vector<std::string> one{"n9A"}, number{"N9"}, unknown{"N9a", "Q7"};
    EXPECT_EQ(select_rows(one)->size(), 1U);
    EXPECT_EQ(select_rows(number)->size(), 2U);
    EXPECT_NE(select_rows(unknown).error().text().find("Q7"), std::string::npos);
}

TEST(Rows, TheLastLineNamesWhatIsBroken) {
    const Row bad{"T1", "", "", "", broken}, good{"T2", "", "", "", fine};
    const std::vector<RowResult> results{run_row(bad, {}), run_row(good, {})};
    const std::string line = summary_of(results);
    EXPECT_NE(line.find("1 of 2 rows hold; broken: T1; not run: none"), std::string::npos) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
}

}  // namespace
}  // namespace surefoot::selftest
