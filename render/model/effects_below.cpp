// Unions and sums from the leaves up.
#include "render/model/effects_below.hpp"

#include <algorithm>

namespace surefoot::model {

namespace {

void add_full_detail(const Model& model, Index leaf, RegionEffects& to) {
    const Node& node = model.nodes[leaf];
    const Representation& full = model.reps[node.first_rep + node.rep_count - 1];
    to.full |= full.effects;
    to.leaves = 1;
    to.largest = leaf;
    for (Index p = full.first_part; p < full.first_part + full.part_count; ++p) {
        const std::uint64_t triangles = model.parts[p].index_count / 3;
        to.triangles += triangles;
        for (std::size_t e = 0; e < to.with_effect.size(); ++e)
            if ((model.materials[model.parts[p].material].effects >> e & 1U) != 0) to.with_effect[e] += triangles;
    }
}

}  // namespace

std::vector<RegionEffects> effects_below(const Model& model) {
    std::vector<RegionEffects> out(model.nodes.size());
    for (auto n = static_cast<Index>(model.nodes.size()); n-- > 0;) {
        const Node& node = model.nodes[n];
        RegionEffects& here = out[n];
        const bool is_leaf = node.child_count == 0;
        for (Index r = node.first_rep; r + (is_leaf ? 1U : 0U) < node.first_rep + node.rep_count; ++r)
            here.coarse |= model.reps[r].effects;
        if (is_leaf) add_full_detail(model, n, here);
        for (Index c = node.first_child; c < node.first_child + node.child_count; ++c) {
            const RegionEffects& below = out[c];
            here.full |= below.full;
            here.coarse |= below.coarse;
            here.triangles += below.triangles;
            here.leaves += below.leaves;
            for (std::size_t e = 0; e < here.with_effect.size(); ++e) here.with_effect[e] += below.with_effect[e];
            const bool larger =
                here.largest == none || model.nodes[below.largest].triangles > model.nodes[here.largest].triangles;
            if (larger) here.largest = below.largest;
        }
    }
    return out;
}

namespace {

/// The root of what stands still: what moves is a tree beside it.
Index root_of_still(const Model& model) {
    if (model.motions.empty()) return 0;
    std::vector<bool> still(model.nodes.size(), false);
    for (std::size_t n = model.nodes.size(); n-- > 0;) {  // children come after their parents
        const Node& node = model.nodes[n];
        if (node.child_count == 0) still[n] = motion_of(model, node) == none;
        for (std::uint32_t c = 0; c < node.child_count; ++c) still[n] = still[n] || still[node.first_child + c];
    }
    Index root = 0;
    while (model.nodes[root].child_count == 2) {
        const Index first = model.nodes[root].first_child;
        if (still[first] == still[first + 1]) break;
        root = still[first] ? first : first + 1;
    }
    return root;
}

}  // namespace

bool has_rooms_apart(const Model& model) {
    if (model.nodes.empty() || (model.called_for() & effect_openness) == 0) return false;
    const Node& root = model.nodes[root_of_still(model)];
    if (root.child_count != 2) return false;
    const std::vector<RegionEffects> below = effects_below(model);
    const RegionEffects &rooms = below[root.first_child], &open = below[root.first_child + 1];
    return ((rooms.full | rooms.coarse) & effect_sun) == 0 && (rooms.full & effect_openness) != 0 &&
           (open.full & effect_sun) != 0;
}

std::vector<Index> main_regions(const Model& model, std::size_t max_count) {
    std::vector<Index> out;
    if (model.nodes.empty()) return out;
    out.push_back(0);
    const auto more = [&](Index a, Index b) {
        const std::uint64_t of_a = model.nodes[a].triangles, of_b = model.nodes[b].triangles;
        return of_a != of_b ? of_a > of_b : a < b;
    };
    while (true) {
        const auto parent = std::find_if(out.begin(), out.end(), [&](Index n) {
            const std::uint32_t children = model.nodes[n].child_count;
            return children > 0 && out.size() - 1 + children <= max_count;
        });
        if (parent == out.end()) return out;
        const Node& node = model.nodes[*parent];
        out.erase(parent);
        for (std::uint32_t c = 0; c < node.child_count; ++c) out.push_back(node.first_child + c);
        std::sort(out.begin(), out.end(), more);
    }
}

}  // namespace surefoot::model
