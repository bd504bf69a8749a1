// The accuracy sweep as CSV, JSON and a page.
#include "tools/accuracy/page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "render/select/registry.hpp"
#include "rt/base/file.hpp"
#include "tools/report/report.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::accuracy {

namespace {

using Json = nlohmann::ordered_json;

Json finite(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

std::string decibels_of(const AccuracyPoint& p) {
    return p.psnr_db < report::max_psnr_db ? fmt::format("{:.2f}", p.psnr_db) : "equal";
}

std::string per_rad(double accuracy) { return std::isfinite(accuracy) ? report::short_number(accuracy) : "exact"; }

/// Two figures, and what the second has more.
std::string from_to(const std::string& now, const std::string& more) {
    return now == more ? now : fmt::format("{} → <b>{}</b>", now, more);
}

bool estimates_gain(const std::string& selector) {
    const auto entry = select::selector_named(selector);
    return entry && (*entry)->by_value;
}

std::string one_more_ms_of(const AccuracyRun& run) {
    if (run.one_more_ms.empty()) return {};
    std::string out = fmt::format(
        "<h2>One more millisecond</h2>\n<p class=\"sub\">At {:g} Hz a frame may take {:.1f} ms. Both budgets were drawn at every "
        "place: this is what a budget of {:.1f} ms shows instead.</p>\n<div class=\"card "
        "scroll\"><table>\n<tr><th>selector</th><th>frame p50, ms</th><th>p99, "
        "ms</th><th>worst accuracy, rad⁻¹</th><th>mean accuracy, rad⁻¹</th><th>PSNR, dB</th><th>FLIP</th><th>value, "
        "%</th><th>more value, %</th><th>as estimated</th></tr>\n",
        run.rate_hz, run.working_ms, run.working_ms + 1);
    const auto ms = [](double time_ms) { return fmt::format("{:.2f}", time_ms); };
    for (const OneMoreMs& m : run.one_more_ms)
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>"
            "<td>{:.2f}</td><td>{}</td></tr>\n",
            report::escaped(m.now.selector), from_to(ms(m.now.frame_ms_p50), ms(m.more.frame_ms_p50)),
            from_to(ms(m.now.frame_ms_p99), ms(m.more.frame_ms_p99)),
            from_to(per_rad(m.now.accuracy_worst), per_rad(m.more.accuracy_worst)),
            from_to(per_rad(m.now.accuracy_mean), per_rad(m.more.accuracy_mean)),
            from_to(decibels_of(m.now), decibels_of(m.more)),
            from_to(fmt::format("{:.4f}", m.now.flip), fmt::format("{:.4f}", m.more.flip)),
            from_to(fmt::format("{:.2f}", 100 * m.now.value), fmt::format("{:.2f}", 100 * m.more.value)),
            100 * (m.more.value - m.now.value),
            estimates_gain(m.now.selector) ? fmt::format("{:.2f}", 100 * m.now.estimated_gain) : "–");
    return out +
           "</table></div>\n<p class=\"sub\"><b>As estimated</b>: what a frame's record says before the millisecond is "
           "spent. Selectors that do not go by value alone have no estimate.</p>\n";
}

std::string changes_of(const AccuracyRun& run) {
    if (run.changes.empty()) return {};
    const AccuracyPoint& as_swept = run.changes.front().point;
    std::string out = fmt::format(
        "<h2>One setting changed</h2>\n<p class=\"sub\">By <b>{}</b> at the same {:.1f} ms. In the charts these are "
        "squares; the full one is as swept.</p>\n<div class=\"card scroll\"><table>\n<tr><th>change</th><th>frame p50, "
        "ms</th><th>p99, ms</th><th>worst accuracy, rad⁻¹</th><th>mean accuracy, rad⁻¹</th><th>PSNR, "
        "dB</th><th>FLIP</th><th>triangles</th></tr>\n",
        report::escaped(as_swept.selector), run.working_ms);
    for (const ChangeMark& mark : run.changes) {
        const AccuracyPoint& p = mark.point;
        out += fmt::format(
            "<tr><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.4f}</td><td>{}</td></tr>\n",
            report::escaped(mark.change), p.frame_ms_p50, p.frame_ms_p99, per_rad(p.accuracy_worst), per_rad(p.accuracy_mean),
            decibels_of(p), p.flip, report::grouped(p.triangles));
    }
    return out + "</table></div>\n";
}

std::string table_of(const AccuracyRun& run) {
    std::string out =
        "<div class=\"card scroll\"><table>\n<tr><th>selector</th><th>budget, ms</th><th>frame p50, "
        "ms</th><th>p90</th><th>accuracy, "
        "rad⁻¹</th><th>exact</th><th>SNR, dB</th><th>SSIM</th><th>triangles</th><th>equal / undefined</th><th>p99, "
        "ms</th><th>worst, rad⁻¹</th><th>error, m</th><th>PSNR, dB</th><th>FLIP</th><th>value</th></tr>\n";
    for (const AccuracyPoint& p : run.points)
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.4f}</td><td>{}</"
            "td><td>{} / {} "
            "of {}</td><td>{:.2f}</td><td>{}{}</td><td>{:.3g}</td><td>{}{}</td><td>{:.4f}</td><td>{:.1f} %</td></tr>\n",
            report::escaped(p.selector), std::isfinite(p.budget_ms) ? fmt::format("{:.2f}", p.budget_ms) : "∞", p.frame_ms_p50,
            p.frame_ms_p90, std::isfinite(p.accuracy_mean) ? report::short_number(p.accuracy_mean) : "∞", p.exact,
            std::isfinite(p.snr_db) ? fmt::format("{:.2f}", p.snr_db) : "–", p.ssim, report::grouped(p.triangles), p.snr_infinite,
            p.snr_undefined, p.frames, p.frame_ms_p99,
            std::isfinite(p.accuracy_worst) ? report::short_number(p.accuracy_worst) : "∞", p.accuracy_front ? " ◯" : "",
            p.error_m, decibels_of(p), p.psnr_front ? " ◯" : "", p.flip, 100 * p.value);
    return out + "</table></div>\n";
}

