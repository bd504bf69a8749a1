// Bench: no shadows, baked visibility and a shadow map of everything: what a frame takes, and how near its picture is to a ray
// to the sun for each pixel. Frames of full detail are drawn in turns; counted is the CPU time of the process.
//
// The map is the device's own for what moves, 512 x 512 texels with 2 x 2 of them compared. Here all that is opaque casts and all
// that the sun lights receives. It is a square about a place before the eye; what is beyond it is in the sun. Pixels that show a
// pane or water do not count: they show two surfaces.
// bench_shadow_methods MODEL.walk [POSES 4] [ROUNDS 5] [FOLDER] -> one JSON object, with h8, h12 and h18. With a folder
// it writes the pictures.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "render/image/image.hpp"
#include "render/measure/flip.hpp"
#include "render/measure/image_metrics.hpp"
#include "render/model/daylight.hpp"
#include "render/model/motion.hpp"
#include "render/model/view.hpp"
#include "render/model/walk_file.hpp"
#include "rt/base/random.hpp"
#include "rt/base/statistics.hpp"
#include "tests/bench/detail_rays.hpp"
#include "tools/report/report.hpp"
#include "tools/walk/path_source.hpp"
#include "tools/walk/tour_controller.hpp"

namespace {

using namespace surefoot;
using bench::DetailRays;
using model::Index;

constexpr model::Viewport viewport{1280, 720};
constexpr std::array<double, 3> hours{8, 12, 18};
constexpr std::array<double, 4> radii_m{30, 60, 120, 240};
constexpr double before_the_eye = 0.6;  // of the radius: where the middle of the map is
constexpr double rim_texels = 4;        // empty ones round the map
constexpr double lift_m = 0.02;         // of a ray's start off its surface

/// A way to have shadows: a frame's time and the picture's distance from the truth, at all poses.
struct Method {
    std::string name;
    model::EffectMask hidden = 0;
    double radius_m = 0;  ///< of the map; 0: none is drawn
    bool shows_map = false;
    std::vector<double> ms = {}, more_ms = {}, more_percent = {};
    std::vector<double> mse = {}, ssim = {}, flip = {};
    std::size_t casters = 0;
    std::uint64_t cast_triangles = 0;
};

std::vector<Method> methods() {
    std::vector<Method> all{{"none", model::effect_shadow | model::effect_moving_shadow}, {"baked", model::effect_moving_shadow}};
    for (const double radius : radii_m) all.push_back({fmt::format("map_{:.0f}_m", radius), model::effect_shadow, radius, true});
    all.push_back({"map_kept", model::effect_shadow, 0, true});  // the map of the method before
    return all;
}

/// All that the sun lights receives, and the device makes programs for all that casts: a part of each state moves, by nothing.
void let_all_receive(model::Model& m) {
    for (model::Material& material : m.materials)
        if ((material.effects & model::effect_sun) != 0) material.effects |= model::effect_moving_shadow;
    for (model::EffectFinding& finding : m.effects)
        if (finding.bit == model::effect_moving_shadow) finding.called_for = true;
    model::Motion still;
    still.first_key = static_cast<std::uint32_t>(m.motion_keys.size());
    still.key_count = 1;
    m.motion_keys.emplace_back();
    m.motions.push_back(still);
    std::set<model::EffectMask> states;
    for (model::Representation& rep : m.reps)
        for (Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            const model::EffectMask state = m.materials[m.parts[p].material].effects;
            rep.effects |= state;
            model::Placement& place = m.placements[rep.placement];
            if (states.insert(state).second && place.motion == model::none)
                place.motion = static_cast<Index>(m.motions.size() - 1);
        }
}

/// A map, and what is drawn into it.
struct SunMap {
    gl::ShadowView view;
    std::vector<gl::DrawItem> casters;
    std::uint64_t triangles = 0;
};

/// As the product plans its own map, but for what it holds.
class MapPlan {
public:
    MapPlan(const model::Model& m, const Pose& eye, const vec3& towards, double radius_m) : m_(m), half_m_(radius_m) {
        z_ = glm::normalize(dvec3(towards));
        x_ = glm::normalize(glm::cross(std::abs(z_.y) < 0.99 ? dvec3(0, 1, 0) : dvec3(1, 0, 0), z_));
        y_ = glm::cross(z_, x_);
        const dvec3 level = glm::normalize(eye.forward() * dvec3(1, 0, 1) + dvec3(1e-9, 0, 0));
        const double texel_m = 2 * half_m_ / gl::shadow_map_px;
        const Box whole = along(m.nodes[0].box);
        const dvec3 place = eye.position + before_the_eye * radius_m * level;
        middle_ = {glm::dot(place, x_), glm::dot(place, y_), whole.centre().z};
        for (int i = 0; i < 2; ++i) middle_[i] = texel_m * std::floor(middle_[i] / texel_m + 0.5);
        const double depth_m = 1.2 * 2 * whole.half().z;
        map_.view.origin = x_ * middle_.x + y_ * middle_.y + z_ * middle_.z;
        map_.view.from_origin = mat4(mat3(glm::transpose(dmat3(x_ / half_m_, y_ / half_m_, z_ / depth_m))));
        map_.view.from_origin[3] = vec4(0, 0, 0.55F, 1);
        map_.view.towards = vec3(z_);
        map_.view.texel_m = static_cast<float>(texel_m);
        map_.view.depth_m = static_cast<float>(depth_m);
        add(0);
    }
    [[nodiscard]] const SunMap& map() const { return map_; }

private:
    [[nodiscard]] Box along(const Box& box) const {
        Box out;
        for (unsigned c = 0; c < 8; ++c) {
            const dvec3 at((c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y,
                           (c & 4U) != 0 ? box.max.z : box.min.z);
            out.grow(dvec3(glm::dot(at, x_), glm::dot(at, y_), glm::dot(at, z_)));
        }
        return out;
    }
    /// Of the forms that are off by a texel at most, the one with the fewest triangles. What reaches over the rim casts nothing.
    void add(Index index) {
        const model::Node& node = m_.nodes[index];
        const Box box = along(node.box);
        const double inside_m = half_m_ * (1 - 2 * rim_texels / gl::shadow_map_px);
        const bool beside = box.min.x > middle_.x + inside_m || box.max.x < middle_.x - inside_m ||
                            box.min.y > middle_.y + inside_m || box.max.y < middle_.y - inside_m;
        if (beside) return;
        const bool whole = box.min.x >= middle_.x - inside_m && box.max.x <= middle_.x + inside_m &&
                           box.min.y >= middle_.y - inside_m && box.max.y <= middle_.y + inside_m;
        Index best = model::none;
        for (Index r = node.first_rep; whole && r < node.first_rep + node.rep_count; ++r) {
            const bool finest = node.child_count == 0 && r + 1 == node.first_rep + node.rep_count;
            if (m_.reps[r].error_m > map_.view.texel_m && !finest) continue;
            if (model::casting_of(m_, m_.reps[r]) != model::Casting::casts) continue;
            if (best == model::none || m_.reps[r].triangles < m_.reps[best].triangles) best = r;
        }
        if (best != model::none) {
            map_.casters.push_back({index, best});
            map_.triangles += m_.reps[best].triangles;
            return;
        }
        for (Index c = 0; c < node.child_count; ++c) add(node.first_child + c);
    }

    const model::Model& m_;
    double half_m_;
    dvec3 x_{0.0}, y_{0.0}, z_{0.0}, middle_{0.0};
    SunMap map_;
};

double cpu_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// What is in view in full detail, from near to far.
std::vector<gl::DrawItem> full_detail(const model::Model& m, const Pose& eye) {
    const model::Frustum frustum = model::make_frustum(eye, viewport, model::far_corners_m(m.nodes[0].box));
    std::vector<gl::DrawItem> items;
    for (Index n = 0; n < m.nodes.size(); ++n)
        if (m.nodes[n].child_count == 0 && model::visible(frustum, m.nodes[n].box))
            items.push_back({n, m.nodes[n].first_rep + m.nodes[n].rep_count - 1});
    std::stable_sort(items.begin(), items.end(), [&](const gl::DrawItem& a, const gl::DrawItem& b) {
        return m.nodes[a.node].box.distance(eye.position) < m.nodes[b.node].box.distance(eye.position);
    });
    return items;
}

class ShadowBench {
public:
    ShadowBench(const model::Model& m, const DetailRays& rays, std::unique_ptr<gl::Device> device, std::string folder)
        : m_(m), rays_(rays), device_(std::move(device)), folder_(std::move(folder)) {}

