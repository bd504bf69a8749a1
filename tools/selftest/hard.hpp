// The hard cases: rows of input and what must hold of it, measured on the machine that runs them. `surefoot selftest --hard`
// prints them, tests/selftest runs the same. A row draws its figures from the product's own functions; none is a constant.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"

namespace surefoot::selftest {

enum class Relation : std::uint8_t { at_most, at_least, exactly };

/// One measured number and what it must keep. Not a number keeps nothing.
struct Figure {
    std::string name;
    double value = 0;
    Relation relation = Relation::at_most;
    double limit = 0;
    std::string unit;  ///< empty: a count
    [[nodiscard]] bool holds() const;
    /// "lost boxes 0 (at most 0)"
    [[nodiscard]] std::string text() const;
};

/// How much of it is tried: sample counts are the row's own times `share`.
struct Effort {
    double share = 1;
    const Progress* progress = nullptr;
    std::string backend = {};  ///< rows that draw: with this one only; empty: EGL, else OSMesa

    [[nodiscard]] bool stopped() const { return progress != nullptr && progress->stopped(); }
    /// `full` times share, at least `min`.
    [[nodiscard]] std::uint64_t count(std::uint64_t full, std::uint64_t min = 1) const;
};

/// What a row found.
struct Outcome {
    std::vector<Figure> figures;
    std::string scaled;   ///< what was tried instead of the full number, in words; empty: all of it
    std::string not_run;  ///< why nothing could be measured (no GL); empty: it was
    /// Of verdicts, triangle counts and cut hashes only: the same for every compiler, level and contraction.
    std::uint64_t digest = 0, triangles = 0, cut_hash = 0;

    void at_most(std::string name, double value, double limit, std::string unit = {});
    void at_least(std::string name, double value, double limit, std::string unit = {});
    void exactly(std::string name, double value, double wanted, std::string unit = {});
    /// Counts `bad` findings, of which there may be none.
    void none_of(std::string name, std::uint64_t bad) { exactly(std::move(name), static_cast<double>(bad), 0); }
    void digest_of(std::uint64_t value);
    void digest_of(std::string_view text);
};

/// One row of the matrix of hard cases.
struct Row {
    std::string_view id;      ///< N1 ... as the matrix of cases numbers them, with a letter where a case has several rows
    std::string_view family;  ///< the file that holds it
    std::string_view input;
    std::string_view must_hold;
    void (*run)(const Effort&, Outcome&);
};

/// All of them, family by family.
std::span<const Row> rows();

enum class Verdict : std::uint8_t { holds, broken, not_run };

/// A row with its outcome.
struct RowResult {
    const Row* row = nullptr;
    Outcome outcome;
    Verdict verdict = Verdict::broken;
    double seconds = 0;
};

/// Holds if there are figures and each of them holds. A row that throws is broken, and names the exception.
RowResult run_row(const Row& row, const Effort& effort);

/// The rows named (an id, or a whole number with all its letters; upper or lower case); none named: all.
/// Error: an unknown id, with the nearest one.
Result<std::vector<const Row*>> select_rows(std::span<const std::string> ids);

/// One after the other; `each`: called after every one. Error: stopped by the user; which row, and how to go on.
Result<std::vector<RowResult>> run_rows(std::span<const Row* const> selection, const Effort& effort,
                                        const std::function<void(const RowResult&)>& each);

std::string_view word(Verdict verdict);    ///< "holds", "broken", "not run"
std::string_view word(Relation relation);  ///< "at most", ...

/// Of all rows' digests, in order.
std::uint64_t digest_of(std::span<const RowResult> results);

/// What a row found, over a few lines, each ending with a line break.
std::string text_of(const RowResult& result);
/// The last line: what a support engineer asks for.
std::string summary_of(std::span<const RowResult> results);

}  // namespace surefoot::selftest
