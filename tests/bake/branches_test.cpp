// Branches stay apart: no form of a forked tree is a sail between them, though the simplifier may merge what is apart.
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "render/bake/bake.hpp"
#include "render/bake/form_picture.hpp"
#include "tests/bake/scenes.hpp"

namespace surefoot::bake {
namespace {

/// Adds a round stick from one point to another, thinner towards its end.
void add_stick(importer::Primitive& to, const vec3& from, const vec3& end, float radius_m, std::uint32_t rings, bool loose) {
    if (loose) {
        for (std::uint32_t i = 0; i < rings; ++i) {
            const auto a = static_cast<float>(i) / static_cast<float>(rings),
                       b = static_cast<float>(i + 1) / static_cast<float>(rings);
            add_stick(to, from + a * (end - from), from + b * (end - from), radius_m, 1, false);
        }
        return;
    }
    const vec3 along = glm::normalize(end - from);
    const vec3 side = glm::normalize(glm::cross(along, vec3(0, 0, 1))), other = glm::cross(along, side);
    const importer::Primitive stick = grid_surface(8, rings, [&](float u, float v) {
        const float angle = u * 6.2831853F, radius = radius_m * (1 - 0.5F * v);
        return from + v * (end - from) + radius * (std::cos(angle) * side + std::sin(angle) * other);
    });
    const auto base = static_cast<std::uint32_t>(to.positions.size());
    to.positions.insert(to.positions.end(), stick.positions.begin(), stick.positions.end());
    to.normals.insert(to.normals.end(), stick.normals.begin(), stick.normals.end());
    to.uvs.insert(to.uvs.end(), stick.uvs.begin(), stick.uvs.end());
    for (const std::uint32_t i : stick.indices) to.indices.push_back(base + i);
}

/// A trunk of 2 m, and two branches that part by 90 degrees and end 3 m from each other.
importer::Scene fork(bool textured, bool loose) {
    importer::Scene scene;
    scene.sources = {"by hand"};
    scene.materials.resize(1);
    scene.materials[0].two_sided = true;
    if (textured) {
        image::Image bark;
        bark.width = bark.height = 8;
        for (int i = 0; i < 64; ++i) bark.rgba.insert(bark.rgba.end(), {static_cast<std::uint8_t>(60 + i), 60, 30, 255});
        scene.images.push_back(std::move(bark));
        scene.materials[0].image = 0;
    }
    importer::Primitive wood;
    add_stick(wood, {0, 0, 0}, {0, 2, 0}, 0.16F, 8, loose);
    add_stick(wood, {0, 1.9F, 0}, {1.5F, 3.5F, 0}, 0.1F, 12, loose);
    add_stick(wood, {0, 1.9F, 0}, {-1.5F, 3.5F, 0}, 0.1F, 12, loose);
    place(scene, add_mesh(scene, std::move(wood), "fork"), dvec3(0));
    place(scene, add_mesh(scene, ball(8, 0.5F), "ball"), dvec3(20, 0.5, 0));
    return scene;
}

void draw_full(const model::Model& m, model::Index n, FormPicture& picture) {
    const model::Node& node = m.nodes[n];
    if (node.child_count == 0) draw_form(m, m.reps[node.first_rep + node.rep_count - 1], picture);
    for (std::uint32_t c = 0; c < node.child_count; ++c) draw_full(m, node.first_child + c, picture);
}

/// Samples of a form, from the front.
struct Counted {
    double all = 0;      ///< of full detail
    double beside = 0;   ///< of the form, where full detail shows nothing
    double between = 0;  ///< of these, those well within the fork: a quarter of a metre from either branch
};

Counted count_samples(const FormPicture& full, const FormPicture& form) {
    Counted counted;
    const double pixel_m = std::ldexp(1.0, full.view.exponent);
    const auto at = [&](std::int64_t first, std::size_t offset) {
        return pixel_m * static_cast<double>(first + static_cast<std::int64_t>(offset));
    };
    for (std::size_t i = 0; i < full.samples.size(); ++i) {
        counted.all += full.samples[i].covered() ? 1 : 0;
        if (!form.samples[i].covered() || full.samples[i].covered()) continue;
        ++counted.beside;
        const double x = full.view.middle.x + at(full.view.left, i % full.view.width);
        const double y = full.view.middle.y + at(full.view.low, i / full.view.width);
        counted.between += y > 2.4 && std::abs(x) < (y - 1.9) * 1.5 / 1.6 - 0.25 ? 1 : 0;
    }
    return counted;
}

TEST(Branches, HaveNoSailBetweenThem) {
    for (const auto& [textured, loose] : {std::pair{false, false}, {true, false}, {false, true}, {true, true}}) {
        const auto m = bake(fork(textured, loose), {}, {});
        ASSERT_TRUE(m.ok()) << m.error().text();
        std::size_t forms = 0;
        for (model::Index n = 0; n < m->nodes.size(); ++n) {
            const model::Node& node = m->nodes[n];
            if (node.box.max.x > 10) continue;  // the ball's too
            FormPicture full;
            full.clear(view_of(node.box, direction_of(0, 0), node.box.centre(), 128));
            draw_full(*m, n, full);
            for (model::Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r, ++forms) {
                FormPicture form;
                form.clear(full.view);
                draw_form(*m, m->reps[r], form);
                const Counted counted = count_samples(full, form);
                EXPECT_GT(counted.all, 500);
                EXPECT_LE(counted.between, 0.01 * counted.all) << "node " << n << ", " << m->reps[r].triangles << " triangles";
                EXPECT_LE(counted.beside, 0.5 * counted.all) << "node " << n << ", " << m->reps[r].triangles << " triangles";
            }
        }
        EXPECT_GE(forms, 4U);
    }
}

}  // namespace
}  // namespace surefoot::bake
