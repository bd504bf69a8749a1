// Cuts, floors, path and viewpoints in plan.
#include "tools/report/floor_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/model/ground/near.hpp"
#include "render/model/ground/walker.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::report {

namespace {

constexpr double plan_px = 1200, margin_m = 5, cut_m = 1.0, max_floor_off_m = 0.6;
constexpr int shown_viewpoints = 8;
constexpr double fly_height_m = 8;  // over what lies below; nobody walks up there

/// World to picture.
struct Plan {
    Box box;
    double scale = 1;
    [[nodiscard]] double x(const dvec3& p) const { return (p.x - box.min.x) * scale; }
    [[nodiscard]] double y(const dvec3& p) const { return (p.z - box.min.z) * scale; }
    [[nodiscard]] double width() const { return (box.max.x - box.min.x) * scale; }
    [[nodiscard]] double height() const { return (box.max.z - box.min.z) * scale; }
};

Plan plan_of(const Path& path) {
    Plan plan;
    for (const PathSample& sample : path.samples) plan.box.grow(sample.pose.position);
    const dvec3 sides = plan.box.max - plan.box.min;
    const double margin = std::max(margin_m, 0.1 * std::max(sides.x, sides.z));
    plan.box.min -= margin;
    plan.box.max += margin;
    plan.scale = plan_px / std::max(plan.box.max.x - plan.box.min.x, plan.box.max.z - plan.box.min.z);
    return plan;
}

/// Floor under the nearest sample of the path, in plan.
double floor_near(const Path& path, double eye_m, const dvec3& at) {
    double nearest = std::numeric_limits<double>::infinity(), y = 0;
    const std::size_t stride = std::max<std::size_t>(1, path.samples.size() / 200);
    for (std::size_t i = 0; i < path.samples.size(); i += stride) {
        const dvec3& p = path.samples[i].pose.position;
        const double d = std::hypot(p.x - at.x, p.z - at.z);
        if (d < nearest) nearest = d, y = p.y - eye_m;
    }
    return y;
}

/// All turn the same way: floors that lie upon each other would cancel out.
std::string triangle_in_plan(const Plan& plan, const model::GroundTriangle& t) {
    const bool turned = glm::cross(t.b - t.a, t.c - t.a).y < 0;
    const dvec3 &b = turned ? t.c : t.b, &c = turned ? t.b : t.c;
    return fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f} {:.1f} {:.1f}z", plan.x(t.a), plan.y(t.a), plan.x(b), plan.y(b), plan.x(c),
                       plan.y(c));
}

/// The line in which a level plane cuts the triangle, or nothing.
std::string cut_in_plan(const Plan& plan, const model::GroundTriangle& t, double y) {
    std::array<dvec3, 3> ends;
    std::size_t found = 0;
    const std::array corners{t.a, t.b, t.c};
    for (std::size_t i = 0; i < 3; ++i) {
        const dvec3 &u = corners[i], &v = corners[(i + 1) % 3];
        if ((u.y < y) != (v.y < y)) ends[found++] = u + (v - u) * ((y - u.y) / (v.y - u.y));
    }
    if (found < 2) return {};
    return fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", plan.x(ends[0]), plan.y(ends[0]), plan.x(ends[1]), plan.y(ends[1]));
}

/// Floors and walls around a walker's path.
std::string walked(const model::Model& model, const Path& path, const Plan& plan) {
    std::string floors, walls;
    const double eye_m = model::Body{}.eye_m, min_area = 0.5 / (plan.scale * plan.scale);
    Box box = plan.box;
    box.min.y -= 3, box.max.y += 1;
    model::for_triangles_near(model.ground, box, [&](const model::GroundTriangle& t) {
        const dvec3 n = glm::cross(t.b - t.a, t.c - t.a), middle = (t.a + t.b + t.c) / 3.0;
        const double floor = floor_near(path, eye_m, middle);
        if (std::abs(n.y) >= 0.7 * glm::length(n)) {
            if (std::abs(middle.y - floor) < max_floor_off_m && 0.5 * std::abs(n.y) > min_area)
                floors += triangle_in_plan(plan, t);
        } else {
            walls += cut_in_plan(plan, t, floor + cut_m);
        }
    });
    return fmt::format(
        "<path d=\"{}\" fill=\"#e6e9ec\" stroke=\"none\"/><path d=\"{}\" fill=\"none\" stroke=\"#20262c\" stroke-width=\"1.3\"/>",
        floors, walls);
}

