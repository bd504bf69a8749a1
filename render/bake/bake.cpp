// The bake: forms of every mesh, the growing grid, a mesh for every cluster, boxes; then the flat model.
#include "render/bake/bake.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "render/bake/limits.hpp"
#include "render/bake/materials.hpp"
#include "render/bake/picture_loss.hpp"
#include "render/bake/proxies.hpp"
#include "render/model/pixels.hpp"
#include "rt/base/fork_join.hpp"
#include "rt/base/mutex.hpp"

namespace surefoot::bake {

namespace {

std::string place_of(const importer::Scene& scene) { return scene.sources.empty() ? "bake" : scene.sources.front(); }

Error stopped_by_user(const importer::Scene& scene) {
    return {place_of(scene), "The user stopped the bake; nothing was written", "", ErrorKind::stopped};
}

/// body(0) to body(count - 1) on all threads of the arena.
template <class Body>
void for_all(std::size_t count, const Body& body) {
    ForkJoin loop;
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
        const ForkJoin::Task task(loop);
        body(i);
    });
    loop.joined();
}

/// Progress from many threads, reported about ten times a second; and the request to stop.
class Stage {
public:
    Stage(const Progress& progress, std::string_view name, std::size_t total) : progress_(progress), name_(name), total_(total) {}
    /// False: stop.
    bool step() {
        const std::size_t done = done_.fetch_add(1) + 1;
        const auto now = std::chrono::steady_clock::now();
        if (mutex_.try_lock()) {
            if (now - last_update_ > std::chrono::milliseconds(100) || done == total_) {
                last_update_ = now;
                progress_.update(name_, static_cast<double>(done) / static_cast<double>(std::max<std::size_t>(1, total_)));
            }
            mutex_.unlock();
        }
        return !progress_.stopped();
    }

private:
    const Progress& progress_;
    std::string_view name_;
    std::size_t total_;
    std::atomic<std::size_t> done_{0};
    Mutex mutex_;
    std::chrono::steady_clock::time_point last_update_ GUARDED_BY(mutex_){};
};

struct BakeContext {
    const importer::Scene& scene;
    const BakeOptions& options;
    const Progress& progress;
    model::Model model;
    model::Index proxy = 0;             ///< a material with vertex colours
    model::Index proxy_or_none = 0;     ///< the same, or none where every colour is a material's own
    std::vector<PlacedObject> objects;  ///< pieces count each
    std::uint32_t object_count = 0;     ///< conceptual ones
    std::vector<MeshForm> forms;
    ClusterTree tree;
    std::vector<ClusterForm> clusters;
    std::vector<BoxForm> object_boxes;
    std::vector<bool> cut_out;  ///< by material

    ProxyInput proxy_input() const;
    void place_objects();
    void adopt_forms(std::vector<std::vector<MeshForm>> by_mesh);
    bool make_forms();
    bool make_clusters();
    bool make_object_boxes();
    void emit();
    bool measure_pictures();
    void emit_object(model::Index node, std::uint32_t object, const std::vector<EmittedChain>& chains);
    void emit_cluster(model::Index node, std::uint32_t cluster, std::vector<std::pair<model::Index, std::uint32_t>>& open);
    model::Index add_name(const std::string& name);
};

