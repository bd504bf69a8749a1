// Selectors or settings side by side: the same walk by each in turn, its pictures against full detail, and its times.
#include "tools/accuracy/compare.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tools/report/rounded.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::accuracy {

namespace {

using Summaries = std::vector<report::WalkSummary>;  // of one selector, a round each

template <class Figure>
std::vector<double> all_of(const Summaries& rounds, Figure figure) {
    std::vector<double> values;
    for (const report::WalkSummary& s : rounds) values.push_back(figure(s));
    return values;
}

/// The middle; of an even number the mean of the two middles, or the lower one where the upper is infinite.
double median_of(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const double lower = values[(values.size() - 1) / 2], upper = values[values.size() / 2];
    return std::isfinite(upper) ? (lower + upper) / 2 : lower;
}

ComparedSelector medians(const std::string& selector, const Summaries& rounds) {
    const auto median = [&](auto figure) { return median_of(all_of(rounds, figure)); };
    ComparedSelector c;
    c.selector = selector;
    const auto psnr = [](const report::WalkSummary& s) { return s.picture.psnr_db; };
    c.psnr_db = median(psnr);
    const std::vector<double> of_rounds = all_of(rounds, psnr);
    c.min_psnr_db = *std::min_element(of_rounds.begin(), of_rounds.end());
    c.max_psnr_db = *std::max_element(of_rounds.begin(), of_rounds.end());
    c.worst_psnr_db = median([](const auto& s) { return s.picture.worst_psnr_db; });
    c.ssim = median([](const auto& s) { return s.picture.ssim; });
    c.flip = median([](const auto& s) { return s.picture.flip; });
    c.pops_compared = std::all_of(rounds.begin(), rounds.end(), [](const auto& s) { return s.picture.pop_frames > 0; });
    if (c.pops_compared) {
        c.popped_share = median([](const auto& s) { return s.picture.popped_share; });
        c.pop_psnr_db = median([](const auto& s) { return s.picture.pop_psnr_db; });
    }
    c.accuracy_mean = median([](const auto& s) { return s.accuracy_mean; });
    c.accuracy_min = median([](const auto& s) { return s.accuracy_min; });
    c.frame_ms_p50 = median([](const auto& s) { return s.frame_ms.p50; });
    c.frame_ms_p99 = median([](const auto& s) { return s.frame_ms.p99; });
    c.unused_ms = median([](const auto& s) { return s.unused_ms.mean; });
    c.switches_per_frame = median([](const auto& s) { return s.switches_per_frame; });
    c.dropped_parts = rounds.front().dropped_parts;
    for (const report::WalkSummary& s : rounds) {
        c.frames += s.frames;
        c.misses += s.misses;
        c.coarse_frames += s.coarse_frames;
        c.floor_frames += s.floor_frames;
        c.dropped_per_frame += s.dropped_per_frame / static_cast<double>(rounds.size());
    }
    return c;
}

/// The off-line part of the comparison.
Result<void> add_shares(const FindShares& find_shares, const Progress& progress, Comparison& c) {
    std::vector<std::string> names;
    for (ComparedSelector& s : c.selectors) {
        const auto entry = select::selector_named(s.selector);
        const bool drops =
            find_named(select::dropping_selectors(), s.selector) != nullptr;  // it owes no floor: no share of a cut
        s.goes_by_budget = entry.ok() && (*entry)->goes_by == select::GoesBy::budget && !drops;
        if (s.goes_by_budget) names.push_back(s.selector);
    }
    if (find_shares == nullptr || names.empty()) return {};
    auto shares = find_shares(names, c.budget_ms * 1e3, progress);
    if (!shares) return shares.error();
    c.value = std::move(*shares);
    for (ComparedSelector& s : c.selectors)
        for (const ValueShare& share : c.value.selectors)
            if (share.selector == s.selector) s.value = share;
    return {};
}

/// Percent of the greatest value; of its bound, "at least", where the greatest value of a frame is not proven.
std::string value_text(const Comparison& c, const ComparedSelector& s) {
    if (c.value.frames == 0 || !s.goes_by_budget) return "-";
    return fmt::format("{}{:.2f}", c.value.proven == c.value.frames ? "" : ">=", 100 * s.value.of_bound);
}

nlohmann::ordered_json value_json(const Comparison& c, const ComparedSelector& s) {
    if (c.value.frames == 0 || !s.goes_by_budget) return nullptr;
    using report::rounded;
    return {{"of_best_known", {{"mean", rounded(s.value.of_best)}, {"min", rounded(s.value.min_of_best)}}},
            {"of_bound", {{"mean", rounded(s.value.of_bound)}, {"min", rounded(s.value.min_of_bound)}}}};
}

/// All walks of a round, in order.
std::vector<NamedWalk> walks_of(const CompareRequest& request) {
    if (!request.settings.empty()) return request.settings;
    std::vector<NamedWalk> walks;
    for (const std::string& selector : request.selectors) {
        walks.push_back({selector, request.walk});
        walks.back().walk.selector = selector;
    }
    return walks;
}

}  // namespace

