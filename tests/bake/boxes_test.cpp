// Boxes with pictures of full detail: each face shows what is there, the right way round; a box that is best nowhere goes.
#include "render/bake/boxes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "render/bake/picture_loss.hpp"
#include "render/model/loss_groups.hpp"
#include "tests/bake/squares.hpp"

namespace surefoot::bake {
namespace {

void one_by_one(std::size_t count, const std::function<void(std::size_t)>& body) {
    for (std::size_t i = 0; i < count; ++i) body(i);
}
bool go_on() { return true; }

/// A rectangle from `corner` along `u` and `v`, in one colour; faces to u x v.
void add_rectangle(model::Model& m, const vec3& corner, const vec3& u, const vec3& v, const std::array<float, 4>& colour) {
    model::Material material;
    material.colour = colour;
    model::Part part{static_cast<model::Index>(m.materials.size()), static_cast<std::uint32_t>(m.indices.size()), 6,
                     static_cast<std::uint32_t>(m.vertices.size()), 4};
    m.materials.push_back(material);
    for (const vec3& p : {corner, corner + u, corner + u + v, corner + v}) {
        model::Vertex vertex{};
        for (int k = 0; k < 3; ++k) vertex.position[k] = p[k];
        m.vertices.push_back(vertex);
    }
    for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) m.indices.push_back(i);
    m.parts.push_back(part);
}

/// All parts so far as the one form of a leaf that is the whole model.
void make_leaf(model::Model& m) {
    m.placements.emplace_back();
    model::Representation rep;
    rep.part_count = static_cast<std::uint32_t>(m.parts.size());
    rep.triangles = 2 * rep.part_count;
    m.reps.push_back(rep);
    model::Node node;
    node.rep_count = 1;
    for (const model::Vertex& v : m.vertices) node.box.grow(dvec3(v.position[0], v.position[1], v.position[2]));
    m.nodes.push_back(node);
}

/// A block whose six sides have a quarter of another colour each way: 24 colours.
model::Model painted_block(const vec3& size) {
    model::Model m;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (int quarter = 0; quarter < 4; ++quarter) {
            vec3 corner(0), along(0), up(0);
            corner[axis] = face % 2 == 1 ? size[axis] : 0;
            corner[u] = 0.5F * size[u] * static_cast<float>(quarter % 2);
            corner[v] = quarter < 2 ? 0.0F : 0.5F * size[v];
            along[u] = 0.5F * size[u];
            up[v] = 0.5F * size[v];
            if (face % 2 == 0) std::swap(along, up);
            const std::array<float, 4> colour{static_cast<float>(1 + face) / 6, static_cast<float>(quarter) / 3,
                                              static_cast<float>((face + quarter) % 3) / 2, 1};
            add_rectangle(m, corner, along, up, colour);
        }
    }
    make_leaf(m);
    return m;
}

std::vector<BoxForm> boxes_of(const model::Model& m, std::uint32_t pixels = 28) {
    std::vector<BoxForm> boxes = capture_boxes(m, {std::vector<bool>(m.nodes.size(), true), true, pixels}, one_by_one, go_on);
    for (BoxForm& box : boxes) box.error_m = 1;
    return boxes;
}

TEST(Boxes, OfABlockLookLikeItFromEverySide) {
    for (const vec3& size : {vec3(2, 2, 2), vec3(1, 3, 2), vec3(4, 1, 1)}) {
        model::Model m = painted_block(size);
        const PlacedBoxes placed(boxes_of(m), 0, m);
        ASSERT_EQ(m.nodes[0].rep_count, 2U);
        ASSERT_EQ(m.reps[0].triangles, 12U);
        for (const auto& [azimuth, elevation] :
             {std::pair{0.4, 0.3}, {2.0, -0.4}, {3.6, 0.2}, {5.2, -0.3}, {1.0, 1.2}, {4.0, -1.2}}) {
            FormPicture full, box;
            full.clear(view_of(m.nodes[0].box, direction_of(azimuth, elevation), m.nodes[0].box.centre(), 64));
            box.clear(full.view);
            draw_form(m, m.reps[1], full);
            draw_form(m, m.reps[0], box);
            std::size_t either = 0, equal = 0;
            for (std::size_t i = 0; i < full.samples.size(); ++i) {
                const FormSample &a = full.samples[i], &b = box.samples[i];
                if (!a.covered() && !b.covered()) continue;
                ++either;
                int off = 0;
                for (std::size_t k = 0; k < 3; ++k) off = std::max(off, std::abs(a.rgb[1][k] - b.rgb[1][k]));
                if (a.covered() == b.covered() && off < 8) ++equal;
            }
            EXPECT_GT(either, 500U);
            EXPECT_GT(static_cast<double>(equal), 0.85 * static_cast<double>(either)) << azimuth << ' ' << elevation;
        }
    }
}