    /// As JSON.
    std::string at_hour(double hour, const Path& path, std::size_t poses, int rounds) {
        light_ = model::daylight_at(hour, m_.light);
        always_hidden_ = effects::without_effect_in(light_);
        std::vector<Method> all = methods();
        for (std::size_t p = 0; p < poses; ++p) {
            const double share = (static_cast<double>(p) + 0.5) / static_cast<double>(poses);
            eye_ = walk::pose_at(path, path.duration_s() * share);
            items_ = full_detail(m_, eye_);
            at_pose(all, fmt::format("{:02.0f}h-{}", hour, p), rounds);
        }
        std::vector<std::string> texts;
        for (const Method& method : all) texts.push_back(fmt::format(R"("{}": {})", method.name, text(method)));
        return fmt::format(R"("h{:.0f}": {{{}}})", hour, fmt::join(texts, ", "));
    }
    [[nodiscard]] double panes_percent() const {
        return 100.0 * double(pane_pixels_) / double(std::max<std::size_t>(pixels_, 1));
    }
    void end() {
        device_->draws.plays();
        device_->release();
    }

private:
    void draw(const Method& method, const SunMap* map) {
        device_->draws.plays();
        device_->hide_effects(always_hidden_ | method.hidden);
        device_->show_shadow(method.shows_map);
        if (map != nullptr) device_->refresh_shadow(map->view, map->casters);
        device_->begin_frame(eye_);
        constexpr std::size_t slice = 1024;
        for (std::size_t at = 0; at < items_.size(); at += slice) {
            device_->draw(std::span(items_).subspan(at, std::min(slice, items_.size() - at)));
            device_->end_slice();
        }
        device_->end_items();
        device_->finish_frame();
    }
    gl::PixelImage picture(const model::Daylight& light, const Method& method, const SunMap* map) {
        device_->draws.plays();
        device_->set_light(light);
        draw(method, map);
        auto image = device_->read_pixels();
        if (image) return *image;
        return {viewport.width, viewport.height, std::vector<std::uint8_t>(std::size_t{4} * viewport.width * viewport.height)};
    }
    /// With all of the sun where a ray meets nothing, and without the sun elsewhere. Finds the pixels that show a pane.
    gl::PixelImage truth(const gl::PixelImage& lit, const gl::PixelImage& dark) {
        gl::PixelImage out = dark;
        panes_.clear();
        const dvec3 towards = glm::normalize(dvec3(light_.sun_direction));
        const double half_y = std::tan(0.5 * eye_.fov_y_rad), half_x = half_y * viewport.width / viewport.height;
        for (std::uint32_t y = 0; y < viewport.height; ++y)
            for (std::uint32_t x = 0; x < viewport.width; ++x) {
                const auto at = std::ptrdiff_t{4} * (std::ptrdiff_t{y} * viewport.width + x);
                if (std::equal(&lit.rgba[std::size_t(at)], &lit.rgba[std::size_t(at)] + 4, &dark.rgba[std::size_t(at)])) continue;
                const dvec3 way = glm::normalize(eye_.forward() + eye_.right() * (half_x * (2 * (x + 0.5) / viewport.width - 1)) -
                                                 eye_.up() * (half_y * (2 * (y + 0.5) / viewport.height - 1)));
                const auto hit = rays_.nearest(eye_.position, way, DetailRays::Sides::shown);
                if (hit && hit->pane) panes_.push_back(at);
                if (hit) {
                    const dvec3 off = glm::dot(hit->normal, towards) < 0 ? -hit->normal : hit->normal;
                    if (rays_.blocked(eye_.position + hit->away_m * way + lift_m * off, towards)) continue;
                }
                std::copy_n(lit.rgba.begin() + at, 4, out.rgba.begin() + at);
            }
        return out;
    }
    void at_pose(std::vector<Method>& all, const std::string& name, int rounds) {
        model::Daylight sunless = light_;
        sunless.sun_light = vec3(0);
        const gl::PixelImage dark = picture(sunless, all[0], nullptr), lit = picture(light_, all[0], nullptr);
        const gl::PixelImage expected = truth(lit, dark);
        write(expected, name, "rays");
        pane_pixels_ += panes_.size();
        pixels_ += expected.rgba.size() / 4;
        std::vector<SunMap> maps(all.size());
        for (std::size_t i = 0; i < all.size(); ++i) {
            Method& method = all[i];
            if (method.radius_m > 0) maps[i] = MapPlan(m_, eye_, light_.sun_direction, method.radius_m).map();
            method.casters = std::max(method.casters, maps[i].casters.size());
            method.cast_triangles = std::max(method.cast_triangles, maps[i].triangles);
            if (method.shows_map && !(method.radius_m > 0)) continue;
            gl::PixelImage shown = picture(light_, method, maps[i].casters.empty() ? nullptr : &maps[i]);
            write(shown, name, method.name);
            for (const std::ptrdiff_t at : panes_) std::copy_n(expected.rgba.begin() + at, 4, shown.rgba.begin() + at);
            method.mse.push_back(measure::snr(shown.rgba, expected.rgba).mse);
            method.ssim.push_back(measure::ssim(shown.rgba, expected.rgba, viewport.width, viewport.height));
            method.flip.push_back(measure::flip(shown.rgba, expected.rgba, viewport.width, viewport.height));
        }
        time_in_turns(all, maps, rounds);
    }
    /// Forwards and backwards. Frames with a map take long, so they come in every third round.
    void time_in_turns(std::vector<Method>& all, const std::vector<SunMap>& maps, int rounds) {
        for (int round = 0; round < 3 * rounds; ++round) {
            std::vector<double> ms(all.size());
            for (std::size_t k = 0; k < all.size(); ++k) {
                const std::size_t i = round % 2 == 0 ? k : all.size() - 1 - k;
                if (all[i].shows_map && round % 3 != 0) continue;
                const double begun = cpu_ms();
                draw(all[i], maps[i].casters.empty() ? nullptr : &maps[i]);
                ms[i] = cpu_ms() - begun;
            }
            for (std::size_t i = 0; i < all.size(); ++i) {
                if (!(ms[i] > 0)) continue;
                all[i].ms.push_back(ms[i]);
                all[i].more_ms.push_back(ms[i] - ms[0]);
                all[i].more_percent.push_back(100 * (ms[i] / ms[0] - 1));
            }
        }
    }
    void write(const gl::PixelImage& image, const std::string& pose, const std::string& of) const {
        if (folder_.empty()) return;
        const std::string file = fmt::format("{}/{}-{}.png", folder_, pose, of);
        if (auto ok = image::write_png(file, image.width, image.height, image.rgba); !ok)
            fmt::print(stderr, "{}\n", ok.error().text());
    }
    static std::string quartiles(const std::vector<double>& of) {
        return fmt::format("[{:.2f}, {:.2f}, {:.2f}]", quantile_of(of, 0.25), quantile_of(of, 0.5), quantile_of(of, 0.75));
    }
    static double mean(const std::vector<double>& of) {
        return std::accumulate(of.begin(), of.end(), 0.0) / static_cast<double>(std::max<std::size_t>(of.size(), 1));
    }
    static std::string text(const Method& m) {
        std::string out =
            fmt::format(R"({{"frame_ms": {}, "more_ms": {}, "more_percent": {}, "casters": {}, "cast_triangles": {})",
                        quartiles(m.ms), quartiles(m.more_ms), quartiles(m.more_percent), m.casters, m.cast_triangles);
        if (!m.mse.empty())
            out += fmt::format(R"(, "psnr_db": {:.2f}, "ssim": {:.4f}, "flip": {:.4f})", report::psnr_db(mean(m.mse)),
                               mean(m.ssim), mean(m.flip));
        return out + "}";
    }

