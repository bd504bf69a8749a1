// Rows: the edges of masks and of what fades: the colour that texels have where nothing shows must not show there. On real GL.
#include <algorithm>
#include <array>
#include <cmath>

#include "rt/base/random.hpp"
#include "tools/selftest/families.hpp"
#include "tools/selftest/picture.hpp"
#include "tools/selftest/shapes.hpp"

namespace surefoot::selftest {

namespace {

using Colour = std::array<std::uint8_t, 3>;

constexpr model::Viewport edge_view{200, 150};
constexpr std::uint32_t texels_across = 64;
constexpr Colour kept_colour{0, 255, 0}, sky_colour{0, 0, 255};
constexpr std::array<Colour, 4> garish = {{{255, 0, 255}, {255, 255, 255}, {0, 0, 0}, {255, 0, 0}}};
constexpr double small_share = 0.02;

/// Where a picture of `texels_across` texels a side shows something.
using Shape = bool (*)(std::uint32_t x, std::uint32_t y);
constexpr std::array<Shape, 4> shapes = {
    [](std::uint32_t x, std::uint32_t y) {  // a disc
        const double dx = x - 31.7, dy = y - 31.2;
        return dx * dx + dy * dy < 23.0 * 23.0;
    },
    [](std::uint32_t x, std::uint32_t) { return x % 8 < 3; },  // a grating, finer than the farther levels
    [](std::uint32_t x, std::uint32_t y) { return x % 16 / 2 == 4 && y % 16 / 2 == 3; },  // dots far apart
    [](std::uint32_t x, std::uint32_t y) { return x + y / 3 < 40; },                      // up to the borders
};

/// Kept texels are opaque; the others have another colour and the alpha `hidden`.
image::Image picture_of(Shape shape, Colour other, std::uint8_t hidden, bool clamp) {
    image::Image image{"picture", texels_across, texels_across, {}, clamp};
    for (std::uint32_t y = 0; y < texels_across; ++y) {
        for (std::uint32_t x = 0; x < texels_across; ++x) {
            const bool shown = shape(x, y);
            const Colour& c = shown ? kept_colour : other;
            image.rgba.insert(image.rgba.end(), {c[0], c[1], c[2], shown ? std::uint8_t{255} : hidden});
        }
    }
    return image;
}

importer::Material material_of(model::AlphaMode alpha) {
    importer::Material material;
    material.image = 0;
    material.alpha = alpha;
    material.two_sided = true;
    material.unlit = true;
    return material;
}

/// A square of 1 m with the whole picture on it.
importer::Primitive card() {
    importer::Primitive p =
        triangles({{-0.5F, -0.5F, 0}, {0.5F, -0.5F, 0}, {0.5F, 0.5F, 0}, {-0.5F, 0.5F, 0}}, {0, 1, 2, 0, 2, 3});
    p.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    return p;
}

/// Share of the cut-out colour in a pixel: what is neither the kept colour nor the sky, nor a mixture of the two.
double stray_share(const gl::PixelImage& image, std::size_t pixel) {
    const std::uint8_t* c = image.rgba.data() + 4 * pixel;
    return std::max<int>(c[0], 255 - c[1] - c[2]) / 255.0;
}

struct Strays {
    double worst = 0;
    std::uint64_t pixels = 0, away = 0;  ///< with more than a small share; of them, more than 1 px from a silhouette
    std::uint64_t edges = 0, drawn = 0;  ///< pixels beside one where nothing is; all where something is

