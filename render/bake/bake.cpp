// The bake: forms of every mesh, the growing grid, a mesh for every cluster, boxes; then the flat model.
#include "render/bake/bake.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <thread>

#include "render/bake/alpha_bleed.hpp"
#include "render/bake/boxes.hpp"
#include "render/bake/closed_pieces.hpp"
#include "render/bake/cluster_coverage.hpp"
#include "render/bake/ground.hpp"
#include "render/bake/limits.hpp"
#include "render/bake/materials.hpp"
#include "render/bake/motions.hpp"
#include "render/bake/moving_shadow.hpp"
#include "render/bake/picture_loss.hpp"
#include "render/bake/proxies.hpp"
#include "render/bake/quality.hpp"
#include "render/bake/scene_light.hpp"
#include "render/bake/stage.hpp"
#include "render/bake/tour.hpp"
#include "render/bake/trim_masks.hpp"
#include "render/model/pixels.hpp"

namespace surefoot::bake {

namespace {

constexpr std::uint32_t min_box_triangles = 64, min_piece_box_triangles = 256, min_plain_box_triangles = 500;
constexpr std::uint64_t min_apart = 16;                         // a share of the triangles: 1/16
constexpr std::uint32_t max_box_cell = 32, min_box_cell = 16;   // texels of a face's picture, with its rim
constexpr std::size_t max_box_bytes = std::size_t{128} << 20U;  // of all pictures of boxes while they are judged
const ForAll all_cores = [](std::size_t count, const std::function<void(std::size_t)>& body) { for_all(count, body); };
/// Six faces of four bytes a texel, and mip levels.
constexpr std::size_t box_bytes(std::uint32_t cell) { return std::size_t{32} * cell * cell; }

std::string place_of(const importer::Scene& scene) { return scene.sources.empty() ? "bake" : scene.sources.front(); }

Error stopped_by_user(const importer::Scene& scene) {
    return {place_of(scene), "The user stopped the bake; nothing was written", "", ErrorKind::stopped};
}

struct BakeContext {
    const importer::Scene& scene;
    const BakeOptions& options;
    const Progress& progress;
    model::Model model{};
    model::Index proxy = 0;               ///< a material with vertex colours
    model::Index proxy_or_none = 0;       ///< the same, or none where every colour is a material's own
    std::vector<PlacedObject> objects{};  ///< pieces count each
    std::uint32_t object_count = 0;       ///< conceptual ones
    std::vector<model::Index> motions{};  ///< of the model, by those of the scene
    std::vector<MeshForm> forms{};
    ClusterTree tree{};
    std::vector<ClusterForm> clusters{};
    std::vector<std::vector<std::uint32_t>> members{};  ///< by cluster: the objects below it
    std::vector<std::uint32_t> entities{};              ///< by node: the object, or after these the cluster
    std::vector<bool> cut_out{};                        ///< by material
    std::unique_ptr<LightRays> rays{};                  ///< none: light is not measured
    RefinedMeshes refined{};
    ClosedVertices closed{};  ///< of chains that see no sky
    SceneLight light{};
    std::vector<bool> hidden{};    ///< by material: its mask shows nothing
    std::vector<float> covered{};  ///< MeasuredLosses::covered