Box placed_box(const Box& box, const dmat4& world) {
    Box out;
    for (unsigned c = 0; c < 8; ++c) {
        const dvec3 corner((c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y,
                           (c & 4U) != 0 ? box.max.z : box.min.z);
        out.grow(dvec3(world * dvec4(corner, 1.0)));
    }
    return out;
}

ChainOptions chain_options(const BakeOptions& options, model::Index proxy) {
    ChainOptions chain;
    chain.slack = options.quality == Quality::full ? 0.1F : 0.3F;
    chain.ratio = options.quality == Quality::full ? 0.6 : 0.45;
    chain.proxy_material = proxy;
    return chain;
}

/// The 1/16-frame rule: as many triangles as fit, seen near and over a quarter of the picture.
std::uint32_t max_triangles(const BakeOptions& options) {
    const model::CostModel fallback = model::default_costs();
    const model::CostModel& costs = options.costs != nullptr && !options.costs->grids.empty() ? *options.costs : fallback;
    const double limit_us = options.frame_us / 16.0;
    const model::CostGrid& grid = costs.grid_for(model::effect_texture | model::effect_sun);
    std::uint32_t max_found = 256;
    for (std::uint32_t n = 512; n <= 65536; n *= 2) {
        const model::ItemCost cost = costs.item(static_cast<float>(n), 60000.0F, grid);
        if (cost.submit_us + cost.raster_us > limit_us) break;
        max_found = n;
    }
    return max_found;
}

ProxyInput BakeContext::proxy_input() const {
    ProxyInput input;
    input.objects = objects;
    input.forms = forms;
    input.clusters = clusters;
    input.model = &model;
    input.proxy_material = proxy_or_none;
    for (const model::Material& m : model.materials) input.two_sided.push_back(m.two_sided);
    input.cut_out = cut_out;
    for (const importer::Material& m : scene.materials) input.textured_boxes |= m.image != importer::none;
    input.slack = chain_options(options, proxy_or_none).slack;
    return input;
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
        objects.push_back(std::move(object));
    }
}

bool BakeContext::make_forms() {
    std::vector<std::vector<MeshForm>> by_mesh(scene.meshes.size());
    std::vector<double> stretch(scene.meshes.size(), 0.0);
    Box world;
    std::vector<Box> mesh_boxes(scene.meshes.size());
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        for (const importer::Primitive& p : scene.meshes[m].primitives) {
            for (const vec3& v : p.positions) mesh_boxes[m].grow(dvec3(v));
        }
    }
    std::erase_if(objects, [&](const PlacedObject& o) { return mesh_boxes[o.mesh].empty(); });
    for (PlacedObject& object : objects) {
        object.box = placed_box(mesh_boxes[object.mesh], object.world);
        world.grow(object.box);
        stretch[object.mesh] = std::max(stretch[object.mesh], largest_stretch(dmat3(object.world)));
    }
    const dvec3 extent = world.max - world.min;
    const double longest_m = std::max({extent.x, extent.y, extent.z}) / 8.0;
    const std::uint32_t max_item_triangles = max_triangles(options);
    Stage stage(progress, "levels of detail", scene.meshes.size());
    std::atomic<bool> go{true};
    ChainOptions chain = chain_options(options, proxy_or_none);
    chain.cut_out = cut_out;
    for (const model::Material& material : model.materials) {
        const bool none = material.texture == model::none;
        chain.pictures.push_back(none                                     ? Picture::none
                                 : model.textures[material.texture].clamp ? Picture::clamped
                                                                          : Picture::repeats);
    }
    for_all(scene.meshes.size(), [&](std::size_t m) {
        if (!go || stretch[m] == 0) return;
        CutLimits limits;
        limits.max_triangles = max_item_triangles;
        limits.longest_m = longest_m / stretch[m];
        by_mesh[m] = bake::make_forms(mesh_geometry(scene.meshes[m], model), limits, chain);
        if (!stage.step()) go = false;
    });
    if (go) adopt_forms(std::move(by_mesh));
    return go;
}

/// Forms get their places in one list; an object of several forms becomes as many pieces.
void BakeContext::adopt_forms(std::vector<std::vector<MeshForm>> by_mesh) {
    std::vector<std::uint32_t> first(by_mesh.size()), count(by_mesh.size());
    for (std::size_t m = 0; m < by_mesh.size(); ++m) {
        first[m] = static_cast<std::uint32_t>(forms.size());
        count[m] = static_cast<std::uint32_t>(by_mesh[m].size());
        for (MeshForm& form : by_mesh[m]) forms.push_back(std::move(form));
    }
    std::vector<PlacedObject> placed;
    for (const PlacedObject& object : objects) {
        for (std::uint32_t i = 0; i < count[object.mesh]; ++i) {
            PlacedObject one = object;
            one.mesh = first[object.mesh] + i;
            one.piece = count[object.mesh] > 1;
            one.box = placed_box(forms[one.mesh].box, object.world);
            placed.push_back(std::move(one));
        }
    }
    objects = std::move(placed);
}