std::string body_of(const AccuracyRun& run) {
    const std::string model = report::escaped(std::filesystem::path(run.model).filename().string());
    std::string out = "<header>\n<p class=\"brand\"><b>Surefoot</b> accuracy</p>\n<h1>What accuracy costs in time</h1>\n";
    out += fmt::format("<p class=\"lead\"><b>{}</b> along <b>{}</b>: {} places, {}×{} pixels, on {}.", model,
                       report::escaped(std::filesystem::path(run.path).filename().string()), run.poses, run.width, run.height,
                       report::escaped(run.renderer));
    if (run.shift_x != 0 || run.shift_y != 0)
        out += fmt::format(" Off axis by {:+g} half widths, {:+g} half heights.", run.shift_x, run.shift_y);
    if (run.full_frame_ms > 0) out += fmt::format(" Full detail takes {:.1f} ms a frame.", run.full_frame_ms);
    out += "</p>\n</header>\n";
    if (!run.uncalibrated.empty())
        out += fmt::format("<ul class=\"notes\"><li><b>Uncalibrated: {}</b></li></ul>\n", report::escaped(run.uncalibrated));
    out += fmt::format("<div class=\"card wide\">{}</div>\n", accuracy_chart(run));
    out +=
        "<p class=\"sub\">Each line is one way to choose what to draw, each point a budget. <b>Accuracy</b>: one over the "
        "largest angular error on screen, the mean over the places. Places drawn exactly have no finite accuracy: they are "
        "left out of the mean and counted under <b>exact</b>. <b>SNR</b> and <b>SSIM</b>: against full detail from the same "
        "place. Up and to the left is better. Points where every picture equals full detail have no finite SNR and are left "
        "out of that panel.</p>\n";
    out += one_more_ms_of(run);
    out += changes_of(run);
    out += fmt::format("<h2>The worst place and the slowest frames</h2>\n<div class=\"card wide\">{}</div>\n",
                       worst_case_chart(run));
    out +=
        "<p class=\"sub\">Left: the accuracy of the worst place against the time of the slowest frames (p99). <b>PSNR</b>: of "
        "the mean squared error over all places. <b>FLIP</b>: how different an eye finds the pictures. Rings: no other point "
        "shows "
        "more in the same time.</p>\n<h2>Figures</h2>\n<p class=\"sub\"><b>Accuracy</b> is "
        "relative to the distance: 1 / angle. <b>Error</b> is absolute: the largest geometric error in metres that is drawn, the "
        "mean over the places. <b>Value</b>: share of what full detail shows, as the selectors count it.</p>\n";
    out += table_of(run);
    return out +
           fmt::format(
               "<footer><p>{}</p><p>Beside this page: <a href=\"accuracy.csv\">accuracy.csv</a>, <a "
               "href=\"accuracy.json\">accuracy.json</a>, "
               "<a href=\"accuracy.svg\">accuracy.svg</a>, <a "
               "href=\"accuracy-dark.svg\">accuracy-dark.svg</a>, <a href=\"accuracy-worst.svg\">accuracy-worst.svg</a>, <a "
               "href=\"accuracy-worst-dark.svg\">accuracy-worst-dark.svg</a>.</p></footer>\n",
               report::escaped(run.machine));
}

}  // namespace

void mark_fronts(std::vector<AccuracyPoint>& points) {
    using Figure = double AccuracyPoint::*;
    const auto beaten = [&](const AccuracyPoint& p, Figure time, Figure shown) {
        return std::any_of(points.begin(), points.end(), [&](const AccuracyPoint& other) {
            const bool as_good = other.*time <= p.*time && other.*shown >= p.*shown;
            return as_good && (other.*time < p.*time || other.*shown > p.*shown);
        });
    };
    for (AccuracyPoint& p : points) {
        p.accuracy_front = !beaten(p, &AccuracyPoint::frame_ms_p99, &AccuracyPoint::accuracy_worst);
        p.psnr_front = !beaten(p, &AccuracyPoint::frame_ms_p50, &AccuracyPoint::psnr_db);
    }
}

