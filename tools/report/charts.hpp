// The charts of a walk's page, each from the frame records alone; inline SVG, coloured by the page's style.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "rt/frame/record.hpp"
#include "tools/report/report.hpp"

namespace surefoot::report {

/// Values over time, one column in two pixels: the band is lowest to highest, the line the median of each column.
struct TimeChart {
    std::string label;  ///< read aloud, and the start of tooltips
    std::string unit;
    std::vector<double> time_s, value;
    /// A horizontal line with its text.
    struct Line {
        double value;
        std::string text, css;
    };
    std::vector<Line> lines;  ///< budgets and deadlines
    /// A mark at one point of the chart.
    struct Marker {
        double time_s, value;
        std::string tip;
    };
    std::vector<Marker> markers;      ///< misses
    std::vector<double> snapshots_s;  ///< moments of the pictures further down
    double top = 0;                   ///< of the axis; 0: from the values
    bool log = false;
    double width = 960, height = 240;
};
std::string time_chart(const TimeChart& chart);

/// Records of the walk alone (no bare control frames), and the time that the page counts from.
struct WalkFrames {
    std::vector<const rt::FrameRecord*> frames;
    std::int64_t start_ns = 0;
    std::int64_t period_ns = 1;
    std::vector<double> snapshots_s;
    [[nodiscard]] double time_s(const rt::FrameRecord& f) const { return static_cast<double>(f.due_ns - start_ns) * 1e-9; }
};

std::string frame_time_chart(const WalkFrames& walk, double budget_ms);
std::string frame_histogram(const WalkFrames& walk, double budget_ms);
std::string phases_chart(const WalkFrames& walk);
/// Pictures of the image cache, made and reused, and boxes that are drawn as triangles.
std::string cache_chart(const WalkFrames& walk);
std::string budget_chart(const WalkFrames& walk);
std::string wake_chart(const WalkFrames& walk);
std::string accuracy_chart_over_time(const WalkFrames& walk);
std::string triangles_chart(const WalkFrames& walk, std::uint64_t model_triangles);
std::string switches_chart(const WalkFrames& walk);
std::string cause_chart(const WalkSummary& summary);
std::string control_chart(const ControlSummary& control);

/// The path from above with the misses and the places of the pictures.
std::string path_map(const WalkFrames& walk, std::span<const ReportSnapshot> snapshots);
/// What was drawn at one place, from above.
std::string top_view(const ReportSnapshot& snapshot);

}  // namespace surefoot::report
