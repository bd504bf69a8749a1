// Draws bird's-eye views.
#include "tools/cache_study/birds_eye.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::cache_study {

namespace {

using Ink = std::array<std::uint8_t, 3>;
constexpr Ink red{208, 40, 36}, green{48, 160, 64}, white{250, 250, 250}, black{16, 16, 16}, grey{168, 168, 168},
    blue{30, 90, 230}, line_ink{90, 90, 90}, paper{220, 220, 220};
constexpr int margin_px = 4, eye_px = 3;
constexpr double inner_share = 0.28;  ///< left free on each side of a small square

Ink ink_of(cache::BoxUse use) {
    switch (use) {
        case cache::BoxUse::fresh:
            return red;
        case cache::BoxUse::combined:
            return green;
        case cache::BoxUse::reused:
            return white;
        case cache::BoxUse::not_replaceable:
            return black;
        case cache::BoxUse::unused:
            break;
    }
    return grey;
}

/// Pixels of a view: x0 <= x < x1, y0 <= y < y1.
struct Area {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

/// Draws on one view.
class Canvas {
public:
    explicit Canvas(const Box& bounds) : low_(bounds.min.x, bounds.min.z) {
        const double side = std::max({bounds.max.x - bounds.min.x, bounds.max.z - bounds.min.z, 1e-9});
        px_a_m_ = (static_cast<double>(view_px) - 2 * margin_px) / side;
        rgba_.assign(std::size_t{4} * view_px * view_px, 255);
        fill({0, 0, static_cast<int>(view_px), static_cast<int>(view_px)}, grey);
    }
    [[nodiscard]] Area area_of(const Box& box) const {
        return {place(box.min.x, low_.x), place(box.min.z, low_.y), place(box.max.x, low_.x), place(box.max.z, low_.y)};
    }
    void fill(const Area& area, const Ink& ink) {
        const int side = static_cast<int>(view_px);
        for (int y = std::max(0, area.y0); y < std::min(side, area.y1); ++y)
            for (int x = std::max(0, area.x0); x < std::min(side, area.x1); ++x) {
                const auto at = 4 * (static_cast<std::size_t>(y) * view_px + static_cast<std::size_t>(x));
                std::copy(ink.begin(), ink.end(), rgba_.begin() + static_cast<std::ptrdiff_t>(at));
            }
    }
    void frame(const Area& area, const Ink& ink) {
        fill({area.x0, area.y0, area.x1, area.y0 + 1}, ink);
        fill({area.x0, area.y1 - 1, area.x1, area.y1}, ink);
        fill({area.x0, area.y0, area.x0 + 1, area.y1}, ink);
        fill({area.x1 - 1, area.y0, area.x1, area.y1}, ink);
    }
    void mark(const dvec3& eye) {
        const int x = place(eye.x, low_.x), y = place(eye.z, low_.y);
        fill({x - eye_px, y - eye_px, x + eye_px, y + eye_px}, blue);
    }
    BirdsEyeView take() { return std::move(rgba_); }

private:
    [[nodiscard]] int place(double at, double low) const {
        const double px = std::clamp((at - low) * px_a_m_, -1e6, 1e6);
        return margin_px + static_cast<int>(std::lround(px));
    }

    dvec2 low_;
    double px_a_m_ = 1;
    BirdsEyeView rgba_;
};

Area inner(const Area& area) {
    const int x = static_cast<int>(inner_share * (area.x1 - area.x0)), y = static_cast<int>(inner_share * (area.y1 - area.y0));
    return {area.x0 + x, area.y0 + y, area.x1 - x, area.y1 - y};
}

}  // namespace

BirdsEyeView birds_eye_view(const cache::BoxTree& tree, const cache::CachePlan& plan, const Box& bounds, const dvec3& eye) {
    Canvas canvas(bounds);
    std::vector<cache::BoxDraw> draws = plan.draws;  // the highest last, as a bird sees them
    std::stable_sort(draws.begin(), draws.end(), [&](const cache::BoxDraw& a, const cache::BoxDraw& b) {
        return tree.boxes[a.box].box.max.y < tree.boxes[b.box].box.max.y;
    });
    std::vector<bool> drawn(tree.boxes.size());
    for (const cache::BoxDraw& draw : draws) {
        const Area area = canvas.area_of(tree.boxes[draw.box].box);
        canvas.fill(area, ink_of(plan.uses[draw.box]));
        canvas.frame(area, line_ink);
        drawn[draw.box] = true;
    }
    for (const cache::Refresh& refresh : plan.refreshes)
        if (!drawn[refresh.box]) canvas.fill(inner(canvas.area_of(tree.boxes[refresh.box].box)), ink_of(plan.uses[refresh.box]));
    canvas.mark(eye);
    return canvas.take();
}

void add_view(ViewSheet& sheet, const cache::BoxTree& tree, const cache::CachePlan& plan, const dvec3& eye) {
    if (sheet.views.size() < max_views) sheet.views.push_back(birds_eye_view(tree, plan, sheet.bounds, eye));
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
