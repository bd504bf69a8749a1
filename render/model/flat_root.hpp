// The root of hand-made models: all objects are its children, and it shows the representation of the first.
#pragma once

#include "render/model/model.hpp"

namespace surefoot::model {

/// nodes[0] is the root, nodes[1] and on are objects with box and triangles. Fills in the root and the number of objects.
inline void make_flat_root(Model& model) {
    Node& root = model.nodes[0];
    root.first_child = 1;
    root.child_count = static_cast<std::uint32_t>(model.nodes.size() - 1);
    root.rep_count = 1;
    for (std::size_t i = 1; i < model.nodes.size(); ++i) {
        root.box.grow(model.nodes[i].box);
        root.triangles += model.nodes[i].triangles;
    }
    model.object_count = root.child_count;
}

}  // namespace surefoot::model
