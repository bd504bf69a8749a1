// Leaves are drawn one by one; clusters are put together from their children's pictures, a face after the other.
#include "render/bake/boxes.hpp"

#include "render/bake/box_light.hpp"
#include "render/bake/level_coverage.hpp"
#include "render/bake/opaque_boxes.hpp"
#include "render/model/loss_groups.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>

namespace surefoot::bake {

namespace {

using model::Index;
using model::Node;

constexpr float clearly = 0.9F;  // of another form's loss for the same time: else the box is not worth its place in the file

std::vector<Index> wanted_leaves(const model::Model& model, const BoxRequest& request) {
    std::vector<Index> leaves;
    for (Index n = 0; n < model.nodes.size(); ++n)
        if (model.nodes[n].child_count == 0 && request.wanted[n]) leaves.push_back(n);
    return leaves;
}

/// Whether a node's box covers about as much as full detail does, or nothing else is coarse.
bool box_covers(const model::Model& model, const Node& node, const std::vector<float>& covered) {
    if (covered.empty()) return true;
    const auto share = static_cast<double>(covered[node.first_rep]);
    if (share >= min_covered && share <= max_covered) return true;
    const Index next = node.first_rep + 1;
    return node.rep_count < 2 || model::is_full_detail(node, next, model.reps[next].error_m);
}

}  // namespace

std::size_t box_steps(const model::Model& model, const BoxRequest& request) {
    return wanted_leaves(model, request).size() + box_faces * PictureTree(model).clusters();
}

std::vector<BoxForm> capture_boxes(const model::Model& model, const BoxRequest& request, const ForAll& for_all,
                                   const std::function<bool()>& step) {
    PictureTree tree(model);
    const std::uint32_t samples = 2 * request.pixels;
    std::vector<BoxForm> boxes(model.nodes.size());
    for (Index n = 0; n < model.nodes.size(); ++n) {
        boxes[n].box = model.nodes[n].box;
        boxes[n].textured = request.textured;
        boxes[n].pixels = request.pixels;
        boxes[n].lit = request.textured && !model.sun_seen.empty();
    }
    std::atomic<bool> go{true};
    const std::vector<Index> leaves = wanted_leaves(model, request);
    std::optional<BoxLight> light;
    if (request.textured && !model.sun_seen.empty()) light.emplace(model);
    const auto capture = [&](Index n, std::uint32_t face, const FormPicture& seen) {
        std::vector<FaceSample> shown;
        FaceCapture& to = boxes[n].faces[face];
        to = capture_face(seen, model.nodes[n].box, face, request.pixels, light ? &shown : nullptr);
        if (light && to.covered > 0) light->take_from(to, {seen, shown, request.pixels});
    };
    for_all(leaves.size(), [&](std::size_t i) {
        if (!go) return;
        const Node& node = model.nodes[leaves[i]];
        FormPicture seen;
        seen.owner = leaves[i];
        seen.keeps_sources = light.has_value();
        for (std::uint32_t face = 0; face < box_faces; ++face) {
            seen.clear(view_of(node.box, direction_of_face(face), tree.middle(), samples), request.textured);
            draw_form(model, model.reps[node.first_rep + node.rep_count - 1], seen);
            capture(leaves[i], face, seen);
        }
        if (!step()) go = false;
    });
    for (std::uint32_t face = 0; face < box_faces && go; ++face) {
        const auto use = [&](Index n, const FormPicture& seen) {
            if (request.wanted[n]) capture(n, face, seen);
            return step();
        };
        if (!tree.look({direction_of_face(face), samples, request.textured, light.has_value()}, for_all, use)) go = false;
    }
    for (BoxForm& box : boxes) {
        // A box without one of its sides would be a hole from there.
        if (!std::all_of(box.faces.begin(), box.faces.end(), [](const FaceCapture& f) { return f.whole; })) box.faces = {};
        for (FaceCapture& face : box.faces)
            if (!box.textured) face.rgba = {};
    }
    return go ? std::move(boxes) : std::vector<BoxForm>();
}

PlacedBoxes::PlacedBoxes(std::vector<BoxForm> boxes, Index proxy, model::Model& model)
    : model_(model),
      boxes_(std::move(boxes)),
      proxy_(proxy),
      meshes_(std::move(model.reps)),
      vertices_(model.vertices.size()),
      indices_(model.indices.size()),
      parts_(model.parts.size()),
      placements_(model.placements.size()),
      materials_(model.materials.size()),
      textures_(model.textures.size()),
      texels_(model.texels.size()) {
    for (const Node& node : model.nodes) ranges_.emplace_back(node.first_rep, node.rep_count);
    insert();
}

/// That of a box without a picture. What sees no sky is drawn without the sun.
Index PlacedBoxes::material_of(const model::Representation& coarsest) {
    constexpr model::EffectMask measured = model::effect_sun | model::effect_openness;
    if ((coarsest.effects & measured) != model::effect_openness) return proxy_;
    if (in_rooms_ == model::none) {
        in_rooms_ = static_cast<Index>(model_.materials.size());
        model::Material material = model_.materials[proxy_];
        material.effects &= ~model::EffectMask{model::effect_sun};
        model_.materials.push_back(material);
    }
    return in_rooms_;
}

void PlacedBoxes::insert() {
    model_.reps.clear();
    in_rooms_ = model::none;
    for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
        Node& node = model_.nodes[n];
        const auto first = static_cast<Index>(model_.reps.size());
        const model::Representation& coarsest = meshes_[ranges_[n].first];
        if (boxes_[n].shown_faces() > 0) {
            const Index material = boxes_[n].textured ? proxy_ : material_of(coarsest);
            emit_box(boxes_[n], material, model_, model_.placements[coarsest.placement].motion);
        }
        const auto from = meshes_.begin() + ranges_[n].first;
        model_.reps.insert(model_.reps.end(), from, from + ranges_[n].second);
        node.first_rep = first;
        node.rep_count = static_cast<std::uint32_t>(model_.reps.size()) - first;
    }
}

