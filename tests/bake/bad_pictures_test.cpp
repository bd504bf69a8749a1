// Pictures and sheets that give a coarse form nothing to go by: the object is still drawn, and no bound is broken.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "render/bake/bake.hpp"
#include "render/bake/form_picture.hpp"
#include "tests/bake/scenes.hpp"
#include "tests/bake/surface.hpp"

namespace surefoot::bake {
namespace {

using Texel = std::array<std::uint8_t, 4>;

importer::Index add_picture(importer::Scene& scene, std::uint32_t size, const Texel& even, const Texel& odd) {
    image::Image image;
    image.width = image.height = size;
    for (std::uint32_t y = 0; y < size; ++y)
        for (std::uint32_t x = 0; x < size; ++x) {
            const Texel& texel = (x + y) % 2 == 0 ? even : odd;
            image.rgba.insert(image.rgba.end(), texel.begin(), texel.end());
        }
    scene.images.push_back(std::move(image));
    return static_cast<importer::Index>(scene.images.size() - 1);
}

importer::Index add_material(importer::Scene& scene, importer::Index image, bool masked) {
    importer::Material material;
    material.image = image;
    material.alpha = masked ? model::AlphaMode::mask : model::AlphaMode::opaque;
    material.two_sided = true;
    scene.materials.push_back(material);
    return static_cast<importer::Index>(scene.materials.size() - 1);
}

/// A scene with a white ball in it, at x = 6.
importer::Scene with_a_ball() {
    importer::Scene scene;
    scene.materials.emplace_back();
    place(scene, add_mesh(scene, ball(12, 1), "ball"), dvec3(6, 1, 0));
    return scene;
}

importer::Primitive sheet(importer::Index material) {
    importer::Primitive p = grid_surface(8, 8, [](float u, float v) { return vec3(3 * u, 3 * v, 0); });
    p.material = material;
    return p;
}

/// Bakes it: all of the scene is there, no sample lies beyond its bound, and every node has a form from everywhere.
void expect_sound(const importer::Scene& scene, const char* name) {
    const auto m = bake(scene, {}, {});
    ASSERT_TRUE(m.ok()) << name << ": " << m.error().text();
    EXPECT_TRUE(model::validate(*m).ok()) << name;
    EXPECT_EQ(m->triangles(), scene.triangles()) << name;
    EXPECT_EQ(m->object_count, scene.nodes.size()) << name;
    for (const Judged& j : judge(*m, 500, 1))
        EXPECT_LE(j.sampled, j.bound + j.rounding) << name << ", node " << j.node << " representation " << j.rep;
    for (const model::Node& node : m->nodes) {
        bool drawable = false;
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) drawable |= m->reps[r].everywhere;
        EXPECT_TRUE(drawable) << name;
    }
}

/// One sample of a picture that the bake draws, without light, from the front.
struct ShownSample {
    dvec3 at;
    std::array<std::uint8_t, 3> rgb;  ///< with textures as from near
};

using Samples = std::vector<ShownSample>;

Samples shown_by(const model::Model& m, const model::Representation& rep, const Box& box) {
    FormPicture picture;
    picture.clear(view_of(box, direction_of(0, 0), box.centre(), 128), false);
    draw_form(m, rep, picture);
    const double pixel_m = std::ldexp(1.0, picture.view.exponent);
    Samples shown;
    for (std::size_t i = 0; i < picture.samples.size(); ++i) {
        const FormSample& sample = picture.samples[i];
        if (!sample.covered()) continue;
        const std::size_t x = i % picture.view.width, y = i / picture.view.width;
        const auto column = static_cast<double>(x), row = static_cast<double>(y);
        shown.push_back({picture.view.middle + dvec3(pixel_m * (static_cast<double>(picture.view.left) + column),
                                                     pixel_m * (static_cast<double>(picture.view.low) + row),
                                                     static_cast<double>(sample.depth)),
                         sample.rgb[0]});
    }
    return shown;
}

/// Calls use(representation, its samples from the front, those of full detail) for each form of each node of that name.
template <class Use>
void for_forms(const model::Model& m, std::string_view name, Use use) {
    std::size_t nodes = 0;
    for (const model::Node& node : m.nodes) {
        if (node.child_count > 0 || m.name_of(node) != name) continue;
        ++nodes;
        const auto full = shown_by(m, m.reps[node.first_rep + node.rep_count - 1], node.box);
        EXPECT_GE(node.rep_count, 2U) << name << " has no coarse form";
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r)
            use(m.reps[r], shown_by(m, m.reps[r], node.box), full);
    }
    EXPECT_GE(nodes, 1U) << name;
}

bool is_textured(const model::Model& m, const model::Representation& rep) {
    for (model::Index p = rep.first_part; p < rep.first_part + rep.part_count; ++p)
        if (m.materials[m.parts[p].material].texture != model::none) return true;
    return false;
}

