// The page of a model's effects, and the same figures as JSON.
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include <fmt/format.h>

#include "rt/base/file.hpp"
#include "tools/accuracy/effect_worth.hpp"
#include "tools/report/report.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::accuracy {

namespace {

using Json = nlohmann::ordered_json;

std::string decibels(const WithAndWithout& w) {
    return w.psnr_db < report::max_psnr_db ? fmt::format("{:.1f}", w.psnr_db) : "equal";
}

std::string row(const std::string& name, const std::string& where, const WithAndWithout& w) {
    return fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:+.2f}</td><td>{}</td><td>{:.4f}</td></tr>\n",
        report::escaped(name), where, w.with_ms, w.without_ms, w.with_ms - w.without_ms, decibels(w), w.flip);
}

std::string pictures(const WithAndWithout& w, const std::string& what) {
    if (w.with.empty()) return "<p class=\"sub\">The pictures are equal at every place.</p>\n";
    return fmt::format(
        "<div class=\"card wide\" style=\"display:grid;grid-template-columns:1fr 1fr;gap:10px\">"
        "<figure><img src=\"{}\" alt=\"with {}\" style=\"width:100%\"><figcaption>with</figcaption></figure>"
        "<figure><img src=\"{}\" alt=\"without {}\" style=\"width:100%\"><figcaption>without, at place {}</figcaption></figure>"
        "</div>\n",
        w.with, what, w.without, what, w.max_at + 1);
}

std::string body_of(const EffectReport& r) {
    std::string out = "<header>\n<p class=\"brand\"><b>Surefoot</b> effects</p>\n<h1>What each effect costs and shows</h1>\n";
    out += fmt::format(
        "<p class=\"lead\"><b>{}</b> along <b>{}</b>: full detail at {} places, {}×{} pixels, on {}.</p>\n</header>\n",
        report::escaped(std::filesystem::path(r.model).filename().string()),
        report::escaped(std::filesystem::path(r.path).filename().string()), r.poses, r.width, r.height,
        report::escaped(r.renderer));
    out += "<div class=\"card scroll\"><table>\n<tr><th>effect</th><th>called for</th><th>by</th><th>triangles</th></tr>\n";
    for (const EffectWorth& e : r.effects)
        out += fmt::format("<tr><td>{}</td><td>{}</td><td style=\"text-align:left\">{}</td><td>{}</td></tr>\n",
                           report::escaped(e.name), e.called_for ? "yes" : "no", report::escaped(e.reason),
                           report::grouped(static_cast<double>(e.triangles)));
    out +=
        "</table></div>\n<h2>Time and pictures</h2>\n<p class=\"sub\">Each effect is switched off alone, in turns with the "
        "whole picture. Times are means over the places of a frame in full detail. <b>PSNR</b> and <b>FLIP</b> say how far the "
        "picture without it is off.</p>\n<div class=\"card scroll\"><table>\n<tr><th>without</th><th>shown at</th><th>with, "
        "ms</th><th>without, ms</th><th>costs, ms</th><th>PSNR, dB</th><th>FLIP</th></tr>\n";
    for (const EffectWorth& e : r.effects)
        if (e.shown_at > 0) out += row(e.name, fmt::format("{} of {}", e.shown_at, r.poses), e.worth);
    out += row("all: bare", "", r.bare) + "</table></div>\n";
    for (const EffectWorth& e : r.effects)
        if (e.shown_at > 0) out += fmt::format("<h2>{}: {}</h2>\n{}", e.name, e.help, pictures(e.worth, e.name));
    out += "<h2>All of them</h2>\n" + pictures(r.bare, "all effects");
    return out + fmt::format("<footer><p>{}</p><p>Beside this page: <a href=\"effects.json\">effects.json</a>.</p></footer>\n",
                             report::escaped(r.machine));
}

Json json_of(const WithAndWithout& w) {
    return {{"with_ms", w.with_ms},
            {"without_ms", w.without_ms},
            {"psnr_db", w.psnr_db < report::max_psnr_db ? Json(w.psnr_db) : Json(nullptr)},
            {"flip", w.flip}};
}

}  // namespace

std::string effects_json(const EffectReport& r) {
    Json effects = Json::array();
    for (const EffectWorth& e : r.effects)
        effects.push_back({{"effect", e.name},
                           {"what", e.help},
                           {"asked_by", e.requested_by},
                           {"called_for", e.called_for},
                           {"triangles", e.triangles},
                           {"reason", e.reason},
                           {"shown_at", e.shown_at},
                           {"worth", e.shown_at > 0 ? json_of(e.worth) : Json(nullptr)}});
    const Json json = {{"model", r.model},     {"path", r.path},     {"renderer", r.renderer},
                       {"machine", r.machine}, {"width", r.width},   {"height", r.height},
                       {"poses", r.poses},     {"effects", effects}, {"bare", json_of(r.bare)}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

Result<void> probe_effects_page(const std::string& dir) { return FileSet::probe(dir, {"effects.json", "index.html"}); }

Result<void> write_effects_page(const std::string& dir, const EffectReport& report) {
    auto written = FileSet::create(dir);
    if (!written) return written.error();
    if (auto ok = written->add("effects.json", effects_json(report)); !ok) return ok;
    if (auto ok = written->add("index.html", report::page("Surefoot: what each effect costs and shows", body_of(report))); !ok)
        return ok;
    return written->commit();
}

}  // namespace surefoot::accuracy
