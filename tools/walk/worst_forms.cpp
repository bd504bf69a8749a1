// Which forms cost a walk's pictures most: each is drawn in full detail in turn, while the rest stays.
#include "tools/walk/worst_forms.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <span>

#include "render/measure/image_metrics.hpp"
#include "tools/walk/light.hpp"

namespace surefoot::walk {

namespace {

using Pixels = std::span<const std::uint8_t>;  // RGBA

/// Squared errors of R, G and B between two pictures, summed over any rectangle at once: a summed-area table.
class SquaredErrors {
public:
    SquaredErrors(Pixels a, Pixels b, std::uint32_t width, std::uint32_t height)
        : columns_(std::size_t{width} + 1), sums_(columns_ * (std::size_t{height} + 1), 0) {
        for (std::uint32_t y = 0; y < height; ++y) {
            std::uint64_t row = 0;
            for (std::uint32_t x = 0; x < width; ++x) {
                const std::size_t first = 4 * (std::size_t{width} * y + x);
                for (std::size_t i = first; i < first + 3; ++i) {
                    const int off = int{a[i]} - int{b[i]};
                    row += static_cast<std::uint64_t>(off * off);
                }
                sums_[columns_ * (y + 1) + x + 1] = sums_[columns_ * y + x + 1] + row;
            }
        }
    }
    [[nodiscard]] double in(const PixelRect& r) const {
        return static_cast<double>(at(r.x1, r.y1) - at(r.x0, r.y1) - at(r.x1, r.y0) + at(r.x0, r.y0));
    }

private:
    [[nodiscard]] std::uint64_t at(std::uint32_t x, std::uint32_t y) const { return sums_[columns_ * y + x]; }
    std::size_t columns_;
    std::vector<std::uint64_t> sums_;
};

/// Where two pictures differ by more than `over` steps, and a little around it.
PixelRect changed_pixels(Pixels a, Pixels b, std::uint32_t width, std::uint32_t height, int over) {
    constexpr std::uint32_t around = 12;
    PixelRect rect{width, height, 0, 0};
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::size_t i = 4 * (std::size_t{width} * y + x);
            const auto differs = [&](std::size_t k) { return std::abs(int{a[i + k]} - int{b[i + k]}) > over; };
            if (!differs(0) && !differs(1) && !differs(2)) continue;
            rect = {std::min(rect.x0, x), std::min(rect.y0, y), std::max(rect.x1, x + 1), std::max(rect.y1, y + 1)};
        }
    }
    if (rect.empty()) return {};
    return {rect.x0 - std::min(rect.x0, around), rect.y0 - std::min(rect.y0, around), std::min(width, rect.x1 + around),
            std::min(height, rect.y1 + around)};
}

std::vector<std::uint8_t> part_of_picture(Pixels picture, std::uint32_t width, const PixelRect& part) {
    std::vector<std::uint8_t> out;
    for (std::uint32_t y = part.y0; y < part.y1; ++y) {
        const Pixels row = picture.subspan(4 * (std::size_t{width} * y + part.x0), std::size_t{4} * (part.x1 - part.x0));
        out.insert(out.end(), row.begin(), row.end());
    }
    return out;
}

}  // namespace

std::vector<std::vector<gl::DrawItem>> full_detail_below(const model::Model& model, std::span<const gl::DrawItem> drawn,
                                                         std::span<const gl::DrawItem> full) {
    std::map<model::Index, std::size_t> shown;
    for (std::size_t i = 0; i < drawn.size(); ++i) shown[drawn[i].node] = i;
    std::vector<std::vector<gl::DrawItem>> below(drawn.size());
    for (const gl::DrawItem& leaf : full) {
        for (model::Index n = leaf.node; n != model::none; n = model.nodes[n].parent) {
            const auto found = shown.find(n);
            if (found == shown.end()) continue;
            const gl::DrawItem& item = drawn[found->second];
            if (!model::is_full_detail(model.nodes[n], item.rep, model.reps[item.rep].error_m))
                below[found->second].push_back(leaf);
            break;
        }
    }
    return below;
}