    void add(const gl::PixelImage& image);
};

void Strays::add(const gl::PixelImage& image) {
    if (image.rgba.empty()) worst = 1;
    const auto is_sky = [&](std::uint32_t x, std::uint32_t y) { return is_colour(image, x, y, sky_colour); };
    for (std::uint32_t y = 0; y < image.height; ++y) {
        for (std::uint32_t x = 0; x < image.width; ++x) {
            if (is_sky(x, y)) continue;
            bool edge = false;
            for (std::uint32_t ny = y == 0 ? 0 : y - 1; ny <= std::min(y + 1, image.height - 1); ++ny)
                for (std::uint32_t nx = x == 0 ? 0 : x - 1; nx <= std::min(x + 1, image.width - 1); ++nx) edge |= is_sky(nx, ny);
            const double share = stray_share(image, static_cast<std::size_t>(y) * image.width + x);
            const bool stray = share > small_share;
            worst = std::max(worst, share);
            pixels += stray ? 1 : 0;
            away += stray && !edge ? 1 : 0;
            edges += edge ? 1 : 0;
            ++drawn;
        }
    }
}

/// Before the card, off its middle by no whole number of pixels, where one pixel is as wide as `texels` of its picture.
Pose before_card(double texels, double tilt_rad) {
    const double distance = texels * edge_view.height / (2 * texels_across * std::tan(0.5 * Pose{}.fov_y_rad));
    Pose pose;
    pose.orientation = glm::angleAxis(tilt_rad, glm::normalize(dvec3(0.3, 1, 0)));
    pose.position = pose.orientation * dvec3(0.013, 0.007, distance);
    return pose;
}

void cards(const Effort& effort, Outcome& out) {
    const auto device = open_picture(edge_view, effort, out);
    if (!device) return;
    struct Range {
        std::string name;
        std::vector<double> texels;
        Strays found = {};
    };
    std::array<Range, 3> ranges = {{{"magnified 4 and 16 times", {1.0 / 16, 1.0 / 4}},
                                    {"at a texel a pixel", {1.0}},
                                    {"from 2 to 16 texels a pixel", {2, 4, 8, 16}}}};
    struct Use {
        model::AlphaMode alpha;
        std::uint8_t hidden;  // 100: below the cutoff, and not nothing
    };
    for (const Use use : {Use{model::AlphaMode::mask, 0}, {model::AlphaMode::mask, 100}, {model::AlphaMode::blend, 0}}) {
        for (std::size_t s = 0; s < shapes.size(); ++s) {
            for (const Colour& other : garish) {
                importer::Scene scene = scene_of(card());
                scene.images = {picture_of(shapes[s], other, use.hidden, s % 2 == 0)};
                scene.materials = {material_of(use.alpha)};
                const auto model = import_and_bake(std::move(scene));
                if (!model) return out.none_of("bakes refused (" + model.error().text() + ")", 1);
                if (!load(*device, *model, out)) return;
                for (Range& range : ranges)
                    for (const double texels : range.texels)
                        for (const double tilt : {0.0, 0.9})
                            range.found.add(draw(*device, finest_of(*model), before_card(texels, tilt)));
            }
        }
    }
    std::uint64_t away = 0;
    for (const Range& range : ranges) {
        out.at_most("largest share of what is cut out in a pixel, " + range.name, range.found.worst, small_share);
        out.none_of("pixels with more than 2 % of it, " + range.name, range.found.pixels);
        out.at_least("pixels at a silhouette, " + range.name, static_cast<double>(range.found.edges), 500);
        away += range.found.away;
    }
    out.none_of("of all these, more than 1 px from a silhouette", away);
}

/// Bushes of crossing cards, so that the bake makes every coarser form of them.
importer::Scene bushes(std::uint8_t hidden) {
    importer::Scene scene;
    scene.images = {picture_of(shapes[2], garish[0], hidden, false)};
    scene.materials = {material_of(model::AlphaMode::mask)};
    Random random(25);
    importer::Primitive bush;
    for (int leaf = 0; leaf < 300; ++leaf) {
        const double about = random.range(0, 6.28), down = random.range(-1, 1);
        const dvec3 at{random.range(-1, 1), random.range(-1, 1), random.range(-1, 1)};  // braces: in this order
        const dquat turn = glm::angleAxis(about, dvec3(0, 1, 0)) * glm::angleAxis(down, dvec3(1, 0, 0));
        const importer::Primitive one = card();
        const auto base = static_cast<std::uint32_t>(bush.positions.size());
        for (const vec3& p : one.positions) bush.positions.push_back(vec3(at + turn * (0.4 * dvec3(p))));
        bush.uvs.insert(bush.uvs.end(), one.uvs.begin(), one.uvs.end());
        for (const std::uint32_t i : one.indices) bush.indices.push_back(base + i);
    }
    scene.meshes.push_back({"bush", {bush}});
    for (int i = 0; i < 12; ++i) {
        importer::Node node;
        node.name = "bush";
        node.mesh = 0;
        const int column = i % 4, row = i / 4;
        node.world = moved({4.0 * column + 0.3 * i, 0, 5.0 * row});
        scene.nodes.push_back(node);
    }
    return scene;
}

/// Every form that stands for the cards from afar: fewer of them, meshes in mean colours, boxes with pictures.
void coarse_forms(const Effort& effort, Outcome& out) {
    const auto device = open_picture(edge_view, effort, out);
    if (!device) return;
    Strays found;
    std::uint64_t forms = 0, boxes = 0;
    for (const std::uint8_t hidden : {std::uint8_t{0}, std::uint8_t{100}}) {
        const auto model = import_and_bake(bushes(hidden));
        if (!model) return out.none_of("bakes refused (" + model.error().text() + ")", 1);
        if (!load(*device, *model, out)) return;
        for (model::Index n = 0; n < model->nodes.size() && !effort.stopped(); ++n) {
            const model::Node& node = model->nodes[n];
            for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
                if (node.child_count == 0 && r + 1 == node.first_rep + node.rep_count) continue;  // full detail
                ++forms;
                boxes += model->reps[r].kind == model::RepKind::textured_box ? 1U : 0U;
                for (const double away : {0.8, 4.0}) {
                    Pose pose;
                    pose.orientation = glm::angleAxis(0.6, glm::normalize(dvec3(-0.5, 1, 0)));
                    pose.position = node.box.centre() + pose.orientation * dvec3(0, 0, away * node.box.diagonal());
                    const gl::DrawItem item{n, r};
                    found.add(draw(*device, {&item, 1}, pose));
                }
            }
        }
    }
    out.at_most("largest share of what is cut out in a pixel of a coarse form", found.worst, small_share);
    out.none_of("pixels with more than 2 % of it", found.pixels);
    out.at_least("coarse forms", static_cast<double>(forms), 40);
    out.at_least("of them, boxes with pictures", static_cast<double>(boxes), 4);
    out.at_least("pixels drawn on", static_cast<double>(found.drawn), 10'000);
}

/// An opaque surface shows every texel's colour, whatever its alpha: also of a picture that a mask shares.
void shared_pictures(const Effort& effort, Outcome& out) {
    const auto device = open_picture(edge_view, effort, out);
    if (!device) return;
    std::uint64_t differ = 0, strays = 0, shown = 0;
    for (const model::AlphaMode other : {model::AlphaMode::mask, model::AlphaMode::blend}) {
        gl::PixelImage alone;
        for (const bool shared : {false, true}) {
            importer::Scene scene = scene_of(card());
            scene.images = {picture_of(shapes[0], garish[0], 0, true)};
            scene.materials = {material_of(model::AlphaMode::opaque), material_of(other)};
            importer::Primitive second = card();
            second.material = 1;
            if (shared) place(scene, second, "second", moved({40, 0, 0}));
            const auto model = import_and_bake(std::move(scene));
            if (!model) return out.none_of("bakes refused (" + model.error().text() + ")", 1);
            if (!load(*device, *model, out)) return;
            Pose pose = before_card(0.25, 0.3);
            gl::PixelImage image = draw(*device, finest_of(*model), pose);
            if (!shared) {
                alone = std::move(image);
                continue;
            }
            for (std::size_t i = 0; i < image.rgba.size() && i < alone.rgba.size(); ++i)
                differ += image.rgba[i] != alone.rgba[i] ? 1 : 0;
            Strays all;
            all.add(image);
            shown += all.pixels;
            pose.position.x += 40;
            Strays cut;
            cut.add(draw(*device, finest_of(*model), pose));
            strays += cut.pixels;
        }
    }
    out.none_of("bytes of an opaque card that differ where a mask or what fades shares its picture", differ);
    out.at_least("pixels of it in the colour that the mask cuts out", static_cast<double>(shown), 1000);
    out.none_of("pixels of the mask with more than 2 % of that colour", strays);
}

}  // namespace

std::span<const Row> alpha_edge_rows() {
    static constexpr std::array<Row, 3> table = {{
        {"N25a", "alpha_edges",
         "cards whose cut-out texels are magenta, white, black or red. They are cut by alpha 0 or below the cutoff, or faded. "
         "Shapes are a disc, a grating and dots, up to the border; 16 pixels a texel to 16 texels a pixel, head-on and aslant",
         "no pixel takes on the colour of what is cut out", cards},
        {"N25b", "alpha_edges", "bushes of such cards in every coarser form: fewer cards, mean colours, boxes with pictures",
         "no pixel takes on the colour of what is cut out", coarse_forms},
        {"N25c", "alpha_edges", "a picture that an opaque card shares with a mask, and with what fades",
         "the opaque one shows all its colours, the other none of those cut out", shared_pictures},
    }};
    return table;
}

}  // namespace surefoot::selftest
