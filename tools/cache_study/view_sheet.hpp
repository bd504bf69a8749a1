// A sheet of bird's-eye views of a study, as in figure 9 of Schaufler and Stuerzlinger 1996: a picture a frame.
#pragma once

#include <cstdint>
#include <vector>

#include "render/cache/update.hpp"

namespace surefoot::cache_study {

/// Views of a sheet, in rows of five.
constexpr std::size_t max_views = 20, views_a_row = 5;
constexpr std::uint32_t view_px = 208, view_gap_px = 6;

/// A view of cache::birds_eye_view(), view_px on each side.
using BirdsEyeView = std::vector<std::uint8_t>;

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
