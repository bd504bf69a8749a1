// Light of boxes with pictures: means by hand, corners that differ, and boxes of a lit street beside full detail at each hour.
#include "render/bake/box_light.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <string>

#include "render/bake/bake.hpp"
#include "render/bake/boxes.hpp"
#include "render/effects/effects.hpp"
#include "render/gl/device.hpp"
#include "render/model/daylight.hpp"
#include "tests/bake/house_scene.hpp"
#include "tests/bake/squares.hpp"

namespace surefoot::bake {
namespace {

constexpr model::EffectMask all_light = model::effect_sun | model::effect_openness | model::effect_shadow | model::effect_lamps;

/// Two squares of a metre side by side, seen from +z: a white one in the sun, and a grey one that has what a test gives it.
model::Model lit_pair() {
    model::Model m = squares({{0, 0, 1, {1, 1, 1, 1}}, {1, 0, 1, {0.5F, 0.5F, 0.5F, 1}}});
    for (model::Material& material : m.materials) material.effects = all_light;
    for (model::Vertex& v : m.vertices) v.normal[2] = 127;
    m.sun_direction = dvec3(0, 0.6, 0.8);
    m.sun_seen.assign(m.vertices.size(), model::always_in_sun);
    m.lamp_light.resize(m.vertices.size());
    m.nodes.resize(1);
    m.nodes[0].rep_count = 1;
    m.nodes[0].box = {dvec3(0), dvec3(2, 1, 0)};
    m.reps[0].part_count = 2;
    return m;
}

constexpr std::uint32_t from_front = 5, from_behind = 4;

constexpr double sampled = 0.03;  // by 32 samples across

TEST(BoxLight, OfALeafIsTheMeanByWhatShowsAndItsColour) {
    model::Model m = lit_pair();
    for (std::size_t v = 4; v < 8; ++v) {
        m.vertices[v].hidden[0] = 255 - 32;  // half of what is enough for all light outside
        m.vertices[v].hidden[2] = 255;
        m.sun_seen[v].share[0] = 51;
        m.lamp_light[v].before[0] = 255;
    }
    const SeenLight light = LeafLight(m).seen(m.nodes[0], from_front);
    const double grey = 128 / 255.0, sum = 1 + grey, half = 4 * 32 / 255.0;
    EXPECT_NEAR(light.weight, sum / 2, sampled);
    EXPECT_NEAR(light.normal.z, sum / 2, sampled);
    EXPECT_NEAR(light.sky, (1 + grey * half) / 2, sampled);
    EXPECT_NEAR(light.room, (1 + grey * 0.6) / 2, sampled);
    EXPECT_NEAR(light.sun[0], 0.8 * (1 + grey * half * 0.6 * 0.2) / 2, sampled);
    EXPECT_NEAR(light.colour.r, sum / 2, sampled);
    EXPECT_NEAR(light.lamps.r, grey / 2, sampled);
    EXPECT_EQ(light.lamps.g, 0);
    m.placements[0].linear = mat3(vec3(-3, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1));
    m.nodes[0].box = {dvec3(-6, 0, 0), dvec3(0, 1, 0)};
    EXPECT_NEAR(LeafLight(m).seen(m.nodes[0], from_front).sun[0], light.sun[0], sampled) << "mirrored and wider";
}

TEST(BoxLight, OfALeafIsThatOfTheSideThatOneSees) {
    model::Model m = lit_pair();
    EXPECT_EQ(LeafLight(m).seen(m.nodes[0], from_behind).weight, 0) << "one-sided";
    for (std::size_t v = 0; v < 8; ++v) {
        m.vertices[v].hidden[1] = 255;  // behind
        m.lamp_light[v].behind[2] = 255;
    }
    m.materials[0].two_sided = m.materials[1].two_sided = true;
    const SeenLight behind = LeafLight(m).seen(m.nodes[0], from_behind);
    EXPECT_GT(behind.weight, 0);
    EXPECT_EQ(behind.sky, 0);
    EXPECT_LT(behind.normal.z, 0);
    EXPECT_NEAR(behind.lamps.b, behind.colour.b, sampled);
    const SeenLight before = LeafLight(m).seen(m.nodes[0], from_front);
    EXPECT_NEAR(before.sky, before.weight, sampled);
    EXPECT_EQ(before.lamps.b, 0);
    m.materials[0].effects = m.materials[1].effects = 0;
    EXPECT_EQ(LeafLight(m).seen(m.nodes[0], from_front).weight, 0) << "unlit";
}

TEST(BoxLight, OfALeafLeavesOutWhatItHidesItself) {
    // A dark square before a bright one that glows.
    model::Model m = squares({{0, 0, 1, {1, 1, 1, 1}}, {0, 1, 1, {0.5F, 0.5F, 0.5F, 1}}});
    for (model::Material& material : m.materials) material.effects = all_light;
    for (model::Vertex& v : m.vertices) v.normal[2] = 127;
    m.sun_seen.assign(m.vertices.size(), model::always_in_sun);
    m.lamp_light.resize(m.vertices.size());
    for (std::size_t v = 0; v < 4; ++v) m.lamp_light[v].before[0] = 255;
    m.nodes.resize(1);
    m.nodes[0].rep_count = 1;
    m.nodes[0].box = {dvec3(0), dvec3(1, 1, 1)};
    m.reps[0].part_count = 2;
    const SeenLight light = LeafLight(m).seen(m.nodes[0], from_front);
    EXPECT_NEAR(light.weight, 128 / 255.0, 1e-5);
    EXPECT_EQ(light.lamps.r, 0);
}

/// A face of 8 x 8 opaque texels of one colour, but for the lowest row.
FaceCapture plain_face(std::uint8_t colour) {
    FaceCapture face;
    face.rgba.assign(std::size_t{4} * 64, colour);
    for (std::size_t i = 0; i < 64; ++i) face.rgba[4 * i + 3] = i < 8 ? 0 : 255;
    face.covered = 1;
    return face;
}

TEST(BoxLight, OfCornersIsOfWhatShowsNearThem) {
    model::Model m = lit_pair();
    SeenLight dark = LeafLight(m).seen(m.nodes[0], from_front), bright = dark;
    dark.sun.fill(0);
    dark.sky = 0.1F * dark.weight;
    bright.lamps = vec3(0.25F) * bright.colour;
    std::vector<model::Index> owners;
    for (std::size_t i = 0; i < 64; ++i) owners.push_back(i % 8 < 4 ? 0 : 1);
    const SunDirections suns = sun_directions(m);
    FaceCapture face = plain_face(90);
    const std::array<SeenLight, 2> lights{dark, bright};
    light_corners(owners, lights, suns, 8, face);
    ASSERT_EQ(face.light.size(), 4U);
    for (const std::size_t row : {0U, 2U}) {
        const CornerLight &left = face.light[row], &right = face.light[row + 1];
        EXPECT_LT(left.sun.share[0] + 30, right.sun.share[0]);
        EXPECT_GT(left.hidden[0], right.hidden[0]);
        EXPECT_LT(left.lamps.before[1] + 30, right.lamps.before[1]);
        EXPECT_EQ(0, std::memcmp(right.lamps.before, right.lamps.behind, 4));
    }
    light_corners(std::vector<model::Index>(64, 1), lights, suns, 8, face);
    for (const CornerLight& corner : face.light) {
        EXPECT_EQ(corner.sun.share[0], 255);
        EXPECT_EQ(corner.hidden[0], 0);
        EXPECT_NEAR(corner.normal[2], 127, 1);
        EXPECT_NEAR(corner.lamps.before[0], 127.5, 1) << "the root of a quarter";
    }
    light_corners(std::vector<model::Index>(64, model::none), lights, suns, 8, face);
    EXPECT_TRUE(face.light.empty()) << "nothing lit";
}

BoxForm box_with(const FaceCapture& face) {
    BoxForm box;
    box.textured = true;
    box.pixels = 8;
    box.faces[from_front] = face;
    return box;
}

TEST(BoxLight, IsTakenFromThePicturesAndComesBackByTheirCorners) {
    model::Model m = lit_pair();
    FaceCapture face = plain_face(90);
    face.light.resize(4);
    for (std::size_t c = 0; c < 4; ++c) {
        face.light[c].normal = {0, 0, 127};
        face.light[c].sun.share[0] = static_cast<std::uint8_t>(c % 2 == 0 ? 0 : 255);
    }
    BoxForm box = box_with(face);
    take_light(m, box);
    EXPECT_EQ(box.light, model::effect_sun | model::effect_shadow);
    const float shade = 0.5F * (0.34F + 0.52F), sun = shade + 0.8F * 0.56F;  // red, of what looks south
    for (std::uint32_t x = 0; x < 8; ++x) {
        const float light = shade + (static_cast<float>(x) + 0.5F) / 8 * (sun - shade);
        EXPECT_NEAR(box.faces[from_front].rgba[std::size_t{4} * (5 * 8 + x)], 90 / light, 0.51) << x;
    }
    EXPECT_EQ(box.faces[from_front].rgba[3], 0) << "alphas stay";
    EXPECT_EQ(box.faces[from_front].rgba[255], 255);
}

TEST(BoxLight, NeedsNoMoreEffectsThanItHas) {
    const auto effects_with = [](model::Model m, const CornerLight& corner) {
        FaceCapture face = plain_face(90);
        face.light.assign(4, corner);
        BoxForm box = box_with(face);
        take_light(m, box);
        return box.light;
    };
    CornerLight corner;
    corner.normal = {0, 127, 0};
    EXPECT_EQ(effects_with(lit_pair(), corner), model::effect_sun);
    corner.lamps.before[1] = 3;
    corner.sun.share[7] = 254;
    EXPECT_EQ(effects_with(lit_pair(), corner), model::effect_sun | model::effect_shadow | model::effect_lamps);
    model::Model without = lit_pair();
    without.sun_seen.clear();
    EXPECT_EQ(effects_with(without, corner), model::effect_sun | model::effect_lamps) << "the model has no shares";
    without.lamp_light.clear();
    EXPECT_EQ(effects_with(without, corner), model::effect_sun);
    corner.hidden = {255, 255, 0, 0};
    EXPECT_EQ(effects_with(lit_pair(), corner), model::effect_openness | model::effect_lamps) << "a closed room has no sun";
    FaceCapture unlit = plain_face(90);
    BoxForm box = box_with(unlit);
    box.faces[0] = plain_face(50);
    box.faces[0].light.resize(4);
    take_light(lit_pair(), box);
    EXPECT_EQ(box.light, 0U) << "a face without light";
    EXPECT_TRUE(box.faces[0].light.empty());
    EXPECT_EQ(box.faces[0].rgba[32], 50) << "its picture stays";
}

/// A house whose south side has windows that glow, beside a tower that shades it in the morning. A thing with a picture, so that
/// boxes have pictures.
importer::Scene lit_street() {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(2);
    image::Image picture;
    picture.width = picture.height = 4;
    for (int i = 0; i < 16; ++i) picture.rgba.insert(picture.rgba.end(), {150, 140, static_cast<std::uint8_t>(120 + i), 255});
    scene.images.push_back(picture);
    scene.materials[0].image = 0;
    scene.materials[1].colour = {0.1F, 0.1F, 0.12F, 1};
    scene.materials[1].emission = {0.9F, 0.6F, 0.25F};
    importer::Primitive walls, windows;
    lit::add_faces(walls, vec3(-4, 0, -4), vec3(4, 6, 4), false);
    for (const float x : {-2.5F, 0.0F, 2.5F}) lit::add_sheet(windows, vec3(x, 3, 4.02F), vec3(0.8F, 0, 0), vec3(0, 1.2F, 0), 2);
    windows.material = 1;
    scene.meshes.push_back({"house", {std::move(walls), std::move(windows)}});
    place(scene, 0, dvec3(0));
    importer::Primitive tower;
    lit::add_faces(tower, vec3(9, 0, -5), vec3(14, 14, 5), false);
    place(scene, add_mesh(scene, std::move(tower), "tower"), dvec3(0));
    return scene;
}

model::Model full_bake(const importer::Scene& scene, int workers = 0) {
    BakeOptions options;
    options.quality = Quality::full;
    options.workers = workers;
    auto m = bake(scene, options, {});
    EXPECT_TRUE(m.ok()) << (m.ok() ? "" : m.error().text());
    return m.ok() ? std::move(*m) : model::Model{};
}

/// Nodes that have a box with pictures.
std::vector<model::Index> boxed_nodes(const model::Model& m) {
    std::vector<model::Index> out;
    for (model::Index n = 0; n < m.nodes.size(); ++n)
        if (m.reps[m.nodes[n].first_rep].kind == model::RepKind::textured_box) out.push_back(n);
    return out;
}

TEST(BoxLight, IsAnEffectOfBoxesWhereLightIsMeasured) {
    const model::Model m = full_bake(lit_street());
    ASSERT_FALSE(boxed_nodes(m).empty());
    for (const model::Index n : boxed_nodes(m)) EXPECT_NE(m.reps[m.nodes[n].first_rep].effects & model::effect_sun, 0U) << n;
    constexpr model::EffectMask of_all = model::effect_sun | model::effect_shadow | model::effect_lamps;
    EXPECT_EQ(m.reps[m.nodes[0].first_rep].effects & of_all, of_all) << "the tower shades the house, and windows glow";
    EXPECT_TRUE(model::validate(m).ok());
    const auto draft = bake(lit_street(), {}, {});
    ASSERT_TRUE(draft.ok());
    ASSERT_FALSE(boxed_nodes(*draft).empty());
    for (const model::Index n : boxed_nodes(*draft)) EXPECT_EQ(draft->reps[draft->nodes[n].first_rep].effects & all_light, 0U);
}

TEST(BoxLight, IsTheSameAtAnyNumberOfWorkers) {
    const model::Model one = full_bake(lit_street(), 1), four = full_bake(lit_street(), 4);
    const auto same = [](const auto& a, const auto& b) {
        return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0;
    };
    EXPECT_TRUE(same(one.vertices, four.vertices));
    EXPECT_TRUE(same(one.sun_seen, four.sun_seen));
    EXPECT_TRUE(same(one.lamp_light, four.lamp_light));
    EXPECT_TRUE(same(one.texels, four.texels));
}

/// Pictures by a device. Skipped only where the library is missing, or a sanitizer allows no GL.
class LitBoxes : public ::testing::Test {
protected:
    static constexpr std::uint32_t side = 64;
    void SetUp() override {
        gl::DeviceOptions options;
        options.viewport = {side, side};
        auto opened = gl::open_device(options);
        if (!opened && opened.error().kind == ErrorKind::unsupported) GTEST_SKIP() << opened.error().text();
        ASSERT_TRUE(opened.ok()) << opened.error().text();
        device_ = std::move(*opened);
        device_->draws.plays();
        const auto loaded = device_->load(model_, effects::assemble_program);
        ASSERT_TRUE(loaded.ok()) << loaded.error().text();
    }
    gl::PixelImage draw(const Pose& pose, const std::vector<gl::DrawItem>& items) {
        device_->draws.plays();
        device_->begin_frame(pose);
        device_->draw(items);
        device_->end_slice();
        device_->finish_frame();
        auto image = device_->read_pixels();
        EXPECT_TRUE(image.ok());
        return image.ok() ? *image : gl::PixelImage{side, side, std::vector<std::uint8_t>(std::size_t{4} * side * side)};
    }
    /// From such a direction, so that the node's box is half of the picture.
    [[nodiscard]] Pose pose_at(const model::Node& node, double azimuth) const {
        const dvec3 towards(std::cos(0.35) * std::sin(azimuth), std::sin(0.35), std::cos(0.35) * std::cos(azimuth));
        Pose pose;
        pose.fov_y_rad = 0.17;
        pose.position = node.box.centre() + node.box.diagonal() / std::tan(0.5 * pose.fov_y_rad) * towards;
        pose.orientation = glm::quatLookAt(-towards, dvec3(0, 1, 0));
        return pose;
    }
    [[nodiscard]] std::vector<gl::DrawItem> full_detail_of(model::Index root) const {
        std::vector<gl::DrawItem> items;
        std::vector<model::Index> open{root};
        while (!open.empty()) {
            const model::Index at = open.back();
            const model::Node& node = model_.nodes[at];
            open.pop_back();
            if (node.child_count == 0) items.push_back({at, node.first_rep + node.rep_count - 1});
            for (model::Index c = 0; c < node.child_count; ++c) open.push_back(node.first_child + c);
        }
        return items;
    }
    model::Model model_ = full_bake(lit_street());
    std::unique_ptr<gl::Device> device_;
};

/// Mean colours of two pictures, where neither shows what is behind all.
struct Means {
    vec3 a{0.0F}, b{0.0F};
    float pixels = 0;
};
Means means_of(const gl::PixelImage& a, const gl::PixelImage& b) {
    Means out;
    const auto behind = [](const gl::PixelImage& image, std::size_t at) {
        return std::equal(image.rgba.begin(), image.rgba.begin() + 3, image.rgba.begin() + static_cast<std::ptrdiff_t>(at));
    };
    for (std::size_t at = 0; at < a.rgba.size(); at += 4) {
        if (behind(a, at) || behind(b, at)) continue;
        const auto colour = [at](const gl::PixelImage& image) {
            return vec3(image.rgba[at], image.rgba[at + 1], image.rgba[at + 2]);
        };
        out.a += colour(a);
        out.b += colour(b);
        ++out.pixels;
    }
    out.a /= std::max(out.pixels, 1.0F);
    out.b /= std::max(out.pixels, 1.0F);
    return out;
}

TEST_F(LitBoxes, ChangeWithTheHourAsFullDetailDoes) {
    constexpr float max_off = 14;  // of 255, in the mean of a picture
    const std::vector<model::Index> nodes = boxed_nodes(model_);
    std::size_t compared = 0;
    float largest_change = 0;
    for (const model::Index n : nodes) {
        for (const double azimuth : {0.1, 1.7, 3.2, 4.8}) {
            const Pose pose = pose_at(model_.nodes[n], azimuth);
            const auto at_hour = [&](const model::Daylight& light) {
                device_->draws.plays();
                device_->set_light(light);
                return means_of(draw(pose, full_detail_of(n)), draw(pose, {{n, model_.nodes[n].first_rep}}));
            };
            const Means own = at_hour(model::daylight_of_model(model_.sun_direction, model_.light));
            if (own.pixels < 300) continue;  // one side of a wall
            ++compared;
            for (const double hour : {7.0, 9.0, 12.0, 17.0, 22.0}) {
                const Means now = at_hour(model::daylight_at(hour, model_.light));
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(now.a[c] - own.a[c], now.b[c] - own.b[c], max_off)
                        << "node " << n << " from " << azimuth << " at " << hour << " h, " << c;
                    largest_change = std::max(largest_change, std::abs(now.a[c] - own.a[c]));
                }
            }
        }
    }
    EXPECT_GE(compared, 4U);
    EXPECT_GT(largest_change, 4 * max_off);
}

TEST_F(LitBoxes, ShowByNightOnWhichSideWindowsGlow) {
    device_->draws.plays();
    device_->set_light(model::daylight_at(23, model_.light));
    const model::Index root = 0;
    ASSERT_EQ(boxed_nodes(model_).front(), root);
    const std::vector<gl::DrawItem> box{{root, model_.nodes[root].first_rep}};
    const auto brightness = [&](double azimuth) {
        const gl::PixelImage image = draw(pose_at(model_.nodes[root], azimuth), box);
        return means_of(image, image).a.r;
    };
    for (const double other : {1.57, 4.71}) EXPECT_GT(brightness(0), 1.5F * brightness(other)) << other;
}

}  // namespace
}  // namespace surefoot::bake
