// Snapshots of frames: remembered during a walk without allocating, and drawn again after it.
#include "tools/walk/snapshots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "render/image/image.hpp"
#include "render/measure/flip.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/base/check.hpp"
#include "tools/walk/light.hpp"

namespace surefoot::walk {

std::size_t snapshots_that_fit(const SnapshotRoom& room, bool with_last) {
    const std::size_t frame_bytes =
        room.items * sizeof(gl::DrawItem) + room.pictures * (sizeof(ShownPicture) + sizeof(cache::FrameBox));
    return std::max<std::size_t>(1, snapshot_memory_bytes / (sizeof(FrameSnapshot) + (with_last ? 2 : 1) * frame_bytes));
}

SnapshotStore::SnapshotStore(std::uint64_t every, std::size_t max_snapshots, const SnapshotRoom& room, bool with_last)
    : every_(every), with_last_(with_last), snapshots_(every == 0 ? 0 : max_snapshots) {
    const auto touch = [](auto& shown, std::size_t count) {  // now, so that the copy later does not fault
        shown.resize(count);
        shown.clear();
    };
    for (FrameSnapshot& snapshot : snapshots_) {
        touch(snapshot.items, room.items);
        touch(snapshot.pictures, room.pictures);
        if (!with_last) continue;
        touch(snapshot.last_items, room.items);
        touch(snapshot.last_pictures, room.pictures);
    }
}

void SnapshotStore::reserve_boxes(std::size_t boxes) {
    for (FrameSnapshot& snapshot : snapshots_) {
        snapshot.boxes.resize(boxes);
        snapshot.boxes.clear();
    }
}

void SnapshotStore::remember_boxes(std::uint64_t frame, std::span<const cache::FrameBox> boxes) {
    if (used_ == 0 || snapshots_[used_ - 1].frame != frame) return;
    FrameSnapshot& snapshot = snapshots_[used_ - 1];
    if (!CHECK_RARE(boxes.size() <= snapshot.boxes.capacity(), "A snapshot has room for all boxes of the cache")) return;
    snapshot.boxes.assign(boxes.begin(), boxes.end());
}

void SnapshotStore::remember(std::uint64_t frame, double time_s, const Pose& pose, float accuracy, float resolution,
                             rt::TextureFilter filter, std::uint64_t triangles, std::span<const gl::DrawItem> drawn,
                             std::span<const gl::DrawItem> culled, const rt::ShownLight& light, const rt::Switches& parts,
                             bool shadow, std::span<const ShownPicture> pictures) {
    if (every_ == 0 || used_ == snapshots_.size()) return;
    if (frame % every_ != 0) {
        if ((frame + 1) % every_ == 0) remember_last(filter, drawn, culled, pictures);
        return;
    }
    FrameSnapshot& snapshot = snapshots_[used_];
    const bool fits = drawn.size() <= snapshot.items.capacity() && pictures.size() <= snapshot.pictures.capacity();
    if (!CHECK_RARE(fits, "A snapshot has room for all that is drawn")) return;
    snapshot.frame = frame;
    snapshot.time_s = time_s;
    snapshot.pose = pose;
    snapshot.accuracy = accuracy;
    snapshot.resolution = resolution;
    snapshot.filter = filter;
    snapshot.triangles = triangles;
    snapshot.light = light;
    snapshot.parts = parts;
    snapshot.shadow = shadow;
    snapshot.items.assign(drawn.begin(), drawn.end());
    snapshot.pictures.assign(pictures.begin(), pictures.end());
    ++used_;
    if (every_ == 1 && used_ < snapshots_.size()) remember_last(filter, drawn, culled, pictures);
}

void SnapshotStore::remember_last(rt::TextureFilter filter, std::span<const gl::DrawItem> drawn,
                                  std::span<const gl::DrawItem> culled, std::span<const ShownPicture> pictures) {
    if (!with_last_) return;
    std::vector<gl::DrawItem>& last = snapshots_[used_].last_items;
    std::vector<ShownPicture>& last_pictures = snapshots_[used_].last_pictures;
    const bool fits = drawn.size() + culled.size() <= last.capacity() && pictures.size() <= last_pictures.capacity();
    if (!CHECK_RARE(fits, "A snapshot has room for a whole cut")) return;
    last_pictures.assign(pictures.begin(), pictures.end());
    snapshots_[used_].last_filter = filter;
    last.assign(drawn.begin(), drawn.end());
    last.insert(last.end(), culled.begin(), culled.end());
}

namespace {

/// What a node is in the last cut.
enum class InLastCut : std::uint8_t { nothing, above_shown, shown };

std::vector<InLastCut> last_cut_of(const model::Model& model, const FrameSnapshot& snapshot) {
    std::vector<InLastCut> state(model.nodes.size(), InLastCut::nothing);
    for (const gl::DrawItem& item : snapshot.last_items) {
        state[item.node] = InLastCut::shown;
        for (model::Index n = model.nodes[item.node].parent; n != model::none && state[n] == InLastCut::nothing;
             n = model.nodes[n].parent)
            state[n] = InLastCut::above_shown;
    }
    return state;
}

bool is_in(const model::Model& model, const std::vector<InLastCut>& state, model::Index node) {
    bool covered = state[node] != InLastCut::nothing;
    for (model::Index n = node; n != model::none && !covered; n = model.nodes[n].parent) covered = state[n] == InLastCut::shown;
    return covered;
}

}  // namespace

std::vector<gl::DrawItem> last_cut_at(const model::Model& model, const FrameSnapshot& snapshot) {
    const std::vector<InLastCut> state = last_cut_of(model, snapshot);
    std::vector<gl::DrawItem> items = snapshot.last_items;
    for (const gl::DrawItem& item : snapshot.items)
        if (!is_in(model, state, item.node)) items.push_back(item);
    return items;
}

std::vector<ShownPicture> last_pictures_at(const Engine& engine, const FrameSnapshot& snapshot) {
    const std::vector<InLastCut> state = last_cut_of(engine.model(), snapshot);
    std::vector<ShownPicture> pictures;  // back to front, as the snapshot's are
    for (const ShownPicture& each : snapshot.pictures) {
        const auto last = std::find_if(snapshot.last_pictures.begin(), snapshot.last_pictures.end(),
                                       [&](const ShownPicture& other) { return other.box == each.box; });
        const std::span<const model::Index> leaves = engine.leaves_in(each.box);
        const bool drawn =
            std::any_of(leaves.begin(), leaves.end(), [&](model::Index n) { return is_in(engine.model(), state, n); });
        if (last == snapshot.last_pictures.end() && !drawn) pictures.push_back(each);
    }
    pictures.insert(pictures.end(), snapshot.last_pictures.begin(), snapshot.last_pictures.end());
    return pictures;
}

namespace {

/// 0 for the coarsest form of a node, 1 for its full detail.
float detail_of(const model::Model& model, const gl::DrawItem& item) {
    const model::Node& node = model.nodes[item.node];
    if (node.triangles == 0) return 1.0F;
    const double share = static_cast<double>(model.reps[item.rep].triangles) / static_cast<double>(node.triangles);
    return static_cast<float>(std::clamp(1.0 + std::log2(std::max(share, 1e-6)) / 10.0, 0.0, 1.0));
}

void add_top_view(const Engine& engine, const FrameSnapshot& snapshot, report::ReportSnapshot& out) {
    const model::Model& model = engine.model();
    const Box& world = model.nodes[0].box;
    out.world_xz = {world.min.x, world.min.z, world.max.x, world.max.z};
    const dvec3 forward = snapshot.pose.forward();
    out.eye = {snapshot.pose.position.x, snapshot.pose.position.y, snapshot.pose.position.z};
    out.forward = {forward.x, forward.y, forward.z};
    const model::SideAngles sides = model::side_angles(snapshot.pose, engine.options().device.viewport);
    out.left_rad = sides.left;
    out.right_rad = sides.right;
    out.drawn.reserve(snapshot.items.size());
    for (const gl::DrawItem& item : snapshot.items) {
        const model::Node& node = model.nodes[item.node];
        out.drawn.push_back({static_cast<float>(node.box.min.x), static_cast<float>(node.box.min.z),
                             static_cast<float>(node.box.max.x), static_cast<float>(node.box.max.z), static_cast<int>(node.kind),
                             detail_of(model, item)});
    }
}

void add_birds_eye(const Engine& engine, const FrameSnapshot& snapshot, report::ReportSnapshot& out) {
    out.birds_eye = engine.birds_eye(snapshot.boxes, snapshot.pose.position, birds_eye_px);
    if (out.birds_eye.empty()) return;
    out.birds_eye_px = birds_eye_px;
    for (const cache::FrameBox& box : snapshot.boxes) {
        out.new_pictures += box.made ? 1 : 0;
        out.reused_pictures += box.shown && !box.made ? 1 : 0;
        out.boxes_as_triangles += box.as_triangles ? 1 : 0;
    }
}

}  // namespace

void draw_as_in(Engine& engine, const FrameSnapshot& snapshot, std::span<const gl::DrawItem> items, rt::TextureFilter filter,
                std::span<const ShownPicture> pictures) {
    if (snapshot.shadow) engine.refresh_shadow(snapshot.pose);
    engine.draw_unbudgeted(snapshot.pose, items, pictures, snapshot.resolution, filter);
}

Result<report::ReportSnapshot> render_snapshot(Engine& engine, const FrameSnapshot& snapshot) {
    report::ReportSnapshot out;
    out.frame = snapshot.frame;
    out.time_s = snapshot.time_s;
    out.triangles = snapshot.triangles;
    out.accuracy = snapshot.accuracy;
    out.resolution = snapshot.resolution;
    add_top_view(engine, snapshot, out);
    add_birds_eye(engine, snapshot, out);
    const std::vector<gl::DrawItem> full = engine.full_detail(snapshot.pose);
    for (const gl::DrawItem& item : full) out.full_triangles += engine.model().reps[item.rep].triangles;
    if (engine.options().device.kind == gl::BackendKind::null) return out;  // nothing to look at

    engine.device().draws.plays();
    show_light(engine, snapshot.light);
    engine.set_time(snapshot.time_s);
    const model::EffectMask hidden = hidden_effects(snapshot.light.on), left_out = hidden | hidden_effects(snapshot.parts);
    engine.hide_effects(left_out);
    draw_as_in(engine, snapshot, snapshot.items, snapshot.filter, snapshot.pictures);
    auto walk = engine.device().read_pixels();
    if (!walk) return walk.error();
    engine.hide_effects(hidden);
    engine.refresh_shadow(snapshot.pose);  // full detail has all that the scene calls for
    engine.draw_unbudgeted(snapshot.pose, full);
    auto reference = engine.device().read_pixels();
    if (!reference) return reference.error();
    if (!snapshot.last_items.empty() || !snapshot.last_pictures.empty()) {
        engine.hide_effects(left_out);
        draw_as_in(engine, snapshot, last_cut_at(engine.model(), snapshot), snapshot.last_filter,
                   last_pictures_at(engine, snapshot));
        auto before = engine.device().read_pixels();
        if (!before) return before.error();
        out.pops_compared = true;
        out.popped_share = 1 - measure::share_within(walk->rgba, before->rgba, report::visible_steps);
        out.pop_mse = measure::snr(walk->rgba, before->rgba).mse;
    }
    out.width = walk->width;
    out.height = walk->height;
    const measure::Snr snr = measure::snr(walk->rgba, reference->rgba);
    out.snr_db = snr.db;
    out.mse = snr.mse;
    out.flip = measure::flip(walk->rgba, reference->rgba, walk->width, walk->height);
    out.ssim = measure::ssim(walk->rgba, reference->rgba, walk->width, walk->height);
    out.difference = measure::difference_image(walk->rgba, reference->rgba);
    out.walk = std::move(walk->rgba);
    out.full = std::move(reference->rgba);
    return out;
}

Result<void> write_snaps(Engine& engine, const SnapshotStore& store, const std::string& dir, const Progress& progress) {
    engine.device().draws.plays();
    std::error_code error;
    std::filesystem::create_directories(dir, error);
    if (error)
        return Error{dir, "The folder cannot be made: " + error.message(), "Name another folder with --snap",
                     ErrorKind::unwritable};
    for (std::size_t i = 0; i < store.used(); ++i) {
        if (progress.stopped()) {
            return Error{
                dir,
                fmt::format("The walk was stopped by the user with {} of {} pictures written: the rest is lost", i, store.used()),
                "", ErrorKind::stopped};
        }
        progress.update("pictures", static_cast<double>(i) / static_cast<double>(store.used()));
        const FrameSnapshot& snapshot = store.snapshots()[i];
        show_light(engine, snapshot.light);
        engine.set_time(snapshot.time_s);
        engine.hide_effects(hidden_effects(snapshot.light.on) | hidden_effects(snapshot.parts));
        draw_as_in(engine, snapshot, snapshot.items, snapshot.filter, snapshot.pictures);
        auto image = engine.device().read_pixels();
        if (!image) return image.error();
        auto written = image::write_png(fmt::format("{}/{:05}.png", dir, i), image->width, image->height, image->rgba);
        if (!written) return written;
        const std::vector<std::uint8_t> above = engine.birds_eye(snapshot.boxes, snapshot.pose.position, birds_eye_px);
        if (above.empty()) continue;
        written = image::write_png(fmt::format("{}/{:05}-cache.png", dir, i), birds_eye_px, birds_eye_px, above);
        if (!written) return written;
    }
    return {};
}

}  // namespace surefoot::walk
