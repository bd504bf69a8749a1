// Words, tiles, pictures and tables of the walk's page. Everything that came from outside is escaped here.
#include "tools/report/page_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "tools/report/charts.hpp"
#include "tools/report/svg.hpp"
#include "tools/report/verdict.hpp"

namespace surefoot::report {

namespace {

constexpr int picture_quality = 84, drawing_quality = 95;

std::string file_name(const std::string& path) { return escaped(std::filesystem::path(path).filename().string()); }

std::string badge(const WalkSummary& s) {
    switch (verdict_of(s)) {
        case Verdict::good:
            return "<div class=\"badge good\"><i></i>every frame in time</div>";
        case Verdict::warn:
            return "<div class=\"badge warn\"><i></i>late at times, within the rule</div>";
        case Verdict::bad:
            return "<div class=\"badge bad\"><i></i>does not keep its frame</div>";
    }
    return {};
}

std::string tile(std::string_view name, const std::string& value, std::string_view unit, const std::string& note) {
    return fmt::format(
        "<div class=\"tile\"><div class=\"name\">{}</div><div class=\"value\">{}<small> {}</small></div><div "
        "class=\"note\">{}</div></div>\n",
        name, value, unit, note);
}

std::string figure(const std::string& uri, std::string_view alt, std::string_view caption) {
    if (uri.empty()) return {};
    return fmt::format("<figure><img loading=\"lazy\" alt=\"{0}\" src=\"{1}\"><figcaption>{2}</figcaption></figure>\n", alt, uri,
                       caption);
}

std::string snapshot_card(const ReportSnapshot& snapshot, std::size_t number, double time_s, const std::string& selector) {
    const auto chip = [](std::string_view name, const std::string& value) {
        return fmt::format("<span class=\"chip\">{} <b>{}</b></span>", name, value);
    };
    std::string out = fmt::format("<section class=\"snapshot\"><div class=\"head\"><h3>{}</h3><div class=\"chips\">", number);
    out += chip("at", fmt::format("{:.1f} s", time_s)) + chip("frame", grouped(static_cast<double>(snapshot.frame)));
    const double share =
        snapshot.full_triangles > 0 ? static_cast<double>(snapshot.triangles) / static_cast<double>(snapshot.full_triangles) : 1;
    out += chip("triangles", fmt::format("{} of {} ({})", short_number(static_cast<double>(snapshot.triangles)),
                                         short_number(static_cast<double>(snapshot.full_triangles)), percent(share)));
    if (!snapshot.difference.empty())
        out += chip("SNR", decibels(snapshot.snr_db)) + chip("SSIM", fmt::format("{:.3f}", snapshot.ssim)) +
               chip("FLIP", fmt::format("{:.3f}", snapshot.flip));
    if (snapshot.resolution < 1) out += chip("resolution", percent(double{snapshot.resolution}));
    out += chip("accuracy", fmt::format("{} rad⁻¹", short_number(double{snapshot.accuracy}))) +
           "</div></div>\n<div class=\"views\">\n";
    const auto uri = [&](const std::vector<std::uint8_t>& rgba) {
        return jpeg_data_uri(rgba, snapshot.width, snapshot.height, picture_quality);
    };
    out += figure(uri(snapshot.walk), "the walk's picture", fmt::format("The walk, {}", escaped(selector)));
    out += figure(uri(snapshot.full), "full detail", "Full detail, without a deadline");
    out += figure(uri(snapshot.difference), "difference of the two", "Difference, four times amplified");
    if (!snapshot.drawn.empty())
        out += fmt::format("<figure><div class=\"map\">{}</div><figcaption>From above: {} nodes drawn</figcaption></figure>\n",
                           top_view(snapshot), grouped(static_cast<double>(snapshot.drawn.size())));
    if (!snapshot.birds_eye.empty())
        out += fmt::format(
            "<figure class=\"birds-eye\"><img loading=\"lazy\" alt=\"the image cache from above\" src=\"{}\"><figcaption>The "
            "image "
            "cache from above. Red: {} new pictures. White: {} reused. Black: {} boxes drawn as triangles. Small squares: new "
            "pictures for later frames. Blue: the eye</figcaption></figure>\n",
            jpeg_data_uri(snapshot.birds_eye, snapshot.birds_eye_px, snapshot.birds_eye_px, drawing_quality),
            snapshot.new_pictures, snapshot.reused_pictures, snapshot.boxes_as_triangles);
    return out + "</div></section>\n";
}

std::string row_of(std::string_view name, const Quantiles& q, double factor, int decimals) {
    std::string out = fmt::format("<tr><td>{}</td>", name);
    for (const double v : {q.min, q.mean, q.p50, q.p90, q.p99, q.p999, q.max})
        out += fmt::format("<td>{:.{}f}</td>", v * factor, decimals);
    return out + "</tr>\n";
}

}  // namespace

std::string page_header(const WalkSummary& s) {
    std::string out =
        fmt::format("<header>\n<p class=\"brand\"><b>Surefoot</b> walk report</p>\n{}\n<h1>{}</h1>\n<p class=\"lead\"><b>{}</b>",
                    badge(s), escaped(headline(s)), file_name(s.model));
    if (!s.path.empty()) out += fmt::format(" {} <b>{}</b>", s.input.given ? "from the start of" : "along", file_name(s.path));
    if (s.input.given) out += fmt::format(", steered by <b>{}</b>", file_name(s.input.source));
    out += fmt::format(" for {:.0f} seconds at {:.4g} Hz and {}×{} pixels{}, chosen by <b>{}</b>, drawn by {}.", s.seconds,
                       s.rate_hz, s.width, s.height, off_axis_words(s), escaped(s.selector),
                       escaped(s.renderer.empty() ? s.backend : s.renderer));
    if (s.model_triangles > 0)
        out += fmt::format(" The model has {} triangles; a frame drew {} on average.",
                           grouped(static_cast<double>(s.model_triangles)), grouped(s.triangles_mean));
    if (const std::string seat = seat_words(s); !seat.empty()) out += fmt::format(" Seat: {}.", seat);
    if (s.clock == "virtual") out += " On the virtual clock: times are predictions, not measurements.";
    return out + "</p>\n</header>\n";
}

std::string degraded_notes(const WalkSummary& s) {
    if (s.degraded.empty() && s.census_problems.empty() && s.uncalibrated.empty()) return {};
    std::string out = "<ul class=\"notes\">\n";
    if (!s.uncalibrated.empty()) out += fmt::format("<li><b>Uncalibrated: {}</b></li>\n", escaped(s.uncalibrated));
    for (const rt::Lack& d : s.degraded) {
        out += fmt::format("<li><b>Not fully real-time: {}</b>", escaped(d.what));
        if (!d.remedy.empty()) out += fmt::format("<code>{}</code>", escaped(d.remedy));
        out += "</li>\n";
    }
    for (const std::string& problem : s.census_problems)
        out += fmt::format("<li><b>A thread is not where it should be: {}</b></li>\n", escaped(problem));
    return out + "</ul>\n";
}

std::string tiles(const WalkSummary& s) {
    std::string out = "<div class=\"tiles\">\n";
    const double period_ms = s.rate_hz > 0 ? 1000 / s.rate_hz : 0;
    const auto count = [](std::uint64_t n) { return grouped(static_cast<double>(n)); };
    out += tile("Missed", count(s.misses), fmt::format("of {}", count(s.frames)),
                s.misses == 0 ? (s.skipped == 0 ? "none skipped either" : fmt::format("{} slots skipped", count(s.skipped)))
                              : fmt::format("{} own, {} slots skipped", count(s.own_misses), count(s.skipped)));
    out += tile("Typical frame", fmt::format("{:.1f}", s.frame_ms.p50), "ms",
                fmt::format("of {:.1f} until the deadline", period_ms));
    out += tile("Slow frame, p99.9", fmt::format("{:.1f}", s.frame_ms.p999), "ms", fmt::format("slowest {:.1f}", s.frame_ms.max));
    out += tile("Budget used", fmt::format("{:.0f}", s.budget_used_wall_mean * 100), "%",
                fmt::format("of {:.1f} ms a frame", s.budget_ms));
    out += tile("Accuracy", short_number(s.accuracy_mean), "rad⁻¹",
                fmt::format("{} of error on average", accuracy_words(s.accuracy_mean)));
    if (s.picture.frames > 0)
        out += tile("Picture, PSNR", fmt::format("{:.1f}", s.picture.psnr_db), "dB",
                    fmt::format("SSIM {:.3f}, FLIP {:.3f}; worst {:.1f} dB, frame {}", s.picture.ssim, s.picture.flip,
                                s.picture.worst_psnr_db, s.picture.worst_frame));
    if (s.unused_ms.max > 0)
        out += tile("Unused time", fmt::format("{:.1f}", s.unused_ms.mean), "ms",
                    fmt::format("where value is missing; p99 {:.1f}", s.unused_ms.p99));
    out += tile("Triangles", short_number(s.triangles_mean), "",
                s.model_triangles > 0
                    ? fmt::format("a frame, of {} in the model", short_number(static_cast<double>(s.model_triangles)))
                    : fmt::format("a frame, at most {}", short_number(static_cast<double>(s.triangles_max))));
    if (s.pictures.any())
        out += tile("Cached pictures", fmt::format("{:.0f}", s.pictures.drawn_mean), "a frame",
                    fmt::format("{:.1f} made, {:.0f} boxes as triangles; up to {:.1f} MiB",
                                static_cast<double>(s.pictures.made) / static_cast<double>(std::max<std::uint64_t>(1, s.frames)),
                                s.pictures.as_triangles_mean, static_cast<double>(s.pictures.max_bytes) / 1048576.0));
    if (s.rest_frames > 0)
        out += tile("At rest", fmt::format("{}", s.rest_frames), "frames",
                    fmt::format("{} in full detail, up to {} samples", s.rested_frames, s.rest_samples));
    if (s.guarantee.accuracy > 0)
        out += tile("Guaranteed accuracy", short_number(s.guarantee.accuracy), "rad⁻¹",
                    fmt::format("kept in {} frames of {}; at worst {}", s.guarantee.kept, s.frames,
                                std::isfinite(s.guarantee.reached_min) ? short_number(s.guarantee.reached_min) : "exact"));
    if (s.resolution_min < 1)
        out += tile("Resolution", fmt::format("{:.0f}", s.resolution_mean * 100), "%",
                    fmt::format("of the sides on average, at least {:.0f}", s.resolution_min * 100));
    if (s.samples > 1 || s.other_samples)
        out += tile("Samples", fmt::format("{}", s.samples), "a pixel",
                    s.other_samples ? "the driver lacks the requested number" : "edges are smoothed");
    if (s.trilinear_frames > 0)
        out += tile("Filter", std::string(rt::name_of(rt::TextureFilter::trilinear)), "",
                    fmt::format("two mip levels of each texture are blended in {} frames of {}", s.trilinear_frames, s.frames));
    return out + "</div>\n";
}

std::string snapshot_cards(const WalkSummary& s, std::span<const double> time_s, std::span<const ReportSnapshot> snapshots) {
    if (snapshots.empty()) return {};
    std::string out =
        "<h2>Along the path</h2>\n<p class=\"sub\">The same pose drawn by the walk, and in full detail without a deadline. "
        "From above: "
        "the drawn nodes; a stronger colour is finer detail.</p>\n"
        "<div class=\"legend\"><span><i class=\"c1\"></i>cluster: one shape for several objects</span><span><i "
        "class=\"c0\"></i>object</span>"
        "<span><i class=\"c2\"></i>piece of an object</span></div>\n";
    for (std::size_t i = 0; i < snapshots.size(); ++i) out += snapshot_card(snapshots[i], i + 1, time_s[i], s.selector);
    return out;
}

std::string worst_form_cards(const WalkSummary& s) {
    if (s.picture.worst_forms.empty()) return {};
    std::string out =
        "<h2>Forms that cost most</h2>\n<p class=\"sub\">In each picture, those before which most is wrong were drawn in full "
        "detail "
        "in turn, while all else stayed. The share "
        "is what that takes away of the squared error of all pictures above. Shares need not add up: one form may hide another.";
    if (s.picture.resolution_error_share > 0)
        out += fmt::format(" Full detail at the same resolutions would have {:.1f} % of that error.",
                           100 * s.picture.resolution_error_share);
    out += "</p>\n<div class=\"two\">\n";
    for (const WorstForm& f : s.picture.worst_forms) {
        const std::string title =
            fmt::format("{} {}{}: {}", f.node_kind, f.node, f.name.empty() ? "" : " “" + f.name + "”", f.form);
        const std::string words =
            fmt::format("{:.1f} % of the error, tried in {} picture{}; {} triangles. Here: frame {}", 100 * f.error_share,
                        f.pictures, f.pictures == 1 ? "" : "s", grouped(static_cast<double>(f.triangles)), f.frame);
        out += fmt::format("<div class=\"card\"><h3>{}</h3><p>{}</p>", escaped(title), escaped(words));
        for (const auto& [name, pixels] : {std::pair{"the walk", &f.walk}, std::pair{"full detail", &f.full}})
            out += fmt::format("<figure><img src=\"{}\" alt=\"{}\"><figcaption>{}</figcaption></figure>",
                               jpeg_data_uri(*pixels, f.width, f.height, 85), escaped(title + ", " + name), name);
        out += "</div>\n";
    }
    return out + "</div>\n";
}

std::string figures_table(const WalkSummary& s) {
    std::string out =
        "<h2>Figures</h2>\n<div class=\"card "
        "scroll\"><table>\n<tr><th></th><th>min</th><th>mean</th><th>p50</th><th>p90</th><th>p99</th><th>p99.9</th><th>max</th></"
        "tr>\n";
    out += row_of("Frame, ms", s.frame_ms, 1, 2) + row_of("Wake lateness, µs", s.wake_us, 1, 0) +
           row_of("Select, µs", s.select_us, 1, 0) + row_of("Submit, ms", s.submit_ms, 1, 2) +
           row_of("Raster, ms", s.raster_ms, 1, 2) + row_of("Prepare (workers' CPU), µs", s.prepare_cpu_us, 1, 0) +
           row_of("Age of prepared arrays, frames", s.prepared_age, 1, 0) + row_of("Nodes visited to prepare", s.visits, 1, 0) +
           row_of("Of them occluded", s.hidden, 1, 0) + row_of("Error of predicted cost, %", s.cost_error, 100, 1);
    if (s.shown.one_percent_low_hz > 0) {
        out += row_of("Picture to picture, ms", s.shown.interval_ms, 1, 2);
        if (s.shown.on_grid) out += row_of("Shown off the grid, µs", s.shown.error_us, 1, 0);
    }
    if (s.input.given) out += row_of("Report to submitted frame, ms", s.input.age_ms, 1, 1);
    if (s.input.to_shown_ms.max > 0) out += row_of("Report to picture shown, ms", s.input.to_shown_ms, 1, 1);
    out += "</table></div>\n";
    out += fmt::format(
        "<p class=\"sub\">{:.2f} switches a frame · {} slices drawn coarser than chosen, in {} frames · cut hash "
        "<code>{}</code></p>\n",
        s.switches_per_frame, grouped(static_cast<double>(s.downgrades)), grouped(static_cast<double>(s.coarse_frames)),
        escaped(s.cut_hash));
    out += fmt::format("<p class=\"sub\">The floor was reached in {} frames · shown without need in {}</p>\n",
                       grouped(static_cast<double>(s.floor_bound_frames)), grouped(static_cast<double>(s.floor_frames)));
    if (s.input.given)
        out += fmt::format("<p class=\"sub\">Steered by {}: {}</p>\n", escaped(s.input.source), escaped(input_words(s.input)));
    return out;
}

std::string machine_table(const WalkSummary& s) {
    const auto yes = [](bool b) { return b ? "yes" : "no"; };
    const std::array<std::pair<std::string_view, std::string>, 10> rows = {{
        {"Machine", s.machine},
        {"Renderer", fmt::format("{} ({})", s.renderer, s.backend)},
        {"Clock, late frames", fmt::format("{}, {}", s.clock, s.late_policy)},
        {"Real-time scheduling (FIFO)", yes(s.fifo)},
        {"Threads pinned to cores", yes(s.pinned)},
        {"Frame core isolated", yes(s.isolated)},
        {"Memory locked", yes(s.locked)},
        {"Threads", s.threads.empty() ? "not counted" : threads_words(s.threads)},
        {"Frame thread's own code", fmt::format("{} page faults, {} guard violations", s.page_faults, s.guard_violations)},
        {"Driver, and the host", fmt::format("{} page faults, {} allocations ({:.1f} a frame); {:.1f} ms stolen by the host",
                                             s.driver_faults, s.driver_allocations, s.driver_allocations_per_frame, s.steal_ms)},
    }};
    std::string out = "<h2>The machine</h2>\n<div class=\"card scroll\"><table>\n";
    for (const auto& [name, value] : rows)
        out += fmt::format("<tr><td>{}</td><td class=\"words\">{}</td></tr>\n", name, escaped(value));
    return out + "</table></div>\n";
}

std::string page_footer() {
    return "<footer><p>Beside this page: <a href=\"ledger.csv\">ledger.csv</a>, one row a frame, and <a "
           "href=\"walk.json\">walk.json</a>, "
           "the figures above.</p><p><b>Own miss</b>: late even without the time that the host stole. <b>Budget</b>: the time "
           "that a frame may spend. "
           "<b>Cluster</b>: a node that stands for several objects. <b>Switch</b>: a node's form changed between two frames. "
           "<b>SNR</b>: variance of the walk's picture over its mean square difference from full detail (Pasman and Jansen "
           "2002). <b>SSIM</b>: structural similarity of luma, 1 for equal pictures. "
           "<b>PSNR</b>: peak signal-to-noise ratio of all compared pictures against full detail. "
           "<b>FLIP</b>: difference that an eye sees flipping between both, 0 for equal pictures.</p></footer>\n";
}

}  // namespace surefoot::report
