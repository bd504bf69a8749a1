// Bench: do coarse forms leave holes, and do objects keep their size? Poses along a path look all round. Each cut may take the
// same time, as in a walk: a share of full detail's median predicted time over all poses, at full resolution. Two engines draw it
// before two skies: where they agree, something is drawn. A hole: the cut shows the sky, but full detail of leaves whose boxes
// are within 50 m covers the pixel and all within two pixels. So a hole before something else is not seen, and an outline that
// draws back by three pixels counts. A size: pixels that a coarse form covers alone, against full detail of what it stands for,
// where either covers over 400 pixels. Only forms wholly in view are sized, at every 25th pose.
//
// bench_coverage MODEL.walk [POSES 1000] [PATH.csv] [LIFT_M] [STATE_DIR] [SHARE 0.5] [PICTURES_DIR] -> one JSON object.
// PICTURES_DIR: cut and full detail at the pose with the most holes, as worst-cut.png and worst-full.png.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "render/engine.hpp"
#include "render/image/image.hpp"
#include "rt/base/check.hpp"
#include "tests/bench/bench_picture.hpp"
#include "tests/bench/bench_scene.hpp"
#include "tools/walk/worst_forms.hpp"

namespace {

using namespace surefoot;
using bench::fail;
using Items = std::vector<gl::DrawItem>;
using Mask = std::vector<std::uint8_t>;  // a byte a pixel: 1 where something is drawn

constexpr double near_m = 50;
constexpr std::size_t min_pixels = 400;
constexpr int round_px = 2;  // of full detail that must be there too
const int usual_green = static_cast<int>(255 * model::usual_sky[1]);
constexpr int poses_a_sizing = 25;  // each form is drawn alone: a pose in so many

/// Two devices: the usual sky, and a black one. The first one chooses the cuts.
class TwoSkies {
public:
    static Result<TwoSkies> open(const bench::SceneArguments& scene, const model::CostModel& costs) {
        TwoSkies two;
        for (int i = 0; i < 2; ++i) {
            auto model = model::read_walk(scene.model_file);
            if (!model) return model.error();
            EngineOptions options;
            options.in_frame_check = false;
            options.resolution = 1;
            options.hysteresis = 1;             // each pose for itself
            options.device.background = false;  // holes are found by the plain colour behind
            if (i == 1) options.device.sky = {0, 0, 0};
            auto engine = Engine::open(std::move(*model), costs, options);
            if (!engine) return engine.error();
            two.engines_[i] = std::move(*engine);
        }
        return two;
    }
    [[nodiscard]] Engine& first() { return *engines_[0]; }
    [[nodiscard]] bench::Pixels picture(const Pose& pose, const Items& items) { return draw(*engines_[0], pose, items); }
    [[nodiscard]] Mask drawn(const Pose& pose, const Items& items) {
        const bench::Pixels a = draw(*engines_[0], pose, items), b = draw(*engines_[1], pose, items);
        Mask mask(a.size() / 4);
        for (std::size_t p = 0; p < mask.size(); ++p) mask[p] = a[4 * p + 1] - b[4 * p + 1] < usual_green / 2 ? 1 : 0;
        return mask;
    }

private:
    static bench::Pixels draw(Engine& engine, const Pose& pose, const Items& items) {
        engine.device().bind();
        engine.draw_unbudgeted(pose, items);
        bench::Pixels pixels = bench::shown(engine.device());
        const model::Viewport v = engine.options().device.viewport;
        CHECK(pixels.size() == std::size_t{4} * v.width * v.height, "A picture could be read");
        engine.device().release();
        return pixels;
    }
    std::array<std::unique_ptr<Engine>, 2> engines_;
};

std::string quoted(const std::string& text) {
    return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::size_t count(const Mask& mask) { return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), 1)); }

double distance_to(const Box& box, const dvec3& eye) {
    return glm::length(glm::max(glm::max(box.min - eye, eye - box.max), dvec3(0.0)));
}