Progress part_of(const Progress& progress, const std::string& stage, double number, double count) {
    Progress part = progress;
    if (progress.report)
        part.report = [&progress, stage, number, count](std::string_view, double share) {
            progress.update(stage, (number + share) / count);
        };
    return part;
}

Result<Comparison> compare_selectors(const CompareRequest& request, const RunWalk& run_walk, const FindShares& find_shares,
                                     const Progress& progress) {
    const std::vector<NamedWalk> walks = walks_of(request);
    std::vector<Summaries> rounds(walks.size());
    std::vector<std::vector<report::PictureFigures>> pictures(walks.size());
    const auto count = static_cast<double>(walks.size() * request.rounds);
    double number = 0;
    for (std::uint32_t round = 0; round < request.rounds; ++round) {
        for (std::size_t i = 0; i < walks.size(); ++i) {
            const walk::WalkRequest& one = walks[i].walk;
            auto outcome = run_walk(one, part_of(progress, walks[i].name, number++, count));
            if (!outcome) return outcome.error();
            if (outcome->stopped || progress.stopped())
                return Error{one.model_file, "The comparison was stopped by the user", "", ErrorKind::stopped};
            if (!outcome->failures.empty()) return outcome->failures.front();
            if (outcome->summary.picture.frames == 0)
                return Error{one.model_file, "The walk is too short: no frame was compared", "Walk longer with --seconds",
                             ErrorKind::misuse};
            rounds[i].push_back(std::move(outcome->summary));
            if (round == 0) pictures[i] = std::move(outcome->pictures);
        }
    }
    Comparison c;
    const report::WalkSummary& first = rounds.front().front();
    c.model = first.model;
    c.path = first.path;
    c.renderer = first.renderer;
    c.machine = first.machine;
    c.uncalibrated = first.uncalibrated;
    c.width = first.width;
    c.height = first.height;
    c.rate_hz = first.rate_hz;
    c.budget_ms = first.budget_ms;
    c.rounds = request.rounds;
    c.pictures = first.picture.frames;
    for (std::size_t i = 0; i < rounds.size(); ++i) c.selectors.push_back(medians(walks[i].name, rounds[i]));
    for (std::size_t i = 0; i < rounds.size(); ++i) c.selectors[i].pictures = std::move(pictures[i]);
    c.in_triangles = request.in_triangles;
    c.of_settings = !request.settings.empty();
    if (c.of_settings) return c;
    if (auto shared = add_shares(find_shares, progress, c); !shared) return shared.error();
    return c;
}

