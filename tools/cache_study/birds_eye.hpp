// Bird's-eye views of the image cache, as in figure 9 of Schaufler and Stuerzlinger 1996: a picture a frame, on one sheet.
#pragma once

#include <cstdint>
#include <vector>

#include "render/cache/update.hpp"

namespace surefoot::cache_study {

/// Views of a sheet, in rows of five.
constexpr std::size_t max_views = 20, views_a_row = 5;
constexpr std::uint32_t view_px = 208, view_gap_px = 6;

/// A view from above, RGBA8, view_px on each side; row 0 has the smallest z. Red: a new picture of triangles. Green: one combined
/// from the children's. White: reused. Black: not replaceable. Small squares: refreshed below what is drawn. Grey: nothing there.
using BirdsEyeView = std::vector<std::uint8_t>;
BirdsEyeView birds_eye_view(const cache::BoxTree& tree, const cache::CachePlan& plan, const Box& bounds, const dvec3& eye);

/// Views in the order of their frames; at most max_views. They show what is within `bounds`.
struct ViewSheet {
    Box bounds;
    std::vector<BirdsEyeView> views;
};
void add_view(ViewSheet& sheet, const cache::BoxTree& tree, const cache::CachePlan& plan, const dvec3& eye);

/// A whole sheet, RGBA8, row 0 on top.
struct SheetPicture {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgba;
};
SheetPicture picture_of_sheet(const ViewSheet& sheet);

}  // namespace surefoot::cache_study
