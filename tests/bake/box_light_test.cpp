// Light of boxes with pictures: sums by hand, pictures that come back by their light, and boxes of a street beside full detail.
#include "render/bake/box_light.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>
#include <string>

#include "render/bake/bake.hpp"
#include "render/effects/effects.hpp"
#include "render/effects/surface_light.hpp"
#include "render/gl/device.hpp"
#include "tests/bake/house_scene.hpp"
#include "tests/bake/squares.hpp"

namespace surefoot::bake {
namespace {

constexpr model::EffectMask all_light = model::effect_sun | model::effect_openness | model::effect_shadow | model::effect_lamps;

/// Two squares of a metre side by side, seen from +z: a white one in the sun, and a grey one under a roof with a lamp.
model::Model lit_pair() {
    model::Model m = squares({{0, 0, 1, {1, 1, 1, 1}}, {1, 0, 1, {0.5F, 0.5F, 0.5F, 1}}});
    for (model::Material& material : m.materials) material.effects = all_light;
    for (model::Vertex& v : m.vertices) v.normal[2] = 127;
    m.sun_direction = dvec3(0, 0.6, 0.8);
    m.sun_seen.assign(m.vertices.size(), model::always_in_sun);
    m.lamp_light.resize(m.vertices.size());
    for (std::size_t v = 4; v < 8; ++v) {
        m.vertices[v].hidden[0] = 255 - 32;  // half of what is enough for all light outside
        m.vertices[v].hidden[2] = 255;
        m.sun_seen[v].share[0] = 51;
        m.lamp_light[v].before[0] = 255;
        m.lamp_light[v].behind[2] = 255;
    }
    m.nodes.resize(1);
    m.nodes[0].rep_count = 1;
    m.nodes[0].box = {dvec3(0), dvec3(2, 1, 0)};
    m.reps[0].part_count = 2;
    return m;
}

constexpr std::uint32_t from_front = 5, from_behind = 4;

/// What a face shows.
struct CapturedFace {
    FormPicture seen;
    std::vector<FaceSample> samples;
    FaceCapture capture;
};

CapturedFace face_of(const model::Model& m, std::uint32_t face) {
    CapturedFace out;
    out.seen.owner = 0;
    out.seen.keeps_sources = true;
    out.seen.clear(view_of(m.nodes[0].box, direction_of_face(face), m.nodes[0].box.centre(), 56));
    draw_form(m, m.reps[0], out.seen);
    out.capture = capture_face(out.seen, m.nodes[0].box, face, 28, &out.samples);
    return out;
}

/// Means over what a face shows.
LightSums means_of(const model::Model& m, std::uint32_t which) {
    const CapturedFace face = face_of(m, which);
    const BoxLight light(m);
    LightSums all;
    for (const FaceSample& s : face.samples) all.add(light.on(face.seen.samples[s.sample], face.seen.sources[s.sample]), 1);
    for (float& sum : all.of) sum /= std::max(all.weight, 1e-9F);
    return all;
}

constexpr double by_bytes = 0.02;  // colours are rounded, and samples on a border belong to one side

TEST(BoxLight, IsTheMeanOfWhatFallsOnWhatAFaceShowsByItsColour) {
    model::Model m = lit_pair();
    const LightSums light = means_of(m, from_front);
    const double grey = 0.5, all = 1 + grey, outside = 0.6 * 4 * 32 / 255.0;
    EXPECT_NEAR(light.of[LightSums::first_sun], 0.8 * (1 + grey * outside * 0.2) / all, by_bytes);
    EXPECT_NEAR(light.of[LightSums::sky], 0.5 * (1 + grey * outside) / all, by_bytes);
    EXPECT_NEAR(light.of[LightSums::ground], light.of[LightSums::sky], 1e-5) << "they look to the horizon";
    EXPECT_NEAR(light.of[LightSums::room], grey * (0.6 - outside) / all, by_bytes);
    EXPECT_NEAR(light.of[LightSums::red], grey / all, by_bytes);
    EXPECT_EQ(light.of[LightSums::blue], 0) << "that shines behind";
    m.placements[0].linear = mat3(vec3(-3, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1));
    m.nodes[0].box = {dvec3(-6, 0, 0), dvec3(0, 1, 0)};
    EXPECT_NEAR(means_of(m, from_front).of[LightSums::first_sun], light.of[LightSums::first_sun], by_bytes)
        << "mirrored and wider";
}

TEST(BoxLight, IsOfTheSideThatOneSees) {
    model::Model m = lit_pair();
    EXPECT_EQ(means_of(m, from_behind).weight, 0) << "one-sided";
    m.materials[0].two_sided = m.materials[1].two_sided = true;
    const LightSums behind = means_of(m, from_behind);
    EXPECT_GT(behind.of[LightSums::blue], 0);
    EXPECT_EQ(behind.of[LightSums::red], 0);
    EXPECT_EQ(behind.of[LightSums::first_sun], 0) << "the sun is on the other side";
}

TEST(BoxLight, LeavesOutWhatIsHidden) {
    model::Model m = lit_pair();
    for (std::size_t v = 4; v < 8; ++v) m.vertices[v].position[0] -= 1, m.vertices[v].position[2] += 0.5F;
    m.nodes[0].box = {dvec3(0), dvec3(1, 1, 0.5)};
    EXPECT_NEAR(means_of(m, from_front).of[LightSums::red], 1, by_bytes) << "only the grey one, before the white one, is seen";
}

TEST(BoxLight, IsTakenFromAllTexelsAndComesBackByTheFace) {
    model::Model m = lit_pair();
    m.nodes[0].box.min.x = -0.5;  // columns that show nothing
    CapturedFace face = face_of(m, from_front);
    const std::vector<std::uint8_t> captured = face.capture.rgba;
    BoxLight(m).take_from(face.capture, {face.seen, face.samples, 28});
    const model::Daylight own = model::daylight_of_model(m.sun_direction, m.light);
    const effects::PictureLight& light = face.capture.light.of_all;
    const vec3 by = effects::light_on_picture(light, own);
    std::uint8_t brightest = 0;
    for (std::size_t at = 0; at < captured.size(); ++at) {
        if (at % 4 == 3)
            ASSERT_EQ(face.capture.rgba[at], captured[at]) << "alphas stay";
        else
            ASSERT_NEAR(face.capture.rgba[at] * by[static_cast<int>(at % 4)], captured[at], 0.7) << at;
        if (at % 4 < 3) brightest = std::max(brightest, face.capture.rgba[at]);
    }
    EXPECT_GT(brightest, 230) << "no darker than it must be";
    model::Daylight dark = own;  // the sky alone
    dark.sun_light = dark.ground_light = vec3(0);
    dark.room_light = 0;
    const double expected = means_of(m, from_front).of[LightSums::sky];
    EXPECT_NEAR(effects::light_on_picture(light, dark).r / effects::light_on_picture(light, own).r,
                0.52 * expected /
                    (0.43 * 2 * expected + 0.56 * means_of(m, from_front).of[LightSums::first_sun] +
                     0.98 * means_of(m, from_front).of[LightSums::room]),
                0.02);
    EXPECT_LT(face.capture.light.lamps[0][0] + 50, face.capture.light.lamps[1][0]) << "the lamp is at the right";
    EXPECT_EQ(face.capture.light.lamps[1][2], 0);
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

model::Model baked(Quality quality, int workers = 0) {
    BakeOptions options;
    options.quality = quality;
    options.workers = workers;
    auto m = bake(lit_street(), options, {});
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

std::set<model::EffectMask> classes_of_boxes(const model::Model& m) {
    std::set<model::EffectMask> out;
    for (const model::Index n : boxed_nodes(m)) out.insert(m.reps[m.nodes[n].first_rep].effects & ~model::effect_alpha_mask);
    return out;
}

TEST(BoxLight, IsOneStateClassForAllBoxesAndNoneInADraft) {
    const model::Model full = baked(Quality::full), draft = baked(Quality::draft);
    ASSERT_FALSE(boxed_nodes(full).empty());
    EXPECT_EQ(classes_of_boxes(full), (std::set<model::EffectMask>{model::effect_texture | model::effect_lit_picture}));
    EXPECT_EQ(classes_of_boxes(draft), (std::set<model::EffectMask>{model::effect_texture}));
    EXPECT_EQ(draft.called_for() & model::effect_lit_picture, 0U);
    EXPECT_TRUE(model::validate(full).ok());
}

TEST(BoxLight, IsTheSameAtAnyNumberOfWorkers) {
    const model::Model one = baked(Quality::full, 1), four = baked(Quality::full, 4);
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
        options.switches = {model::effect_sun | model::effect_shadow, model::effect_lamps};
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
    /// From so far that the node's box is half of the picture.
    [[nodiscard]] Pose pose_at(const model::Node& node, const dvec3& towards) const {
        Pose pose;
        pose.fov_y_rad = 0.05;
        pose.position = node.box.centre() + node.box.diagonal() / std::tan(0.5 * pose.fov_y_rad) * towards;
        pose.orientation = glm::quatLookAt(-towards, std::abs(towards.y) > 0.9 ? dvec3(0, 0, -1) : dvec3(0, 1, 0));
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
    /// Mean of the channels of a picture's pixels that do not show what is behind everything.
    static double brightness_of(const gl::PixelImage& image) {
        double sum = 0, count = 0;
        for (std::size_t at = 0; at < image.rgba.size(); at += 4) {
            if (std::equal(image.rgba.begin(), image.rgba.begin() + 3, image.rgba.begin() + static_cast<std::ptrdiff_t>(at)))
                continue;
            for (std::size_t c = 0; c < 3; ++c) sum += image.rgba[at + c], ++count;
        }
        return count > 0 ? sum / count : 0;
    }
    void set_hour(double hour) {
        device_->draws.plays();
        device_->set_light(model::daylight_at(hour, model_.light));
    }
    [[nodiscard]] double of_box(model::Index n, const dvec3& towards) {
        return brightness_of(draw(pose_at(model_.nodes[n], towards), {{n, model_.nodes[n].first_rep}}));
    }
    [[nodiscard]] double of_full_detail(model::Index n, const dvec3& towards) {
        return brightness_of(draw(pose_at(model_.nodes[n], towards), full_detail_of(n)));
    }
    model::Model model_ = baked(Quality::full);
    std::unique_ptr<gl::Device> device_;
};

constexpr dvec3 from_east(1, 0, 0), from_west(-1, 0, 0), from_south(0, 0, 1), from_north(0, 0, -1), from_above(0, 1, 0);

// By the light that the pictures were captured in, what holes show of the far half differs on some sides. These say nothing of
// light.
TEST_F(LitBoxes, AreAsBrightAsFullDetailOnEverySideAtEachHour) {
    std::size_t sides = 0;
    double largest = 0, smallest = 1e9;
    for (const model::Index n : boxed_nodes(model_)) {
        for (const dvec3& from : {from_east, from_west, from_south, from_north, from_above}) {
            device_->draws.plays();
            device_->set_light(model::daylight_of_model(model_.sun_direction, model_.light));
            const double own = of_full_detail(n, from);
            if (own == 0 || std::abs(of_box(n, from) - own) > 0.03 * own) continue;
            ++sides;
            for (const double hour : {7.0, 9.0, 12.0, 17.0, 22.0}) {
                set_hour(hour);
                const double full = of_full_detail(n, from);
                EXPECT_NEAR(of_box(n, from), full, std::max(0.06 * full, 4.0))
                    << "node " << n << " at " << hour << " h from " << from.x << ' ' << from.y << ' ' << from.z;
                largest = std::max(largest, full);
                smallest = std::min(smallest, full);
            }
        }
    }
    EXPECT_GE(sides, 10U);
    EXPECT_GT(largest, 4 * smallest) << "the hour makes a difference";
}

TEST_F(LitBoxes, FollowTheSwitches) {
    const auto hide = [&](model::EffectMask hidden) {
        device_->draws.plays();
        device_->hide_effects(hidden);
    };
    set_hour(22);
    const double night = of_box(0, from_south);
    hide(model::effect_lamps);
    EXPECT_NEAR(of_box(0, from_south), of_full_detail(0, from_south), 3);
    EXPECT_LT(of_box(0, from_south), 0.8 * night) << "windows no longer glow";
    hide(0);
    EXPECT_NEAR(of_box(0, from_south), night, 1e-9);
    set_hour(12);
    const double noon = of_box(0, from_south);
    hide(model::effect_sun | model::effect_shadow);
    EXPECT_NEAR(of_box(0, from_south), of_full_detail(0, from_south), 8);
    EXPECT_GT(std::abs(of_box(0, from_south) - noon), 3);
}

}  // namespace
}  // namespace surefoot::bake