PixelRect pixels_of(const Box& box, const Pose& pose, model::Viewport viewport) {
    const mat4 to_clip = model::projection(pose, viewport) * model::view_rotation(pose);
    std::array<vec4, 8> corners;
    for (unsigned c = 0; c < corners.size(); ++c) {
        const dvec3 at{(c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y,
                       (c & 4U) != 0 ? box.max.z : box.min.z};
        corners[c] = to_clip * vec4(vec3(at - pose.position), 1.0F);
    }
    constexpr auto near = static_cast<float>(model::near_plane_m);
    double left = 1, right = -1, bottom = 1, top = -1;
    const auto show = [&](const vec4& clip) {
        const double x = static_cast<double>(clip.x / clip.w), y = static_cast<double>(clip.y / clip.w);
        left = std::min(left, x);
        right = std::max(right, x);
        bottom = std::min(bottom, y);
        top = std::max(top, y);
    };
    for (unsigned c = 0; c < corners.size(); ++c) {
        if (corners[c].w >= near) show(corners[c]);
        for (unsigned axis = 1; axis < corners.size(); axis *= 2) {  // edges that cross the near plane
            const vec4 &a = corners[c], &b = corners[c | axis];
            if ((a.w >= near) != (b.w >= near)) show(glm::mix(a, b, (near - a.w) / (b.w - a.w)));
        }
    }
    const auto pixel = [](double ndc, std::uint32_t size, auto round) {
        return static_cast<std::uint32_t>(std::clamp(round((ndc + 1) / 2 * size), 0.0, static_cast<double>(size)));
    };
    const auto floor = [](double v) { return std::floor(v); };
    const auto ceil = [](double v) { return std::ceil(v); };
    const PixelRect rect{pixel(left, viewport.width, floor), pixel(-top, viewport.height, floor),
                         pixel(right, viewport.width, ceil), pixel(-bottom, viewport.height, ceil)};
    return rect.empty() ? PixelRect{} : rect;
}

Result<void> WorstForms::add(const FrameSnapshot& snapshot, std::span<const report::ReportSnapshot> pictures, std::size_t number,
                             const Progress& progress) {
    const report::ReportSnapshot& picture = pictures[number];
    const std::uint32_t width = picture.width, height = picture.height;
    if (picture.walk.empty() || picture.full.empty()) return {};
    engine_.device().draws.plays();
    show_light(engine_, snapshot.light);
    engine_.set_time(snapshot.time_s);
    const SquaredErrors wrong(picture.walk, picture.full, width, height);
    mse_ += picture.mse;
    const model::Model& model = engine_.model();
    const std::vector<gl::DrawItem> full = engine_.full_detail(snapshot.pose);
    if (snapshot.resolution < 1) {
        draw_as_in(engine_, snapshot, full, snapshot.filter);
        auto blurred = engine_.device().read_pixels();
        if (!blurred) return blurred.error();
        of_resolution_ += measure::snr(blurred->rgba, picture.full).mse;
    }
    const auto below = full_detail_below(model, snapshot.items, full);
    std::vector<std::pair<double, std::size_t>> tried;
    for (std::size_t i = 0; i < snapshot.items.size(); ++i) {
        if (below[i].empty()) continue;
        const Box& box = model.nodes[snapshot.items[i].node].box;
        tried.emplace_back(wrong.in(pixels_of(box, snapshot.pose, engine_.options().device.viewport)), i);
    }
    std::sort(tried.rbegin(), tried.rend());
    tried.resize(std::min(tried.size(), forms_tried));
    for (const auto& [unused, i] : tried) {
        if (progress.stopped()) break;
        const gl::DrawItem& item = snapshot.items[i];
        std::vector<gl::DrawItem> items = snapshot.items;
        items.erase(items.begin() + static_cast<std::ptrdiff_t>(i));
        items.insert(items.end(), below[i].begin(), below[i].end());
        draw_as_in(engine_, snapshot, items, snapshot.filter, snapshot.pictures);
        auto with = engine_.device().read_pixels();
        if (!with) return with.error();
        const double goes = picture.mse - measure::snr(with->rgba, picture.full).mse;
        Total& total = totals_[{item.node, item.rep}];
        total.mse += goes;
        ++total.pictures;
        if (goes <= total.max_mse) continue;
        total.max_mse = goes;
        total.shown_in = number;
        total.part = changed_pixels(picture.walk, with->rgba, width, height, report::visible_steps);
        if (total.part.empty()) total.part = changed_pixels(picture.walk, with->rgba, width, height, 0);
    }
    return {};
}

std::vector<report::WorstForm> WorstForms::list(std::size_t count, std::span<const report::ReportSnapshot> pictures) const {
    using Entry = std::pair<const std::pair<model::Index, model::Index>, Total>;
    std::vector<const Entry*> worst;
    for (const Entry& entry : totals_)
        if (entry.second.mse > 0) worst.push_back(&entry);
    std::stable_sort(worst.begin(), worst.end(), [](const Entry* a, const Entry* b) { return a->second.mse > b->second.mse; });
    worst.resize(std::min(worst.size(), count));
    std::vector<report::WorstForm> forms;
    const model::Model& model = engine_.model();
    for (const Entry* entry : worst) {
        const auto& [key, total] = *entry;
        const model::Node& node = model.nodes[key.first];
        const report::ReportSnapshot& picture = pictures[total.shown_in];
        report::WorstForm& form = forms.emplace_back();
        form.node = key.first;
        form.name = model.name_of(node);
        form.node_kind = model::name_of(node.kind);
        form.form = model::form_of(model.reps[key.second].kind).name;
        form.triangles = model.reps[key.second].triangles;
        form.error_share = total.mse / mse_;
        form.pictures = total.pictures;
        form.frame = picture.frame;
        form.width = total.part.x1 - total.part.x0;
        form.height = total.part.y1 - total.part.y0;
        form.walk = part_of_picture(picture.walk, picture.width, total.part);
        form.full = part_of_picture(picture.full, picture.width, total.part);
    }
    return forms;
}

}  // namespace surefoot::walk