    ProxyInput proxy_input() const;
    void adopt_materials();
    void place_objects();
    void adopt_forms(std::vector<std::vector<MeshForm>> by_mesh);
    bool make_forms();
    std::vector<SkySides> find_sides(const std::vector<Geometry>& geometries) const;
    bool make_clusters();
    bool trim_masks();
    bool shows_pictures() const;
    bool wants_box(std::uint32_t entity) const;
    void emit();
    bool mend_clusters();
    std::vector<bool> wanted_boxes() const;
    void bound(const ProxyInput& input, model::Index n, BoxForm& box) const;
    std::optional<PlacedBoxes> add_boxes();
    void measure_areas();
    void prepare_light();
    bool measure_light();
    bool measure_pictures();
    void find_effects();
    void emit_object(model::Index node, std::uint32_t object, const std::vector<EmittedChain>& chains);
    void emit_cluster(model::Index node, std::uint32_t cluster, std::vector<std::pair<model::Index, std::uint32_t>>& open);
};

ProxyInput BakeContext::proxy_input() const {
    ProxyInput input;
    input.objects = objects;
    input.forms = forms;
    input.clusters = clusters;
    input.model = &model;
    input.proxy_material = proxy_or_none;
    for (const model::Material& m : model.materials) input.two_sided.push_back(m.two_sided);
    input.cut_out = cut_out;
    input.hidden = hidden;
    input.slack = chain_options(options, proxy_or_none).slack;
    return input;
}

void BakeContext::adopt_materials() {
    cut_out = cut_out_materials(scene);
    hidden = hidden_materials(scene, model.provenance.warnings);
    set_own_light(scene, options.sun, options.fog_visibility_m.value_or(scene.fog_visibility_m), model);
    proxy = add_materials(scene, model, {options.water_by_name, options.light_by_pixel});
    bool coloured = false;
    for (std::size_t m = 0; m < scene.materials.size(); ++m)
        coloured |= (model.materials[m].effects & (model::effect_texture | model::effect_vertex_colour)) != 0;
    proxy_or_none = coloured ? proxy : model::none;
}

void BakeContext::place_objects() {
    for (const importer::Node& node : scene.nodes) {
        if (node.mesh == importer::none) continue;
        PlacedObject object;
        object.mesh = node.mesh;
        object.world = node.world;
        object.name = node.name;
        object.importance = node.importance;
        object.object = object_count++;
        object.motion = node.motion;
        objects.push_back(std::move(object));
    }
    motions = adopt_motions(scene, objects, model);
}

bool BakeContext::make_forms() {
    std::vector<std::vector<MeshForm>> by_mesh(scene.meshes.size());
    std::vector<double> stretch(scene.meshes.size(), 0.0);
    Box world;
    std::vector<Box> mesh_boxes(scene.meshes.size());
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
        for (const importer::Primitive& p : scene.meshes[m].primitives)
            for (const vec3& v : p.positions) mesh_boxes[m].grow(dvec3(v));
    std::erase_if(objects, [&](const PlacedObject& o) { return mesh_boxes[o.mesh].empty(); });
    std::vector<std::uint32_t> placements(scene.meshes.size(), 0);
    for (PlacedObject& object : objects) {
        ++placements[object.mesh];
        object.box = placed_box(mesh_boxes[object.mesh], object.world);
        world.grow(object.box);
        stretch[object.mesh] = std::max(stretch[object.mesh], largest_stretch(dmat3(object.world)));
    }
    const dvec3 extent = world.max - world.min;
    std::atomic<bool> go{true};
    ChainOptions chain = chain_options(options, proxy_or_none);
    chain.cut_out = cut_out;
    chain.hidden = hidden;
    chain.pictures = pictures_of(model);
    chain.looks = &model;
    std::vector<std::vector<std::string>> notes(scene.meshes.size());
    std::vector<Geometry> geometries(scene.meshes.size());
    for_all(scene.meshes.size(), [&](std::size_t m) {
        if (stretch[m] > 0)
            geometries[m] = mesh_geometry(m < refined.size() && refined[m] ? *refined[m] : scene.meshes[m], model);
    });
    refined.clear();
    const std::vector<SkySides> sides = find_sides(geometries);
    if (progress.stopped()) return false;
    Stage stage(progress, "levels of detail", scene.meshes.size());
    for_all(scene.meshes.size(), [&](std::size_t m) {
        if (!go || stretch[m] == 0) return;
        Geometry geometry = std::move(geometries[m]);
        const std::vector<ArtistStandIn> stand_ins =
            stand_ins_of(scene, static_cast<importer::Index>(m), model, geometry, notes[m]);
        const CutLimits limits =
            cut_limits({std::max({extent.x, extent.y, extent.z}), stretch[m], std::uint64_t{placements[m]} * geometry.triangles(),
                        has_pictures(geometry, chain), max_triangles(options), !stand_ins.empty() || options.whole_objects});
        by_mesh[m] = bake::make_forms(std::move(geometry), limits, chain, stand_ins, &notes[m], sides[m]);
        if (!stage.step()) go = false;
    });
    for (const auto& of_mesh : notes)
        model.provenance.warnings.insert(model.provenance.warnings.end(), of_mesh.begin(), of_mesh.end());
    if (go && rays && !options.whole_objects) go = find_closed_pieces(by_mesh, objects, model, *rays, progress);
    if (go) adopt_forms(std::move(by_mesh));
    return go;
}

/// Forms get their places in one list; an object of several forms becomes as many pieces.
void BakeContext::adopt_forms(std::vector<std::vector<MeshForm>> by_mesh) {
    std::vector<std::uint32_t> first(by_mesh.size()), count(by_mesh.size());
    for (std::size_t m = 0; m < by_mesh.size(); ++m) {
        first[m] = static_cast<std::uint32_t>(forms.size());
        for (MeshForm& form : share_places(std::move(by_mesh[m]))) forms.push_back(std::move(form));
        count[m] = static_cast<std::uint32_t>(forms.size()) - first[m];
    }
    objects = with_forms(objects, forms, first, count);
}

/// What sees the sky, mesh by mesh; empty where light is not measured, and where objects stay whole.
std::vector<SkySides> BakeContext::find_sides(const std::vector<Geometry>& geometries) const {
    if (!rays || options.whole_objects) return std::vector<SkySides>(geometries.size());
    std::vector<MeshInPlaces> meshes(geometries.size());
    for (std::size_t m = 0; m < meshes.size(); ++m) meshes[m].geometry = &geometries[m];
    for (const PlacedObject& object : objects) meshes[object.mesh].places.push_back(object.world);
    return find_scene_sides(meshes, model, *rays, progress);
}

bool BakeContext::make_clusters() {
    std::vector<bool> in_rooms;
    std::uint64_t triangles = 0, closed_triangles = 0;
    for (const PlacedObject& object : objects) {
        const MeshForm& form = forms[object.mesh];
        in_rooms.push_back(form.closed);
        triangles += form.triangles;
        closed_triangles += form.closed ? form.triangles : 0;
    }
    if (closed_triangles * min_apart < triangles) in_rooms.clear();  // what is below a bench is no inside of a building
    tree = cluster_objects(objects, in_rooms, model, 8);
    clusters.resize(tree.clusters.size());
    const auto n = static_cast<std::uint32_t>(objects.size());
    const std::vector<std::vector<std::uint32_t>> by_height = clusters_by_height(tree, n, members);
    const ProxyInput input = proxy_input();
    Stage stage(progress, "clusters", tree.clusters.size());
    std::atomic<bool> go{true};
    for (const auto& same : by_height) {
        for_all(same.size(), [&](std::size_t i) {
            if (!go) return;
            const std::uint32_t c = same[i];
            clusters[c] = make_cluster(input, tree.clusters[c], members[c]);
            add_displacement(clusters[c].chain, tree.clusters[c].displacement_m);
            if (!stage.step()) go = false;
        });
    }
    return go;
}

bool BakeContext::trim_masks() {
    const MaskShapes shapes(model, cut_out);
    Stage stage(progress, "masks", forms.size() + clusters.size());
    std::atomic<bool> go{true};
    for_all(forms.size() + clusters.size(), [&](std::size_t i) {
        if (!go) return;
        trim_levels(i < forms.size() ? forms[i].chain : clusters[i - forms.size()].chain, shapes);
        if (!stage.step()) go = false;
    });
    return go;
}

bool BakeContext::shows_pictures() const {
    return std::any_of(scene.materials.begin(), scene.materials.end(),
                       [](const importer::Material& m) { return m.image != importer::none; });
}

/// A box carries its colours in vertices or a picture: in a scene that calls for neither it would be the only one to. Few
/// triangles are cheaper than six faces.
bool BakeContext::wants_box(std::uint32_t entity) const {
    if (proxy_or_none == model::none) return false;
    if (entity >= objects.size()) return !(tree.clusters[entity - objects.size()].displacement_m > 0);
    const std::uint32_t above = shows_pictures() ? min_box_triangles : min_plain_box_triangles;
    return forms[objects[entity].mesh].triangles > (objects[entity].piece ? std::max(above, min_piece_box_triangles) : above);
}

void BakeContext::emit_object(model::Index index, std::uint32_t which, const std::vector<EmittedChain>& chains) {
    const PlacedObject& object = objects[which];
    const MeshForm& form = forms[object.mesh];
    model::Node& node = model.nodes[index];
    node.kind = object.piece ? model::NodeKind::piece : model::NodeKind::object;
    node.object = object.object;
    node.importance = object.importance;
    node.box = object.box;
    node.triangles = form.triangles;
    node.name = add_name(model, object.name);
    node.first_rep = static_cast<model::Index>(model.reps.size());
    emit_representations(chains[object.mesh], object.world, model, object.motion);
    model.nodes[index].rep_count = static_cast<std::uint32_t>(model.reps.size()) - model.nodes[index].first_rep;
}

void BakeContext::emit_cluster(model::Index index, std::uint32_t which,
                               std::vector<std::pair<model::Index, std::uint32_t>>& open) {
    const ClusterTree::Cluster& cluster = tree.clusters[which];
    const ClusterForm& form = clusters[which];
    model.nodes[index].box = cluster.box;
    model.nodes[index].first_rep = static_cast<model::Index>(model.reps.size());
    const auto is_closed = [&](std::uint32_t object) { return forms[objects[object].mesh].closed; };
    if (std::all_of(members[which].begin(), members[which].end(), is_closed))
        closed.push_back(static_cast<std::uint32_t>(model.vertices.size()));
    emit_representations(emit_chain(form.chain, model), dmat4(1.0), model, cluster.motion);
    model.nodes[index].rep_count = static_cast<std::uint32_t>(model.reps.size()) - model.nodes[index].first_rep;
    const auto first = static_cast<model::Index>(model.nodes.size());
    model.nodes[index].first_child = first;
    model.nodes[index].child_count = static_cast<std::uint32_t>(cluster.children.size());
    model.nodes.resize(first + cluster.children.size());
    for (std::size_t c = 0; c < cluster.children.size(); ++c) {
        model.nodes[first + c].parent = index;
        open.emplace_back(first + static_cast<model::Index>(c), cluster.children[c]);
    }
}

void BakeContext::emit() {
    clear_emitted(model);
    entities.clear();
    closed.clear();
    std::vector<EmittedChain> chains(forms.size());
    for (std::size_t m = 0; m < forms.size(); ++m) {
        if (forms[m].triangles == 0) continue;
        if (forms[m].closed) closed.push_back(static_cast<std::uint32_t>(model.vertices.size()));
        chains[m] = emit_chain(forms[m].chain, model);
    }
    model.object_count = object_count;
    model.nodes.resize(1);
    std::vector<std::pair<model::Index, std::uint32_t>> open{{0, tree.root}};
    for (std::size_t i = 0; i < open.size(); ++i) {
        const auto [node, entity] = open[i];
        if (entity < objects.size()) {
            emit_object(node, entity, chains);
        } else {
            emit_cluster(node, entity - static_cast<std::uint32_t>(objects.size()), open);
        }
    }
    for (const auto& [node, entity] : open) entities.push_back(entity);
    for (std::size_t i = model.nodes.size(); i-- > 1;) {  // children come after their parents
        model::Node& node = model.nodes[i];
        model::Node& parent = model.nodes[node.parent];
        if (parent.kind == model::NodeKind::cluster) parent.triangles += node.triangles;
        parent.box.grow(node.box);
    }
}

/// Meshes of clusters cover about what is below them: else they change, and all is emitted anew.
bool BakeContext::mend_clusters() {
    std::vector<ClusterChain> chains(entities.size());
    for (std::size_t n = 0; n < entities.size(); ++n) {
        if (entities[n] < objects.size()) continue;
        const std::size_t c = entities[n] - objects.size();
        chains[n] = {&clusters[c].chain, tree.clusters[c].displacement_m};
    }
    Stage stage(progress, "coverage", mend_steps(model));
    const std::optional<bool> changed = bake::mend_clusters(model, chains, all_cores, [&] { return stage.step(); });
    if (changed.value_or(false)) emit();
    return changed.has_value();
}

/// Bounds a node's box. A box that cannot be its coarsest form loses its faces.
void BakeContext::bound(const ProxyInput& input, model::Index n, BoxForm& box) const {
    if (box.shown_faces() == 0) return;
    const auto clusters_from = static_cast<std::uint32_t>(objects.size());
    const std::uint32_t entity = entities[n];
    box.error_m = entity < clusters_from
                      ? bound_box(input, objects[entity], box)
                      : bound_box(input, tree.clusters[entity - clusters_from], members[entity - clusters_from], box);
    const model::Representation& coarsest = model.reps[model.nodes[n].first_rep];
    // Faces of one colour show little, and hide what is behind them. They are for nodes whose mesh is dearer and has a smaller
    // error.
    if (!box.textured && (box.error_m <= coarsest.error_m || 2 * box.shown_faces() >= coarsest.triangles)) box.faces = {};
    // Forms go from a large error to a small one. A bound may be larger than need be.
    box.error_m = std::max(box.error_m, std::nextafter(coarsest.error_m, std::numeric_limits<float>::infinity()));
}

/// Where all would take too much memory, what has most triangles goes first, and so clusters before what is in them.
std::vector<bool> BakeContext::wanted_boxes() const {
    std::vector<model::Index> nodes;
    for (model::Index n = 0; n < entities.size(); ++n)
        if (wants_box(entities[n])) nodes.push_back(n);
    std::stable_sort(nodes.begin(), nodes.end(),
                     [&](model::Index a, model::Index b) { return model.nodes[a].triangles > model.nodes[b].triangles; });
    nodes.resize(std::min(nodes.size(), max_box_bytes / box_bytes(min_box_cell)));
    std::vector<bool> wanted(entities.size(), false);
    for (const model::Index n : nodes) wanted[n] = true;
    return wanted;
}

std::optional<PlacedBoxes> BakeContext::add_boxes() {
    BoxRequest request;
    request.textured = shows_pictures();
    request.wanted = wanted_boxes();
    const auto count = static_cast<std::size_t>(std::count(request.wanted.begin(), request.wanted.end(), true));
    std::uint32_t cell = request.textured ? max_box_cell : min_box_cell;
    if (box_bytes(cell) * count > max_box_bytes) cell = min_box_cell;
    request.pixels = face_pixels(cell);
    Stage stage(progress, "boxes", box_steps(model, request) + entities.size());
    std::vector<BoxForm> boxes = capture_boxes(model, request, all_cores, [&] { return stage.step(); });
    if (boxes.empty()) return {};
    const ProxyInput input = proxy_input();
    std::atomic<bool> go{true};
    for_all(boxes.size(), [&](std::size_t n) {
        if (!go) return;
        bound(input, static_cast<model::Index>(n), boxes[n]);
        if (!stage.step()) go = false;
    });
    if (!go) return {};
    std::optional<PlacedBoxes> placed(std::in_place, std::move(boxes), proxy, model);
    fill_scene_light(model);  // pictures of their vertices are looked at next
    return placed;
}

void BakeContext::measure_areas() {
    for_all(model.reps.size(), [&](std::size_t r) { model.reps[r].area_m2 = model::rasterised_area(model, model.reps[r]); });
}

void BakeContext::find_effects() {
    std::vector<std::uint64_t> material_triangles(scene.materials.size(), 0);
    for (const PlacedObject& object : objects)
        for (const GeometryPart& part : forms[object.mesh].chain.levels.back().parts)
            material_triangles[part.material] += part.indices.size() / 3;
    keep_used_effects(model, light.openness.copies);
    model.effects = bake::find_effects(model, material_triangles, light);
    add_sun_reason(scene, options.sun, model.effects);
    add_scene_effects(scene, options.sky, model.effects);
    add_moving_shadow(model);
}

/// Only lit scenes: rays for what light is measured from, and meshes that are cut for it.
void BakeContext::prepare_light() {
    const auto lit = [](const model::Material& m) { return (m.effects & model::effect_sun) != 0; };
    if (options.quality != Quality::full || std::none_of(model.materials.begin(), model.materials.end(), lit)) return;
    rays = make_light_rays(scene, progress);
    if (!progress.stopped()) refined = refine_scene(scene, model, *rays, progress);
}

bool BakeContext::measure_light() {
    if (!rays) return true;
    auto found = measure_scene_light(scene, *rays, closed, model, progress);
    rays.reset();
    if (found) light = std::move(*found);
    return found.has_value();
}

bool BakeContext::measure_pictures() {
    Stage stage(progress, "pictures", loss_steps(model));
    MeasuredLosses measured = measure_losses(model, all_cores, [&] { return stage.step(); });
    covered = std::move(measured.covered);
    measured.move_to(model);
    return !model.losses.empty();
}

}  // namespace

Result<model::Model> bake(const importer::Scene& scene, const BakeOptions& options, const Progress& progress) {
    BakeContext context{scene, options, progress};
    context.adopt_materials();
    context.place_objects();
    bool done = true;
    const int workers =
        options.workers > 0 ? options.workers : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    tbb::task_arena arena(workers);
    arena.execute([&] {
        context.prepare_light();
        done = !progress.stopped() && context.make_forms();
        if (done && !context.objects.empty()) done = context.make_clusters() && context.trim_masks();
    });
    if (!done) return stopped_by_user(scene);
    if (context.objects.empty()) {
        return Error{place_of(scene), "The scene holds nothing to draw", "Check that its nodes have meshes with triangles",
                     ErrorKind::damaged};
    }
    std::size_t max_boxes = 0;
    for (std::uint32_t e = 0; e < context.objects.size() + context.clusters.size(); ++e)
        max_boxes += context.wants_box(e) ? 1 : 0;
    if (auto ok = check_limits(counts_of(context.proxy_input(), max_boxes), place_of(scene), options.max_counts); !ok)
        return ok.error();
    arena.execute([&] {
        context.emit();
        done = context.mend_clusters() && context.measure_light();
        if (!done) return;
        std::optional<PlacedBoxes> boxes = context.add_boxes();
        done = boxes.has_value();
        if (!done) return;
        context.measure_areas();
        done = context.measure_pictures();
        if (!done) return;
        boxes->drop_idle(costs_of(options), context.covered);
        context.measure_areas();
        fill_scene_light(context.model);
        context.find_effects();
        context.model.ground = make_ground(scene, progress, nullptr, &context.model.moving_ground);
        for (model::Index& motion : context.model.moving_ground.motions) motion = context.motions[motion];
        const std::optional<model::Ground> ways = ground_with_ways(context.model);
        Tour tour = make_tour(ways ? *ways : context.model.ground, context.model.nodes[0].box, progress);
        sweep_boxes(context.model);
        context.model.tour = std::move(tour.path);
        context.model.tour_kind = std::move(tour.kind);
        done = !progress.stopped();
    });
    if (!done) return stopped_by_user(scene);
    progress.update("write", 0.0);
    model::Model& model = context.model;
    model.provenance.sources = scene.sources;
    model.provenance.warnings.insert(model.provenance.warnings.begin(), scene.warnings.begin(), scene.warnings.end());
    for (std::string& line : ground_warnings(model.ground, model.nodes[0].box))
        model.provenance.warnings.push_back(std::move(line));
    model.provenance.quality = options.quality == Quality::full ? "full" : "draft";
    if (auto valid = model::validate(model); !valid) return valid.error();
    model::index_moving_ground(model);
    return std::move(model);
}

}  // namespace surefoot::bake
