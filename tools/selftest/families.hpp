// The rows of each family, for the table: one file a family.
#pragma once

#include <span>

#include "tools/selftest/hard.hpp"

namespace surefoot::selftest {

std::span<const Row> origin_rows();
std::span<const Row> depth_rows();
std::span<const Row> near_and_inside_rows();
std::span<const Row> off_axis_rows();
std::span<const Row> behind_others_rows();
std::span<const Row> geometry_rows();
std::span<const Row> transform_rows();
std::span<const Row> polygon_rows();
std::span<const Row> budgets_and_curves_rows();
std::span<const Row> long_runs_rows();
std::span<const Row> files_rows();
std::span<const Row> texture_rows();
std::span<const Row> alpha_edge_rows();
std::span<const Row> walking_rows();
std::span<const Row> riding_rows();

}  // namespace surefoot::selftest
