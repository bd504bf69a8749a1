// The page of a model's effects, and the same figures as JSON.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "rt/base/file.hpp"
#include "tools/accuracy/effect_worth.hpp"
#include "tools/report/report.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::accuracy {

namespace {

using EffectJson = nlohmann::ordered_json;

constexpr std::string_view words = "<td style=\"text-align:left\">";  // of a cell; figures stand at its right

std::string decibels(const PictureDifference& d) {
    return d.psnr_db < report::max_psnr_db ? fmt::format("{:.1f}", d.psnr_db) : "equal";
}

std::string percent(double share) { return share > 0 && share < 0.001 ? "&lt; 0.1 %" : fmt::format("{:.3g} %", 100 * share); }

std::string row(const std::string& name, const std::string& where, const WithAndWithout& w) {
    return fmt::format(
        "<tr><td>{}</td><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:+.2f}</td><td>{}</td><td>{:.4f}</td></tr>\n",
        report::escaped(name), where, w.with_ms, w.without_ms, w.with_ms - w.without_ms, decibels(w), w.flip);
}

std::string pictures(const PictureDifference& w, const std::string& what, std::string_view with = "with",
                     std::string_view without = "without") {
    if (w.with.empty()) return "<p class=\"sub\">The pictures are equal at every place.</p>\n";
    return fmt::format(
        "<div class=\"card wide\" style=\"display:grid;grid-template-columns:1fr 1fr;gap:10px\">"
        "<figure><img src=\"{0}\" alt=\"{3} {2}\" style=\"width:100%\"><figcaption>{3}</figcaption></figure>"
        "<figure><img src=\"{1}\" alt=\"{4} {2}\" style=\"width:100%\"><figcaption>{4}, at place {5}</figcaption></figure>"
        "</div>\n",
        w.with, w.without, what, with, without, w.max_at + 1);
}

std::string way_row(std::string_view name, const Way& way, bool compared) {
    return fmt::format(
        "<tr><td>{}</td><td>{:.2f}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.0f}</td><td>{:.0f}</td><td>{:.0f}</td></tr>\n",
        name, way.ms, compared ? decibels(way.difference) : "–", compared ? fmt::format("{:.4f}", way.difference.flip) : "–",
        way.programs, way.batches, way.state_changes, way.draws);
}

std::string three_ways(const ThreeWays& w) {
    std::string out =
        "<h2>All on, as called for, bare</h2>\n<p class=\"sub\">Means of a frame in full detail, drawn in turns. <b>PSNR</b> and "
        "<b>FLIP</b> compare the picture with the one as called for.</p>\n<div class=\"card scroll\"><table>\n<tr><th>drawn</th>"
        "<th>ms</th><th>PSNR, dB</th><th>FLIP</th><th>programs</th><th>batches</th><th>state changes</th><th>draws</th></tr>\n";
    out += way_row("all on", w.all_on, true) + way_row("as called for", w.as_called_for, false) + way_row("bare", w.bare, true);
    out +=
        "</table></div>\n<p class=\"sub\"><b>All on</b> is what a renderer with one program for all would do. Every material has "
        "each effect that the model uses anywhere, where its picture can stay the same. It gets a white texture, an alpha cutoff "
        "of "
        "0, white vertex colours, and the sun where no sky is seen. <b>As called for</b> is how Surefoot draws: each material "
        "has "
        "its own effects alone. <b>Bare</b> has none. Where surfaces coincide, another order of drawing may show another one. "
        "Programs are those that the whole model needs, coarse forms included.</p>\n"
        "<div class=\"card scroll\"><table>\n<tr><th>effect</th><th>triangles with it</th><th>all on</th>"
        "<th style=\"text-align:left\">why not on all</th></tr>\n";
    const auto of_all = [&](std::uint64_t triangles) {
        return percent(static_cast<double>(triangles) / std::max(1.0, static_cast<double>(w.spread.triangles)));
    };
    for (const SpreadEffect& e : w.spread.effects)
        out += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td>{}{}</td></tr>\n", e.name, of_all(e.triangles),
                           of_all(e.all_on_triangles), words, report::escaped(e.why_not));
    return out + "</table></div>\n" + pictures(w.all_on.difference, "everywhere", "as called for", "all on");
}

std::string where_words(const EffectWorth& e) {
    if (e.behind) return "behind everything";
    if (e.where.empty()) return "coarse forms alone";
    std::string out;
    for (const Holder& h : e.where) {
        const std::string name = h.name.empty() ? "objects without a name" : report::escaped(h.name);
        const std::string count = h.objects > 1 ? fmt::format(" ({}×)", report::grouped(h.objects)) : "";
        out += fmt::format("{}{}{}: {}", out.empty() ? "" : "<br>", name, count, percent(h.share));
    }
    return out;
}

