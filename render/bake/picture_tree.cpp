// Clusters in tasks of some, whose pictures are held only until their parent's is made; then the others by height.
#include "render/bake/picture_tree.hpp"

#include <algorithm>
#include <atomic>

namespace surefoot::bake {

namespace {

using model::Index;
using model::Node;
using model::none;

constexpr std::uint32_t clusters_a_task = 128;  // their pictures are made one after the other, and few are held

}  // namespace

PictureTree::PictureTree(const model::Model& model)
    : model_(model), middle_(model.nodes.empty() ? dvec3(0.0) : model.nodes[0].box.centre()), pictures_(model.nodes.size()) {
    std::vector<std::uint32_t> below(model.nodes.size(), 0), height(model.nodes.size(), 0);
    for (std::size_t n = model.nodes.size(); n-- > 0;) {  // children come after their parents
        const Node& node = model.nodes[n];
        if (node.child_count == 0) continue;
        ++clusters_;
        ++below[n];
        if (below[n] > clusters_a_task) {
            if (upper_.size() <= height[n]) upper_.resize(height[n] + 1);
            upper_[height[n]].push_back(static_cast<Index>(n));
        }
        if (node.parent == none) continue;
        below[node.parent] += below[n];
        if (below[n] > clusters_a_task) height[node.parent] = std::max(height[node.parent], height[n] + 1);
    }
    for (std::size_t n = 0; n < model.nodes.size(); ++n) {
        const Node& node = model.nodes[n];
        const bool root = node.parent == none || below[node.parent] > clusters_a_task;
        if (node.child_count > 0 && root && below[n] <= clusters_a_task) task_roots_.push_back(static_cast<Index>(n));
    }
}

/// Children first.
std::vector<Index> PictureTree::clusters_below(Index root) const {
    std::vector<Index> open{root}, found;
    while (!open.empty()) {
        const Index at = open.back();
        const Node& node = model_.nodes[at];
        open.pop_back();
        if (node.child_count == 0) continue;
        found.push_back(at);
        for (Index c = node.first_child; c < node.first_child + node.child_count; ++c) open.push_back(c);
    }
    std::reverse(found.begin(), found.end());
    return found;
}

void PictureTree::draw(Index index, const View& view) {
    const Node& node = model_.nodes[index];
    FormPicture& full = pictures_[index];
    full.keeps_sources = view.keeps_sources;
    full.clear(view_of(node.box, view.from, middle_, view.pixels), view.lit);
    for (Index c = node.first_child; c < node.first_child + node.child_count; ++c) {
        const Node& child = model_.nodes[c];
        full.owner = c;
        if (child.child_count == 0) draw_form(model_, model_.reps[child.first_rep + child.rep_count - 1], full);
        if (child.child_count > 0) draw_picture(pictures_[c], full);
        pictures_[c] = {};
    }
}

bool PictureTree::look(const View& view, const ForAll& for_all, const Use& use) {
    std::atomic<bool> go{true};
    const auto draw_all = [&](const std::vector<Index>& nodes) {
        for (const Index node : nodes) {
            if (!go) return;
            draw(node, view);
            if (!use(node, pictures_[node])) go = false;
        }
    };
    for_all(task_roots_.size(), [&](std::size_t i) { draw_all(clusters_below(task_roots_[i])); });
    for (const std::vector<Index>& same : upper_) for_all(same.size(), [&](std::size_t i) { draw_all({same[i]}); });
    for (FormPicture& picture : pictures_) picture = {};
    return go;
}

}  // namespace surefoot::bake
