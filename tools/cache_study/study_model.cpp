// Makes the model of a study. All items share one array of vertices; each has triangles of its own.
#include "tools/cache_study/study_model.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "render/model/flat_root.hpp"

namespace surefoot::cache_study {

namespace {

/// Channels that are full, by bits: never none.
constexpr std::uint32_t full_colours = 7;

class ModelMaker {
public:
    ModelMaker(const StudyScene& scene, Colouring colouring, double grown_m) : scene_(scene), grown_m_(grown_m) {
        model::Model& model = made_.model;
        model.names = std::string(1, '\0');
        model.nodes.emplace_back();
        model.placements.emplace_back().origin = scene.tree.boxes.front().box.centre();
        for (const bool two_sided : {false, true}) {
            model::Material& material = model.materials.emplace_back();
            material.two_sided = two_sided;
            material.effects = model::effect_vertex_colour;
        }
        add_vertices(colouring);
    }

    StudyModel run() {
        const cache::BoxTree& tree = scene_.tree;
        const std::size_t count = scene_.triangles.size();
        made_.of_leaf.resize(tree.boxes.size());
        made_.of_captured.resize(tree.boxes.size());
        std::vector<std::vector<std::uint32_t>> homes(tree.boxes.size()), objects, grown(tree.boxes.size());
        for (std::uint32_t triangle = 0; triangle < count; ++triangle) add_to_grown(triangle, 0, grown);
        std::vector<bool> housed(count);
        for (cache::Index i = 0; i < tree.boxes.size(); ++i) {
            const cache::CacheBox& box = tree.boxes[i];
            if (box.child_count > 0 || box.primitive_count == 0) continue;
            const auto first = tree.primitives.begin() + box.first_primitive;
            const std::vector<std::uint32_t> inside(first, first + box.primitive_count);
            made_.of_leaf[i] = add(inside).item;
            const gl::DrawItem captured = add(grown[i]).item;
            for (cache::Index above = i; above != cache::none; above = tree.boxes[above].parent)
                made_.of_captured[above].push_back(captured);
            for (const std::uint32_t triangle : inside)
                if (!housed[triangle]) homes[i].push_back(triangle);
            for (const std::uint32_t triangle : inside) housed[triangle] = true;
        }
        for (std::uint32_t triangle = 0; triangle < count; ++triangle) {
            const std::uint32_t object = scene_.objects[triangle];
            if (object >= objects.size()) objects.resize(object + std::size_t{1});
            objects[object].push_back(triangle);
        }
        for (const auto& home : homes)
            if (!home.empty()) made_.whole.push_back(add(home));
        if (objects.size() <= max_objects)
            for (const auto& object : objects)
                if (!object.empty()) made_.objects.push_back(add(object));
        model::make_flat_root(made_.model);
        return std::move(made_);
    }

private:
    /// A scene with more has none that anybody would see as such.
    static constexpr std::size_t max_objects = 1000;

    void add_to_grown(std::uint32_t triangle, cache::Index i, std::vector<std::vector<std::uint32_t>>& grown) const {
        const cache::CacheBox& box = scene_.tree.boxes[i];
        if (box.primitive_count == 0) return;
        if (!cache::meets(scene_.triangles[triangle], {box.box.min - grown_m_, box.box.max + grown_m_})) return;
        if (box.child_count == 0) grown[i].push_back(triangle);
        for (cache::Index child = 0; child < box.child_count; ++child) add_to_grown(triangle, box.first_child + child, grown);
    }

    void add_vertices(Colouring colouring) {
        using Key = std::tuple<float, float, float, std::array<std::uint8_t, 3>>;
        std::map<Key, std::uint32_t> known;
        const dvec3 origin = made_.model.placements.front().origin;
        corners_.reserve(3 * scene_.triangles.size());
        for (std::size_t i = 0; i < scene_.triangles.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c) {
                const vec3 at(scene_.triangles[i][c] - origin);
                const auto colour = colouring == Colouring::shaded ? scene_.colours[i][c] : full_colour(scene_.objects[i]);
                const auto next = static_cast<std::uint32_t>(made_.model.vertices.size());
                const auto [found, is_new] = known.try_emplace(Key{at.x, at.y, at.z, colour}, next);
                corners_.push_back(found->second);
                if (!is_new) continue;
                model::Vertex& vertex = made_.model.vertices.emplace_back();
                for (int axis = 0; axis < 3; ++axis) vertex.position[axis] = at[axis];
                std::copy(colour.begin(), colour.end(), vertex.colour);
                vertex.normal[1] = 127;
                vertex.colour[3] = 255;
            }
        }
    }

    StudyObject add(const std::vector<std::uint32_t>& triangles) {
        model::Model& model = made_.model;
        model::Representation rep;
        rep.first_part = static_cast<model::Index>(model.parts.size());
        rep.effects = model::effect_vertex_colour;
        rep.triangles = static_cast<std::uint32_t>(triangles.size());
        model::Node node;
        for (const bool two_sided : {false, true}) {
            model::Part part;
            part.material = two_sided ? 1 : 0;
            part.first_index = static_cast<std::uint32_t>(model.indices.size());
            part.vertex_count = static_cast<std::uint32_t>(model.vertices.size());
            for (const std::uint32_t triangle : triangles) {
                if (scene_.two_sided[triangle] != two_sided) continue;
                for (std::size_t c = 0; c < 3; ++c) model.indices.push_back(corners_[3 * std::size_t{triangle} + c]);
                for (const dvec3& corner : scene_.triangles[triangle]) node.box.grow(corner);
            }
            part.index_count = static_cast<std::uint32_t>(model.indices.size()) - part.first_index;
            if (part.index_count > 0) model.parts.push_back(part);
        }
        rep.part_count = static_cast<std::uint32_t>(model.parts.size()) - rep.first_part;
        node.parent = 0;
        node.first_rep = static_cast<model::Index>(model.reps.size());
        node.rep_count = 1;
        node.triangles = triangles.size();
        node.kind = model::NodeKind::object;
        model.reps.push_back(rep);
        model.nodes.push_back(node);
        return {{static_cast<model::Index>(model.nodes.size() - 1), node.first_rep}, node.box};
    }

    const StudyScene& scene_;
    double grown_m_;
    StudyModel made_;
    std::vector<std::uint32_t> corners_;  ///< three a triangle: vertices
};

}  // namespace

std::array<std::uint8_t, 3> full_colour(std::uint32_t object) {
    const std::uint32_t bits = object % full_colours + 1;
    return {static_cast<std::uint8_t>((bits & 1U) != 0 ? 255 : 0), static_cast<std::uint8_t>((bits & 2U) != 0 ? 255 : 0),
            static_cast<std::uint8_t>((bits & 4U) != 0 ? 255 : 0)};
}

StudyModel make_study_model(const StudyScene& scene, Colouring colouring, double grown_m) {
    return ModelMaker(scene, colouring, grown_m).run();
}

}  // namespace surefoot::cache_study