/// Pixels that `cut` leaves open although `full` is there and all round.
std::size_t holes(const Mask& cut, const Mask& full, int width, int height) {
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    std::size_t found = 0;
    for (int y = round_px; y < height - round_px; ++y) {
        for (int x = round_px; x < width - round_px; ++x) {
            if (cut[at(x, y)] != 0) continue;
            bool whole = true;
            for (int v = y - round_px; whole && v <= y + round_px; ++v)
                for (int u = x - round_px; whole && u <= x + round_px; ++u) whole = full[at(u, v)] != 0;
            found += whole ? 1 : 0;
        }
    }
    return found;
}

/// How the sizes of one kind of form are off.
struct Sizes {
    std::size_t forms = 0, small = 0, large = 0;  ///< small: below half of full detail's pixels; large: above twice
    double worst = 1;                             ///< the ratio that is farthest off
    std::string worst_name{};
};

/// Figures over all poses.
struct Coverage {
    double budget_us = 0;
    std::size_t poses = 0, poses_with_holes = 0, pixels = 0, worst_pixels = 0, near_pixels = 0;
    Pose worst_pose;
    Items worst_cut{};
    std::map<std::string, Sizes> sizes;
};

void size_forms(TwoSkies& two, const Pose& pose, const Items& cut, const Items& full, Coverage& out) {
    const model::Model& model = two.first().model();
    const model::Viewport viewport = two.first().options().device.viewport;
    const auto below = walk::full_detail_below(model, cut, full);
    for (std::size_t i = 0; i < cut.size(); ++i) {
        if (below[i].empty()) continue;
        const model::Node& node = model.nodes[cut[i].node];
        const walk::PixelRect part = walk::pixels_of(node.box, pose, viewport);
        if (std::size_t{part.x1 - part.x0} * (part.y1 - part.y0) <= min_pixels) continue;
        if (part.x0 == 0 || part.y0 == 0 || part.x1 == viewport.width || part.y1 == viewport.height)
            continue;  // only in part in view
        const std::size_t whole = count(two.drawn(pose, below[i])), coarse = count(two.drawn(pose, {cut[i]}));
        if (std::max(whole, coarse) <= min_pixels) continue;
        const double ratio = static_cast<double>(coarse) / static_cast<double>(std::max<std::size_t>(whole, 1));
        Sizes& sizes = out.sizes[std::string(model::form_of(model.reps[cut[i].rep].kind).name)];
        ++sizes.forms;
        if (ratio < 0.5) ++sizes.small;
        if (ratio > 2) ++sizes.large;
        const auto off = [](double r) { return std::abs(std::log(std::max(r, 1e-6))); };
        if (off(ratio) <= off(sizes.worst)) continue;
        sizes.worst = ratio;
        sizes.worst_name = model.name_of(node);
    }
}

void prepare(Engine& engine, const Pose& pose, prepare::PreparedFrame& set) {
    engine.device().bind();
    engine.prepare({pose, 0, 0}, 0, 0, 0, set);
    engine.device().release();
}

Items drawn_cut(Engine& engine, const Pose& pose, double budget_us, prepare::PreparedFrame& set) {
    prepare(engine, pose, set);
    engine.device().bind();
    engine.select(set, budget_us, {1, 1}, 0);
    SubmitLimits limits;
    limits.limit_us = 1e12;
    engine.submit(pose, limits);
    Items cut(engine.drawn().begin(), engine.drawn().end());
    engine.device().release();
    return cut;
}

std::vector<Pose> poses_along(const Path& path, int count) {
    std::vector<Pose> poses;
    for (int i = 0; i < count; ++i) {
        poses.push_back(sample_path(path, path.duration_s() * (i + 0.5) / count));
        const double golden_rad = std::numbers::pi * (3 - std::sqrt(5.0));
        poses.back().orientation = glm::angleAxis(golden_rad * i, dvec3(0, 1, 0)) * poses.back().orientation;
    }
    return poses;
}

