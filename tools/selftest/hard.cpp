// The table of rows, their running and their verdicts.
#include "tools/selftest/hard.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <exception>

#include <fmt/format.h>

#include "rt/base/hash.hpp"
#include "rt/base/text.hpp"
#include "tools/selftest/families.hpp"

namespace surefoot::selftest {

namespace {

std::string upper_case(std::string text) {
    for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return text;
}

/// "N9" names N9, N9a and N9b, and not N90.
bool named(std::string_view row, const std::string& id) {
    const std::string of_row = upper_case(std::string(row));
    if (of_row == id) return true;
    return of_row.starts_with(id) && of_row.size() > id.size() &&
           std::isalpha(static_cast<unsigned char>(of_row[id.size()])) != 0;
}

}  // namespace

bool Figure::holds() const {
    switch (relation) {
        case Relation::at_most:
            return value <= limit;
        case Relation::at_least:
            return value >= limit;
        default:
            return value == limit;
    }
}

std::string Figure::text() const {
    const std::string of = unit.empty() ? "" : " " + unit;
    return fmt::format("{} {:.6g}{} ({} {:.6g}{})", name, value, of, word(relation), limit, of);
}

std::uint64_t Effort::count(std::uint64_t full, std::uint64_t min) const {
    return std::max(min, static_cast<std::uint64_t>(std::llround(static_cast<double>(full) * share)));
}

void Outcome::at_most(std::string name, double value, double limit, std::string unit) {
    figures.push_back({std::move(name), value, Relation::at_most, limit, std::move(unit)});
}

void Outcome::at_least(std::string name, double value, double limit, std::string unit) {
    figures.push_back({std::move(name), value, Relation::at_least, limit, std::move(unit)});
}

void Outcome::exactly(std::string name, double value, double wanted, std::string unit) {
    figures.push_back({std::move(name), value, Relation::exactly, wanted, std::move(unit)});
}

void Outcome::digest_of(std::uint64_t value) { digest = fnv1a(digest == 0 ? fnv_start : digest, value); }

void Outcome::digest_of(std::string_view text) {
    digest_of(hash_bytes(std::as_bytes(std::span<const char>(text.data(), text.size()))));
}

std::span<const Row> rows() {
    static const std::vector<Row> all = [] {
        std::vector<Row> list;
        for (const auto family : {origin_rows(), depth_rows(), near_and_inside_rows(), off_axis_rows(), behind_others_rows(),
                                  geometry_rows(), transform_rows(), polygon_rows(), budgets_and_curves_rows(), long_runs_rows(),
                                  files_rows(), texture_rows(), alpha_edge_rows(), walking_rows(), riding_rows()})
            list.insert(list.end(), family.begin(), family.end());
        return list;
    }();
    return all;
}

RowResult run_row(const Row& row, const Effort& effort) {
    RowResult result;
    result.row = &row;
    const auto begun = std::chrono::steady_clock::now();
    try {
        row.run(effort, result.outcome);
    } catch (const std::exception& error) {
        result.outcome.not_run.clear();
        result.outcome.none_of(fmt::format("exceptions ('{}')", error.what()), 1);
    }
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    const std::vector<Figure>& figures = result.outcome.figures;
    const bool hold = !figures.empty() && std::all_of(figures.begin(), figures.end(), [](const Figure& f) { return f.holds(); });
    result.verdict = hold ? Verdict::holds : Verdict::broken;
    if (figures.empty() && !result.outcome.not_run.empty()) result.verdict = Verdict::not_run;
    return result;
}

Result<std::vector<const Row*>> select_rows(std::span<const std::string> ids) {
    std::vector<const Row*> selection;
    std::vector<bool> used(ids.size(), false);
    for (const Row& row : rows()) {
        bool wanted = ids.empty();
        for (std::size_t i = 0; i < ids.size(); ++i) {
            if (!named(row.id, upper_case(ids[i]))) continue;
            wanted = used[i] = true;
        }
        if (wanted) selection.push_back(&row);
    }
    const auto missing = std::find(used.begin(), used.end(), false);
    if (missing == used.end()) return selection;
    const std::string& id = ids[static_cast<std::size_t>(missing - used.begin())];
    std::vector<std::string_view> known;
    for (const Row& row : rows()) known.push_back(row.id);
    const std::string_view nearest = nearest_word(upper_case(id), known);
    return Error{"row '" + id + "'",
                 "There is no such row" + (nearest.empty() ? "" : fmt::format(". Did you mean '{}'?", nearest)),
                 "List them: surefoot selftest --hard --list", ErrorKind::not_found};
}

Result<std::vector<RowResult>> run_rows(std::span<const Row* const> selection, const Effort& effort,
                                        const std::function<void(const RowResult&)>& each) {
    std::vector<RowResult> results;
    for (const Row* row : selection) {
        if (effort.progress != nullptr)
            effort.progress->update(row->id, static_cast<double>(results.size()) / static_cast<double>(selection.size()));
        RowResult result = run_row(*row, effort);
        if (effort.stopped())
            return Error{"selftest",
                         fmt::format("The test was stopped by the user in row {}, after {} of {}", row->id, results.size(),
                                     selection.size()),
                         "Run a single row for less time: surefoot selftest --hard " + std::string(row->id), ErrorKind::stopped};
        each(result);
        results.push_back(std::move(result));
    }
    return results;
}

std::string_view word(Verdict verdict) {
    return verdict == Verdict::holds ? "holds" : verdict == Verdict::broken ? "broken" : "not run";
}

std::string_view word(Relation relation) {
    return relation == Relation::at_most ? "at most" : relation == Relation::at_least ? "at least" : "exactly";
}

std::uint64_t digest_of(std::span<const RowResult> results) {
    std::uint64_t hash = fnv_start;
    for (const RowResult& r : results) hash = fnv1a(hash, r.outcome.digest);
    return hash;
}

std::string text_of(const RowResult& result) {
    const Row& row = *result.row;
    const std::string_view verdict = result.verdict == Verdict::broken ? "BROKEN" : word(result.verdict);
    std::string text = fmt::format("{:<5} {:<8}{}\n      must hold: {}\n", row.id, verdict, row.input, row.must_hold);
    for (const Figure& f : result.outcome.figures) text += fmt::format("      {} {}\n", f.holds() ? " " : "!", f.text());
    if (!result.outcome.scaled.empty()) text += fmt::format("        tried: {}\n", result.outcome.scaled);
    if (!result.outcome.not_run.empty()) text += fmt::format("        not run: {}\n", result.outcome.not_run);
    return text;
}

std::string summary_of(std::span<const RowResult> results) {
    std::string broken, not_run;
    std::size_t held = 0;
    double seconds = 0;
    for (const RowResult& r : results) {
        seconds += r.seconds;
        if (r.verdict == Verdict::holds) ++held;
        std::string& list = r.verdict == Verdict::broken ? broken : not_run;
        if (r.verdict != Verdict::holds) list += (list.empty() ? "" : " ") + std::string(r.row->id);
    }
    return fmt::format("hard cases: {} of {} rows hold; broken: {}; not run: {}; {:.0f} s; digest {:016x}", held, results.size(),
                       broken.empty() ? "none" : broken, not_run.empty() ? "none" : not_run, seconds, digest_of(results));
}

}  // namespace surefoot::selftest