/// Compared at the octaves of the sizes for which losses are measured. A form is best for some price of a loss, if it lies on the
/// lower convex hull of time and loss. The box has to lie a tenth below the hull of the others, or to be the cheapest form.
bool PlacedBoxes::is_best_somewhere(const Node& node, const model::CostModel& costs) const {
    const vec3 half(node.box.half());
    const float size_m = std::sqrt(2.0F * (half.x * half.y + half.y * half.z + half.z * half.x));
    // Halves are exact.
    for (float size_px = model::loss_sizes_px.front(); size_px >= model::loss_sizes_px.back();  // NOLINT(clang-analyzer-*)
         size_px *= 0.5F) {
        const float px_per_m = size_px / std::max(size_m, 1e-6F);
        struct Point {
            float cost, loss;
        };
        const auto point = [&](Index r) {
            const model::Representation& rep = model_.reps[r];
            const float pixels = (rep.area_m2[0] + rep.area_m2[1] + rep.area_m2[2]) / 3 * px_per_m * px_per_m;
            const model::ItemCost cost = costs.item(static_cast<float>(rep.triangles), pixels, costs.grid_for(rep.effects));
            return Point{costs.combine.frame_us(cost.submit_us, cost.raster_us), model::loss_at(model_.losses[r], size_px)};
        };
        const Point box = point(node.first_rep);
        bool best = true;
        for (Index a = node.first_rep + 1; a < node.first_rep + node.rep_count && best; ++a) {
            const Point cheap = point(a);
            if (cheap.cost > box.cost) continue;
            if (clearly * cheap.loss <= box.loss) best = false;
            for (Index b = node.first_rep + 1; b < node.first_rep + node.rep_count && best; ++b) {
                const Point dear = point(b);
                if (dear.cost <= box.cost || dear.loss >= cheap.loss) continue;
                const float at = (box.cost - cheap.cost) / (dear.cost - cheap.cost);
                best = box.loss < clearly * (cheap.loss + at * (dear.loss - cheap.loss));
            }
        }
        if (best) return true;
    }
    return false;
}

std::size_t PlacedBoxes::drop_idle(const model::CostModel& costs, const std::vector<float>& covered) {
    const model::LossGroups groups(model_);
    std::vector<model::PictureLoss> losses;
    std::vector<model::LossOfGroup> group_losses;
    std::size_t left = 0;
    for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
        const Node& node = model_.nodes[n];
        const bool had = boxes_[n].shown_faces() > 0;
        const bool whole = node.parent == model::none;  // from far off all of the scene is one picture
        const bool keeps = had && (whole || box_covers(model_, node, covered)) && is_best_somewhere(node, costs);
        if (had && !keeps) boxes_[n].faces = {};
        left += keeps ? 1 : 0;
        for (Index r = node.first_rep + (had && !keeps ? 1 : 0); r < node.first_rep + node.rep_count; ++r)
            losses.push_back(model_.losses[r]);
        if (model_.group_losses.empty()) continue;
        const auto cluster = static_cast<Index>(n);
        const auto end = model_.group_losses.begin() + static_cast<std::ptrdiff_t>(groups.first(cluster + 1));
        const std::size_t kept = (node.rep_count - (had && !keeps ? 1U : 0U)) * std::size_t{groups.count(cluster)};
        group_losses.insert(group_losses.end(), end - static_cast<std::ptrdiff_t>(kept), end);
    }
    model_.vertices.resize(vertices_);
    if (!model_.sun_seen.empty()) model_.sun_seen.resize(vertices_);
    if (!model_.lamp_light.empty()) model_.lamp_light.resize(vertices_);
    model_.indices.resize(indices_);
    model_.parts.resize(parts_);
    model_.placements.resize(placements_);
    model_.materials.resize(materials_);
    model_.textures.resize(textures_);
    model_.texels.resize(texels_);
    insert();
    model_.losses = std::move(losses);
    model_.group_losses = std::move(group_losses);
    drop_needless_masks(model_);
    return left;
}

}  // namespace surefoot::bake
