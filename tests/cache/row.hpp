// A row of boxes for tests of the image cache: few, and each in a box of the tree by itself.
#pragma once

#include "render/model/model.hpp"

namespace surefoot::cache {

/// Eight leaves beside each other, 100 m together, each so long.
inline model::Model row_of_leaves(double leaf_m = 10) {
    model::Model model;
    model.nodes.resize(9);
    model.nodes[0].child_count = 8;
    model.nodes[0].first_child = 1;
    for (model::Index n = 1; n < 9; ++n) {
        model.nodes[n].parent = 0;
        model.nodes[n].box = {dvec3(12.5 * n, 0, 0), dvec3(12.5 * n + leaf_m, 10, 10)};
        model.nodes[0].box.grow(model.nodes[n].box);
    }
    return model;
}

}  // namespace surefoot::cache
