// Which forms cost a walk's pictures most: each is drawn in full detail in turn, while the rest stays.
#include "tools/walk/worst_forms.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>

namespace surefoot::walk {

namespace {

using Pixels = std::span<const std::uint8_t>;  // RGBA

double squared_error(Pixels a, Pixels b, std::uint32_t width, const PixelRect& in) {
    double sum = 0;
    for (std::uint32_t y = in.y0; y < in.y1; ++y) {
        const std::size_t row = std::size_t{4} * width * y;
        std::uint64_t of_row = 0;
        for (std::size_t i = row + std::size_t{4} * in.x0; i < row + std::size_t{4} * in.x1; ++i) {
            if (i % 4 == 3) continue;
            const int d = int{a[i]} - int{b[i]};
            of_row += static_cast<std::uint64_t>(d * d);
        }
        sum += static_cast<double>(of_row);
    }
    return sum;
}

/// Where two pictures differ visibly, and a little around it.
PixelRect changed_pixels(Pixels a, Pixels b, std::uint32_t width, std::uint32_t height) {
    constexpr std::uint32_t around = 12;
    PixelRect rect{width, height, 0, 0};
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::size_t i = 4 * (std::size_t{width} * y + x);
            const auto differs = [&](std::size_t k) { return std::abs(int{a[i + k]} - int{b[i + k]}) > report::visible_steps; };
            if (!differs(0) && !differs(1) && !differs(2)) continue;
            rect = {std::min(rect.x0, x), std::min(rect.y0, y), std::max(rect.x1, x + 1), std::max(rect.y1, y + 1)};
        }
    }
    if (rect.x0 >= rect.x1) return {};
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
    const PixelRect all{0, 0, viewport.width, viewport.height};
    const mat4 rotation = model::view_rotation(pose);
    const mat4 projection = model::projection(pose, viewport);
    double left = 1, right = -1, bottom = 1, top = -1;
    for (unsigned corner = 0; corner < 8; ++corner) {
        const dvec3 at{(corner & 1U) != 0 ? box.max.x : box.min.x, (corner & 2U) != 0 ? box.max.y : box.min.y,
                       (corner & 4U) != 0 ? box.max.z : box.min.z};
        const vec4 clip = projection * rotation * vec4(vec3(at - pose.position), 1.0F);
        if (!(static_cast<double>(clip.w) > model::near_plane_m)) return all;
        const double x = static_cast<double>(clip.x / clip.w), y = static_cast<double>(clip.y / clip.w);
        left = std::min(left, x);
        right = std::max(right, x);
        bottom = std::min(bottom, y);
        top = std::max(top, y);
    }
    const auto pixel = [](double ndc, std::uint32_t size, auto round) {
        return static_cast<std::uint32_t>(std::clamp(round((ndc + 1) / 2 * size), 0.0, static_cast<double>(size)));
    };
    const auto floor = [](double v) { return std::floor(v); };
    const auto ceil = [](double v) { return std::ceil(v); };
    PixelRect rect{pixel(left, viewport.width, floor), pixel(-top, viewport.height, floor), pixel(right, viewport.width, ceil),
                   pixel(-bottom, viewport.height, ceil)};
    if (rect.x0 >= rect.x1 || rect.y0 >= rect.y1) return {};
    return rect;
}

Result<void> WorstForms::add(const FrameSnapshot& snapshot, const report::ReportSnapshot& picture) {
    const std::uint32_t width = picture.width, height = picture.height;
    if (picture.walk.empty() || picture.full.empty()) return {};
    const double wrong = squared_error(picture.walk, picture.full, width, {0, 0, width, height});
    squared_error_ += wrong;
    const model::Model& model = engine_.model();
    const std::vector<gl::DrawItem> full = engine_.full_detail(snapshot.pose);
    if (snapshot.resolution < 1) {
        engine_.draw_unbudgeted(snapshot.pose, full, snapshot.resolution, snapshot.filter);
        auto blurred = engine_.device().read_pixels();
        if (!blurred) return blurred.error();
        of_resolution_ += squared_error(blurred->rgba, picture.full, width, {0, 0, width, height});
    }
    const auto below = full_detail_below(model, snapshot.items, full);
    std::vector<std::pair<double, std::size_t>> tried;
    for (std::size_t i = 0; i < snapshot.items.size(); ++i) {
        if (below[i].empty()) continue;
        const Box& box = model.nodes[snapshot.items[i].node].box;
        const PixelRect rect = pixels_of(box, snapshot.pose, engine_.options().device.viewport);
        tried.emplace_back(squared_error(picture.walk, picture.full, width, rect), i);
    }
    std::sort(tried.rbegin(), tried.rend());
    tried.resize(std::min(tried.size(), forms_tried));
    for (const auto& [unused, i] : tried) {
        const gl::DrawItem& item = snapshot.items[i];
        std::vector<gl::DrawItem> items = snapshot.items;
        items.erase(items.begin() + static_cast<std::ptrdiff_t>(i));
        items.insert(items.end(), below[i].begin(), below[i].end());
        engine_.draw_unbudgeted(snapshot.pose, items, snapshot.resolution, snapshot.filter);
        auto with = engine_.device().read_pixels();
        if (!with) return with.error();
        const double less = wrong - squared_error(with->rgba, picture.full, width, {0, 0, width, height});
        if (!(less > 0)) continue;
        Total& total = totals_[{item.node, item.rep}];
        total.squared_error += less;
        ++total.form.pictures;
        if (less <= total.max_squared_error) continue;
        total.max_squared_error = less;
        const PixelRect part = changed_pixels(picture.walk, with->rgba, width, height);
        total.form.frame = picture.frame;
        total.form.width = part.x1 - part.x0;
        total.form.height = part.y1 - part.y0;
        total.form.walk = part_of_picture(picture.walk, width, part);
        total.form.full = part_of_picture(picture.full, width, part);
    }
    return {};
}

double WorstForms::resolution_share() const { return squared_error_ > 0 ? of_resolution_ / squared_error_ : 0; }

std::vector<report::WorstForm> WorstForms::list(std::size_t count) const {
    std::vector<report::WorstForm> forms;
    const model::Model& model = engine_.model();
    for (const auto& [key, total] : totals_) {
        const auto& [n, rep] = key;
        const model::Node& node = model.nodes[n];
        report::WorstForm form = total.form;
        form.node = n;
        form.name = model.name_of(node);
        form.node_kind = model::name_of(node.kind);
        form.form = model::form_of(model.reps[rep].kind).name;
        form.triangles = model.reps[rep].triangles;
        form.error_share = total.squared_error / squared_error_;
        forms.push_back(std::move(form));
    }
    std::sort(forms.begin(), forms.end(), [](const auto& a, const auto& b) { return a.error_share > b.error_share; });
    if (forms.size() > count) forms.resize(count);
    return forms;
}

}  // namespace surefoot::walk