bool BakeContext::make_clusters() {
    std::vector<Box> boxes;
    for (const PlacedObject& object : objects) boxes.push_back(object.box);
    tree = grow_clusters(boxes, 8);
    clusters.resize(tree.clusters.size());
    const auto n = static_cast<std::uint32_t>(objects.size());
    std::vector<std::vector<std::uint32_t>> members(tree.clusters.size()), by_height;
    std::vector<std::uint32_t> height(tree.clusters.size(), 0);
    for (std::uint32_t c = 0; c < tree.clusters.size(); ++c) {  // children come first
        for (const std::uint32_t e : tree.clusters[c].children) {
            if (e < n) {
                members[c].push_back(e);
            } else {
                members[c].insert(members[c].end(), members[e - n].begin(), members[e - n].end());
                height[c] = std::max(height[c], height[e - n] + 1);
            }
        }
        if (by_height.size() <= height[c]) by_height.resize(height[c] + 1);
        by_height[height[c]].push_back(c);
    }
    const ProxyInput input = proxy_input();
    Stage stage(progress, "clusters", tree.clusters.size());
    std::atomic<bool> go{true};
    for (const auto& same : by_height) {
        for_all(same.size(), [&](std::size_t i) {
            if (!go) return;
            const std::uint32_t c = same[i];
            clusters[c] = make_cluster(input, tree.clusters[c], members[c]);
            if (!stage.step()) go = false;
        });
    }
    return go;
}

bool BakeContext::make_object_boxes() {
    object_boxes.resize(objects.size());
    const ProxyInput input = proxy_input();
    Stage stage(progress, "boxes", objects.size());
    std::atomic<bool> go{true};
    for_all(objects.size(), [&](std::size_t i) {
        if (!go) return;
        const MeshForm& form = forms[objects[i].mesh];
        if (form.triangles > 500 && form.chain.levels.front().triangles > 12)
            object_boxes[i] = make_object_box(input, objects[i], 16);
        if (!stage.step()) go = false;
    });
    return go;
}

model::Index BakeContext::add_name(const std::string& name) {
    if (name.empty()) return 0;
    const auto at = static_cast<model::Index>(model.names.size());
    model.names += name;
    model.names.push_back('\0');
    return at;
}

std::uint32_t faces_of(const BoxForm& box) {
    std::uint32_t faces = 0;
    for (const FaceCapture& face : box.faces) faces += face.covered > 0 ? 1 : 0;
    return faces;
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
    node.name = add_name(object.name);
    node.first_rep = static_cast<model::Index>(model.reps.size());
    const Level& coarsest = form.chain.levels.front();
    const BoxForm& box = object_boxes[which];
    const std::uint32_t faces = faces_of(box);
    const auto coarsest_error_m = static_cast<float>(coarsest.error_m * largest_stretch(dmat3(object.world)));
    // A box carries its colours in vertices or a picture: in a scene that calls for neither it would be the only one to.
    if (proxy_or_none != model::none && faces > 0 && 2 * faces < coarsest.triangles && box.error_m > coarsest_error_m)
        emit_box(box, proxy, model);
    emit_representations(chains[object.mesh], object.world, model);
    model.nodes[index].rep_count = static_cast<std::uint32_t>(model.reps.size()) - model.nodes[index].first_rep;
}