TEST(Boxes, HoldAReadablePicture) {
    model::Model m;
    add_board(m, 8);
    add_rectangle(m, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1, 1});
    m.materials[0].texture = 0;
    m.materials[0].effects = model::effect_texture;
    for (std::size_t corner = 0; corner < 4; ++corner) {
        m.vertices[corner].uv[0] = corner == 1 || corner == 2 ? 1.0F : 0.0F;
        m.vertices[corner].uv[1] = corner >= 2 ? 1.0F : 0.0F;
    }
    make_leaf(m);
    m.nodes[0].box.grow(dvec3(0.5, 0.5, -0.1));
    constexpr std::uint32_t pixels = 32;
    const FaceCapture face = boxes_of(m, pixels)[0].faces[5];
    EXPECT_EQ(face.covered, 1);
    for (std::uint32_t y = 0; y < 8; ++y) {
        for (std::uint32_t x = 0; x < 8; ++x) {
            const std::size_t texel = (4 * y + 2) * pixels + 4 * x + 2;
            EXPECT_NEAR(face.rgba[4 * texel], (x + y) % 2 * 255, 60) << x << ' ' << y;
        }
    }
}

TEST(Boxes, ShowOnEachFaceTheNearHalfAlone) {
    model::Model m;
    add_rectangle(m, {0, 0, 0.25F}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0, 1});  // to +z, in the far half of that face
    m.materials[0].two_sided = true;
    make_leaf(m);
    m.nodes[0].box.grow(dvec3(0, 0, 1));
    m.nodes[0].box.grow(dvec3(0));
    const BoxForm box = boxes_of(m)[0];
    EXPECT_EQ(box.faces[5].covered, 0);
    EXPECT_EQ(box.faces[4].covered, 1) << "the opposite face shows it, seen from behind through this one";
    EXPECT_NEAR(box.faces[4].depth_m, 0.25, 1e-3);
    EXPECT_EQ(box.faces[4].mean[0], 255);
    EXPECT_EQ(box.shown_faces(), 1U) << "from its edge it shows nothing";
}

TEST(Boxes, OfAFlatThingShowItWhereverItLies) {
    for (const float z : {-3.7F, 1234.567F, -98765.4F}) {
        model::Model m = squares({{0, z, 1}, {5, 0, 1}});
        m.nodes.resize(3);
        m.nodes[0].first_child = 1, m.nodes[0].child_count = 2, m.nodes[0].rep_count = 1;
        for (model::Index leaf = 1; leaf < 3; ++leaf) {
            m.nodes[leaf].parent = 0;
            m.nodes[leaf].first_rep = leaf - 1, m.nodes[leaf].rep_count = 1;
            const auto x = leaf == 1 ? 0.0 : 5.0, at = leaf == 1 ? static_cast<double>(z) : 0.0;
            m.nodes[leaf].box = Box{dvec3(x, 0, at), dvec3(x + 1, 1, at)};
            m.nodes[0].box.grow(m.nodes[leaf].box);
        }
        const std::vector<BoxForm> boxes = boxes_of(m);
        EXPECT_EQ(boxes[1].faces[5].covered, 1) << z;
        EXPECT_EQ(boxes[2].faces[5].covered, 1) << z;
    }
}

