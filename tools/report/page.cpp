// The walk's page: one file that a person reads from top to bottom, verdict first, pictures last but one.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "rt/base/file.hpp"
#include "tools/report/charts.hpp"
#include "tools/report/page_parts.hpp"
#include "tools/report/report.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"
#include "tools/report/verdict.hpp"

namespace surefoot::report {

namespace {

using rt::FrameRecord;

WalkFrames walk_frames(const WalkSummary& s, std::span<const FrameRecord> records, std::span<const ReportSnapshot> snapshots) {
    WalkFrames walk;
    for (const FrameRecord& record : records)
        if (!record.control) walk.frames.push_back(&record);
    if (!walk.frames.empty()) {
        walk.start_ns = walk.frames.front()->due_ns;
    }
    if (s.rate_hz > 0) walk.period_ns = static_cast<std::int64_t>(1e9 / s.rate_hz);
    for (const ReportSnapshot& snapshot : snapshots) {
        const auto at = std::lower_bound(walk.frames.begin(), walk.frames.end(), snapshot.frame,
                                         [](const FrameRecord* f, std::uint64_t frame) { return f->frame < frame; });
        walk.snapshots_s.push_back(at != walk.frames.end() && (*at)->frame == snapshot.frame ? walk.time_s(**at)
                                                                                             : snapshot.time_s);
    }
    return walk;
}

std::string card(std::string_view title, std::string_view words, const std::string& chart) {
    return fmt::format("<div class=\"card\"><h3>{}</h3><p>{}</p>{}</div>\n", escaped(title), escaped(words), chart);
}

std::string legend(std::initializer_list<std::pair<std::string_view, std::string_view>> entries) {
    std::string out = "<div class=\"legend\">";
    for (const auto& [css, name] : entries) out += fmt::format("<span><i class=\"{}\"></i>{}</span>", css, name);
    return out + "</div>";
}

std::string time_section(const WalkSummary& s, const WalkFrames& walk) {
    std::string out =
        "<h2>Time</h2>\n<p class=\"sub\">The time of every frame, from its due time to its end. The band runs from the fastest "
        "to the "
        "slowest frame of each column, so that every slow frame shows. The numbers on top are the pictures below.</p>\n";
    out += fmt::format("<div class=\"card wide\">{}</div>\n", frame_time_chart(walk, s.budget_ms));
    out += "<div class=\"two\">\n";
    out += card("How long frames took", "Counts on a logarithmic scale, so that a single slow frame shows.",
                frame_histogram(walk, s.budget_ms));
    out += fmt::format("<div class=\"card\"><h3>Where the time goes</h3>{}{}</div>\n",
                       legend({{"c7", "wake"}, {"c2", "select"}, {"c0", "submit"}, {"c3", "raster"}, {"c5", "present"}}),
                       phases_chart(walk));
    out += card("Budget spent", "Time spent over time allowed. The aim is close to 100 %.", budget_chart(walk));
    out += card("Wake lateness", "How late the frame thread woke up.", wake_chart(walk));
    return out + "</div>\n";
}

std::string picture_section(const WalkSummary& s, const WalkFrames& walk, std::span<const ReportSnapshot> snapshots) {
    std::string out =
        "<h2>What was drawn</h2>\n<p class=\"sub\">Accuracy is one over the largest angular error of anything on screen: higher "
        "is finer. "
        "Overload lowers it; it never drops an object.</p>\n<div class=\"two\">\n";
    out += card("Accuracy",
                fmt::format("Mean {}, at worst {} of error.", accuracy_words(s.accuracy_mean), accuracy_words(s.accuracy_min)),
                accuracy_chart_over_time(walk));
    out += card("Triangles",
                s.model_triangles > 0 ? fmt::format("Mean {} of the model's {}.", short_number(s.triangles_mean),
                                                    short_number(static_cast<double>(s.model_triangles)))
                                      : fmt::format("Mean {}.", short_number(s.triangles_mean)),
                triangles_chart(walk, s.model_triangles));
    out += card("The path", snapshots.empty() ? "From above." : "From above; numbers are where the pictures were taken.",
                path_map(walk, snapshots));
    out += s.misses > 0 ? card("Misses by cause", "One cause per miss, from the measurements of that frame.", cause_chart(s))
                        : card("Switches", "Nodes drawn in another form than in the previous frame. Fewer is better.",
                               switches_chart(walk));
    if (s.pictures.any())
        out += fmt::format("<div class=\"card\"><h3>The image cache</h3>{}{}</div>\n",
                           legend({{"u0", "new pictures"}, {"u1", "reused"}, {"u2", "boxes as triangles"}}), cache_chart(walk));
    return out + "</div>\n" + snapshot_cards(s, walk.snapshots_s, snapshots) + worst_form_cards(s);
}

std::string control_section(const ControlSummary& control) {
    if (!control.ran) return {};
    return fmt::format("<h2>Against a bare loop</h2>\n<p class=\"sub\">{}</p>\n<div class=\"card\">{}{}</div>\n",
                       escaped(control_words(control)), legend({{"c0", "walk"}, {"c8", "bare loop of the same cost"}}),
                       control_chart(control));
}

std::string body_of(const WalkSummary& s, std::span<const FrameRecord> records, std::span<const ReportSnapshot> snapshots) {
    const WalkFrames walk = walk_frames(s, records, snapshots);
    return page_header(s) + degraded_notes(s) + tiles(s) + time_section(s, walk) + picture_section(s, walk, snapshots) +
           control_section(s.control) + figures_table(s) + machine_table(s) + page_footer();
}

}  // namespace

Result<void> write_report(const std::string& dir, const WalkSummary& summary, std::span<const FrameRecord> records,
                          std::span<const ReportSnapshot> snapshots) {
    auto files = FileSet::create(dir);
    if (!files) return files.error();
    auto ledger = files->add("ledger.csv");
    if (!ledger) return ledger.error();
    if (auto written = write_ledger(**ledger, records); !written) return written;
    if (auto written = files->add("walk.json", to_json(summary)); !written) return written;
    const std::string title = fmt::format("Surefoot: {}", escaped(summary.model));
    if (auto written = files->add("index.html", page(title, body_of(summary, records, snapshots))); !written) return written;
    return files->commit();
}

}  // namespace surefoot::report