std::string called_for_row(const EffectWorth& e) {
    const std::string name = report::escaped(e.name);
    std::string out = fmt::format("<tr><td>{}</td>{}{}</td>{}{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>", name, words,
                                  report::escaped(e.reason), words, where_words(e), percent(e.frames_share),
                                  percent(e.triangles_share), percent(e.walked_frames_share), percent(e.walked_triangles_share));
    out += e.shown_at > 0 ? fmt::format("<td>{:+.2f}</td><td>{}</td><td>{:.4f}</td>", e.worth.with_ms - e.worth.without_ms,
                                        decibels(e.worth), e.worth.flip)
                          : std::string("<td>–</td><td>–</td><td>–</td>");
    return out + "</tr>\n";
}

std::string called_for(const EffectReport& r) {
    std::string out = fmt::format(
        "<h2>Called for</h2>\n<p class=\"sub\">An effect is in use in a frame if anything drawn has it. <b>Frames</b> are {} "
        "along "
        "the path. They are counted in full detail, and as a walk at {:.0f} Hz selects them by the cost table. <b>Where</b> "
        "names "
        "the objects with most of its triangles in full detail, and their share. Time, PSNR and FLIP are lost without it.</p>\n",
        r.use_frames, walked_rate_hz);
    out += fmt::format(
        "<div class=\"card scroll\"><table>\n<tr><th>effect</th><th style=\"text-align:left\">by</th>"
        "<th style=\"text-align:left\">where</th><th>frames</th><th>their triangles</th><th>at {0:.0f} Hz: frames</th>"
        "<th>their triangles</th><th>ms</th><th>PSNR, dB</th><th>FLIP</th></tr>\n",
        walked_rate_hz);
    for (const EffectWorth& e : r.effects)
        if (e.called_for) out += called_for_row(e);
    out += "</table></div>\n<h2>Not called for</h2>\n";
    std::string absent;
    for (const EffectWorth& e : r.effects)
        if (!e.called_for)
            absent += fmt::format("<tr><td>{}</td>{}{}</td></tr>\n", report::escaped(e.name), words, report::escaped(e.reason));
    if (absent.empty()) return out + "<p class=\"sub\">Nothing: the model calls for every effect.</p>\n";
    return out +
           "<p class=\"sub\">These are neither compiled nor bound nor fetched.</p>\n<div class=\"card scroll\"><table>\n<tr>"
           "<th>effect</th><th style=\"text-align:left\">reason</th></tr>\n" +
           absent + "</table></div>\n";
}

/// A line for each reason.
std::string lines_of(const EffectRegion& region) {
    std::string out;
    for (const std::string& line : reason_lines(region)) out += (out.empty() ? "" : "<br>") + report::escaped(line);
    return out;
}

std::string region_tables(const EffectReport& r) {
    std::string out =
        "<h2>By region</h2>\n<p class=\"sub\">The largest regions of the hierarchy hold each object once. What <b>coarse "
        "forms</b> "
        "alone need is not needed by full detail.</p>\n<div class=\"card scroll\"><table>\n<tr>"
        "<th style=\"text-align:left\">region</th><th>triangles</th><th style=\"text-align:left\">called for</th>"
        "<th style=\"text-align:left\">why</th></tr>\n";
    for (const EffectRegion& region : r.regions)
        out += fmt::format("<tr>{0}node {1}: {2}</td><td>{3}</td>{0}{4}</td>{0}{5}</td></tr>\n", words, region.node,
                           report::escaped(region.name), report::grouped(static_cast<double>(region.triangles)),
                           report::escaped(effects_in_words(region)), lines_of(region));
    out +=
        "</table></div>\n<h2>Along the path</h2>\n<div class=\"card scroll\"><table>\n<tr><th>effect</th><th>frames</th>"
        "<th>items</th><th style=\"text-align:left\">why</th></tr>\n";
    for (const EffectWorth& e : r.effects)
        if (e.called_for)
            out += fmt::format("<tr><td>{}</td><td>{} of {}</td><td>{}</td>{}{}</td></tr>\n", report::escaped(e.name),
                               e.walked_frames, r.use_frames, report::grouped(static_cast<double>(e.walked_items)), words,
                               report::escaped(e.along_path));
    return out + "</table></div>\n";
}