TEST(Boxes, OfAClusterShowWhatItsLeavesDo) {
    // Two squares of another size beside each other: the cluster's front shows them in its left and right part.
    model::Model m = squares({{0, 0.5F, 1, {1, 0, 0, 1}}, {1, 0.5F, 1, {0, 0, 1, 1}}});
    m.nodes.resize(3);
    m.nodes[0].first_child = 1, m.nodes[0].child_count = 2, m.nodes[0].rep_count = 1;
    for (model::Index leaf = 1; leaf < 3; ++leaf) {
        m.nodes[leaf].parent = 0;
        m.nodes[leaf].first_rep = leaf - 1, m.nodes[leaf].rep_count = 1;
        m.nodes[leaf].box = Box{dvec3(leaf - 1.0, 0, 0), dvec3(leaf, 1, 1)};
        m.nodes[0].box.grow(m.nodes[leaf].box);
    }
    const FaceCapture face = boxes_of(m)[0].faces[5];
    ASSERT_EQ(face.covered, 1);
    for (const std::uint32_t x : {2U, 12U, 15U, 25U}) {
        const std::uint8_t* rgba = &face.rgba[std::size_t{4} * (14 * 28 + x)];
        EXPECT_EQ(rgba[0] > 200, x < 14) << x;
        EXPECT_EQ(rgba[2] > 200, x >= 14) << x;
    }
}

TEST(Boxes, KeepTheShareThatIsCoveredOfThinThings) {
    model::Model m;
    for (int i = 0; i < 10; ++i)  // bars a fifth of a texel wide
        add_rectangle(m, {0.1F * static_cast<float>(i), 0, 1}, {0.007F, 0, 0}, {0, 1, 0}, {1, 1, 1, 1});
    make_leaf(m);
    m.nodes[0].box.grow(dvec3(0, 0, 0));
    m.nodes[0].box.grow(dvec3(1, 1, 1));
    const FaceCapture face = boxes_of(m)[0].faces[5];
    ASSERT_EQ(face.rgba.size(), 4U * 28 * 28);
    std::size_t opaque = 0;
    for (std::size_t at = 3; at < face.rgba.size(); at += 4) opaque += face.rgba[at] >= opaque_alpha ? 1 : 0;
    EXPECT_GT(opaque, 28U) << "no texel is half covered, and yet they show";
    EXPECT_LT(opaque, 28U * 28 / 4);
}

TEST(Boxes, AFaceThatEndsAtASharpEdgeDoesNotVanish) {
    for (const float width : {1.0F, 1.1F, 1.3F, 1.5F, 1.7F, 1.9F}) {
        for (const int texels : {3, 7, 10, 14, 19, 25}) {
            model::Model m;
            const float to = width * static_cast<float>(texels) / 28;
            add_rectangle(m, {0, 0, 1}, {to, 0, 0}, {0, 1, 0}, {1, 1, 1, 1});
            make_leaf(m);
            m.nodes[0].box.grow(dvec3(0, 0, 0));
            m.nodes[0].box.grow(dvec3(static_cast<double>(width), 1, 1));
            EXPECT_GT(boxes_of(m)[0].faces[5].covered, 0.5F * to / width) << width << " m, " << texels << " texels";
        }
    }
}

TEST(Boxes, OfVeryLongThingsAreLeftOut) {
    const model::Model m = painted_block({400, 0.5, 0.5});
    EXPECT_EQ(boxes_of(m, 28)[0].shown_faces(), 6U);
    EXPECT_EQ(boxes_of(m, 56)[0].shown_faces(), 0U)
        << "twice the samples are more than a picture holds: no box without its long sides";
}