void BakeContext::emit_cluster(model::Index index, std::uint32_t which,
                               std::vector<std::pair<model::Index, std::uint32_t>>& open) {
    const ClusterTree::Cluster& cluster = tree.clusters[which];
    const ClusterForm& form = clusters[which];
    model.nodes[index].box = cluster.box;
    model.nodes[index].first_rep = static_cast<model::Index>(model.reps.size());
    const std::uint32_t faces = faces_of(form.box);
    if (proxy_or_none != model::none && form.has_box && faces > 0 && 2 * faces < form.chain.levels.front().triangles)
        emit_box(form.box, proxy, model);
    emit_representations(emit_chain(form.chain, model), dmat4(1.0), model);
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
    model.names.assign(1, '\0');
    std::vector<EmittedChain> chains(forms.size());
    std::vector<std::uint64_t> material_triangles(scene.materials.size(), 0);
    for (std::size_t m = 0; m < forms.size(); ++m) {
        if (forms[m].triangles > 0) chains[m] = emit_chain(forms[m].chain, model);
    }
    for (const PlacedObject& object : objects) {
        for (const GeometryPart& part : forms[object.mesh].chain.levels.back().parts)
            material_triangles[part.material] += part.indices.size() / 3;
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
    for (std::size_t i = model.nodes.size(); i-- > 1;) {  // children come after their parents
        model::Node& node = model.nodes[i];
        model::Node& parent = model.nodes[node.parent];
        if (parent.kind == model::NodeKind::cluster) parent.triangles += node.triangles;
        parent.box.grow(node.box);
    }
    for_all(model.reps.size(), [&](std::size_t r) { model.reps[r].area_m2 = model::rasterised_area(model, model.reps[r]); });
    std::vector<bool> used(model.materials.size(), false);
    for (const model::Part& part : model.parts) used[part.material] = true;
    for (std::size_t m = 0; m < used.size(); ++m) {  // what nothing is drawn with calls for nothing
        if (!used[m]) model.materials[m].effects = 0;
    }
    model.effects = find_effects(model, material_triangles);
}

bool BakeContext::measure_pictures() {
    Stage stage(progress, "pictures", loss_steps(model));
    MeasuredLosses measured = measure_losses(
        model, [](std::size_t count, const std::function<void(std::size_t)>& body) { for_all(count, body); },
        [&] { return stage.step(); });
    model.losses = std::move(measured.forms);
    model.colours = measured.colours;
    return !model.losses.empty();
}

}  // namespace

Result<model::Model> bake(const importer::Scene& scene, const BakeOptions& options, const Progress& progress) {
    BakeContext context{scene, options, progress, {}, 0, 0, {}, 0, {}, {}, {}, {}, {}};
    context.cut_out = cut_out_materials(scene);
    context.proxy = add_materials(scene, context.model);
    mark_vertex_colours(scene, context.model);
    bool coloured = false;
    for (std::size_t m = 0; m < scene.materials.size(); ++m) {
        coloured |= (context.model.materials[m].effects & (model::effect_texture | model::effect_vertex_colour)) != 0;
    }
    context.proxy_or_none = coloured ? context.proxy : model::none;
    context.place_objects();
    bool done = true;
    const int workers =
        options.workers > 0 ? options.workers : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    tbb::task_arena arena(workers);
    arena.execute([&] {
        done = context.make_forms();
        if (done && !context.objects.empty()) done = context.make_clusters() && context.make_object_boxes();
    });
    if (!done) return stopped_by_user(scene);
    if (context.objects.empty()) {
        return Error{place_of(scene), "The scene holds nothing to draw", "Check that its nodes have meshes with triangles",
                     ErrorKind::damaged};
    }
    if (auto ok = check_limits(counts_of(context.proxy_input(), context.object_boxes), place_of(scene), options.max_counts); !ok)
        return ok.error();
    arena.execute([&] {
        context.emit();
        done = context.measure_pictures();
    });
    if (!done) return stopped_by_user(scene);
    progress.update("write", 0.0);
    model::Model& model = context.model;
    model.provenance.sources = scene.sources;
    model.provenance.warnings = scene.warnings;
    model.provenance.quality = options.quality == Quality::full ? "full" : "draft";
    if (auto valid = model::validate(model); !valid) return valid.error();
    return std::move(model);
}

}  // namespace surefoot::bake
