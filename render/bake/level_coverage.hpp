// Levels that show too little or too much of an object: they grow, or give way.
#pragma once

#include <vector>

#include "render/bake/geometry.hpp"

namespace surefoot::bake {

/// A level covers at least this share of the samples that full detail covers, and at most that one.
constexpr double min_covered = 0.5, max_covered = 2;

/// Levels that cover too little grow: each connected part about its own middle, within the object's box. The growth is part of
/// their error. Takes out of the chain, and returns, those that still cover too little or too much. Without options.looks it
/// does nothing. Source of the growth: Cook, Halstead, Planck & Ryu 2007.
std::vector<Level> take_poor_levels(LodChain& chain, const ChainOptions& options);

/// What covers too little is better than nothing: if full detail is all that is left, the last of the poor levels is put back.
void put_back_poor_level(LodChain& chain, std::vector<Level>&& poor);

}  // namespace surefoot::bake
