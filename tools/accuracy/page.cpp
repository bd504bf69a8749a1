// The accuracy sweep as CSV, JSON and a page.
#include "tools/accuracy/page.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "rt/base/file.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::accuracy {

namespace {

using Json = nlohmann::ordered_json;

Json finite(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }

std::string table_of(const AccuracyRun& run) {
    std::string out =
        "<div class=\"card scroll\"><table>\n<tr><th>selector</th><th>budget, ms</th><th>frame p50, "
        "ms</th><th>p90</th><th>accuracy, "
        "rad⁻¹</th><th>exact</th><th>SNR, dB</th><th>SSIM</th><th>triangles</th><th>equal / undefined</th></tr>\n";
    for (const AccuracyPoint& p : run.points)
        out += fmt::format(
            "<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.4f}</td><td>{}</"
            "td><td>{} / {} "
            "of {}</td></tr>\n",
            report::escaped(p.selector), std::isfinite(p.budget_ms) ? fmt::format("{:.2f}", p.budget_ms) : "∞", p.frame_ms_p50,
            p.frame_ms_p90, std::isfinite(p.accuracy_mean) ? report::short_number(p.accuracy_mean) : "∞", p.exact,
            std::isfinite(p.snr_db) ? fmt::format("{:.2f}", p.snr_db) : "–", p.ssim, report::grouped(p.triangles), p.snr_infinite,
            p.snr_undefined, p.frames);
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
        "out of that panel.</p>\n<h2>Figures</h2>\n";
    out += table_of(run);
    return out + fmt::format(
                     "<footer><p>{}</p><p>Beside this page: <a href=\"accuracy.csv\">accuracy.csv</a>, <a "
                     "href=\"accuracy.json\">accuracy.json</a>, "
                     "<a href=\"accuracy.svg\">accuracy.svg</a>, <a "
                     "href=\"accuracy-dark.svg\">accuracy-dark.svg</a>.</p></footer>\n",
                     report::escaped(run.machine));
}

}  // namespace

std::string accuracy_csv(const AccuracyRun& run) {
    std::string out =
        "selector,budget_ms,frame_ms_p50,frame_ms_p90,accuracy_per_rad,snr_db,ssim,triangles,cost_us,frames,snr_infinite,snr_"
        "undefined,exact\n";
    for (const AccuracyPoint& p : run.points)
        out += fmt::format("{},{},{:.4f},{:.4f},{:.4f},{:.4f},{:.6f},{:.1f},{:.2f},{},{},{},{}\n", p.selector, p.budget_ms,
                           p.frame_ms_p50, p.frame_ms_p90, p.accuracy_mean, p.snr_db, p.ssim, p.triangles, p.cost_us, p.frames,
                           p.snr_infinite, p.snr_undefined, p.exact);
    return out;
}

std::string accuracy_json(const AccuracyRun& run) {
    Json points = Json::array();
    for (const AccuracyPoint& p : run.points)
        points.push_back({{"selector", p.selector},
                          {"budget_ms", finite(p.budget_ms)},
                          {"frame_ms", {{"p50", finite(p.frame_ms_p50)}, {"p90", finite(p.frame_ms_p90)}}},
                          {"accuracy", finite(p.accuracy_mean)},
                          {"snr_db", finite(p.snr_db)},
                          {"ssim", finite(p.ssim)},
                          {"triangles", finite(p.triangles)},
                          {"cost_us", finite(p.cost_us)},
                          {"frames", p.frames},
                          {"snr_infinite", p.snr_infinite},
                          {"snr_undefined", p.snr_undefined},
                          {"exact", p.exact}});
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
                       {"points", points}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<void> probe_accuracy_page(const std::string& dir) {
    return FileSet::probe(dir, {"accuracy.csv", "accuracy.json", "accuracy.svg", "accuracy-dark.svg", "index.html"});
}

Result<void> write_accuracy_page(const std::string& dir, const AccuracyRun& run) {
    auto written = FileSet::create(dir);
    if (!written) return written.error();
    const std::array<std::pair<std::string_view, std::string>, 5> files = {{
        {"accuracy.csv", accuracy_csv(run)},
        {"accuracy.json", accuracy_json(run)},
        {"accuracy.svg", accuracy_svg(run, false)},
        {"accuracy-dark.svg", accuracy_svg(run, true)},
        {"index.html", report::page("Surefoot: what accuracy costs in time", body_of(run))},
    }};
    for (const auto& [name, text] : files)
        if (auto ok = written->add(name, text); !ok) return ok;
    return written->commit();
}

}  // namespace surefoot::accuracy
