// Views from above: the whole path, and which nodes were drawn at one place (Maciel 1994, figure 3.20, key 't').
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "tools/report/charts.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::report {

namespace {

/// World XZ to picture: north (−Z) up, one scale for both axes, centred.
struct Projection {
    double scale = 1, left = 0, top = 0;
    [[nodiscard]] Point operator()(double x, double z) const { return {left + x * scale, top + z * scale, false}; }
};

/// A rectangle on the ground, metres.
struct Ground {
    double x0 = std::numeric_limits<double>::infinity(), z0 = x0, x1 = -x0, z1 = -x0;
    void grow(double x, double z) {
        if (!std::isfinite(x) || !std::isfinite(z)) return;
        x0 = std::min(x0, x);
        x1 = std::max(x1, x);
        z0 = std::min(z0, z);
        z1 = std::max(z1, z);
    }
    [[nodiscard]] bool empty() const { return x0 > x1; }
};

Projection fit(Ground g, double width, double height, double margin) {
    if (g.empty()) g = {-1, -1, 1, 1};
    const double min_size = 1e-3;
    const double across = std::max(g.x1 - g.x0, min_size);
    const double down = std::max(g.z1 - g.z0, min_size);
    const double scale = std::min((width - 2 * margin) / across, (height - 2 * margin) / down);
    return {scale, width / 2 - scale * (g.x0 + g.x1) / 2, height / 2 - scale * (g.z0 + g.z1) / 2};
}

/// A bar of round length, so that distances can be judged.
std::string scale_bar(const Projection& p, double height) {
    double length = nice_ceiling(90 / p.scale);
    if (length * p.scale > 150) length /= 2;
    const double at = height - 14;
    return fmt::format("<path d=\"M14 {:.1f}v5h{:.1f}v-5\" fill=\"none\" class=\"axis\"/>", at - 5, length * p.scale) +
           text_at(14 + length * p.scale + 7, at + 4, "note", short_number(length) + " m");
}

/// Where both edges of the view leave the picture does not matter: the cone is long enough to.
std::string view_cone(const Projection& p, const ReportSnapshot& snapshot, double reach_px) {
    const double length = std::hypot(snapshot.forward[0], snapshot.forward[2]);
    if (!(length > 1e-6)) return {};  // straight up or down
    const double heading = std::atan2(snapshot.forward[2], snapshot.forward[0]);
    const Point eye = p(snapshot.eye[0], snapshot.eye[2]);
    const auto edge = [&](double angle) {
        return Point{eye.x + reach_px * std::cos(angle), eye.y + reach_px * std::sin(angle), false};
    };
    const Point a = edge(heading + std::max(snapshot.left_rad, -1.5));
    const Point b = edge(heading + std::min(snapshot.right_rad, 1.5));
    return fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}L{:.1f} {:.1f}Z\" class=\"cone\"/>", eye.x, eye.y, a.x, a.y, b.x,
                       b.y) +
           line_between(eye.x, eye.y, a.x, a.y, "cone-edge") + line_between(eye.x, eye.y, b.x, b.y, "cone-edge");
}

constexpr std::array<std::string_view, 3> kind_names = {"cluster", "object", "piece"};
constexpr std::size_t max_rects = 3000;  // more cannot be told apart, and would make the page heavy

std::string rect_of(const Projection& p, const ReportSnapshot::Rect& r) {
    const Point a = p(std::min(r.x0, r.x1), std::min(r.z0, r.z1));
    const Point b = p(std::max(r.x0, r.x1), std::max(r.z0, r.z1));
    const auto kind = static_cast<std::size_t>(std::clamp(r.kind, 0, 2));
    const double detail = std::clamp(double{r.detail}, 0.0, 1.0);
    return fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"node k{}\" "
        "fill-opacity=\"{:.2f}\"><title>{}, detail {:.0f} "
        "%</title></rect>",
        a.x, a.y, std::max(0.6, b.x - a.x), std::max(0.6, b.y - a.y), kind, 0.05 + 0.5 * detail, kind_names[kind], detail * 100);
}

bool drawable(const ReportSnapshot::Rect& r) {
    return std::isfinite(r.x0) && std::isfinite(r.x1) && std::isfinite(r.z0) && std::isfinite(r.z1);
}

}  // namespace

std::string top_view(const ReportSnapshot& snapshot) {
    constexpr double width = 640;
    constexpr double height = 360;
    // Large ones first, so that small ones stay visible on top.
    std::vector<ReportSnapshot::Rect> rects;
    for (const auto& r : snapshot.drawn)
        if (drawable(r)) rects.push_back(r);
    const auto area = [](const ReportSnapshot::Rect& r) { return std::abs((r.x1 - r.x0) * (r.z1 - r.z0)); };
    std::stable_sort(rects.begin(), rects.end(), [&](const auto& a, const auto& b) { return area(a) > area(b); });
    const std::size_t left_out = rects.size() > max_rects ? rects.size() - max_rects : 0;
    rects.resize(rects.size() - left_out);

    Ground ground;
    ground.grow(snapshot.eye[0], snapshot.eye[2]);
    for (const auto& r : rects) {
        ground.grow(r.x0, r.z0);
        ground.grow(r.x1, r.z1);
    }
    const Projection p = fit(ground, width, height, 22);
    std::string out = open_chart(width, height, "What was drawn, seen from above");
    const Point low = p(snapshot.world_xz[0], snapshot.world_xz[1]);
    const Point high = p(snapshot.world_xz[2], snapshot.world_xz[3]);
    if (high.x > low.x)
        out += fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" class=\"world\"/>", low.x, low.y,
                           high.x - low.x, high.y - low.y);
    out += view_cone(p, snapshot, width + height);
    for (const auto& r : rects) out += rect_of(p, r);
    const Point eye = p(snapshot.eye[0], snapshot.eye[2]);
    out +=
        fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5.5\" class=\"eye\"><title>the eye</title></circle>", eye.x, eye.y);
    if (left_out > 0) out += text_at(width - 12, height - 10, "note end", fmt::format("{} smaller nodes left out", left_out));
    return out + scale_bar(p, height) + close_chart();
}

std::string path_map(const WalkFrames& walk, std::span<const ReportSnapshot> snapshots) {
    constexpr double width = 470;
    constexpr double height = 250;
    Ground ground;
    for (const auto* f : walk.frames) ground.grow(f->eye[0], f->eye[2]);
    const Projection p = fit(ground, width, height, 26);
    std::string out = open_chart(width, height, "The path from above");
    // A point wherever the path has moved two pixels: finer cannot be seen.
    std::vector<Point> line;
    for (const auto* f : walk.frames) {
        if (!std::isfinite(f->eye[0]) || !std::isfinite(f->eye[2])) continue;
        const Point at = p(f->eye[0], f->eye[2]);
        if (line.empty() || std::hypot(at.x - line.back().x, at.y - line.back().y) >= 2) line.push_back(at);
    }
    out += polyline(line, "line");
    for (const auto* f : walk.frames) {
        if (!f->missed) continue;
        const Point at = p(f->eye[0], f->eye[2]);
        out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" class=\"miss\"><title>frame {}: {}</title></circle>",
                           at.x, at.y, f->frame, rt::cause_of(*f));
    }
    for (std::size_t i = 0; i < snapshots.size(); ++i) {
        const Point at = p(snapshots[i].eye[0], snapshots[i].eye[2]);
        out += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"9\" class=\"snapshot\"/>", at.x, at.y);
        out += text_at(at.x, at.y + 4, "mid strong", std::to_string(i + 1));
    }
    return out + scale_bar(p, height) + close_chart();
}

}  // namespace surefoot::report
