// Draws bird's-eye views.
#include "render/cache/birds_eye.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace surefoot::cache {

namespace {

using Ink = std::array<std::uint8_t, 3>;
constexpr Ink red{208, 40, 36}, green{48, 160, 64}, white{250, 250, 250}, black{16, 16, 16}, grey{168, 168, 168},
    blue{30, 90, 230}, line_ink{90, 90, 90};
constexpr int margin_px = 4, eye_px = 3;
constexpr double inner_share = 0.28;  ///< left free on each side of a small square

Ink ink_of(BoxUse use) {
    switch (use) {
        case BoxUse::fresh:
            return red;
        case BoxUse::combined:
            return green;
        case BoxUse::reused:
            return white;
        case BoxUse::not_replaceable:
            return black;
        case BoxUse::unused:
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
    Canvas(const Box& bounds, std::uint32_t side_px) : low_(bounds.min.x, bounds.min.z), side_px_(static_cast<int>(side_px)) {
        const double side_m = std::max({bounds.max.x - bounds.min.x, bounds.max.z - bounds.min.z, 1e-9});
        px_a_m_ = std::max(1.0, static_cast<double>(side_px) - 2 * margin_px) / side_m;
        rgba_.assign(std::size_t{4} * side_px * side_px, 255);
        fill({0, 0, side_px_, side_px_}, grey);
    }
    [[nodiscard]] Area area_of(const Box& box) const {
        return {place(box.min.x, low_.x), place(box.min.z, low_.y), place(box.max.x, low_.x), place(box.max.z, low_.y)};
    }
    void fill(const Area& area, const Ink& ink) {
        const auto row = static_cast<std::size_t>(side_px_);
        for (int y = std::max(0, area.y0); y < std::min(side_px_, area.y1); ++y)
            for (int x = std::max(0, area.x0); x < std::min(side_px_, area.x1); ++x) {
                const std::size_t at = 4 * (static_cast<std::size_t>(y) * row + static_cast<std::size_t>(x));
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
    std::vector<std::uint8_t> take() { return std::move(rgba_); }

private:
    [[nodiscard]] int place(double at, double low) const {
        const double px = std::clamp((at - low) * px_a_m_, -1e6, 1e6);
        return margin_px + static_cast<int>(std::lround(px));
    }

    dvec2 low_;
    int side_px_;
    double px_a_m_ = 1;
    std::vector<std::uint8_t> rgba_;
};

Area inner(const Area& area) {
    const int x = static_cast<int>(inner_share * (area.x1 - area.x0)), y = static_cast<int>(inner_share * (area.y1 - area.y0));
    return {area.x0 + x, area.y0 + y, area.x1 - x, area.y1 - y};
}

}  // namespace

std::vector<std::uint8_t> birds_eye_view(std::vector<SeenBox> boxes, const Box& bounds, const dvec3& eye, std::uint32_t side_px) {
    Canvas canvas(bounds, side_px);
    const auto not_drawn = std::stable_partition(boxes.begin(), boxes.end(), [](const SeenBox& box) { return box.drawn; });
    std::stable_sort(boxes.begin(), not_drawn, [](const SeenBox& a, const SeenBox& b) { return a.box.max.y < b.box.max.y; });
    for (const SeenBox& seen : boxes) {
        const Area area = canvas.area_of(seen.box);
        canvas.fill(seen.drawn ? area : inner(area), ink_of(seen.use));
        if (seen.drawn) canvas.frame(area, line_ink);
    }
    canvas.mark(eye);
    return canvas.take();
}

}  // namespace surefoot::cache
