// Which forms cost a walk's pictures most: each is drawn in full detail in turn, while the rest stays.
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "render/engine.hpp"
#include "rt/base/result.hpp"
#include "tools/report/report.hpp"
#include "tools/walk/snapshots.hpp"

namespace surefoot::walk {

/// Adds up what single forms cost over several snapshots. After the walk only: it draws and allocates.
class WorstForms {
public:
    explicit WorstForms(Engine& engine) : engine_(engine) {}

    /// Tries the forms behind whose boxes the picture is most wrong, at most `forms_tried` of them. `picture`: render_snapshot()
    /// of the snapshot. Errors: of reading pixels.
    Result<void> add(const FrameSnapshot& snapshot, const report::ReportSnapshot& picture);
    /// Share of the squared error that full detail would have too, at the snapshots' resolutions.
    [[nodiscard]] double resolution_share() const;
    /// At most `count`, the one that costs most first.
    [[nodiscard]] std::vector<report::WorstForm> list(std::size_t count) const;

    static constexpr std::size_t forms_tried = 12;  ///< a snapshot; each is a frame to draw

private:
    struct Total {
        double squared_error = 0, max_squared_error = 0;  ///< of all pictures, of one
        report::WorstForm form;
    };

    Engine& engine_;
    double squared_error_ = 0, of_resolution_ = 0;  ///< of all pictures
    std::map<std::pair<model::Index, model::Index>, Total> totals_;
};

/// For each drawn item, what full detail draws below its node. Empty: it is full detail, or nothing of it is in view.
std::vector<std::vector<gl::DrawItem>> full_detail_below(const model::Model& model, std::span<const gl::DrawItem> drawn,
                                                         std::span<const gl::DrawItem> full);

/// Columns and rows from, and up to but without.
struct PixelRect {
    std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};
/// Pixels, top row first, that can show a box; all of the picture where the box reaches behind the eye's near plane.
PixelRect pixels_of(const Box& box, const Pose& pose, model::Viewport viewport);

}  // namespace surefoot::walk
