// Accuracy curves of a model's nodes: what each accuracy takes, from the forms that it has. Off line.
#pragma once

#include <vector>

#include "render/model/curve.hpp"
#include "render/model/model.hpp"

namespace surefoot::model {

/// Relative accuracies: the node's diameter over the error of what is drawn for it. Of resources: triangles and texels of its
/// textures. The group's is the sum of its children's, whose accuracies grow by the ratio of diameters; its own forms compete
/// with them. Ranges in which a form is valid are left out of account. Unknown below nodes without a size.
/// `weights`: by which forms compete.
Curve relative_curve(const Model& model, Index node, const Resources& weights);

/// The forms of a node, by their relative accuracy.
std::vector<CurvePoint> form_points(const Model& model, Index node);

/// The diagonal of a node's box, m: the size that relative accuracies are of.
double diameter_of(const Node& node);

}  // namespace surefoot::model
