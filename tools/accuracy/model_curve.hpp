// The accuracy curve of a model or of one of its nodes: what each relative accuracy takes, as figures and as a chart.
#pragma once

#include <string>
#include <vector>

#include "render/model/model_curves.hpp"
#include "rt/base/result.hpp"

namespace surefoot::accuracy {

/// A node's curve, the points of its own forms, and the least-squares line through those that are not exact, if there
/// are three or more.
struct ModelCurve {
    std::string file, node;  ///< the node's name, or its kind
    model::Index index = 0;
    double diameter_m = 0;
    std::vector<model::CurvePoint> points;
    model::Curve curve;  ///< in triangles
    model::FittedLine line;
};

/// Of the first node whose name contains `name`; empty: the root. Error: there is none.
Result<ModelCurve> find_curve(const std::string& file, const model::Model& model, const std::string& name);

std::string curve_json(const ModelCurve& of);
/// The parts of the curve, a line each, and the fitted line.
std::string curve_table(const ModelCurve& of);
/// Triangles against accuracy: the curve, the points of forms, and the fitted line.
std::string curve_svg(const ModelCurve& of);

}  // namespace surefoot::accuracy
