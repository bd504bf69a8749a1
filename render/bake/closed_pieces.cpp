// Each piece in each of its places, unless it is known to be closed there (closed_pieces.hpp).
#include "render/bake/closed_pieces.hpp"

#include "render/bake/stage.hpp"

namespace surefoot::bake {

namespace {

/// A piece, and the places of its mesh where it may see sky.
struct OpenPiece {
    MeshForm* form = nullptr;
    std::vector<std::size_t> places;
};

}  // namespace

bool find_closed_pieces(std::vector<std::vector<MeshForm>>& by_mesh, std::span<const PlacedObject> objects,
                        const model::Model& model, const LightRays& rays, const Progress& progress) {
    std::vector<std::vector<dmat4>> worlds(by_mesh.size());
    std::vector<std::vector<bool>> moves(by_mesh.size());
    Box scene;
    for (const PlacedObject& object : objects) {
        worlds[object.mesh].push_back(object.world);
        moves[object.mesh].push_back(object.motion != model::none);
        scene.grow(object.box);
    }
    std::vector<OpenPiece> pieces;
    std::vector<MeshInPlaces> meshes;
    for (std::size_t m = 0; m < by_mesh.size(); ++m) {
        if (by_mesh[m].size() < 2) continue;  // whole: all is known
        for (MeshForm& form : by_mesh[m]) {
            OpenPiece piece{&form, {}};
            MeshInPlaces mesh{&form.chain.full, {}};
            form.closed_in.resize(worlds[m].size(), false);
            for (std::size_t p = 0; p < worlds[m].size(); ++p) {
                if (form.closed_in[p] || moves[m][p]) continue;  // what moves may come out
                piece.places.push_back(p);
                mesh.places.push_back(worlds[m][p]);
            }
            if (piece.places.empty()) continue;
            pieces.push_back(std::move(piece));
            meshes.push_back(std::move(mesh));
        }
    }
    if (pieces.empty()) return true;
    Stage stage(progress, "sky of pieces", sky_steps(meshes));
    const ForAll all = [](std::size_t count, const std::function<void(std::size_t)>& body) { for_all(count, body); };
    const std::vector<std::vector<bool>> closed =
        find_closed(meshes, model.materials, rays.opaque, 2 * scene.diagonal(), all, [&] { return stage.step(); });
    if (progress.stopped()) return false;
    for (std::size_t i = 0; i < pieces.size(); ++i)
        for (std::size_t p = 0; p < closed[i].size(); ++p) pieces[i].form->closed_in[pieces[i].places[p]] = closed[i][p];
    return true;
}

}  // namespace surefoot::bake
