// Bench: are boxes with pictures as bright as what they stand for, at each hour and from each side? Draws single boxes and the
// same nodes in full detail, and whole scenes in which what is small shows its box. Compared where both show something.
//
// bench_box_light MODEL.walk [NODES 40] [FOLDER] -> one JSON object. With a folder it writes pictures of the scene.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>
#include <string>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "render/image/image.hpp"
#include "render/model/daylight.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/file.hpp"
#include "tools/report/report.hpp"

using namespace surefoot;

namespace {

constexpr std::uint32_t wide = 480, high = 270;
constexpr std::uint64_t max_triangles = 60000;  // of a node in full detail
constexpr std::size_t min_pixels = 40;
constexpr double own_light = -1;
constexpr std::array<double, 5> hours{own_light, 8, 12, 18, 22};

/// Both pictures, where both show something.
struct Compared {
    std::size_t pixels = 0;
    double full = 0, boxes = 0, squares = 0;  ///< sums of channels
    void add(const Compared& more) { pixels += more.pixels, full += more.full, boxes += more.boxes, squares += more.squares; }
    [[nodiscard]] double ratio() const { return boxes / std::max(full, 1.0); }
    [[nodiscard]] double db() const { return report::psnr_db(squares / std::max(3.0 * double(pixels), 1.0)); }
    [[nodiscard]] double mean(double sum) const { return sum / std::max(3.0 * double(pixels), 1.0); }
};

Compared compare(const gl::PixelImage& full, const gl::PixelImage& boxes, bool behind_too) {
    Compared out;
    const auto shows = [&](const gl::PixelImage& image, std::size_t at) {
        return behind_too || !std::equal(image.rgba.begin(), image.rgba.begin() + 3, image.rgba.begin() + std::ptrdiff_t(at));
    };
    for (std::size_t at = 0; at + 3 < full.rgba.size(); at += 4) {
        if (!shows(full, at) || !shows(boxes, at)) continue;
        ++out.pixels;
        for (std::size_t c = 0; c < 3; ++c) {
            const double a = double(full.rgba[at + c]), b = double(boxes.rgba[at + c]);
            out.full += a, out.boxes += b, out.squares += (a - b) * (a - b);
        }
    }
    return out;
}

struct BoxBench {
    const model::Model& model;
    gl::Device& device;

    gl::PixelImage draw(const Pose& pose, const std::vector<gl::DrawItem>& items) const {
        device.draws.plays();
        device.begin_frame(pose);
        for (std::size_t at = 0; at < items.size(); at += 4096) {
            device.draw(std::span(items).subspan(at, std::min<std::size_t>(4096, items.size() - at)));
            device.end_slice();
        }
        device.end_items();
        device.finish_frame();
        auto image = device.read_pixels();
        return image ? *image : gl::PixelImage{wide, high, std::vector<std::uint8_t>(std::size_t{4} * wide * high)};
    }
    void set_hour(double hour) const {
        device.draws.plays();
        device.set_light(hour < 0 ? model::daylight_of_model(model.sun_direction, model.light)
                                  : model::daylight_at(hour, model.light));
    }
    [[nodiscard]] bool has_box(model::Index n) const {
        return model.reps[model.nodes[n].first_rep].kind == model::RepKind::textured_box;
    }
    /// Full detail below a node; where a node with a box is smaller, that.
    [[nodiscard]] std::vector<gl::DrawItem> items(model::Index root, const Pose& pose, double below_px) const {
        std::vector<gl::DrawItem> out;
        std::vector<model::Index> open{root};
        const double px = high / (2 * std::tan(0.5 * pose.fov_y_rad));
        while (!open.empty()) {
            const model::Index at = open.back();
            const model::Node& node = model.nodes[at];
            open.pop_back();
            const double away = std::max(glm::length(node.box.centre() - pose.position), 1e-3);
            const bool small = px * node.box.diagonal() / away < below_px && away > node.box.diagonal();
            if (small && has_box(at)) {
                out.push_back({at, node.first_rep});
                continue;
            }
            if (node.child_count == 0) out.push_back({at, node.first_rep + node.rep_count - 1});
            for (model::Index c = 0; c < node.child_count; ++c) open.push_back(node.first_child + c);
        }
        return out;
    }
};

/// Looks at a box, which is about size_px large.
Pose pose_at(const Box& box, const dvec3& towards, double size_px) {
    Pose pose;
    pose.fov_y_rad = 0.3;
    const double px = high / (2 * std::tan(0.5 * pose.fov_y_rad));
    pose.position = box.centre() + std::max(px / size_px, 1.0) * box.diagonal() * towards;
    pose.orientation = glm::quatLookAt(-towards, std::abs(towards.y) > 0.99 ? dvec3(0, 0, -1) : dvec3(0, 1, 0));
    return pose;
}

dvec3 direction(double azimuth, double elevation) {
    return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), std::cos(elevation) * std::cos(azimuth)};
}

