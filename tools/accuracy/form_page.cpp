// The page of a model's forms, level by level, and the same figures as CSV.
#include <cmath>
#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "rt/base/file.hpp"
#include "tools/accuracy/form_pictures.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::accuracy {

namespace {

constexpr std::string_view rules =
    "<style>.forms{display:flex;flex-wrap:wrap;gap:14px;align-items:flex-start;margin:10px 0 4px}"
    ".forms figure{flex:0 0 192px}.forms figure img{width:auto;max-width:192px;display:inline-block;margin-right:4px}"
    ".forms figcaption b{color:var(--ink);font-weight:600}.node{content-visibility:auto}</style>\n";

std::string image(const std::string& uri, const std::string& what) {
    return uri.empty() ? "" : fmt::format("<img src=\"{}\" alt=\"{}\">", uri, report::escaped(what));
}

std::string microseconds(double us) { return report::short_number(us) + " µs"; }

std::string form_figure(const DrawnForm& form) {
    const std::string what = form.full_detail ? "full detail" : form.kind;
    std::string out = fmt::format("<figure>{}<figcaption><b>{}</b>, {} triangles<br>error {} m, {} KiB<br>close: {}, ",
                                  image(form.close, what + ", close"), what, report::grouped(form.triangles),
                                  report::short_number(form.error_m),
                                  report::short_number(static_cast<double>(form.bytes) / 1024), microseconds(form.close_us));
    out += std::isfinite(form.close_psnr_db) ? fmt::format("{:.1f} dB", form.close_psnr_db) : std::string("as full detail");
    if (!form.full_detail)
        out += fmt::format("<br>colour loss {}, {}, {}<br>coverage off {:.0f} %", report::short_number(form.loss.colour[0]),
                           report::short_number(form.loss.colour[1]), report::short_number(form.loss.colour[2]),
                           100 * static_cast<double>(form.loss.coverage));
    out += "</figcaption>";
    if (!form.served.empty())
        out += fmt::format("{}{}<figcaption>from {} m: {}; full detail (right): {}</figcaption>",
                           image(form.served, what + ", far"), image(form.full, "full detail, far"),
                           report::short_number(form.served_m), microseconds(form.served_us), microseconds(form.full_us));
    return out + "</figure>\n";
}

std::string node_card(const DrawnNode& node) {
    std::string out = fmt::format("<div class=\"card node\"><div class=\"chips\"><h3>{} {}{}</h3>", node.kind, node.node,
                                  node.name.empty() ? "" : " “" + report::escaped(node.name) + "”");
    out += fmt::format("<span class=\"chip\">{} triangles</span><span class=\"chip\">size {} m</span>",
                       report::grouped(static_cast<double>(node.triangles)), report::short_number(node.size_m));
    if (node.same > 1) out += fmt::format("<span class=\"chip\">{} alike on this level</span>", node.same);
    out += "</div>\n<div class=\"forms\">\n";
    for (const DrawnForm& form : node.forms) out += form_figure(form);
    if (node.forms.empty() || !node.forms.back().full_detail)
        out += fmt::format("<figure>{}<figcaption><b>full detail</b> of all below<br>close: {}</figcaption></figure>\n",
                           image(node.full, "full detail, close"), microseconds(node.full_us));
    return out + "</div></div>\n";
}

std::string body_of(const FormPictures& p) {
    std::string out =
        std::string(rules) + "<header>\n<p class=\"brand\"><b>Surefoot</b> forms</p>\n<h1>How each part is drawn</h1>\n";
    out += fmt::format(
        "<p class=\"lead\"><b>{}</b>: {} of {} nodes with forms of their own, of {} nodes in all, on {}.</p>\n</header>\n",
        report::escaped(std::filesystem::path(p.model).filename().string()), p.drawn.size(), p.distinct, p.nodes,
        report::escaped(p.renderer));
    if (!p.uncalibrated.empty())
        out += fmt::format("<ul class=\"notes\"><li><b>Uncalibrated: {}</b></li></ul>\n", report::escaped(p.uncalibrated));
    out +=
        "<p class=\"sub\">Forms go from coarse to fine. A pixel here is a pixel of a walk at 1280×720. The large picture shows "
        "the node close, where it fills the picture; the <b>dB</b> compare it with full detail there. The small ones show the "
        "form, and full detail on its right, from where its <b>error</b> is two pixels. <b>Colour loss</b>: the mean squared "
        "difference from six directions, at 512, 64 and 8 pixels. <b>Coverage off</b>: pixels that only one of both covers. "
        "Times are predicted from the cost table. KiB: vertices, indices, and the pictures of a box.</p>\n";
    std::uint32_t level = ~0U;
    for (const DrawnNode& node : p.drawn) {
        if (node.level != level) out += fmt::format("<h2>Level {}</h2>\n", node.level);
        level = node.level;
        out += node_card(node);
    }
    return out + fmt::format("<footer><p>{}</p><p>Beside this page: <a href=\"forms.csv\">forms.csv</a>.</p></footer>\n",
                             report::escaped(p.machine));
}

/// A field of a CSV file.
std::string field(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

}  // namespace

std::string forms_csv(const FormPictures& pictures) {
    std::string out =
        "level,node,kind,name,alike,size_m,form,triangles,full_detail,error_m,close_m,close_us,close_psnr_db,coverage_loss,"
        "colour_loss_512,colour_loss_64,colour_loss_8,served_m,served_us,full_us,bytes\n";
    for (const DrawnNode& n : pictures.drawn)
        for (const DrawnForm& f : n.forms)
            out += fmt::format(
                "{},{},{},{},{},{:.6g},{},{},{},{:.6g},{:.6g},{:.3f},{:.3f},{:.5f},{:.6f},{:.6f},{:.6f},{:.6g},{:.3f},{:.3f},{}"
                "\n",
                n.level, n.node, n.kind, field(n.name), n.same, n.size_m, f.kind, f.triangles, f.full_detail ? 1 : 0, f.error_m,
                n.close_m, f.close_us, f.close_psnr_db, f.loss.coverage, f.loss.colour[0], f.loss.colour[1], f.loss.colour[2],
                f.served_m, f.served_us, f.full_us, f.bytes);
    return out;
}

Result<void> probe_forms_page(const std::string& dir) { return FileSet::probe(dir, {"forms.csv", "index.html"}); }

Result<void> write_forms_page(const std::string& dir, const FormPictures& pictures) {
    auto written = FileSet::create(dir);
    if (!written) return written.error();
    if (auto ok = written->add("forms.csv", forms_csv(pictures)); !ok) return ok;
    if (auto ok = written->add("index.html", report::page("Surefoot: how each part is drawn", body_of(pictures))); !ok) return ok;
    return written->commit();
}

}  // namespace surefoot::accuracy
