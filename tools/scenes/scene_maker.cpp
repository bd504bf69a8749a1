// Collects a scene: pictures, materials, shared meshes, placed nodes.
#include "tools/scenes/scene_maker.hpp"

#include <algorithm>

namespace surefoot::scenes {
namespace {

Index last_of(std::size_t size) { return static_cast<Index>(size - 1); }

/// Plain materials need no coordinates, white shapes no colours: a scene calls only for what it shows.
void drop_needless(importer::Primitive& p, const importer::Material& material) {
    if (material.image == importer::none) p.uvs.clear();
    const bool white = std::all_of(p.colours.begin(), p.colours.end(), [](const Colour& c) {
        return c == Colour{255, 255, 255, 255};
    });
    if (white) p.colours.clear();
}

}  // namespace

Index SceneMaker::image(image::Image picture) {
    scene.images.push_back(std::move(picture));
    return last_of(scene.images.size());
}

Index SceneMaker::material(const std::string& name, const Colour& colour, Index picture, model::AlphaMode alpha, bool two_sided) {
    importer::Material m;
    m.name = name;
    for (std::size_t i = 0; i < 4; ++i) m.colour[i] = static_cast<float>(colour[i]) / 255.0F;
    m.image = picture;
    m.alpha = alpha;
    m.two_sided = two_sided;
    scene.materials.push_back(std::move(m));
    return last_of(scene.materials.size());
}

Index SceneMaker::glowing(const std::string& name, Index like, const vec3& emission) {
    importer::Material m = scene.materials[like];
    m.name = name;
    m.emission = emission;
    scene.materials.push_back(std::move(m));
    return last_of(scene.materials.size());
}

Index SceneMaker::mesh(importer::Mesh made) {
    for (importer::Primitive& p : made.primitives) {
        drop_needless(p, scene.materials[p.material]);
        importer::clean(p, made.name, scene.warnings);  // poles leave vertices that no triangle uses
    }
    std::erase_if(made.primitives, [](const importer::Primitive& p) { return p.indices.empty(); });
    scene.meshes.push_back(std::move(made));
    return last_of(scene.meshes.size());
}

Index SceneMaker::node(const std::string& name, Index parent, Index mesh_index, const dmat4& local, float importance) {
    const dmat4 world = parent == importer::none ? local : scene.nodes[parent].world * local;
    scene.nodes.push_back(importer::Node{name, parent, mesh_index, world, importance});
    return last_of(scene.nodes.size());
}

}  // namespace surefoot::scenes