double median_full_us(Engine& engine, const std::vector<Pose>& poses, prepare::PreparedFrame& set) {
    std::vector<double> times;
    for (const Pose& pose : poses) {
        prepare(engine, pose, set);
        const model::FrameCombine combine = engine.costs().combine_at(1, set.viewport);
        times.push_back(static_cast<double>(combine.frame_us(set.full_cost.submit_us, set.full_cost.raster_us)));
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    return times[times.size() / 2];
}

Coverage covered_along(TwoSkies& two, const std::vector<Pose>& poses, double share) {
    Engine& engine = two.first();
    const model::Viewport viewport = engine.options().device.viewport;
    prepare::PreparedFrame set;
    engine.reserve(set);
    Coverage out;
    out.budget_us = share * median_full_us(engine, poses, set);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Pose& pose = poses[i];
        const Items cut = drawn_cut(engine, pose, out.budget_us, set);
        const Items full = engine.full_detail(pose);
        Items close;
        for (const gl::DrawItem& leaf : full)
            if (distance_to(engine.model().nodes[leaf.node].box, pose.position) <= near_m) close.push_back(leaf);
        const Mask near = two.drawn(pose, close);
        const std::size_t open =
            holes(two.drawn(pose, cut), near, static_cast<int>(viewport.width), static_cast<int>(viewport.height));
        out.near_pixels += count(near);
        ++out.poses;
        out.pixels += open;
        if (open > 0) ++out.poses_with_holes;
        if (open > out.worst_pixels) {
            out.worst_pixels = open;
            out.worst_pose = pose;
            out.worst_cut = cut;
        }
        if (i % poses_a_sizing == 0) size_forms(two, pose, cut, full, out);
    }
    return out;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2)
        return fmt::print(stderr, "bench_coverage MODEL.walk [POSES] [PATH.csv] [LIFT_M] [STATE_DIR] [SHARE] [DIR]\n"), 2;
    const auto argument = [&](int i) { return argc > i ? std::string(argv[i]) : std::string(); };
    const int poses = argc > 2 ? std::max(1, std::atoi(argv[2])) : 1000;
    const double share = argc > 6 ? std::atof(argv[6]) : 0.5;
    const bench::SceneArguments arguments{argument(1), argument(3), argc > 4 ? std::atof(argv[4]) : 0, argument(5)};
    auto scene = bench::open_scene(arguments);
    if (!scene) return fail(scene.error());
    auto two = TwoSkies::open(arguments, scene->costs);
    if (!two) return fail(two.error());
    const Coverage found = covered_along(*two, poses_along(scene->path.path, poses), share);
    std::string sizes;
    std::size_t forms = 0, off = 0;
    for (const auto& [form, s] : found.sizes) {
        forms += s.forms;
        off += s.small + s.large;
        sizes +=
            fmt::format("{}{}: {{\"forms\": {}, \"below_half\": {}, \"above_twice\": {}, \"worst\": {:.3f}, \"worst_name\": {}}}",
                        sizes.empty() ? "" : ", ", quoted(form), s.forms, s.small, s.large, s.worst, quoted(s.worst_name));
    }
    if (const std::string folder = argument(7); !folder.empty() && found.worst_pixels > 0) {
        const Items full = two->first().full_detail(found.worst_pose);
        const model::Viewport v = two->first().options().device.viewport;
        for (const auto& [name, items] : {std::pair{"worst-cut.png", &found.worst_cut}, std::pair{"worst-full.png", &full}}) {
            const bench::Pixels pixels = two->picture(found.worst_pose, *items);
            if (auto written = image::write_png(folder + "/" + name, v.width, v.height, pixels); !written)
                return fail(written.error());
        }
    }
    const auto of = [](std::size_t evidence, std::size_t figure) { return evidence > 0 ? fmt::format("{}", figure) : "null"; };
    fmt::print(
        "{{\"model\": {}, \"share\": {}, \"budget_ms\": {:.3f}, \"poses\": {}, \"near_pixels\": {}, \"poses_with_holes\": {}, "
        "\"hole_pixels\": {}, "
        "\"worst_hole_pixels\": {}, \"forms\": {}, \"forms_off\": {}, \"sizes\": {{{}}}}}\n",
        quoted(arguments.model_file), share, found.budget_us / 1000, found.poses, found.near_pixels, found.poses_with_holes,
        of(found.near_pixels, found.pixels), found.worst_pixels, forms, of(forms, off), sizes);
    return 0;
}
