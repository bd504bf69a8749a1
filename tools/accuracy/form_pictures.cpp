// Which nodes are drawn, from where, and what is measured there.
#include "tools/accuracy/form_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "render/engine.hpp"
#include "render/measure/calibrate.hpp"
#include "render/measure/image_metrics.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/pixels.hpp"
#include "render/model/walk_file.hpp"
#include "tools/report/page_parts.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::accuracy {

namespace {

using model::Index;

constexpr double side_px = form_picture_px;
constexpr double filled_px = 160;  // of the picture's side, by the sphere round the node
constexpr double served_error_px = 2;
constexpr double min_served_px = 6;  // below, nothing can be told
constexpr int jpeg_quality = 92;
constexpr model::Viewport walk_viewport;

/// Tangent of a pixel of a walk's picture.
double pixel_tangent() { return 2 * std::tan(0.5 * Pose().fov_y_rad) / walk_viewport.height; }

/// From where people look at things: a little from above, off a face.
dvec3 towards_eye() { return glm::normalize(dvec3(0.62, 0.30, 0.73)); }

/// An eye at `distance_m` from the box that looks at its middle.
Pose pose_at(const Box& box, double distance_m) {
    double low = distance_m, high = distance_m + box.diagonal();
    for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (low + high);
        (box.distance(box.centre() + middle * towards_eye()) < distance_m ? low : high) = middle;
    }
    Pose pose;
    pose.position = box.centre() + high * towards_eye();
    pose.orientation = glm::quatLookAt(-towards_eye(), dvec3(0, 1, 0));
    pose.fov_y_rad = 2 * std::atan(0.5 * side_px * pixel_tangent());
    return pose;
}

double close_distance_m(const Box& box) {
    const double radius = 0.5 * box.diagonal();
    const double from_middle = radius / (0.5 * filled_px * pixel_tangent());
    return box.distance(box.centre() + from_middle * towards_eye());
}

/// A node that stands for all with the same forms on its level.
struct Chosen {
    Index node = 0;
    std::uint32_t level = 0, same = 0;
};

/// Nodes by level, then by triangles, most first. Of nodes with the same triangles in the same forms the first stands for all.
std::vector<Chosen> distinct_nodes(const model::Model& model, const std::string& name) {
    std::vector<std::uint32_t> level(model.nodes.size(), 0);
    std::map<std::pair<std::uint32_t, Index>, std::size_t> known;  // level, first part of the finest form
    std::vector<Chosen> found;
    for (Index n = 0; n < model.nodes.size(); ++n) {
        const model::Node& node = model.nodes[n];
        for (std::uint32_t c = 0; c < node.child_count; ++c) level[node.first_child + c] = level[n] + 1;
        if (std::string_view(model.name_of(node)).find(name) == std::string_view::npos) continue;
        const Index part = model.reps[node.first_rep + node.rep_count - 1].first_part;
        const auto [at, is_new] = known.try_emplace({level[n], part}, found.size());
        if (is_new) found.push_back({n, level[n], 0});
        ++found[at->second].same;
    }
    std::stable_sort(found.begin(), found.end(), [&](const Chosen& a, const Chosen& b) {
        if (a.level != b.level) return a.level < b.level;
        return model.nodes[a.node].triangles > model.nodes[b.node].triangles;
    });
    return found;
}

/// At most `count`, as evenly from all levels as they have nodes.
std::vector<Chosen> spread_over_levels(std::vector<Chosen> nodes, std::size_t count) {
    if (count == 0 || nodes.size() <= count) return nodes;
    std::vector<std::size_t> of_level(nodes.back().level + 1, 0);
    std::vector<std::size_t> rank(nodes.size());
    for (std::size_t i = 0; i < nodes.size(); ++i) rank[i] = of_level[nodes[i].level]++;
    std::size_t share = 0, taken = 0;  // nodes of each level
    for (;; ++share) {
        std::size_t more = 0;
        for (const std::size_t has : of_level) more += has > share;
        if (taken + more > count) break;
        taken += more;
    }
    std::size_t left = count - taken;
    std::vector<Chosen> chosen;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const bool extra = rank[i] == share && left > 0;
        if (extra) --left;
        if (rank[i] < share || extra) chosen.push_back(nodes[i]);
    }
    return chosen;
}

std::vector<gl::DrawItem> full_detail_below(const model::Model& model, Index root) {
    std::vector<gl::DrawItem> items;
    std::vector<Index> open{root};
    while (!open.empty()) {
        const Index n = open.back();
        open.pop_back();
        const model::Node& node = model.nodes[n];
        if (node.child_count == 0) items.push_back({n, node.first_rep + node.rep_count - 1});
        for (std::uint32_t c = node.child_count; c > 0; --c) open.push_back(node.first_child + c - 1);
    }
    return items;
}

