// Scenes by hand for rows: surfaces over a grid, closed bodies, and a small town of awkward objects.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "render/import/scene.hpp"
#include "render/model/model.hpp"

namespace surefoot::selftest {

/// Positions and triples only; clean() makes the normals.
importer::Primitive triangles(std::vector<vec3> positions, std::vector<std::uint32_t> indices);
/// (nu + 1) x (nv + 1) vertices, two triangles a cell.
importer::Primitive surface(std::uint32_t nu, std::uint32_t nv, const std::function<vec3(double, double)>& at);
/// A ball with a bumpy skin, open at the poles: about 4 n^2 triangles.
importer::Primitive bumpy_ball(std::uint32_t n, double radius_m);

/// One mesh, one node at `world`.
importer::Scene scene_of(importer::Primitive primitive, const dmat4& world = dmat4(1.0));
void place(importer::Scene& scene, importer::Primitive primitive, const std::string& name, const dmat4& world);
dmat4 moved(const dvec3& by);
dmat4 scaled(const dvec3& by);

/// Hilly ground, balls (one stretched, one mirrored, one sheared), thin posts, and a crumb far from all, about `at`, turned by
/// `turn`. The same shape wherever it stands.
importer::Scene hard_town(const dvec3& at = dvec3(0), const dquat& turn = dquat(1, 0, 0, 0));

/// All of the model moved after the bake: the very same nodes and forms, so that a cut can be drawn of both.
model::Model moved_model(model::Model model, const dvec3& by);

/// The scene as files bring it: cleaned and finished as every importer's is, then baked (draft, one worker). An error names what
/// is wrong.
Result<model::Model> import_and_bake(importer::Scene scene);

}  // namespace surefoot::selftest
