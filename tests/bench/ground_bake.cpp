// Bench: what a bake takes longer for what visitors walk on: which triangles block, their trees, and the default path. The
// quickest of three turns, on one thread, as the bake runs it. bench_ground_bake SCENE -> one JSON object.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "render/bake/ground.hpp"
#include "render/bake/tour.hpp"
#include "render/import/scene.hpp"
#include "tests/bench/bench_scene.hpp"

namespace {

using namespace surefoot;

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return bench::fail({"SCENE", "is missing", "give a file that bake reads"});
    auto scene = importer::import_files({argv[1]}, {});
    if (!scene) return bench::fail(scene.error());
    std::size_t triangles = 0;  // of each node, as a bake counts them
    Box box;
    for (const importer::Node& node : scene->nodes) {
        if (node.mesh == importer::none) continue;
        for (const importer::Primitive& p : scene->meshes[node.mesh].primitives) {
            triangles += p.indices.size() / 3;
            for (const vec3& v : p.positions) box.grow(dvec3(node.world * dvec4(dvec3(v), 1.0)));
        }
    }
    double ground_s = 1e9, tour_s = 1e9;
    std::size_t instances = 0, bytes = 0;
    for (int turn = 0; turn < 3; ++turn) {
        const double begun = now_s();
        const model::Ground ground = bake::make_ground(*scene, {});
        const double between = now_s();
        (void)bake::make_tour(ground, box, {});
        ground_s = std::min(ground_s, between - begun), tour_s = std::min(tour_s, now_s() - between);
        instances = ground.instances.size(), bytes = model::bytes_of(ground);
    }
    fmt::print("{{\"triangles\": {}, \"instances\": {}, \"bytes\": {}, \"ground_s\": {:.3f}, \"tour_s\": {:.3f}}}\n", triangles,
               instances, bytes, ground_s, tour_s);
    return 0;
}