std::string body_of(const EffectReport& r) {
    std::string out = "<header>\n<p class=\"brand\"><b>Surefoot</b> effects</p>\n<h1>What each effect costs and shows</h1>\n";
    out += fmt::format(
        "<p class=\"lead\"><b>{}</b> along <b>{}</b>: full detail at {} places, {}×{} pixels, on {}{}{}.</p>\n</header>\n",
        report::escaped(std::filesystem::path(r.model).filename().string()),
        report::escaped(std::filesystem::path(r.path).filename().string()), r.poses, r.width, r.height,
        report::escaped(r.renderer), r.hour < 0 ? "" : fmt::format(", in the light of {:.4g} h", r.hour),
        r.time_s > 0 ? fmt::format(", {:.4g} s after the animations began", r.time_s) : "");
    if (!r.uncalibrated.empty()) out += fmt::format("<p class=\"sub\">{}</p>\n", report::escaped(r.uncalibrated));
    out += called_for(r) + region_tables(r) + three_ways(r.ways);
    out +=
        "<h2>Time and pictures</h2>\n<p class=\"sub\">Each effect is switched off alone, in turns with the "
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

EffectJson json_of(const WithAndWithout& w) {
    return {{"with_ms", w.with_ms},
            {"without_ms", w.without_ms},
            {"psnr_db", w.psnr_db < report::max_psnr_db ? EffectJson(w.psnr_db) : EffectJson(nullptr)},
            {"flip", w.flip}};
}

EffectJson json_of(const Way& way, bool compared) {
    const PictureDifference& d = way.difference;
    return {{"ms", way.ms},
            {"psnr_db", compared && d.psnr_db < report::max_psnr_db ? EffectJson(d.psnr_db) : EffectJson(nullptr)},
            {"flip", compared ? EffectJson(d.flip) : EffectJson(nullptr)},
            {"programs", way.programs},
            {"batches_per_frame", way.batches},
            {"state_changes_per_frame", way.state_changes},
            {"draws_per_frame", way.draws}};
}

EffectJson json_of(const ThreeWays& w) {
    EffectJson spread = EffectJson::array();
    for (const SpreadEffect& e : w.spread.effects)
        spread.push_back({{"effect", e.name},
                          {"triangles", e.triangles},
                          {"all_on_triangles", e.all_on_triangles},
                          {"why_not_all", e.why_not}});
    return {{"all_on", json_of(w.all_on, true)},
            {"as_called_for", json_of(w.as_called_for, false)},
            {"bare", json_of(w.bare, true)},
            {"full_detail_triangles", w.spread.triangles},
            {"all_on_effects", spread}};
}

EffectJson json_of(const std::vector<EffectRegion>& regions) {
    EffectJson out = EffectJson::array();
    for (const EffectRegion& region : regions)
        out.push_back({{"node", region.node},
                       {"name", region.name},
                       {"leaves", region.leaves},
                       {"triangles", region.triangles},
                       {"effects", effects_in_words(region)},
                       {"why", reasons_in_words(region)},
                       {"reasons", reason_lines(region)}});
    return out;
}

EffectJson json_of(const std::vector<DrawnHolder>& drawn) {
    EffectJson out = EffectJson::array();
    for (const DrawnHolder& d : drawn)
        out.push_back({{"name", d.name},
                       {"items", d.items},
                       {"node", d.node},
                       {"middle_m", {d.middle_m.x, d.middle_m.y, d.middle_m.z}},
                       {"vertices", d.vertices},
                       {"vertices_that_see_sky", d.see_sky}});
    return out;
}

EffectJson json_of(const std::vector<Holder>& where) {
    EffectJson out = EffectJson::array();
    for (const Holder& h : where) out.push_back({{"name", h.name}, {"objects", h.objects}, {"triangles_share", h.share}});
    return out;
}

}  // namespace

std::string effects_json(const EffectReport& r) {
    EffectJson effects = EffectJson::array();
    for (const EffectWorth& e : r.effects)
        effects.push_back({{"effect", e.name},
                           {"what", e.help},
                           {"asked_by", e.requested_by},
                           {"called_for", e.called_for},
                           {"triangles", e.triangles},
                           {"reason", e.reason},
                           {"shown_at", e.shown_at},
                           {"frames_share", e.frames_share},
                           {"triangles_share", e.triangles_share},
                           {"walked_frames_share", e.walked_frames_share},
                           {"walked_triangles_share", e.walked_triangles_share},
                           {"walked_frames", e.walked_frames},
                           {"walked_items", e.walked_items},
                           {"along_path", e.along_path},
                           {"along_path_items", json_of(e.drawn)},
                           {"where", json_of(e.where)},
                           {"worth", e.shown_at > 0 ? json_of(e.worth) : EffectJson(nullptr)}});
    const EffectJson json = {{"model", r.model},           {"path", r.path},
                             {"renderer", r.renderer},     {"machine", r.machine},
                             {"width", r.width},           {"height", r.height},
                             {"poses", r.poses},           {"hour", r.hour < 0 ? EffectJson(nullptr) : EffectJson(r.hour)},
                             {"use_frames", r.use_frames}, {"walked_rate_hz", walked_rate_hz},
                             {"effects", effects},         {"regions", json_of(r.regions)},
                             {"bare", json_of(r.bare)},    {"ways", json_of(r.ways)}};
    return json.dump(2, ' ', false, EffectJson::error_handler_t::replace) + "\n";
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