std::uint64_t bytes_of(const model::Model& model, const model::Representation& rep) {
    std::uint64_t bytes = 0;
    for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
        const model::Part& part = model.parts[p];
        bytes +=
            std::uint64_t{part.vertex_count} * sizeof(model::Vertex) + std::uint64_t{part.index_count} * sizeof(std::uint32_t);
        const Index of = model.materials[part.material].texture;
        if (rep.kind != model::RepKind::textured_box || of == model::none) continue;
        const model::Texture& texture = model.textures[of];
        for (std::uint32_t l = 0; l < texture.levels; ++l)
            bytes += std::uint64_t{4} * std::max(1U, texture.width >> l) * std::max(1U, texture.height >> l);
    }
    return bytes;
}

/// The square in the middle of a picture.
std::vector<std::uint8_t> middle_of(const gl::PixelImage& image, std::uint32_t side) {
    std::vector<std::uint8_t> rgba;
    rgba.reserve(std::size_t{side} * side * 4);
    const std::uint32_t x = (image.width - side) / 2, y = (image.height - side) / 2;
    for (std::uint32_t row = y; row < y + side; ++row) {
        const auto from = image.rgba.begin() + static_cast<std::ptrdiff_t>((std::size_t{row} * image.width + x) * 4);
        rgba.insert(rgba.end(), from, from + static_cast<std::ptrdiff_t>(std::size_t{side} * 4));
    }
    return rgba;
}

double psnr_db(const gl::PixelImage& a, const gl::PixelImage& b) {
    const double mse = measure::snr(a.rgba, b.rgba).mse;
    return mse > 0 ? 10 * std::log10(255.0 * 255.0 / mse) : std::numeric_limits<double>::infinity();
}

/// Draws a model's forms with one device.
class FormDrawer {
public:
    FormDrawer(Engine& engine, const model::CostModel& costs)
        : engine_(engine), model_(engine.model()), costs_(costs), item_costs_(model_, costs) {}

    Result<DrawnNode> draw(const Chosen& chosen);

private:
    Result<gl::PixelImage> picture(const Pose& pose, std::span<const gl::DrawItem> items);
    /// Predicted, of a walk's picture from there.
    double cost_us(const Pose& pose, std::span<const gl::DrawItem> items) const;
    Result<void> draw_served(const model::Node& node, std::span<const gl::DrawItem> full, const gl::DrawItem& item,
                             DrawnForm& form);

    Engine& engine_;
    const model::Model& model_;
    const model::CostModel& costs_;
    model::ItemCosts item_costs_;
};

Result<gl::PixelImage> FormDrawer::picture(const Pose& pose, std::span<const gl::DrawItem> items) {
    engine_.device().draws.plays();
    engine_.draw_unbudgeted(pose, items);
    return engine_.device().read_pixels();
}

double FormDrawer::cost_us(const Pose& pose, std::span<const gl::DrawItem> items) const {
    Pose walk = pose;
    walk.fov_y_rad = Pose().fov_y_rad;
    const model::ViewScale scale = model::make_view_scale(walk, walk_viewport);
    double us = 0;
    for (const gl::DrawItem& item : items) {
        const model::ItemCost cost = item_costs_.of(item.rep, model_.nodes[item.node].box, pose.position, scale);
        us += static_cast<double>(costs_.combine.frame_us(cost.submit_us, cost.raster_us) - costs_.combine.fixed_us);
    }
    return us;
}

/// Where the error is two pixels, if that is farther than the close view and the node can still be seen there.
Result<void> FormDrawer::draw_served(const model::Node& node, std::span<const gl::DrawItem> full, const gl::DrawItem& item,
                                     DrawnForm& form) {
    const double at_m = form.error_m / (served_error_px * pixel_tangent());
    const double px = node.box.diagonal() / (at_m * pixel_tangent());
    form.served_m = at_m;
    if (!(at_m > close_distance_m(node.box)) || px < min_served_px) return {};
    const Pose pose = pose_at(node.box, at_m);
    form.served_us = cost_us(pose, {&item, 1});
    form.full_us = cost_us(pose, full);
    form.served_px = std::min(form_picture_px, (static_cast<std::uint32_t>(px) + 8) / 2 * 2);
    for (const auto& [to, items] :
         {std::pair{&form.served, std::span<const gl::DrawItem>(&item, 1)}, std::pair{&form.full, full}}) {
        auto image = picture(pose, items);
        if (!image) return image.error();
        *to = report::jpeg_data_uri(middle_of(*image, form.served_px), form.served_px, form.served_px, jpeg_quality);
    }
    return {};
}

