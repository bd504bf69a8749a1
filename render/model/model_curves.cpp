// Curves from the leaves up, one subtree after the other, so that few of them are held at a time.
#include "render/model/model_curves.hpp"

#include <limits>
#include <set>

namespace surefoot::model {

namespace {

Resources resources_of(const Model& model, const Representation& rep) {
    Resources r;
    r.triangles = rep.triangles;
    std::set<Index> textures;
    for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const Index texture = model.materials[model.parts[p].material].texture;
        if (texture == none || !textures.insert(texture).second) continue;
        r.texels += static_cast<double>(model.textures[texture].width) * model.textures[texture].height;
    }
    return r;
}

}  // namespace

double diameter_of(const Node& node) { return node.box.empty() ? 0.0 : glm::length(node.box.max - node.box.min); }

std::vector<CurvePoint> form_points(const Model& model, Index n) {
    const Node& node = model.nodes[n];
    const double diameter_m = diameter_of(node);
    std::vector<CurvePoint> points;
    for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
        const Representation& rep = model.reps[r];
        const double error_m = is_full_detail(node, r, rep.error_m) ? 0.0 : static_cast<double>(rep.error_m);
        points.push_back(
            {error_m > 0 ? diameter_m / error_m : std::numeric_limits<double>::infinity(), resources_of(model, rep)});
    }
    return points;
}

Curve relative_curve(const Model& model, Index root, const Resources& weights) {
    struct Open {
        Index node;
        std::uint32_t next = 0;  ///< child
        Curve children;
    };
    std::vector<Open> open{{root, 0, {}}};
    Curve done;
    while (true) {
        Open& at = open.back();
        const Node& node = model.nodes[at.node];
        if (at.next > 0) {  // `done` is the curve of the child before
            const double child_m = diameter_of(model.nodes[node.first_child + at.next - 1]);
            const Curve child = child_m > 0 ? done.scaled(diameter_of(node) / child_m) : Curve();
            at.children = at.next == 1 ? child : sum_of(at.children, child, weights);
        }
        if (at.next < node.child_count) {
            const Index child = node.first_child + at.next++;
            open.push_back({child, 0, {}});
            continue;
        }
        done = cheaper_of(at.children, curve_of_forms(form_points(model, at.node), weights), weights);
        open.pop_back();
        if (open.empty()) return done;
    }
}

}  // namespace surefoot::model
