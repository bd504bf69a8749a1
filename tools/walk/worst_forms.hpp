// Which forms cost a walk's pictures most: each is drawn in full detail in turn, while the rest stays.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include "render/engine.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "tools/report/report.hpp"
#include "tools/walk/snapshots.hpp"

namespace surefoot::walk {

/// Columns and rows from, and up to but without.
struct PixelRect {
    std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    [[nodiscard]] bool empty() const { return x0 >= x1 || y0 >= y1; }
};

/// Adds up what single forms cost over several pictures. After the walk only: it draws and allocates.
class WorstForms {
public:
    explicit WorstForms(Engine& engine) : engine_(engine) {}

    /// Tries the forms behind whose boxes the picture is most wrong, at most `forms_tried` of them. `pictures[number]`:
    /// render_snapshot() of the snapshot. Stopped: fewer are tried. Errors: of reading pixels.
    Result<void> add(const FrameSnapshot& snapshot, std::span<const report::ReportSnapshot> pictures, std::size_t number,
                     const Progress& progress);
    /// Share of the squared error that full detail has too, at the resolutions and by the filter of the snapshots below full
    /// resolution. Errors of forms may cancel it in part: then it is above 1.
    [[nodiscard]] double resolution_share() const { return mse_ > 0 ? of_resolution_ / mse_ : 0; }
    /// At most `count`, the one that costs most first; none that costs nothing. pictures: as add() had them.
    [[nodiscard]] std::vector<report::WorstForm> list(std::size_t count, std::span<const report::ReportSnapshot> pictures) const;

    static constexpr std::size_t forms_tried = 12;  ///< a snapshot; each is a frame to draw, with new pictures

private:
    struct Total {
        double mse = 0, max_mse = 0;  ///< mean squared error that goes: summed over the pictures where it was tried; in one
        std::uint32_t pictures = 0;
        std::size_t shown_in = 0;  ///< the picture where it costs most
        PixelRect part;            ///< of that picture
    };

    Engine& engine_;
    double mse_ = 0, of_resolution_ = 0;  ///< summed over all pictures
    std::map<std::pair<model::Index, model::Index>, Total> totals_;
};

/// For each drawn item, what full detail draws below its node. Empty: it is full detail, or nothing of it is in view.
std::vector<std::vector<gl::DrawItem>> full_detail_below(const model::Model& model, std::span<const gl::DrawItem> drawn,
                                                         std::span<const gl::DrawItem> full);

/// Pixels, top row first, that can show the part of a box before the eye's near plane.
PixelRect pixels_of(const Box& box, const Pose& pose, model::Viewport viewport);

}  // namespace surefoot::walk