std::string accuracy_csv(const AccuracyRun& run) {
    std::string out =
        "selector,budget_ms,frame_ms_p50,frame_ms_p90,accuracy_per_rad,snr_db,ssim,triangles,cost_us,frames,snr_infinite,snr_"
        "undefined,exact,frame_ms_p99,accuracy_worst_per_rad,error_m,psnr_db,flip,value,accuracy_front,psnr_front,change\n";
    const auto add = [&](const AccuracyPoint& p, std::string_view change) {
        out += fmt::format(
            "{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.6f},{:.1f},{:.2f},{},{},{},{},{:.4f},{:.4f},{:.6g},{:.4f},{:.6f},"
            "{:.6f},{:d},{:d},{}\n",
            p.selector, p.budget_ms, p.frame_ms_p50, p.frame_ms_p90, p.accuracy_mean, p.snr_db, p.ssim, p.triangles, p.cost_us,
            p.frames, p.snr_infinite, p.snr_undefined, p.exact, p.frame_ms_p99, p.accuracy_worst, p.error_m, p.psnr_db, p.flip,
            p.value, p.accuracy_front, p.psnr_front, change);
    };
    for (const AccuracyPoint& p : run.points) add(p, "");
    for (const ChangeMark& mark : run.changes) add(mark.point, mark.change);
    return out;
}

namespace {

Json json_of(const AccuracyPoint& p) {
    return {{"selector", p.selector},
            {"budget_ms", finite(p.budget_ms)},
            {"frame_ms", {{"p50", finite(p.frame_ms_p50)}, {"p90", finite(p.frame_ms_p90)}, {"p99", finite(p.frame_ms_p99)}}},
            {"accuracy", finite(p.accuracy_mean)},
            {"accuracy_worst", finite(p.accuracy_worst)},
            {"error_m", finite(p.error_m)},
            {"snr_db", finite(p.snr_db)},
            {"psnr_db", p.psnr_db < report::max_psnr_db ? finite(p.psnr_db) : Json(nullptr)},
            {"ssim", finite(p.ssim)},
            {"flip", finite(p.flip)},
            {"value", finite(p.value)},
            {"estimated_gain", finite(p.estimated_gain)},
            {"triangles", finite(p.triangles)},
            {"cost_us", finite(p.cost_us)},
            {"frames", p.frames},
            {"snr_infinite", p.snr_infinite},
            {"snr_undefined", p.snr_undefined},
            {"exact", p.exact},
            {"accuracy_front", p.accuracy_front},
            {"psnr_front", p.psnr_front}};
}

}  // namespace

std::string accuracy_json(const AccuracyRun& run) {
    Json points = Json::array(), more = Json::array(), changes = Json::array();
    for (const ChangeMark& mark : run.changes) {
        changes.push_back(json_of(mark.point));
        changes.back()["change"] = mark.change;
    }
    for (const AccuracyPoint& p : run.points) points.push_back(json_of(p));
    for (const OneMoreMs& m : run.one_more_ms) more.push_back({{"now", json_of(m.now)}, {"more", json_of(m.more)}});
    const Json json = {{"model", run.model},
                       {"path", run.path},
                       {"renderer", run.renderer},
                       {"machine", run.machine},
                       {"width", run.width},
                       {"height", run.height},
                       {"shift_x", run.shift_x},
                       {"shift_y", run.shift_y},
                       {"poses", run.poses},
                       {"full_frame_ms", finite(run.full_frame_ms)},
                       {"calibrated", run.uncalibrated.empty()},
                       {"points", points},
                       {"rate_hz", run.rate_hz},
                       {"working_ms", run.working_ms},
                       {"one_more_ms", more},
                       {"changes", changes}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<void> probe_accuracy_page(const std::string& dir) {
    return FileSet::probe(dir, {"accuracy.csv", "accuracy.json", "accuracy.svg", "accuracy-dark.svg", "accuracy-worst.svg",
                                "accuracy-worst-dark.svg", "index.html"});
}

Result<void> write_accuracy_page(const std::string& dir, const AccuracyRun& run) {
    auto written = FileSet::create(dir);
    if (!written) return written.error();
    const std::array<std::pair<std::string_view, std::string>, 7> files = {{
        {"accuracy.csv", accuracy_csv(run)},
        {"accuracy.json", accuracy_json(run)},
        {"accuracy.svg", accuracy_svg(run, false)},
        {"accuracy-dark.svg", accuracy_svg(run, true)},
        {"accuracy-worst.svg", worst_case_svg(run, false)},
        {"accuracy-worst-dark.svg", worst_case_svg(run, true)},
        {"index.html", report::page("Surefoot: what accuracy costs in time", body_of(run))},
    }};
    for (const auto& [name, text] : files)
        if (auto ok = written->add(name, text); !ok) return ok;
    return written->commit();
}

}  // namespace surefoot::accuracy
