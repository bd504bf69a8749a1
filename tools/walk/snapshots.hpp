// Snapshots of frames. A walk stores them without allocating. After the walk they are drawn again, beside full detail.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "render/engine.hpp"
#include "rt/base/progress.hpp"
#include "rt/base/result.hpp"
#include "rt/frame/record.hpp"
#include "tools/report/report.hpp"

namespace surefoot::walk {

/// The exact items of one frame, enough to draw it again.
struct FrameSnapshot {
    std::uint64_t frame = 0;
    double time_s = 0;
    Pose pose;
    float accuracy = 0, resolution = 1;
    rt::TextureFilter filter = rt::TextureFilter::automatic, last_filter = rt::TextureFilter::automatic;  ///< of last_items
    std::uint64_t triangles = 0;
    rt::ShownLight light;
    rt::Switches parts;   ///< of it, that were drawn
    bool shadow = false;  ///< it showed the shadow map of what moves
    std::vector<gl::DrawItem> items;
    std::vector<cache::FrameBox> boxes;    ///< of the image cache; empty: it has none, or the frame drew no cut
    std::vector<gl::DrawItem> last_items;  ///< the frame before's, those outside its view included; empty: none was kept
    std::vector<ShownPicture> pictures, last_pictures;  ///< of the image cache, in both frames
};

/// Memory limit of all snapshots of a walk, in bytes.
constexpr std::size_t snapshot_memory_bytes = 256U << 20U;
/// Most items and pictures of the image cache in a frame.
struct SnapshotRoom {
    std::size_t items = 0, pictures = 0;
    SnapshotRoom(std::size_t max_items, std::size_t max_pictures = 0)  // NOLINT: most frames have items alone
        : items(max_items), pictures(max_pictures) {}
};
/// At least one. with_last: each holds two frames.
std::size_t snapshots_that_fit(const SnapshotRoom& room, bool with_last);

/// Sized before the walk; remember() only copies.
class SnapshotStore {
public:
    /// Every `every` frames, at most `max_snapshots` of them. with_last: also what the frame before each shows.
    SnapshotStore(std::uint64_t every, std::size_t max_snapshots, const SnapshotRoom& room, bool with_last = false);
    /// On the frame thread, after each frame. Frames that are not due, or beyond the store, are passed over.
    void remember(std::uint64_t frame, double time_s, const Pose& pose, float accuracy, float resolution,
                  rt::TextureFilter filter, std::uint64_t triangles, std::span<const gl::DrawItem> drawn,
                  std::span<const gl::DrawItem> culled = {}, const rt::ShownLight& light = {}, const rt::Switches& parts = {},
                  bool shadow = false, std::span<const ShownPicture> pictures = {});
    /// Before the walk: room for what the image cache does with this many boxes.
    void reserve_boxes(std::size_t boxes);
    /// On the frame thread, after remember(): adds the boxes of that frame, if it was remembered.
    void remember_boxes(std::uint64_t frame, std::span<const cache::FrameBox> boxes);
    [[nodiscard]] const std::vector<FrameSnapshot>& snapshots() const { return snapshots_; }
    [[nodiscard]] std::size_t used() const { return used_; }

private:
    void remember_last(rt::TextureFilter filter, std::span<const gl::DrawItem> drawn, std::span<const gl::DrawItem> culled,
                       std::span<const ShownPicture> pictures);

    std::uint64_t every_;
    bool with_last_;
    std::vector<FrameSnapshot> snapshots_;
    std::size_t used_ = 0;
};

/// What the frame before's cut shows at the snapshot's pose. Nodes that only came into view with this frame are drawn as it draws
/// them: they are no pop. Allocates.
std::vector<gl::DrawItem> last_cut_at(const model::Model& model, const FrameSnapshot& snapshot);

/// The pictures of the image cache beside those items: of boxes that only came into view, those of the snapshot. Allocates.
std::vector<ShownPicture> last_pictures_at(const Engine& engine, const FrameSnapshot& snapshot);

/// Draws items and pictures at the resolution and with the filter of a snapshot. Light, time and hidden effects are those that
/// were set. If its frame showed shadows of what moves, they are drawn anew for its moment: the frame's own may be
/// MovingShadow::max_off_px beside.
void draw_as_in(Engine& engine, const FrameSnapshot& snapshot, std::span<const gl::DrawItem> items, rt::TextureFilter filter,
                std::span<const ShownPicture> pictures = {});

/// Draws a snapshot again, and full detail, and measures the difference; with the top view of what was drawn. Where the items of
/// the frame before were kept, draws them too: what changes is the popping.
Result<report::ReportSnapshot> render_snapshot(Engine& engine, const FrameSnapshot& snapshot);

/// Side of a bird's-eye view of the image cache, pixels.
constexpr std::uint32_t birds_eye_px = 420;

/// DIR/00000.png, ... one a snapshot, named by frame number over `every`. Where there is an image cache: its bird's-eye view
/// beside it, as DIR/00000-cache.png.
Result<void> write_snaps(Engine& engine, const SnapshotStore& store, const std::string& dir, const Progress& progress);

}  // namespace surefoot::walk
