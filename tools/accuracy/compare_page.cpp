// The page of a comparison: what each picture of a walk took, and how near full detail it came.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "rt/base/file.hpp"
#include "tools/accuracy/compare.hpp"
#include "tools/report/charts.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::accuracy {

namespace {

/// What a chart shows of each picture.
struct Shown {
    std::string_view label, unit;
    double (*value)(const report::PictureFigures&);
    bool log;
};

constexpr std::array<Shown, 3> charted = {{
    {"Triangles", "", [](const report::PictureFigures& p) { return static_cast<double>(p.triangles); }, false},
    {"Accuracy, rad⁻¹", "", [](const report::PictureFigures& p) { return static_cast<double>(p.accuracy); }, true},
    {"SNR, dB", "", [](const report::PictureFigures& p) { return p.snr_db; }, false},
}};

constexpr double strip_width = 960, strip_height = 180;

/// Inline; empty where every picture equals full detail.
std::string chart_of(const ComparedSelector& of, const Shown& what, double rate_hz) {
    report::TimeChart chart;
    chart.label = what.label;
    chart.unit = what.unit;
    chart.log = what.log;
    chart.width = strip_width;
    chart.height = strip_height;
    bool any = false;
    for (const report::PictureFigures& p : of.pictures) {  // without a value, too: all charts span the same time
        const double value = what.value(p);
        any = any || std::isfinite(value);
        chart.time_s.push_back(static_cast<double>(p.frame) / rate_hz);
        chart.value.push_back(value);
    }
    return any ? report::time_chart(chart) : std::string();
}

/// All charts below each other, as an SVG of its own.
std::string chart_file_of(const Comparison& c) {
    constexpr double title_height = 22;
    std::string charts;
    double y = 8;
    for (const ComparedSelector& s : c.selectors)
        for (const Shown& what : charted) {
            const std::string chart = chart_of(s, what, c.rate_hz);
            charts += report::text_at(
                10, y + 14, "note",
                fmt::format("{}: {}{}", s.selector, what.label, chart.empty() ? ". Every picture equals full detail." : ""));
            y += title_height;
            if (chart.empty()) continue;
            charts += fmt::format("<svg y=\"{:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\"{}", y, strip_width, strip_height,
                                  chart.substr(std::string_view("<svg").size()));
            y += strip_height;
        }
    return report::stand_alone(
        report::open_chart(strip_width, y + 8, "Pictures of a comparison") + charts + report::close_chart(), false);
}

/// What the walk left out of the light, in the order in which it went.
std::string dropped_list(const ComparedSelector& of) {
    if (of.dropped_parts.empty()) return {};
    std::string out = "<p>Parts of the light that were left out where forms showed more for the time:</p><ol>";
    for (const report::DroppedSummary& part : of.dropped_parts) out += "<li>" + report::escaped(dropped_words(part)) + "</li>";
    return out + "</ol>\n";
}

std::string body_of(const Comparison& c) {
    std::string out = fmt::format(
        "<header><p class=\"brand\"><b>Surefoot</b> · comparison</p><h1>{}</h1>"
        "<p class=\"lead\">{} pictures of one walk, {}x{} at {:.4g} Hz, {} a frame.</p></header>\n",
        report::escaped(c.model), c.pictures, c.width, c.height, c.rate_hz, budget_text(c));
    for (const ComparedSelector& s : c.selectors) {
        out += fmt::format("<h2>{}</h2>\n", report::escaped(s.selector)) + dropped_list(s);
        for (const Shown& what : charted) {
            const std::string chart = chart_of(s, what, c.rate_hz);
            out += chart.empty() ? fmt::format("<p>{}: every picture equals full detail.</p>\n", what.label)
                                 : fmt::format("<h3>{}</h3>\n{}", what.label, chart);
        }
    }
    return out +
           "<p>Pictures without error have no accuracy and no SNR, and leave gaps. All figures are in pictures.csv, and these "
           "charts in pictures.svg.</p>\n";
}

std::string csv_of(const Comparison& c) {
    std::string out = "selector,frame,triangles,full_triangles,accuracy,snr_db,mse,ssim,flip\n";
    for (const ComparedSelector& s : c.selectors)
        for (const report::PictureFigures& p : s.pictures)
            out += fmt::format("\"{}\",{},{},{},{:.4f},{:.4f},{:.4f},{:.5f},{:.5f}\n", s.selector, p.frame, p.triangles,
                               p.full_triangles, p.accuracy, p.snr_db, p.mse, p.ssim, p.flip);
    return out;
}

}  // namespace

Result<void> probe_compare_page(const std::string& dir) {
    return FileSet::probe(dir, {"index.html", "pictures.csv", "pictures.svg"});
}

Result<void> write_compare_page(const std::string& dir, const Comparison& comparison) {
    auto written = FileSet::create(dir);
    if (!written) return written.error();
    const std::array<std::pair<std::string_view, std::string>, 3> files = {
        {{"index.html", report::page("Surefoot: a comparison", body_of(comparison))},
         {"pictures.csv", csv_of(comparison)},
         {"pictures.svg", chart_file_of(comparison)}}};
    for (const auto& [name, text] : files)
        if (auto ok = written->add(name, text); !ok) return ok;
    return written->commit();
}

}  // namespace surefoot::accuracy