namespace {

/// Over the compared pictures.
struct TriangleFigures {
    std::uint64_t min = std::numeric_limits<std::uint64_t>::max(), max = 0;
    double snr_min_db = std::numeric_limits<double>::infinity(), snr_max_db = -snr_min_db;
};

TriangleFigures triangle_figures(const ComparedSelector& s) {
    TriangleFigures figures;
    for (const report::PictureFigures& p : s.pictures) {
        figures.min = std::min(figures.min, p.triangles);
        figures.max = std::max(figures.max, p.triangles);
        if (!std::isfinite(p.snr_db)) continue;
        figures.snr_min_db = std::min(figures.snr_min_db, p.snr_db);
        figures.snr_max_db = std::max(figures.snr_max_db, p.snr_db);
    }
    return figures;
}

nlohmann::ordered_json triangles_json(const ComparedSelector& s) {
    if (s.pictures.empty()) return nullptr;
    const TriangleFigures figures = triangle_figures(s);
    return {{"min", figures.min},
            {"max", figures.max},
            {"snr_db", {{"min", report::rounded(figures.snr_min_db)}, {"max", report::rounded(figures.snr_max_db)}}}};
}

nlohmann::ordered_json dropped_parts_json(const ComparedSelector& s) {
    auto list = nlohmann::ordered_json::array();
    for (const report::DroppedSummary& part : s.dropped_parts)
        list.push_back({{"part", part.part},
                        {"frames", part.frames},
                        {"times", part.falls},
                        {"first_frame", part.first_frame},
                        {"value_per_us", report::rounded(part.first_value_per_us)}});
    return list;
}

std::string triangles_line(const ComparedSelector& s) {
    const TriangleFigures figures = triangle_figures(s);
    const std::string snr = figures.snr_min_db <= figures.snr_max_db
                                ? fmt::format("SNR {:.1f} to {:.1f} dB", figures.snr_min_db, figures.snr_max_db)
                                : std::string("all equal to full detail");
    return fmt::format("{}: {} to {} triangles a picture, {}\n", s.selector, figures.min, figures.max, snr);
}

}  // namespace

std::string dropped_words(const report::DroppedSummary& part) {
    return fmt::format("{} from frame {} on, at {:.3g} px/us; {} frames without, dropped {} {}", part.part, part.first_frame,
                       part.first_value_per_us, part.frames, part.falls, part.falls == 1 ? "time" : "times");
}

std::string budget_text(const Comparison& c) {
    return c.in_triangles ? fmt::format("{} triangles", triangles_of_budget(c.budget_ms)) : fmt::format("{:.1f} ms", c.budget_ms);
}

