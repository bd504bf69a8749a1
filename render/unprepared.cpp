// The last cut's forms at another pose. A walk down the tree, from the root to what was shown, or to the coarse levels.
#include "render/unprepared.hpp"

#include <algorithm>

#include "render/model/form_range.hpp"
#include "render/model/pixels.hpp"
#include "render/select/select.hpp"

namespace surefoot {

namespace {

constexpr std::uint32_t coarse_nodes = 256;   // a few hundred small meshes, whatever the model's size
constexpr std::size_t max_items = 1U << 13U;  // more would take milliseconds to plan
constexpr std::uint32_t no_group = ~0U;

/// The coarsest representation that is valid with the eye anywhere; validate() has made sure that there is one.
model::Index everywhere_rep(const model::Model& model, model::Index node) {
    const model::Node& n = model.nodes[node];
    for (model::Index r = n.first_rep; r < n.first_rep + n.rep_count; ++r) {
        if (!model.reps[r].everywhere) continue;
        return model::is_full_detail(n, r, model.reps[r].error_m) ? n.first_rep + n.rep_count - 1 : r;
    }
    return n.first_rep;
}

/// An antichain that covers the model with about coarse_nodes nodes: open the largest box first.
std::vector<model::Index> coarse_cover(const model::Model& model) {
    std::vector<model::Index> open{0};
    const auto smaller = [&](model::Index a, model::Index b) {
        const double da = model.nodes[a].child_count == 0 ? -1 : model.nodes[a].box.diagonal();
        const double db = model.nodes[b].child_count == 0 ? -1 : model.nodes[b].box.diagonal();
        return da != db ? da < db : a > b;
    };
    while (true) {
        std::pop_heap(open.begin(), open.end(), smaller);
        const model::Node& node = model.nodes[open.back()];
        if (node.child_count == 0 || open.size() + node.child_count > coarse_nodes) {
            return open;  // the largest does not fit: stop rather than skip on
        }
        open.pop_back();
        for (std::uint32_t c = 0; c < node.child_count; ++c) {
            open.push_back(node.first_child + c);
            std::push_heap(open.begin(), open.end(), smaller);
        }
    }
}

}  // namespace

struct Unprepared::View {
    const model::Frustum& frustum;
    const dvec3& eye;
    const model::ViewScale& scale;
    const model::ItemCosts& costs;
    model::EffectMask hidden;
};

void Unprepared::reserve(const model::Model& model) {
    model_ = &model;
    level_.assign(model.nodes.size(), Level::below);
    for (const model::Index node : coarse_cover(model)) {
        level_[node] = Level::coarse;
        for (model::Index n = model.nodes[node].parent; n != model::none; n = model.nodes[n].parent) level_[n] = Level::above;
    }
    const std::size_t places = std::clamp<std::size_t>(2 * model.nodes.size(), 2 * coarse_nodes, max_items);
    stack_.reserve(places);
    groups_.reserve(places);
    items_.reserve(places);
}

std::size_t Unprepared::capacity() const { return items_.capacity(); }

UnpreparedItem Unprepared::item_of(model::Index node, model::Index rep, const View& view) const {
    const model::Node& n = model_->nodes[node];
    const model::Representation& r = model_->reps[rep];
    UnpreparedItem item;
    item.item = {node, rep};
    float rasterised = 0;
    item.cost = view.costs.of(rep, n.box, view.eye, view.scale, rasterised, view.hidden);
    item.pixels = std::min(model::rasterised_pixels(r, n.box, view.eye, view.scale), view.scale.viewport_pixels);
    item.error_rad = model::error_rad(r, static_cast<float>(n.box.distance(view.eye)));
    item.floor = rep == everywhere_rep(*model_, node) && (n.child_count > 0 || rep + 1 < n.first_rep + n.rep_count);
    return item;
}

/// Returns its number; no_group: there is no room.
std::uint32_t Unprepared::begin_group(model::Index node, const View& view) {
    if (groups_.size() == groups_.capacity()) return no_group;
    groups_.push_back({.first = static_cast<std::uint32_t>(items_.size()), .count = 0, .cost = {}, .stand_in = {}});
    groups_.back().stand_in = item_of(node, everywhere_rep(*model_, node), view);
    return static_cast<std::uint32_t>(groups_.size() - 1);
}

/// An item without a group has one of its own. False: there is no room.
bool Unprepared::add(model::Index node, model::Index rep, std::uint32_t group, const View& view) {
    if (items_.size() == items_.capacity()) return false;
    if (group == no_group) {
        group = begin_group(node, view);
        if (group == no_group) return false;
    }
    items_.push_back(item_of(node, rep, view));
    groups_[group].cost += items_.back().cost;
    ++groups_[group].count;
    return true;
}

/// Depth first, so that what lies below one coarse node stays together. False: there is no room.
bool Unprepared::walk(std::span<const model::Index> shown, const View& view) {
    stack_.clear();
    groups_.clear();
    items_.clear();
    stack_.push_back({0, no_group});
    while (!stack_.empty()) {
        Step step = stack_.back();
        stack_.pop_back();
        const model::Node& node = model_->nodes[step.node];
        if (!model::visible(view.frustum, node.box)) continue;
        const model::Index form = shown.empty() ? model::none : shown[step.node];
        const bool opened = form == select::SelectState::opened || (form == model::none && level_[step.node] == Level::above);
        if (!opened) {
            const auto nearest_m = static_cast<float>(node.box.distance(view.eye));
            const bool keeps = form != model::none && model::legal(model_->reps[form], nearest_m);
            if (!add(step.node, keeps ? form : everywhere_rep(*model_, step.node), step.group, view)) return false;
            continue;
        }
        if (level_[step.node] == Level::coarse) {
            step.group = begin_group(step.node, view);
            if (step.group == no_group) return false;
        }
        if (stack_.size() + node.child_count > stack_.capacity()) return false;
        for (std::uint32_t c = 0; c < node.child_count; ++c) stack_.push_back({node.first_child + c, step.group});
    }
    return true;
}

void Unprepared::plan(std::span<const model::Index> shown, const model::Frustum& frustum, const Pose& pose,
                      const model::ViewScale& scale, const model::ItemCosts& costs, model::EffectMask hidden) {
    const View view{frustum, pose.position, scale, costs, hidden};
    if (!walk(shown, view)) walk({}, view);
    std::sort(groups_.begin(), groups_.end(), [](const UnpreparedGroup& a, const UnpreparedGroup& b) {
        return a.stand_in.pixels != b.stand_in.pixels ? a.stand_in.pixels > b.stand_in.pixels : a.first < b.first;
    });
}

}  // namespace surefoot
