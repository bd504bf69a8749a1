// Rows: the same picture wherever on Earth the model stands, and a steady one while the eye creeps.
#include <array>
#include <cmath>

#include "render/bake/bake.hpp"
#include "render/measure/image_metrics.hpp"
#include "rt/base/path.hpp"
#include "tools/scenes/scenes.hpp"
#include "tools/selftest/cut_fixture.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/picture.hpp"
#include "tools/selftest/shapes.hpp"

namespace surefoot::selftest {

namespace {

constexpr model::Viewport view{320, 240};
/// No round numbers: what float can hold at that distance, by halves of a metre, hides what it cannot.
const dvec3 on_earth(6.4e6 * 0.6 + 0.377, 6.4e6 * 0.64 - 0.181, -6.4e6 * 0.48 + 0.233);

Pose over_town() {
    Pose pose;
    pose.position = {20.13, 6.07, 95.21};
    pose.orientation = glm::angleAxis(-0.2, glm::normalize(dvec3(0.5, 1, 0)));
    return pose;
}

Pose moved_pose(Pose pose, const dvec3& by, const dquat& turn) {
    pose.position = by + turn * pose.position;
    pose.orientation = turn * pose.orientation;
    return pose;
}

std::vector<gl::DrawItem> some_cut(const model::Model& model, const Pose& pose, double budget_us) {
    CutFixture fixture(model);
    fixture.prepare({pose, 0, 0}, view);
    std::vector<gl::DrawItem> items;
    for (const select::CutItem& item : fixture.select(select::usual_selector, budget_us).items)
        items.push_back({item.node, item.rep});
    return items;
}

double share_equal(const gl::PixelImage& a, const gl::PixelImage& b) {
    return a.rgba.empty() || b.rgba.empty() ? 0 : measure::share_within(a.rgba, b.rgba, 1);
}

/// Not all sky, or the comparison says nothing.
double share_drawn(const gl::PixelImage& image) {
    std::size_t drawn = 0;
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) drawn += is_colour(image, x, y, {0, 0, 255}) ? 0 : 1;
    }
    return image.rgba.empty() ? 0 : static_cast<double>(drawn) / static_cast<double>(image.width * image.height);
}

void translations(const Effort& effort, Outcome& out) {
    const auto device = open_picture(view, effort, out);
    if (!device) return;
    const auto here = import_and_bake(hard_town());
    if (!here) return out.none_of("bakes refused (" + here.error().text() + ")", 1);
    const auto cut = some_cut(*here, over_town(), 2500);
    if (!load(*device, *here, out)) return;
    const gl::PixelImage full = draw(*device, finest_of(*here), over_town()), coarse = draw(*device, cut, over_town());
    double worst_full = 1, worst_cut = 1;
    for (const dvec3& by : {dvec3(1e4 + 0.1, 0, 0), dvec3(-7e5 + 0.3, 2e5, 6e5), on_earth, dvec3(0, 1e7 + 0.7, 0)}) {
        const auto there = import_and_bake(hard_town(by));
        if (!there) return out.none_of("bakes refused (" + there.error().text() + ")", 1);
        const Pose pose = moved_pose(over_town(), by, dquat(1, 0, 0, 0));
        if (!load(*device, *there, out)) return;
        worst_full = std::min(worst_full, share_equal(full, draw(*device, finest_of(*there), pose)));
        const model::Model moved = moved_model(*here, by);
        if (!load(*device, moved, out)) return;
        worst_cut = std::min(worst_cut, share_equal(coarse, draw(*device, cut, pose)));
    }
    out.at_least("pixels within 1/255, baked there, full detail", worst_full, 0.999);
    out.at_least("pixels within 1/255, moved there, a cut", worst_cut, 0.999);
    out.at_least("of the picture drawn on", std::min(share_drawn(full), share_drawn(coarse)), 0.3);
    out.triangles = here->triangles();
}

