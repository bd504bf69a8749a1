// Building the scenes (shapes.hpp).
#include "tools/selftest/shapes.hpp"

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "render/bake/bake.hpp"
#include "render/import/finish.hpp"
#include "rt/base/random.hpp"

namespace surefoot::selftest {

importer::Primitive triangles(std::vector<vec3> positions, std::vector<std::uint32_t> indices) {
    importer::Primitive p;
    p.positions = std::move(positions);
    p.indices = std::move(indices);
    return p;
}

importer::Primitive surface(std::uint32_t nu, std::uint32_t nv, const std::function<vec3(double, double)>& at) {
    importer::Primitive p;
    for (std::uint32_t j = 0; j <= nv; ++j) {
        for (std::uint32_t i = 0; i <= nu; ++i)
            p.positions.push_back(at(static_cast<double>(i) / nu, static_cast<double>(j) / nv));
    }
    for (std::uint32_t j = 0; j < nv; ++j) {
        for (std::uint32_t i = 0; i < nu; ++i) {
            const std::uint32_t a = j * (nu + 1) + i, b = a + 1, c = a + nu + 1, d = c + 1;
            p.indices.insert(p.indices.end(), {a, b, d, a, d, c});
        }
    }
    return p;
}

importer::Primitive bumpy_ball(std::uint32_t n, double radius_m) {
    return surface(2 * n, n, [=](double u, double v) {
        const double a = u * 6.283185307179586, b = (0.02 + 0.96 * v) * 3.141592653589793;
        const double r = radius_m * (1 + 0.05 * std::sin(7 * a) * std::sin(5 * b));
        return vec3(dvec3(r * std::sin(b) * std::cos(a), r * std::cos(b), r * std::sin(b) * std::sin(a)));
    });
}

importer::Scene scene_of(importer::Primitive primitive, const dmat4& world) {
    importer::Scene scene;
    place(scene, std::move(primitive), "shape", world);
    return scene;
}

void place(importer::Scene& scene, importer::Primitive primitive, const std::string& name, const dmat4& world) {
    scene.meshes.push_back({name, {std::move(primitive)}});
    importer::Node node;
    node.name = name;
    node.mesh = static_cast<importer::Index>(scene.meshes.size() - 1);
    node.world = world;
    scene.nodes.push_back(node);
}

dmat4 moved(const dvec3& by) { return glm::translate(dmat4(1.0), by); }
dmat4 scaled(const dvec3& by) { return glm::scale(dmat4(1.0), by); }

importer::Scene hard_town(const dvec3& at, const dquat& turn) {
    const dmat4 root = moved(at) * glm::mat4_cast(turn);
    importer::Scene scene;
    scene.materials.resize(2);
    scene.materials[1].colour = {0.8F, 0.2F, 0.1F, 1};
    importer::Primitive ground =
        surface(40, 40, [](double u, double v) { return vec3(dvec3(100 * v, 3 * std::sin(9 * u) * std::cos(7 * v), 100 * u)); });
    Random random(16);  // colours all over, so that a picture shows where it lies
    for (std::size_t i = 0; i < ground.positions.size(); ++i) {
        const auto byte = [&] { return static_cast<std::uint8_t>(random.below(256)); };
        ground.colours.push_back({byte(), byte(), byte(), 255});
    }
    place(scene, ground, "ground", root);
    importer::Primitive ball = bumpy_ball(16, 1);
    ball.material = 1;
    const auto post = surface(8, 6, [](double u, double v) {
        return vec3(dvec3(0.05 * std::cos(u * 6.283185307179586), 6 * v, 0.05 * std::sin(u * 6.283185307179586)));
    });
    const auto instance = [&](std::uint32_t mesh, const std::string& name, const dmat4& world) {
        importer::Node node;
        node.name = name;
        node.mesh = mesh;
        node.world = world;
        scene.nodes.push_back(node);
    };
    scene.meshes.push_back({"ball", {ball}});
    scene.meshes.push_back({"post", {post}});
    for (int i = 0; i < 12; ++i) {
        dmat4 form(1.0);
        if (i == 4) form = scaled({1, 4, 0.5});
        if (i == 5) form = scaled({-1, 1, 1});
        if (i == 6) form[1][0] = 0.7;  // sheared
        instance(1, "ball", root * moved({10 + 7 * i, 5, 20 + i % 3}) * form);
        instance(2, "post", root * moved({8 + 7 * i, 2, 50}));
    }
    place(scene, surface(3, 3, [](double u, double v) { return vec3(dvec3(0.02 * u, 0.03 * v, 0.01 * u * v)); }), "crumb",
          root * moved({300, 40, -90}));
    return scene;
}

model::Model moved_model(model::Model model, const dvec3& by) {
    for (model::Placement& p : model.placements) p.origin += by;
    for (model::Node& n : model.nodes) n.box = {n.box.min + by, n.box.max + by};
    return model;
}

Result<model::Model> import_and_bake(importer::Scene scene) {
    if (auto finished = importer::finish(scene, "by hand", {}); !finished) return finished.error();
    bake::BakeOptions options;
    options.workers = 1;
    auto model = bake::bake(scene, options, {});
    if (!model) return model;
    if (auto valid = model::validate(*model); !valid) return valid.error();
    return model;
}

}  // namespace surefoot::selftest
