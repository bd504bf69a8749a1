// How alike the members of each group are: groups of the same things say more as a whole (Gestalt: the law of similarity).
#pragma once

#include <vector>

#include "render/model/model.hpp"

namespace surefoot::prepare {

/// By node, 0..1: 0 where no two children are of one kind, 1 where all are; between, by those of the most frequent kind. A leaf's
/// kind is the mesh of its full detail. A group is of its members' kind if more than half of them are of one, else of its own.
/// Leaves have 0. Source: the law of similarity in Maciel 1994, 3.4.3 and figure 3.9; 3.3.2 asks for it in the benefit and gives
/// no formula.
std::vector<float> alike_members(const model::Model& model);

}  // namespace surefoot::prepare