void rotations(const Effort& effort, Outcome& out) {
    const auto device = open_picture(view, effort, out);
    if (!device) return;
    const auto here = import_and_bake(hard_town());
    if (!here) return out.none_of("bakes refused (" + here.error().text() + ")", 1);
    // Sun and sky are the world's and do not turn with the model: without them only places are compared, by the vertices'
    // colours.
    const auto unlit = [](model::Model model) {
        for (model::Material& m : model.materials) m.effects &= ~static_cast<model::EffectMask>(model::effect_sun);
        for (model::Representation& r : model.reps) r.effects &= ~static_cast<model::EffectMask>(model::effect_sun);
        return model;
    };
    const model::Model unlit_here = unlit(*here);
    if (!load(*device, unlit_here, out)) return;
    const gl::PixelImage full = draw(*device, finest_of(*here), over_town());
    double worst = 1;
    for (const auto& [angle, axis] : {std::pair{0.7, dvec3(1, 2, 3)}, {2.9, dvec3(-1, 0.1, 0.2)}, {1e-4, dvec3(0, 0, 1)}}) {
        const dquat turn = glm::angleAxis(angle, glm::normalize(axis));
        const auto there = import_and_bake(hard_town(on_earth, turn));
        if (!there) return out.none_of("bakes refused (" + there.error().text() + ")", 1);
        const model::Model unlit_there = unlit(*there);
        if (!load(*device, unlit_there, out)) return;
        worst = std::min(worst, share_equal(full, draw(*device, finest_of(*there), moved_pose(over_town(), on_earth, turn))));
    }
    out.at_least("pixels within 1/255, turned", worst, 0.99);
    out.at_least("of the picture drawn on", share_drawn(full), 0.3);
}

/// The generator's town, from its path: baked once, and moved with the cut that was chosen at the origin.
void streets(const Effort& effort, Outcome& out) {
    const auto device = open_picture(view, effort, out);
    if (!device) return;
    const auto town = scenes::generate("town", 0.05, 1);
    if (!town) return out.none_of("scenes refused (" + town.error().text() + ")", 1);
    const auto here = bake::bake(town->scene, {}, {});
    if (!here) return out.none_of("bakes refused (" + here.error().text() + ")", 1);
    double worst = 1, min_drawn = 1;
    for (const double share : {0.2, 0.7}) {
        const Pose pose = sample_path(town->path, share * town->path.duration_s());
        const auto cut = some_cut(*here, pose, 6000);
        if (!load(*device, *here, out)) return;
        const gl::PixelImage image = draw(*device, cut, pose);
        min_drawn = std::min(min_drawn, share_drawn(image));
        for (const dvec3& by : {dvec3(1e6 + 0.3, 0, 0), on_earth}) {
            const model::Model moved = moved_model(*here, by);
            if (!load(*device, moved, out)) return;
            worst = std::min(worst, share_equal(image, draw(*device, cut, moved_pose(pose, by, dquat(1, 0, 0, 0)))));
        }
    }
    out.at_least("pixels within 1/255, moved there, a cut", worst, 0.999);
    out.at_least("of the picture drawn on", min_drawn, 0.3);
    out.triangles = here->triangles();
}

/// Where an edge that leans by a few pixels over the picture lies, read off how many pixels of each row it leaves: the mean over
/// the rows is good to a hundredth of a pixel. Against the same worked out in extended precision.
void creeping(const Effort& effort, Outcome& out) {
    const auto device = open_picture(view, effort, out);
    if (!device) return;
    double worst = 0;
    std::uint64_t frames = 0;
    for (const dvec3& at : {dvec3(0), on_earth}) {
        Squares squares;
        const vec3 up(0.37F, 40, 0);
        const auto node = squares.add(at, vec3(60, 0, 0), up, {1, 0, 0});
        const model::Model model = squares.finish();
        if (!load(*device, model, out)) return;
        const std::array<gl::DrawItem, 1> item{{{node, model.nodes[node].first_rep}}};
        const std::uint64_t max_frames = effort.count(1000, 60);
        for (std::uint64_t i = 0; i < max_frames && !effort.stopped(); ++i, ++frames) {
            const dvec3 eye(0.5 + 1e-3 * static_cast<double>(i), 20, 10 + 3e-4 * static_cast<double>(i));
            Pose pose;
            pose.position = at + eye;
            const gl::PixelImage image = draw(*device, item, pose);
            if (image.rgba.empty()) return out.none_of("pictures that cannot be read", 1);
            // The eye as the frame has it: rounded to double at that distance.
            const dvec3 true_eye = pose.position - at;
            double sum = 0;
            for (std::uint32_t y = 20; y < view.height - 20; ++y) {
                std::uint32_t sky = 0;
                while (sky < view.width && is_colour(image, sky, y, {0, 0, 255})) ++sky;
                const double tan_y = std::tan(0.5 * pose.fov_y_rad), scale = view.height / (2 * tan_y);
                const double height = true_eye.y + (0.5 * view.height - (y + 0.5)) / scale * true_eye.z;
                const double edge = 0.5 * view.width + (0.37F / 40.0 * height - true_eye.x) / true_eye.z * scale;
                sum += sky - std::ceil(edge - 0.5);
            }
            worst = std::max(worst, std::abs(sum / (view.height - 40)));
        }
    }
    out.at_most("an edge off its place", worst, 0.05, "px");
    out.at_least("frames", static_cast<double>(frames), 100);
}