std::string compare_json(const Comparison& c) {
    using report::rounded;
    using Json = nlohmann::ordered_json;
    Json selectors = Json::array();
    for (const ComparedSelector& s : c.selectors)
        selectors.push_back({{c.of_settings ? "setting" : "selector", s.selector},
                             {"psnr_db", rounded(s.psnr_db)},
                             {"psnr_db_rounds", {{"min", rounded(s.min_psnr_db)}, {"max", rounded(s.max_psnr_db)}}},
                             {"worst_psnr_db", rounded(s.worst_psnr_db)},
                             {"ssim", rounded(s.ssim)},
                             {"flip", rounded(s.flip)},
                             {"popping", s.pops_compared ? Json({{"pixels", s.popped_share}, {"psnr_db", rounded(s.pop_psnr_db)}})
                                                         : Json(nullptr)},
                             {"accuracy", {{"mean", rounded(s.accuracy_mean)}, {"min", rounded(s.accuracy_min)}}},
                             {"frame_ms", {{"p50", rounded(s.frame_ms_p50)}, {"p99", rounded(s.frame_ms_p99)}}},
                             {"unused_ms", rounded(s.unused_ms)},
                             {"switches_per_frame", rounded(s.switches_per_frame)},
                             {"value_share", value_json(c, s)},
                             {"frames", s.frames},
                             {"misses", s.misses},
                             {"coarse_frames", s.coarse_frames},
                             {"floor_frames", s.floor_frames},
                             {"dropped_per_frame", rounded(s.dropped_per_frame)},
                             {"dropped_parts", dropped_parts_json(s)},
                             {"triangles", triangles_json(s)}});
    const Json json = {{"model", c.model},
                       {"path", c.path},
                       {"renderer", c.renderer},
                       {"machine", c.machine},
                       {"calibrated", c.uncalibrated.empty()},
                       {"width", c.width},
                       {"height", c.height},
                       {"rate_hz", rounded(c.rate_hz)},
                       {"budget_ms", c.in_triangles ? Json(nullptr) : rounded(c.budget_ms)},
                       {"budget_triangles", c.in_triangles ? Json(triangles_of_budget(c.budget_ms)) : Json(nullptr)},
                       {"rounds", c.rounds},
                       {"pictures", c.pictures},
                       {"value_frames",
                        {{"compared", c.value.frames},
                         {"proven", c.value.proven},
                         {"at_the_floor", c.value.floor_frames},
                         {"in_full_detail", c.value.full_frames}}},
                       {c.of_settings ? "settings" : "selectors", selectors}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string compare_table(const Comparison& c) {
    std::string out = fmt::format("{}, {}x{} at {:.4g} Hz, budget {}: {} pictures of a walk, {} {}\n", c.model, c.width, c.height,
                                  c.rate_hz, budget_text(c), c.pictures, c.rounds, c.rounds == 1 ? "round" : "rounds, medians");
    const auto text = [](double value, int decimals) { return fmt::format("{:.{}f}", value, decimals); };
    const auto ms = [&](double value) { return c.in_triangles ? "-" : text(value, 1); };  // no time was spent
    const auto accuracy = [&](double value) { return std::isfinite(value) ? text(value, 1) : "exact"; };
    std::size_t name_columns = 18;
    for (const ComparedSelector& s : c.selectors) name_columns = std::clamp(s.selector.size(), name_columns, std::size_t{24});
    const report::TextColumn name{c.of_settings ? "setting" : "selector", static_cast<int>(name_columns)};
    const report::Columns pictures({name,
                                    {"PSNR dB", -8},
                                    {"worst", -6},
                                    {"SSIM", -6},
                                    {"FLIP", -6},
                                    {"popped %", -9},
                                    {"pops dB", -8},
                                    {"accuracy", -9},
                                    {"least", -8}});
    out += pictures.heading() + "\n";
    for (const ComparedSelector& s : c.selectors)
        out +=
            pictures.row({s.selector, text(s.psnr_db, 2), text(s.worst_psnr_db, 1), text(s.ssim, 3), text(s.flip, 3),
                          s.pops_compared ? text(100 * s.popped_share, 2) : "-", s.pops_compared ? text(s.pop_psnr_db, 1) : "-",
                          accuracy(s.accuracy_mean), accuracy(s.accuracy_min)}) +
            "\n";
    const report::Columns frames({name,
                                  {"p50 ms", -8},
                                  {"p99 ms", -8},
                                  {"unused", -8},
                                  {"switches", -9},
                                  {"value %", -8},
                                  {"frames", -8},
                                  {"misses", -7},
                                  {"coarse", -7},
                                  {"floor", -7}});
    out += frames.heading() + "\n";
    for (const ComparedSelector& s : c.selectors)
        out += frames.row({s.selector, ms(s.frame_ms_p50), ms(s.frame_ms_p99), ms(s.unused_ms), text(s.switches_per_frame, 2),
                           value_text(c, s), std::to_string(s.frames), std::to_string(s.misses), std::to_string(s.coarse_frames),
                           std::to_string(s.floor_frames)}) +
               "\n";
    for (const ComparedSelector& s : c.selectors)
        if (c.in_triangles && !s.pictures.empty()) out += triangles_line(s);
    for (const ComparedSelector& s : c.selectors)
        if (s.dropped_per_frame > 0)
            out += fmt::format("{}: leaves out {:.1f} visible objects a frame\n", s.selector, s.dropped_per_frame);
    for (const ComparedSelector& s : c.selectors)
        for (const report::DroppedSummary& part : s.dropped_parts)
            out += fmt::format("{}: drops {}\n", s.selector, dropped_words(part));
    if (c.value.frames > 0)
        out += fmt::format(
            "value: {} frames off line; the greatest is proven for {}; bounds are {:.2f} % above the best in the mean\n",
            c.value.frames, c.value.proven, 100 * c.value.bound_gap);
    return out;
}

}  // namespace surefoot::accuracy