/// The scene without light, baked: pictures have the colours of their textures.
model::Model bake_unlit(importer::Scene scene) {
    for (importer::Material& material : scene.materials) material.unlit = true;
    auto m = bake(scene, {}, {});
    EXPECT_TRUE(m.ok()) << (m.ok() ? "" : m.error().text());
    return m.ok() ? std::move(*m) : model::Model{};
}

TEST(BadPictures, OfOneTexelAreColours) {
    importer::Scene scene = with_a_ball();
    const auto red = add_picture(scene, 1, {200, 30, 30, 255}, {200, 30, 30, 255});
    place(scene, add_mesh(scene, sheet(add_material(scene, red, false)), "opaque"), dvec3(0));
    place(scene, add_mesh(scene, sheet(add_material(scene, red, true)), "masked"), dvec3(0, 0, 3));
    expect_sound(scene, "one texel");
    const model::Model m = bake_unlit(scene);
    ASSERT_FALSE(m.textures.empty());
    EXPECT_EQ(m.textures[0].width * m.textures[0].height * m.textures[0].levels, 1U);
    for (const char* name : {"opaque", "masked"}) {
        for_forms(m, name, [&](const model::Representation& rep, const Samples& shown, const Samples& full) {
            EXPECT_EQ(shown.size(), full.size());
            ASSERT_GT(shown.size(), 32U * 64U) << name << ", " << rep.triangles << " triangles";
            std::array<int, 3> off{};
            for (const ShownSample& sample : shown)
                for (std::size_t k = 0; k < 3; ++k) off[k] = std::max(off[k], std::abs(sample.rgb[k] - (k == 0 ? 200 : 30)));
            for (const int channel : off) EXPECT_LE(channel, 2) << name << ", " << rep.triangles << " triangles";
        });
    }
}

// 16384 texels are the most that a file may have: they are neither refused nor made smaller.
TEST(BadPictures, OfTheLargestSideAreShownWhole) {
    importer::Scene scene = with_a_ball();
    image::Image strip;
    strip.width = 16384;
    strip.height = 16;
    for (std::uint32_t i = 0; i < strip.width * strip.height; ++i) {
        const bool odd = i % strip.width / 1024 % 2 == 1;  // sixteen fields
        strip.rgba.insert(strip.rgba.end(), {static_cast<std::uint8_t>(odd ? 220 : 20), 60, 40, 255});
    }
    scene.images.push_back(std::move(strip));
    const auto material = add_material(scene, static_cast<importer::Index>(scene.images.size() - 1), false);
    place(scene, add_mesh(scene, sheet(material), "strip"), dvec3(0));
    expect_sound(scene, "16384 x 16");
    const model::Model m = bake_unlit(scene);
    ASSERT_FALSE(m.textures.empty());
    EXPECT_EQ(m.textures[0].width, 16384U);
    EXPECT_EQ(m.textures[0].height, 16U);
    EXPECT_EQ(m.textures[0].levels, 15U);
    std::size_t textured = 0;
    for_forms(m, "strip", [&](const model::Representation& rep, const Samples& shown, const Samples& full) {
        EXPECT_EQ(shown.size(), full.size()) << rep.triangles << " triangles";
        if (!is_textured(m, rep)) return;
        ++textured;
        std::array<std::size_t, 2> wrong{}, all{};
        for (const ShownSample& sample : shown) {
            const double field = sample.at.x * 16 / 3, within = field - std::floor(field);
            if (within < 0.25 || within > 0.75) continue;
            const std::size_t odd = static_cast<std::size_t>(field) % 2;
            ++all[odd];
            wrong[odd] += (sample.rgb[0] > 120) != (odd == 1) ? 1 : 0;
        }
        for (const std::size_t odd : {0U, 1U}) {
            EXPECT_GT(all[odd], 1000U);
            EXPECT_EQ(wrong[odd], 0U) << rep.triangles << " triangles, " << (odd == 1 ? "light" : "dark");
        }
    });
    EXPECT_GE(textured, 1U);
}

TEST(BadPictures, MaskThatHidesAllLeavesTheRest) {
    importer::Scene scene = with_a_ball();
    const auto hidden = add_picture(scene, 32, {200, 30, 30, 0}, {30, 200, 30, 0});
    place(scene, add_mesh(scene, sheet(add_material(scene, hidden, true)), "hidden"), dvec3(0));
    expect_sound(scene, "hides all");
    const model::Model m = bake_unlit(scene);
    std::size_t of_ball = 0;
    for (std::size_t n = 0; n < m.nodes.size(); ++n) {
        const model::Node& node = m.nodes[n];
        for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
            std::size_t of_sheet = 0;
            for (const ShownSample& sample : shown_by(m, m.reps[r], node.box)) ++(sample.at.x < 4 ? of_sheet : of_ball);
            EXPECT_EQ(of_sheet, 0U) << "node " << n << ", form " << r - node.first_rep << " of " << node.rep_count << ", "
                                    << m.reps[r].triangles << " triangles";
        }
    }
    EXPECT_GT(of_ball, 1000U);
}