/// Outlines of blocks and instances from above.
std::string flown_over(const model::Model& model, const Plan& plan) {
    std::string outlines;
    const auto add = [&](const Box& b) {
        if (b.max.x < plan.box.min.x || b.min.x > plan.box.max.x || b.max.z < plan.box.min.z || b.min.z > plan.box.max.z) return;
        outlines += fmt::format("M{:.1f} {:.1f}H{:.1f}V{:.1f}H{:.1f}z", plan.x(b.min), plan.y(b.min), plan.x(b.max),
                                plan.y(b.max), plan.x(b.min));
    };
    for (const model::Node& node : model.nodes)
        if (node.child_count == 0) add(node.box);
    return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#aab3bb\" stroke-width=\"0.7\"/>", outlines);
}

std::string path_and_viewpoints(const Path& path, const Plan& plan) {
    std::string line, marks;
    for (const PathSample& s : path.samples)
        line += fmt::format("{}{:.1f} {:.1f}", line.empty() ? "M" : "L", plan.x(s.pose.position), plan.y(s.pose.position));
    for (int i = 0; i < shown_viewpoints; ++i) {
        const Pose pose = sample_path(path, path.duration_s() * i / shown_viewpoints);
        const dvec3 to = pose.position + pose.forward() * (18 / plan.scale);
        const double x = plan.x(pose.position), y = plan.y(pose.position);
        marks += fmt::format(
            "<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\" stroke=\"#b3471d\" stroke-width=\"2\"/><circle cx=\"{:.1f}\" cy=\"{:.1f}\" "
            "r=\"9\" "
            "fill=\"#b3471d\"/><text x=\"{:.1f}\" y=\"{:.1f}\" fill=\"#fff\" text-anchor=\"middle\">{}</text>",
            x, y, plan.x(to), plan.y(to), x, y, x, y + 4, i + 1);
    }
    return fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"#1c7c4a\" stroke-width=\"3\" stroke-linejoin=\"round\"/>", line) +
           marks;
}

}  // namespace

std::string floor_plan_svg(const model::Model& model, const Path& path, const std::string& title) {
    const Plan plan = plan_of(path);
    double length_m = 0;
    for (std::size_t i = 1; i < path.samples.size(); ++i)
        length_m += glm::length(path.samples[i].pose.position - path.samples[i - 1].pose.position);
    double bar_m = nice_ceiling(90 / plan.scale);
    if (bar_m * plan.scale > 180) bar_m /= 2;
    const double bottom = plan.height() + 34;
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" height=\"{:.0f}\" "
        "font-family=\"sans-serif\" font-size=\"12\"><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>",
        plan.width(), bottom + 8, plan.width(), bottom + 8);
    const model::Walker walker(model.ground, {});
    std::size_t on_foot = 0;
    for (const PathSample& s : path.samples)
        on_foot += std::isfinite(walker.floor_at(s.pose.position, s.pose.position.y, s.pose.position.y - fly_height_m)) ? 1 : 0;
    const bool walks = !model.ground.empty() && 2 * on_foot > path.samples.size();
    svg += walks ? walked(model, path, plan) : flown_over(model, plan);
    svg += path_and_viewpoints(path, plan);
    svg += fmt::format(
        "<path d=\"M12 {:.1f}v5h{:.1f}v-5\" fill=\"none\" stroke=\"#20262c\"/><text x=\"{:.1f}\" y=\"{:.1f}\">{} m</text>",
        bottom - 14, bar_m * plan.scale, 20 + bar_m * plan.scale, bottom - 7, short_number(bar_m));
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}: {} m in {} s</text></svg>\n", plan.width() - 12,
                       bottom - 7, escaped(title), short_number(length_m), short_number(path.duration_s()));
    return svg;
}

}  // namespace surefoot::report
