// Finds a node's curve, and writes it as text, JSON and SVG.
#include "tools/accuracy/model_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "rt/base/text.hpp"
#include "tools/report/rounded.hpp"
#include "tools/report/style.hpp"
#include "tools/report/svg.hpp"

namespace surefoot::accuracy {

namespace {

constexpr model::Resources triangles_alone{0, 0, 1, 0};

std::size_t inexact(const std::vector<model::CurvePoint>& points) {
    return static_cast<std::size_t>(
        std::count_if(points.begin(), points.end(), [](const model::CurvePoint& p) { return std::isfinite(p.accuracy); }));
}

model::FittedLine line_of(const std::vector<model::CurvePoint>& points) {
    std::vector<double> accuracy, triangles;
    for (const model::CurvePoint& p : points) {
        accuracy.push_back(p.accuracy);
        triangles.push_back(p.takes.triangles);
    }
    return model::fit_line(accuracy, triangles);
}

/// The last accuracy of the chart: of the finest form that is not exact, or where the curve's last part begins.
double last_accuracy(const ModelCurve& of) {
    double last = 0;
    for (const model::CurvePoint& p : of.points)
        if (std::isfinite(p.accuracy)) last = std::max(last, p.accuracy);
    for (const model::CurvePart& part : of.curve.parts())
        if (part.from < 1e12) last = std::max(last, part.from);
    return last > 0 ? last : 1;
}

}  // namespace

Result<ModelCurve> find_curve(const std::string& file, const model::Model& model, const std::string& name) {
    model::Index n = 0;
    while (!name.empty() && n < model.nodes.size() &&
           std::string_view(model.name_of(model.nodes[n])).find(name) == std::string_view::npos)
        ++n;
    if (n == model.nodes.size())
        return Error{"--node " + name, "No node has a name that contains this", "`surefoot inspect MODEL --tree` lists all names",
                     ErrorKind::misuse};
    const model::Node& node = model.nodes[n];
    ModelCurve of;
    of.file = file;
    of.node = printable(model.name_of(node));
    if (of.node.empty()) of.node = model::name_of(node.kind);
    of.index = n;
    of.diameter_m = model::diameter_of(node);
    of.points = model::form_points(model, n);
    of.curve = model::relative_curve(model, n, triangles_alone);
    if (inexact(of.points) >= 3) of.line = line_of(of.points);
    return of;
}

std::string curve_json(const ModelCurve& of) {
    using Json = nlohmann::ordered_json;
    using report::rounded;
    Json points = Json::array(), parts = Json::array();
    for (const model::CurvePoint& p : of.points)
        points.push_back({{"accuracy", rounded(p.accuracy)}, {"triangles", p.takes.triangles}, {"texels", p.takes.texels}});
    for (const model::CurvePart& part : of.curve.parts())
        parts.push_back({{"from", rounded(part.from < 1e300 ? part.from : INFINITY)},
                         {"triangles", rounded(part.base.triangles)},
                         {"per_accuracy", part.slope.triangles},
                         {"texels", rounded(part.base.texels)}});
    Json line = nullptr;  // too few forms
    if (of.line.r_squared > 0)
        line = {{"triangles", rounded(of.line.base)}, {"per_accuracy", rounded(of.line.slope)}, {"r_squared", of.line.r_squared}};
    const Json json = {{"file", of.file}, {"node", of.index}, {"name", of.node}, {"diameter_m", rounded(of.diameter_m)},
                       {"forms", points}, {"curve", parts},   {"line", line}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string curve_table(const ModelCurve& of) {
    std::string out = fmt::format("{}, node {} ({}): {:.4g} m across\n", of.file, of.index, of.node, of.diameter_m);
    if (!of.curve.known()) return out + "It has no curve: it has no size, or something below it has none.\n";
    out += "    accuracy up to   triangles   each accuracy more\n";
    const auto parts = of.curve.parts();
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const model::CurvePart& part = parts[i];
        const double to = i + 1 < parts.size() ? parts[i + 1].from : of.curve.end();
        const double begins =
            part.slope.triangles != 0 ? part.base.triangles + part.slope.triangles * part.from : part.base.triangles;
        out += fmt::format("{:>18}{:>12.0f}{:>21.3f}\n", to < 1e300 ? fmt::format("{:.2f}", to) : "exact", begins,
                           part.slope.triangles);
    }
    const double tenth = std::floor(of.curve.at(of.curve.end()).triangles / 10);
    if (const double bought = model::accuracy_within(of.curve, triangles_alone, triangles_alone, tenth); bought > 0)
        out += bought < 1e300 ? fmt::format("{:.0f} triangles, a tenth, are sure to buy an accuracy of {:.2f}\n", tenth, bought)
                              : fmt::format("{:.0f} triangles, a tenth, show it exactly\n", tenth);
    if (of.line.r_squared > 0)
        out += fmt::format("line through {} forms that are not exact: {:.1f} + {:.2f} triangles a unit of accuracy, R^2 {:.4f}\n",
                           inexact(of.points), of.line.base, of.line.slope, of.line.r_squared);
    return out;
}

std::string curve_svg(const ModelCurve& of) {
    constexpr double width = 720, height = 420;
    const report::PlotArea area{64, 40, width - 24, height - 44};
    const double last = last_accuracy(of);
    double max_takes = of.curve.at(last).triangles;
    for (const model::CurvePoint& p : of.points)
        if (std::isfinite(p.accuracy)) max_takes = std::max(max_takes, p.takes.triangles);
    const report::Scale x{0, report::nice_ceiling(last), area.left, area.right, false};
    const report::Scale y{0, report::nice_ceiling(std::max(1.0, max_takes)), area.bottom, area.top, false};
    const std::string title = fmt::format("What accuracy takes: {}", report::escaped(of.node));
    std::string out = report::open_chart(width, height, title);
    out += report::y_axis(area, y, report::nice_ticks(0, y.to, 6), "triangles") +
           report::x_axis(area, x, report::nice_ticks(0, x.to, 8), "");
    out += report::text_at(area.right, height - 8, "note end", "relative accuracy: size over error");
    out += report::text_at(area.left, 22, "title", title);
    if (of.line.r_squared > 0) {
        double from = last, to = 0;  // where it was fitted
        for (const model::CurvePoint& p : of.points) {
            if (!std::isfinite(p.accuracy)) continue;
            from = std::min(from, p.accuracy);
            to = std::max(to, p.accuracy);
        }
        const auto on_line = [&](double accuracy) { return y(std::max(0.0, of.line.base + of.line.slope * accuracy)); };
        out += report::line_between(x(from), on_line(from), x(to), on_line(to), "budget");
        out += report::text_at(area.right - 6, 22, "note end",
                               fmt::format("dashed: least-squares line, R² {:.4f}", of.line.r_squared));
    }
    std::vector<report::Point> steps;
    const auto parts = of.curve.parts();
    for (std::size_t i = 0; i < parts.size() && parts[i].from <= last; ++i) {
        const double to = std::min(last, i + 1 < parts.size() ? parts[i + 1].from : last), from = i == 0 ? 0 : parts[i].from;
        steps.push_back({x(from), y(of.curve.at(from).triangles), i == 0});
        steps.push_back({x(to), y(of.curve.at(std::nextafter(to, 0.0)).triangles), false});
    }
    if (steps.empty() && of.curve.known()) {  // full detail alone
        steps.push_back({x(0), y(of.curve.at(last).triangles), true});
        steps.push_back({x(last), y(of.curve.at(last).triangles), false});
    }
    out += report::polyline(steps, "line");
    for (const model::CurvePoint& p : of.points)
        if (std::isfinite(p.accuracy))
            out += fmt::format("<circle class=\"dot k0\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3.5\"/>", x(p.accuracy),
                               y(p.takes.triangles));
    return report::stand_alone(out + report::close_chart(), false);
}

}  // namespace surefoot::accuracy
