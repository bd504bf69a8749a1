// Views of frames, on one sheet.
#include "tools/cache_study/view_sheet.hpp"

#include <algorithm>
#include <array>

#include "render/cache/birds_eye.hpp"

namespace surefoot::cache_study {

namespace {

constexpr std::array<std::uint8_t, 3> paper{220, 220, 220};

std::vector<cache::SeenBox> seen_boxes(const cache::BoxTree& tree, const cache::CachePlan& plan) {
    std::vector<cache::SeenBox> seen;
    std::vector<bool> drawn(tree.boxes.size());
    for (const cache::BoxDraw& draw : plan.draws) {
        seen.push_back({tree.boxes[draw.box].box, plan.uses[draw.box], true});
        drawn[draw.box] = true;
    }
    for (const cache::Refresh& refresh : plan.refreshes)
        if (!drawn[refresh.box]) seen.push_back({tree.boxes[refresh.box].box, plan.uses[refresh.box], false});
    return seen;
}

}  // namespace

void add_view(ViewSheet& sheet, const cache::BoxTree& tree, const cache::CachePlan& plan, const dvec3& eye) {
    if (sheet.views.size() < max_views)
        sheet.views.push_back(cache::birds_eye_view(seen_boxes(tree, plan), sheet.bounds, eye, view_px));
}

SheetPicture picture_of_sheet(const ViewSheet& sheet) {
    SheetPicture picture;
    if (sheet.views.empty()) return picture;
    const std::size_t columns = std::min(views_a_row, sheet.views.size());
    const std::size_t rows = (sheet.views.size() + views_a_row - 1) / views_a_row, pitch = view_px + view_gap_px;
    picture.width = static_cast<std::uint32_t>(columns * pitch + view_gap_px);
    picture.height = static_cast<std::uint32_t>(rows * pitch + view_gap_px);
    picture.rgba.resize(std::size_t{4} * picture.width * picture.height, 255);
    for (std::size_t i = 0; i < picture.rgba.size(); i += 4)
        std::copy(paper.begin(), paper.end(), picture.rgba.begin() + static_cast<std::ptrdiff_t>(i));
    for (std::size_t i = 0; i < sheet.views.size(); ++i) {
        const std::size_t left = view_gap_px + i % views_a_row * pitch, top = view_gap_px + i / views_a_row * pitch;
        for (std::size_t y = 0; y < view_px; ++y) {
            const auto from = sheet.views[i].begin() + static_cast<std::ptrdiff_t>(4 * y * view_px);
            const std::size_t to = 4 * ((top + y) * picture.width + left);
            std::copy(from, from + 4 * view_px, picture.rgba.begin() + static_cast<std::ptrdiff_t>(to));
        }
    }
    return picture;
}

}  // namespace surefoot::cache_study
