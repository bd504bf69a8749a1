// Counts the most frequent kind among the children of each node, children first.
#include "render/prepare/alike.hpp"

#include <algorithm>
#include <cstdint>

namespace surefoot::prepare {

std::vector<float> alike_members(const model::Model& model) {
    constexpr std::uint64_t of_group = 1ULL << 32U;  // kinds of groups are told apart from those of meshes
    std::vector<float> alike(model.nodes.size());
    std::vector<std::uint64_t> kinds(model.nodes.size()), members;
    for (std::size_t n = model.nodes.size(); n-- > 0;) {  // breadth-first order: children stand behind their parent
        const model::Node& node = model.nodes[n];
        if (node.child_count == 0) {
            kinds[n] = model.reps[node.first_rep + node.rep_count - 1].first_part;
            continue;
        }
        members.assign(kinds.begin() + node.first_child, kinds.begin() + node.first_child + node.child_count);
        std::sort(members.begin(), members.end());
        std::size_t max_count = 0;
        kinds[n] = of_group + n;
        for (std::size_t from = 0; from < members.size();) {
            const auto end = std::upper_bound(members.begin() + static_cast<std::ptrdiff_t>(from), members.end(), members[from]);
            const std::size_t count = static_cast<std::size_t>(end - members.begin()) - from;
            if (count > max_count) {
                max_count = count;
                if (2 * count > members.size()) kinds[n] = members[from];
            }
            from += count;
        }
        alike[n] = members.size() > 1 ? static_cast<float>(max_count - 1) / static_cast<float>(members.size() - 1) : 0.0F;
    }
    return alike;
}

}  // namespace surefoot::prepare