/// A tile as geodesists deliver it: local coordinates under a node at the Earth's surface, the whole globe's axes.
void earth_centred(const Effort&, Outcome& out) {
    const dquat local_up = glm::angleAxis(0.9, glm::normalize(dvec3(0.3, -0.2, 1)));
    auto model = import_and_bake(hard_town(on_earth, local_up));
    if (!model) return out.none_of("bakes refused (" + model.error().text() + ")", 1);
    const auto origin = import_and_bake(hard_town(dvec3(0), local_up));
    if (!origin) return out.none_of("bakes refused (" + origin.error().text() + ")", 1);
    double local = 0, off = 0;
    for (const model::Vertex& v : model->vertices)
        local = std::max<double>(local, glm::length(vec3(v.position[0], v.position[1], v.position[2])));
    const Box &there = model->nodes[0].box, &here = origin->nodes[0].box;
    for (int axis = 0; axis < 3; ++axis) {
        off = std::max(off, std::abs(there.min[axis] - on_earth[axis] - here.min[axis]));
        off = std::max(off, std::abs(there.max[axis] - on_earth[axis] - here.max[axis]));
    }
    double outside = 0;  // of a leaf's full detail as it is placed, out of the leaf's box
    for (const gl::DrawItem& item : finest_of(*model)) {
        const model::Representation& rep = model->reps[item.rep];
        const model::Placement& placement = model->placements[rep.placement];
        for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p) {
            for (std::uint32_t v = 0; v < model->parts[p].vertex_count; ++v) {
                const float* at = model->vertices[model->parts[p].first_vertex + v].position;
                const dvec3 placed = placement.origin + dmat3(placement.linear) * dvec3(at[0], at[1], at[2]);
                outside = std::max(outside, model->nodes[item.node].box.distance(placed));
            }
        }
    }
    float worst_error = 0, worst_here = 0;
    for (const model::Representation& r : model->reps) worst_error = std::max(worst_error, r.error_m);
    for (const model::Representation& r : origin->reps) worst_here = std::max(worst_here, r.error_m);
    out.at_most("largest coordinate of a vertex about its own origin", local, 1000, "m");
    out.at_most("box off its place", off, 1e-8, "m");
    out.at_most("placed vertices out of their boxes", outside, 1e-4, "m");
    out.at_most("worst error bound there over that at the origin",
                static_cast<double>(worst_error) / static_cast<double>(worst_here), 1.1);
    out.exactly("triangles less those at the origin",
                static_cast<double>(model->triangles()) - static_cast<double>(origin->triangles()), 0);
    out.triangles = model->triangles();
    out.digest_of(out.triangles);
    out.digest_of(static_cast<std::uint64_t>(model->nodes.size()));
}

}  // namespace

std::span<const Row> origin_rows() {
    static constexpr std::array<Row, 5> table = {{
        {"N16a", "origin", "a town of awkward objects at 10, 940, 6400 and 10 000 km from the origin, full detail and a cut",
         "the same picture as at the origin", translations},
        {"N16b", "origin", "the same at 6400 km under three odd rotations", "99 % of the pixels as at the origin", rotations},
        {"N16c", "origin", "an edge seen over 1000 frames at 1 mm a frame, at the origin and at 6400 km",
         "it shakes by less than a twentieth of a pixel", creeping},
        {"N16d", "origin", "a tile of an Earth-centred model, its axes the globe's",
         "vertices about their own origin, its place and error bounds kept", earth_centred},
        {"N16e", "origin",
         "the town of `surefoot scene`, from two places of its path, a cut, at 1000 and 6400 km from the origin",
         "the same picture as at the origin", streets},
    }};
    return table;
}

}  // namespace surefoot::selftest