    const model::Model& m_;
    const DetailRays& rays_;
    std::unique_ptr<gl::Device> device_;
    std::string folder_;
    model::Daylight light_;
    model::EffectMask always_hidden_ = 0;
    Pose eye_;
    std::vector<gl::DrawItem> items_;
    std::vector<std::ptrdiff_t> panes_;  ///< bytes of pixels that do not count
    std::size_t pane_pixels_ = 0, pixels_ = 0;
};

/// Rays between random places of the model: the tree must find what trying every triangle finds.
bool rays_are_right(const model::Model& m, const DetailRays& rays) {
    Random random(1);
    const Box& box = m.nodes[0].box;
    const auto place = [&] {
        dvec3 at(0);
        for (int i = 0; i < 3; ++i) at[i] = box.min[i] + random.unit() * (box.max[i] - box.min[i]);
        return at;
    };
    std::size_t met = 0;
    for (int i = 0; i < 60; ++i) {
        const dvec3 from = place(), way = glm::normalize(place() - from);
        const auto sides = i % 2 == 0 ? DetailRays::Sides::hiding : DetailRays::Sides::shown;
        const auto found = rays.nearest(from, way, sides), expected = rays.tried(from, way, sides);
        if (found.has_value() != expected.has_value() || (found && found->away_m != expected->away_m)) return false;
        if (i % 2 == 0 && rays.blocked(from, way) != expected.has_value()) return false;
        met += expected ? 1 : 0;
    }
    return met > 0;
}

int fail(const std::string& what) {
    fmt::print(stderr, "bench_shadow_methods: {}\n", what);
    return 1;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return fmt::print(stderr, "bench_shadow_methods MODEL.walk [POSES 4] [ROUNDS 5] [FOLDER]\n"), 2;
    auto model = model::read_walk(argv[1]);
    if (!model) return fail(model.error().text());
    if (model->sun_seen.empty()) return fail("The model has no baked shadows. Bake it with --quality full.");
    auto path = walk::choose_path("", argv[1], *model, 0);
    if (!path) return fail(path.error().text());
    const DetailRays rays(*model);
    if (!rays_are_right(*model, rays)) return fail("The rays are wrong.");
    let_all_receive(*model);
    gl::DeviceOptions options;
    options.viewport = viewport;
    options.switches = {model::effect_shadow, model::effect_moving_shadow, model::effect_lamps};
    auto device = gl::open_device(options);
    if (!device) return fail(device.error().text());
    (*device)->bind();
    (*device)->draws.plays();
    if (auto ok = (*device)->load(*model, effects::assemble_program); !ok) return fail(ok.error().text());
    const auto poses = static_cast<std::size_t>(argc > 2 ? std::max(1, std::atoi(argv[2])) : 4);
    ShadowBench shadows(*model, rays, std::move(*device), argc > 4 ? argv[4] : "");
    const int rounds = argc > 3 ? std::max(1, std::atoi(argv[3])) : 5;
    std::vector<std::string> texts;
    for (const double hour : hours) texts.push_back(shadows.at_hour(hour, path->path, poses, rounds));
    shadows.end();
    fmt::print("{{\"poses\": {}, \"triangles\": {}, \"panes_percent\": {:.2f}, {}}}\n", poses, rays.triangles(),
               shadows.panes_percent(), fmt::join(texts, ", "));
    return 0;
}