Result<DrawnNode> FormDrawer::draw(const Chosen& chosen) {
    const model::Node& node = model_.nodes[chosen.node];
    DrawnNode drawn;
    drawn.node = chosen.node;
    drawn.name = model_.name_of(node);
    drawn.kind = model::name_of(node.kind);
    drawn.level = chosen.level;
    drawn.same = chosen.same;
    drawn.triangles = node.triangles;
    drawn.size_m = node.box.diagonal();
    drawn.close_m = close_distance_m(node.box);
    const Pose close = pose_at(node.box, drawn.close_m);
    const std::vector<gl::DrawItem> full = full_detail_below(model_, chosen.node);
    const auto full_image = picture(close, full);
    if (!full_image) return full_image.error();
    drawn.full = report::jpeg_data_uri(full_image->rgba, full_image->width, full_image->height, jpeg_quality);
    drawn.full_us = cost_us(close, full);
    for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
        const model::Representation& rep = model_.reps[r];
        DrawnForm& form = drawn.forms.emplace_back();
        form.kind = model::form_of(rep.kind).name;
        form.triangles = rep.triangles;
        form.error_m = static_cast<double>(rep.error_m);
        form.full_detail = model::is_full_detail(node, r, rep.error_m);
        if (!model_.losses.empty()) form.loss = model_.losses[r];
        form.bytes = bytes_of(model_, rep);
        const gl::DrawItem item{chosen.node, r};
        const auto image = picture(close, {&item, 1});
        if (!image) return image.error();
        form.close = report::jpeg_data_uri(image->rgba, image->width, image->height, jpeg_quality);
        form.close_us = cost_us(close, {&item, 1});
        form.close_psnr_db = psnr_db(*image, *full_image);
        if (form.full_detail) continue;
        if (auto ok = draw_served(node, full, item, form); !ok) return ok.error();
    }
    return drawn;
}

Result<std::unique_ptr<Engine>> open_drawing_engine(const FormPicturesRequest& request, model::Model model,
                                                    const model::CostModel& costs) {
    const auto backend = gl::backend_named(request.backend);
    if (!backend) return backend.error();
    if (!(*backend)->draws())
        return Error{"--backend " + request.backend, "This backend draws no pictures", "Use one of: " + gl::drawing_backends(),
                     ErrorKind::misuse};
    EngineOptions options;
    options.device.kind = (*backend)->kind;
    options.device.viewport = {form_picture_px, form_picture_px};
    options.device.background = false;  // a form alone: what shows where it is not is one colour
    return Engine::open(std::move(model), costs, options);
}

}  // namespace

Result<FormPictures> draw_forms(const FormPicturesRequest& request, const Progress& progress) {
    model::WalkFileInfo info;
    auto model = model::read_walk(request.model_file, &info);
    if (!model) return model.error();
    FormPictures all;
    all.model = request.model_file;
    const std::string state = walk::state_directory(request.state_dir);
    auto table = walk::load_costs(state, "", all.uncalibrated);
    if (!table) return table.error();
    auto costs = walk::fitted_costs(state, *table, {info.hash, walk_viewport.width, walk_viewport.height, request.backend});
    if (!costs) return costs.error();
    const std::vector<Chosen> distinct = distinct_nodes(*model, request.name);
    if (distinct.empty())
        return Error{"--node " + request.name, "No node of " + request.model_file + " has a name with this text",
                     "List the names with `surefoot inspect --tree`", ErrorKind::misuse};
    const std::vector<Chosen> chosen = spread_over_levels(distinct, request.max_nodes);
    all.nodes = static_cast<std::uint32_t>(model->nodes.size());
    all.distinct = static_cast<std::uint32_t>(distinct.size());
    auto engine = open_drawing_engine(request, std::move(*model), *costs);
    if (!engine) return engine.error();
    all.renderer = (*engine)->device().renderer();
    all.machine = measure::machine_identity(all.renderer, 0);
    FormDrawer drawer(**engine, *costs);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        if (progress.stopped())
            return Error{
                request.model_file,
                fmt::format("The drawing was stopped by the user after {} of {} nodes, so no page is written", i, chosen.size()),
                "", ErrorKind::stopped};
        progress.update("forms", static_cast<double>(i) / static_cast<double>(chosen.size()));
        auto drawn = drawer.draw(chosen[i]);
        if (!drawn) return drawn.error();
        all.drawn.push_back(std::move(*drawn));
    }
    return all;
}

}  // namespace surefoot::accuracy