double quantile(std::vector<double>& values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

std::string name_of_hour(double hour) { return hour < 0 ? "own" : fmt::format("{} h", hour); }

/// 50 views of each: ten azimuths, five heights, five sizes in turn. And faces seen straight on: their ratios apart.
nlohmann::ordered_json nodes_report(const BoxBench& bench, const std::vector<model::Index>& nodes) {
    nlohmann::ordered_json out;
    for (const double hour : hours) {
        bench.set_hour(hour);
        Compared all;
        std::vector<double> ratios, db, by_node, faces;
        for (const model::Index n : nodes) {
            const model::Node& node = bench.model.nodes[n];
            Compared of_node;
            for (int view = 0; view < 56; ++view) {
                const bool face = view >= 50;
                const int ring = view / 10;
                dvec3 towards = direction(0.628 * (view % 10) + 0.11 * ring, 0.04 + 0.3 * ring);
                if (face) towards = dvec3(0), towards[(view - 50) / 2] = view % 2 == 0 ? 1 : -1;
                const Pose pose = pose_at(node.box, towards, face ? 60 : 24 + 18 * (view % 5));
                const Compared one =
                    compare(bench.draw(pose, bench.items(n, pose, 0)), bench.draw(pose, {{n, node.first_rep}}), false);
                if (one.pixels < min_pixels) continue;
                if (face) {
                    faces.push_back(one.ratio());
                    continue;
                }
                ratios.push_back(one.ratio());
                db.push_back(one.db());
                of_node.add(one);
            }
            if (of_node.pixels > 0) by_node.push_back(of_node.ratio());
            all.add(of_node);
        }
        const auto within = [](const std::vector<double>& values, double off) {
            const auto count = std::count_if(values.begin(), values.end(), [&](double v) { return std::abs(v - 1) <= off; });
            return values.empty() ? 0 : double(count) / double(values.size());
        };
        auto& row = out[name_of_hour(hour)];
        row = {{"full", all.mean(all.full)}, {"boxes", all.mean(all.boxes)}, {"ratio", all.ratio()}, {"db", all.db()}};
        row["node_p10_p50_p90"] = {quantile(by_node, 0.1), quantile(by_node, 0.5), quantile(by_node, 0.9)};
        row["nodes_within_5"] = within(by_node, 0.05);
        row["nodes_within_10"] = within(by_node, 0.1);
        row["views_within_10"] = within(ratios, 0.1);
        row["mean_view_db"] = db.empty() ? 0 : std::accumulate(db.begin(), db.end(), 0.0) / double(db.size());
        row["face_p10_p50_p90"] = {quantile(faces, 0.1), quantile(faces, 0.5), quantile(faces, 0.9)};
        row["faces_within_10"] = within(faces, 0.1);
    }
    return out;
}

/// The whole scene from outside, at eight places and two distances: what is below 140 pixels shows its box.
nlohmann::ordered_json scene_report(const BoxBench& bench, const std::string& folder) {
    nlohmann::ordered_json out;
    const Box& box = bench.model.nodes[0].box;
    for (const double hour : hours) {
        bench.set_hour(hour);
        Compared shown, whole;
        for (int view = 0; view < 8; ++view) {
            Pose pose = pose_at(box, direction(0.785 * view + 0.3, view % 2 == 0 ? 0.35 : 0.12), view < 4 ? 900 : 500);
            const gl::PixelImage full = bench.draw(pose, bench.items(0, pose, 0));
            const gl::PixelImage boxes = bench.draw(pose, bench.items(0, pose, 140));
            shown.add(compare(full, boxes, false));
            whole.add(compare(full, boxes, true));
            if (folder.empty() || view % 3 != 0) continue;
            for (const auto& [image, kind] : {std::pair(&full, "full"), std::pair(&boxes, "boxes")}) {
                const std::string name = fmt::format("{}/view{}-{}-{}.png", folder, view, hour < 0 ? 0 : int(hour), kind);
                const auto png = image::encode_png(image->width, image->height, image->rgba);
                if (!write_file(name, std::as_bytes(std::span(png)))) fmt::print(stderr, "cannot write {}\n", name);
            }
        }
        out[name_of_hour(hour)] = {{"full", shown.mean(shown.full)},
                                   {"boxes", shown.mean(shown.boxes)},
                                   {"ratio", shown.ratio()},
                                   {"db", shown.db()},
                                   {"picture_db", whole.db()}};
    }
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return fmt::print(stderr, "bench_box_light MODEL.walk [NODES 40] [FOLDER]\n"), 2;
    auto model = model::read_walk(argv[1]);
    if (!model) return fmt::print(stderr, "{}\n", model.error().text()), 1;
    gl::DeviceOptions options;
    options.viewport = {wide, high};
    options.max_items = 1U << 20U;
    auto opened = gl::open_device(options);
    if (!opened) return fmt::print(stderr, "{}\n", opened.error().text()), 1;
    gl::Device& device = **opened;
    device.draws.plays();
    if (const auto loaded = device.load(*model, effects::assemble_program); !loaded)
        return fmt::print(stderr, "{}\n", loaded.error().text()), 1;
    const BoxBench bench{*model, device};
    std::vector<model::Index> with_box, nodes;
    for (model::Index n = 0; n < model->nodes.size(); ++n)
        if (bench.has_box(n) && model->nodes[n].triangles <= max_triangles) with_box.push_back(n);
    const std::size_t wanted = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 40;
    for (std::size_t i = 0; i < std::min(wanted, with_box.size()); ++i)
        nodes.push_back(with_box[i * with_box.size() / std::min(wanted, with_box.size())]);
    nlohmann::ordered_json out{{"model", argv[1]}, {"boxes", with_box.size()}, {"nodes", nodes.size()}};
    std::size_t classes = 0;
    {
        std::vector<model::EffectMask> masks;
        for (const model::Index n : with_box) masks.push_back(model->reps[model->nodes[n].first_rep].effects);
        std::sort(masks.begin(), masks.end());
        classes = static_cast<std::size_t>(std::unique(masks.begin(), masks.end()) - masks.begin());
    }
    out["state_classes"] = classes;
    out["nodes_alone"] = nodes_report(bench, nodes);
    out["scene"] = scene_report(bench, argc > 3 ? argv[3] : "");
    fmt::print("{}\n", out.dump(1));
    return 0;
}