/// Two leaves below a root, each with a coarse mesh of two triangles and full detail.
model::Model two_leaves() {
    model::Model m = squares({{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {5, 0, 1}, {5, 0, 1}});
    m.nodes.resize(3);
    m.nodes[0].first_rep = 0, m.nodes[0].rep_count = 1, m.nodes[0].first_child = 1, m.nodes[0].child_count = 2;
    for (model::Index leaf = 1; leaf < 3; ++leaf) {
        m.nodes[leaf].parent = 0;
        m.nodes[leaf].first_rep = 2 * leaf - 1, m.nodes[leaf].rep_count = 2;
        m.nodes[leaf].box = Box{dvec3(leaf == 1 ? 0 : 5, 0, -0.5), dvec3(leaf == 1 ? 1 : 6, 1, 0.5)};
        m.nodes[0].box.grow(m.nodes[leaf].box);
        m.reps[2 * leaf].triangles = 5000;
    }
    for (model::Representation& rep : m.reps) rep.area_m2 = {1, 1, 1};
    return m;
}

TEST(Boxes, ThatAreBestAtNoSizeAreTakenOutAgain) {
    model::Model m = two_leaves();
    std::vector<BoxForm> boxes = capture_boxes(m, {{false, true, true}, true, 28}, one_by_one, go_on);
    ASSERT_EQ(boxes.size(), 3U);
    const std::size_t texels = m.texels.size(), textures = m.textures.size();
    PlacedBoxes placed(std::move(boxes), 0, m);
    const std::size_t with_both = m.texels.size();
    ASSERT_EQ(m.reps.size(), 7U);
    ASSERT_EQ(m.textures.size(), textures + 2);
    for (const model::Index leaf : {1U, 2U}) m.reps[m.nodes[leaf].first_rep].area_m2 = {2, 2, 2};
    m.losses.resize(m.reps.size());
    const auto lose = [&](model::Index form, float loss) { m.losses[form].colour.fill(loss); };
    lose(m.nodes[1].first_rep, 0.1F);
    lose(m.nodes[1].first_rep + 1, 0.5F);
    lose(m.nodes[2].first_rep, 0.5F);
    lose(m.nodes[2].first_rep + 1, 0.1F);
    EXPECT_EQ(placed.drop_idle(model::default_costs()), 1U);
    EXPECT_EQ(m.reps.size(), 6U);
    EXPECT_EQ(m.losses.size(), 6U);
    EXPECT_EQ(m.nodes[1].rep_count, 3U);
    EXPECT_EQ(m.reps[m.nodes[1].first_rep].kind, model::RepKind::textured_box);
    EXPECT_EQ(m.losses[m.nodes[1].first_rep].colour[0], 0.1F);
    EXPECT_EQ(m.nodes[2].rep_count, 2U);
    EXPECT_EQ(m.losses[m.nodes[2].first_rep].colour[0], 0.1F);
    EXPECT_EQ(m.textures.size(), textures + 1);
    EXPECT_EQ(m.texels.size() - texels, (with_both - texels) / 2) << "what it alone used is gone";
    EXPECT_EQ(m.parts[m.reps[m.nodes[1].first_rep].first_part].material, m.materials.size() - 1);
}

TEST(Boxes, OfOneColourAFaceAreWithoutTheSunWhereNoSkyIsSeen) {
    model::Model m = two_leaves();
    const auto proxy = static_cast<model::Index>(m.materials.size());
    m.materials.emplace_back();
    m.materials[proxy].effects = model::effect_vertex_colour | model::effect_sun | model::effect_openness;
    m.reps[m.nodes[1].first_rep].effects = model::effect_openness;
    m.reps[m.nodes[2].first_rep].effects = model::effect_openness | model::effect_sun;
    std::vector<BoxForm> boxes = capture_boxes(m, {{true, true, true}, false, 28}, one_by_one, go_on);
    PlacedBoxes placed(std::move(boxes), proxy, m);
    const auto effects_of = [&](model::Index node) { return m.reps[m.nodes[node].first_rep].effects; };
    ASSERT_EQ(m.reps[m.nodes[1].first_rep].kind, model::RepKind::colour_box);
    EXPECT_EQ(effects_of(1), model::effect_vertex_colour | model::effect_openness);
    EXPECT_EQ(effects_of(2), m.materials[proxy].effects);
    EXPECT_EQ(effects_of(0), m.materials[proxy].effects) << "nothing is known of it";
    m.losses.resize(m.reps.size());
    static_cast<void>(placed.drop_idle(model::default_costs()));
    EXPECT_LE(m.materials.size(), proxy + 2U) << "one material for all of them, placed once or twice";
}

/// Of the second leaf's box, which is the best form by far: whether it stays where it covers `share` of full detail.
bool box_stays(float share, bool has_coarse_mesh) {
    model::Model m = two_leaves();
    for (const model::Index leaf : {1U, 2U}) m.reps[m.nodes[leaf].first_rep].error_m = has_coarse_mesh ? 0.1F : 0.0F;
    std::vector<BoxForm> boxes = capture_boxes(m, {{false, false, true}, true, 28}, one_by_one, go_on);
    PlacedBoxes placed(std::move(boxes), 0, m);
    const model::Index box = m.nodes[2].first_rep;
    m.losses.resize(m.reps.size());
    m.losses[box].colour.fill(0.01F);
    m.losses[box + 1].colour.fill(0.5F);
    std::vector<float> covered(m.reps.size(), 1.0F);
    covered[box] = share;
    return placed.drop_idle(model::default_costs(), covered) == 1;
}

TEST(Boxes, ThatCoverTooLittleOrTooMuchGoIfACoarseMeshIsLeft) {
    EXPECT_FALSE(box_stays(0.4F, true));
    EXPECT_TRUE(box_stays(0.6F, true));
    EXPECT_TRUE(box_stays(1.0F, true));
    EXPECT_FALSE(box_stays(2.5F, true));
    EXPECT_TRUE(box_stays(0.4F, false)) << "full detail is no coarse mesh";
}

TEST(Boxes, OfAClusterTakeTheirLossesOfGroupsWithThem) {
    // Two leaves below a root that has a mesh of its own.
    model::Model m = squares({{0, 0, 1}, {0, 0, 1}, {5, 0, 1}});
    m.nodes.resize(3);
    m.nodes[0].first_rep = 0, m.nodes[0].rep_count = 1, m.nodes[0].first_child = 1, m.nodes[0].child_count = 2;
    for (model::Index leaf = 1; leaf < 3; ++leaf) {
        m.nodes[leaf].parent = 0;
        m.nodes[leaf].first_rep = leaf, m.nodes[leaf].rep_count = 1;
        m.nodes[leaf].box = Box{dvec3(leaf == 1 ? 0 : 5, 0, -0.5), dvec3(leaf == 1 ? 1 : 6, 1, 0.5)};
        m.nodes[0].box.grow(m.nodes[leaf].box);
    }
    for (model::Representation& rep : m.reps) rep.area_m2 = {1, 1, 1};
    for (const float box_loss : {0.01F, 0.5F}) {
        model::Model with = m;
        std::vector<BoxForm> boxes = capture_boxes(with, {{true, false, false}, true, 28}, one_by_one, go_on);
        ASSERT_EQ(boxes.size(), 3U);
        ASSERT_GT(boxes[0].shown_faces(), 0U);
        PlacedBoxes placed(std::move(boxes), 0, with);
        ASSERT_EQ(with.nodes[0].rep_count, 2U);
        with.reps[0].area_m2 = {2, 2, 2};
        with.losses.resize(with.reps.size());
        with.losses[0].colour.fill(box_loss);
        with.losses[1].colour.fill(0.1F);
        with.group_losses = {{{0.9F, 0.9F, 0.9F}}, {{0.8F, 0.8F, 0.8F}}, {{0.1F, 0.1F, 0.1F}}, {{0.2F, 0.2F, 0.2F}}};
        ASSERT_EQ(with.group_losses.size(), model::LossGroups(with).size());
        const std::size_t left = placed.drop_idle(model::default_costs());
        EXPECT_EQ(left, box_loss < 0.1F ? 1U : 0U);
        ASSERT_EQ(with.group_losses.size(), model::LossGroups(with).size());
        EXPECT_EQ(with.group_losses.front().colour[0], left > 0 ? 0.9F : 0.1F);
        EXPECT_EQ(with.group_losses.back().colour[0], 0.2F);
    }
}

TEST(Boxes, StopWhenTheyAreToldTo) {
    const model::Model m = painted_block({1, 1, 1});
    EXPECT_TRUE(capture_boxes(m, {{true}, true, 28}, one_by_one, [] { return false; }).empty());
}

}  // namespace
}  // namespace surefoot::bake
