// Collects a scene: pictures, materials, shared meshes, placed nodes.
#pragma once

#include <string>

#include "tools/scenes/mesh_maker.hpp"

namespace surefoot::scenes {

/// A scene under construction.
struct SceneMaker {
    importer::Scene scene;

    Index image(image::Image picture);
    /// Plain: coloured by the vertices alone.
    Index material(const std::string& name, const Colour& colour = {255, 255, 255, 255}, Index picture = importer::none,
                   model::AlphaMode alpha = model::AlphaMode::opaque, bool two_sided = false);
    /// A copy of a material that sends out light: linear RGB.
    Index glowing(const std::string& name, Index like, const vec3& emission);
    Index mesh(importer::Mesh made);
    /// `local` is relative to the parent.
    Index node(const std::string& name, Index parent, Index mesh_index, const dmat4& local, float importance = 1.0F);
};

}  // namespace surefoot::scenes