// Eight kinds of cards beside each other, 2 m apart: the k-th kind's picture is as red as k.
TEST(BadPictures, EachCardShowsItsOwn) {
    importer::Scene scene = with_a_ball();
    importer::Mesh mesh;
    mesh.name = "cards";
    Random random(7);
    constexpr std::size_t kinds = 8;
    for (std::size_t k = 0; k < kinds; ++k) {
        const auto red = static_cast<std::uint8_t>(30 * k);
        const auto picture = add_picture(scene, 16, {red, 120, 60, 255}, {red, 120, 60, 0});
        importer::Primitive p;
        p.material = add_material(scene, picture, true);
        for (std::uint32_t card = 0; card < 12; ++card) {
            const vec3 at(2.0F * static_cast<float>(k) + random.range(0, 0.5), random.range(0, 3), random.range(-1, 1));
            for (const vec2 uv : {vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 1)}) {
                p.positions.push_back(at + vec3(0.4F * uv.x, 0.4F * uv.y, 0));
                p.uvs.push_back(uv);
            }
            for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) p.indices.push_back(4 * card + i);
        }
        mesh.primitives.push_back(std::move(p));
    }
    scene.meshes.push_back(std::move(mesh));
    place(scene, static_cast<importer::Index>(scene.meshes.size() - 1), dvec3(20, 0, 0));
    const model::Model m = bake_unlit(scene);
    std::size_t textured = 0;
    std::set<std::size_t> seen;
    for_forms(m, "cards", [&](const model::Representation& rep, const Samples& shown, const Samples& full) {
        textured += is_textured(m, rep) ? 1 : 0;
        const auto kind_at = [&](const ShownSample& sample) {
            return static_cast<std::size_t>(std::clamp((sample.at.x - 20 + 0.7) / 2, 0.0, kinds - 1.0));
        };
        std::array<double, kinds> red{}, count{}, of_full{};
        for (const ShownSample& sample : full) ++of_full[kind_at(sample)];
        for (const ShownSample& sample : shown) {
            red[kind_at(sample)] += sample.rgb[0];
            ++count[kind_at(sample)];
        }
        for (std::size_t k = 0; k < kinds; ++k) {
            EXPECT_EQ(count[k] > 0, of_full[k] > 0) << "kind " << k << ", " << rep.triangles << " triangles";
            if (!(count[k] > 0)) continue;
            seen.insert(k);
            EXPECT_NEAR(red[k] / count[k], 30.0 * static_cast<double>(k), 8) << rep.triangles << " triangles";
        }
    });
    EXPECT_EQ(seen.size(), kinds);
    EXPECT_GE(textured, 2U) << "a coarse form keeps its pictures";
}

TEST(BadPictures, CardsWithoutACommonTextureKeepTheirs) {
    importer::Scene scene = with_a_ball();
    importer::Mesh mesh;
    mesh.name = "cards";
    Random random(7);
    for (std::uint8_t k = 0; k < 8; ++k) {
        const auto checkered = add_picture(scene, 16, {static_cast<std::uint8_t>(30 * k), 120, 60, 255}, {0, 0, 0, 0});
        importer::Primitive p;
        p.material = add_material(scene, checkered, true);
        for (std::uint32_t card = 0; card < 12; ++card) {
            const vec3 at(random.range(-2, 2), random.range(0, 3), random.range(-2, 2));
            for (const vec2 uv : {vec2(0, 0), vec2(1, 0), vec2(1, 1), vec2(0, 1)}) {
                p.positions.push_back(at + vec3(0.4F * uv.x, 0.4F * uv.y, 0));
                p.uvs.push_back(uv);
            }
            for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) p.indices.push_back(4 * card + i);
        }
        mesh.primitives.push_back(std::move(p));
    }
    scene.meshes.push_back(std::move(mesh));
    place(scene, static_cast<importer::Index>(scene.meshes.size() - 1), dvec3(0));
    expect_sound(scene, "cards");
}

// A sheet that is folded back upon itself forty times, and a doubled one that faces both ways.
TEST(BadPictures, FoldsStayWhereTheyAre) {
    importer::Scene scene = with_a_ball();
    const importer::Primitive folded =
        grid_surface(40, 4, [](float u, float v) { return vec3(2 * static_cast<float>(std::lround(40 * u) % 2), 2 * v, 0); });
    place(scene, add_mesh(scene, folded, "folded"), dvec3(0));
    importer::Primitive doubled = sheet(0);
    const std::size_t count = doubled.indices.size();
    for (std::size_t i = 0; i < count; i += 3)
        for (const std::size_t k : {0U, 2U, 1U}) doubled.indices.push_back(doubled.indices[i + k]);
    place(scene, add_mesh(scene, doubled, "doubled"), dvec3(0, 0, 3));
    expect_sound(scene, "folds");
}

}  // namespace
}  // namespace surefoot::bake
