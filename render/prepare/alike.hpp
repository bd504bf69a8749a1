// How alike the members of each group are: groups of the same things say more as a whole (Gestalt: the law of similarity).
#pragma once

#include <vector>

#include "render/model/model.hpp"

namespace surefoot::prepare {

/// By node, 0..1: the share of the children that are of the most frequent kind. A leaf's kind is the mesh of its full detail. A
/// group is of its members' kind if more than half of them are of one, else of its own. Leaves have 0, a row of equal dots 1.
/// Source: Maciel 1994, section 3.3.2 and figure 3.6, which gives no formula.
std::vector<float> alike_members(const model::Model& model);

}  // namespace surefoot::prepare
