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

constexpr std::array<Shown, 3> shown = {{
    {"Triangles", "", [](const report::PictureFigures& p) { return static_cast<double>(p.triangles); }, false},
    {"Accuracy, rad⁻¹", "", [](const report::PictureFigures& p) { return static_cast<double>(p.accuracy); }, true},
    {"SNR, dB", "", [](const report::PictureFigures& p) { return p.snr_db; }, false},
}};

std::string chart_of(const ComparedSelector& of, const Shown& what, double rate_hz) {
    report::TimeChart chart;
    chart.label = what.label;
    chart.unit = what.unit;
    chart.log = what.log;
    chart.height = 180;
    for (const report::PictureFigures& p : of.pictures) {
        const double value = what.value(p);
        if (!std::isfinite(value)) continue;
        chart.time_s.push_back(static_cast<double>(p.frame) / rate_hz);
        chart.value.push_back(value);
    }
    if (chart.value.empty()) return fmt::format("<p>{}: every picture equals full detail.</p>\n", what.label);
    return fmt::format("<h3>{}</h3>\n{}", what.label, report::time_chart(chart));
}

std::string body_of(const Comparison& c) {
    std::string out = fmt::format(
        "<header><p class=\"brand\"><b>Surefoot</b> · comparison</p><h1>{}</h1>"
        "<p class=\"lead\">{} pictures of one walk, {}x{} at {:.4g} Hz, {} a frame.</p></header>\n",
        report::escaped(c.model), c.pictures, c.width, c.height, c.rate_hz, budget_text(c));
    for (const ComparedSelector& s : c.selectors) {
        out += fmt::format("<h2>{}</h2>\n", report::escaped(s.selector));
        for (const Shown& what : shown) out += chart_of(s, what, c.rate_hz);
    }
    return out + "<p>Pictures without error have no accuracy and no SNR, and leave gaps. All figures are in pictures.csv.</p>\n";
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

Result<void> probe_compare_page(const std::string& dir) { return FileSet::probe(dir, {"index.html", "pictures.csv"}); }

Result<void> write_compare_page(const std::string& dir, const Comparison& comparison) {
    auto written = FileSet::create(dir);
    if (!written) return written.error();
    const std::array<std::pair<std::string_view, std::string>, 2> files = {
        {{"index.html", report::page("Surefoot: a comparison", body_of(comparison))}, {"pictures.csv", csv_of(comparison)}}};
    for (const auto& [name, text] : files)
        if (auto ok = written->add(name, text); !ok) return ok;
    return written->commit();
}

}  // namespace surefoot::accuracy
