// Generating the calibration model (calibrate_scene.hpp).
#include "render/measure/calibrate_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "render/effects/effects.hpp"
#include "render/model/cost.hpp"
#include "rt/base/random.hpp"

namespace surefoot::measure {

namespace {

using model::Index;

constexpr model::EffectMask texture = model::effect_texture, colours = model::effect_vertex_colour, sun = model::effect_sun,
                            mask = model::effect_alpha_mask, blend = model::effect_blend;
constexpr std::array<model::EffectMask, 7> all_classes{
    0, colours | sun, texture, texture | sun, texture | sun | colours, texture | sun | mask, texture | sun | blend};
constexpr std::array<int, 8> triangle_levels{12, 24, 64, 256, 1024, 4096, 16384, 65536};  // the first is a box
constexpr std::array<double, 6> pixel_levels{16, 128, 1024, 8192, 65536, 262144};
constexpr int copies_of_small = 8;           // of each mesh: equal neighbours would merge into one instanced draw
constexpr std::uint32_t texture_count = 16;  // equal images, but each a state of its own, as in real scenes
constexpr double cell_us = 2500;             // aim for this long a measurement
constexpr std::size_t max_items = 300;       // in a cell

/// A mesh in the model, to be referenced by parts of any class.
struct Mesh {
    model::Part part;  ///< material to be filled in
    std::uint32_t triangles = 0;
};

class Builder {
public:
    explicit Builder(std::uint64_t seed) : random_(seed) {
        model_.names = std::string(1, '\0');
        model_.nodes.emplace_back();
        model_.sun_direction = glm::normalize(dvec3(0.36, 0.80, 0.48));
        for (std::uint32_t i = 0; i < texture_count; ++i) add_texture();
    }

    /// Materials of one class that differ in their texture; one where there is none.
    std::vector<Index> materials(model::EffectMask effects) {
        std::vector<Index> list;
        for (Index t = 0; t < ((effects & texture) != 0 ? texture_count : 1U); ++t) list.push_back(material(effects, t));
        return list;
    }
    Index material(model::EffectMask effects, Index image) {
        model::Material m;
        m.colour = {0.8F, 0.75F, 0.7F, (effects & blend) != 0 ? 0.6F : 1.0F};
        m.effects = effects;
        if ((effects & texture) != 0) m.texture = image;
        m.alpha = (effects & mask) != 0    ? model::AlphaMode::mask
                  : (effects & blend) != 0 ? model::AlphaMode::blend
                                           : model::AlphaMode::opaque;
        model_.materials.push_back(m);
        return static_cast<Index>(model_.materials.size() - 1);
    }

    /// A box of 12 triangles.
    Mesh box() {
        Mesh mesh;
        begin(mesh);
        for (int side = 0; side < 6; ++side) {
            dvec3 out(0.0);
            out[side / 2] = side % 2 == 0 ? 1.0 : -1.0;
            add_sheet(1, out, out);
        }
        finish(mesh);
        return mesh;
    }

    /// A level sheet of 2 * cells^2 triangles that shows from above.
    Mesh ground(int cells) {
        Mesh mesh;
        begin(mesh);
        add_sheet(cells, dvec3(0, 1, 0), dvec3(0.0));
        finish(mesh);
        return mesh;
    }

    /// A bumpy sphere of radius about 1 with about `triangles` triangles.
    Mesh sphere(int triangles) {
        const int segments = std::max(3, static_cast<int>(std::lround(std::sqrt(triangles))));
        const int rings = std::max(2, static_cast<int>(std::lround(triangles / (2.0 * segments))) + 1);
        Mesh mesh;
        begin(mesh);
        for (int i = 0; i <= rings; ++i) {
            for (int j = 0; j <= segments; ++j) {
                const double a = std::numbers::pi * i / rings;
                const double b = 2 * std::numbers::pi * (j % segments) / segments;
                const bool seam = i == 0 || i == rings || j % segments == 0;
                const double r = seam ? 1.0 : random_.range(0.93, 1.0);
                const dvec3 out(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b));
                add_vertex(r * out, out, vec2(2.0 * j / segments, 1.0 * i / rings));
            }
        }
        for (int i = 0; i < rings; ++i) {
            for (int j = 0; j < segments; ++j) {
                const auto a = static_cast<std::uint32_t>(i * (segments + 1) + j);
                const auto c = a + static_cast<std::uint32_t>(segments) + 1;
                if (i > 0) add_triangle({a, a + 1, c});
                if (i + 1 < rings) add_triangle({a + 1, c + 1, c});
            }
        }
        finish(mesh);
        return mesh;
    }

    /// A node at a place, without representations yet; meshes are stretched to the radii.
    Index node(const dvec3& centre, const dvec3& radii) {
        model::Node n;
        n.box.grow(centre - radii);
        n.box.grow(centre + radii);
        n.parent = 0;
        n.kind = model::NodeKind::object;
        n.first_rep = static_cast<Index>(model_.reps.size());
        model_.nodes.push_back(n);
        model::Placement placement;
        placement.origin = centre;
        for (int i = 0; i < 3; ++i) placement.linear[i][i] = static_cast<float>(radii[i]);
        model_.placements.push_back(placement);
        return static_cast<Index>(model_.nodes.size() - 1);
    }

    /// One more representation of the node made last.
    Index rep(const Mesh& mesh, Index material) {
        model::Part part = mesh.part;
        part.material = material;
        model_.parts.push_back(part);
        model::Representation r;
        r.placement = static_cast<Index>(model_.placements.size() - 1);
        r.first_part = static_cast<Index>(model_.parts.size() - 1);
        r.part_count = 1;
        r.triangles = mesh.triangles;
        r.effects = model_.materials[material].effects;
        r.area_m2 = model::rasterised_area(model_, r);
        model_.reps.push_back(r);
        ++model_.nodes.back().rep_count;
        model_.nodes.back().triangles = mesh.triangles;
        return static_cast<Index>(model_.reps.size() - 1);
    }

    Random& random() { return random_; }
    model::Model& model() { return model_; }

private:
    void add_texture() {
        model::Texture t;
        t.width = t.height = 256;
        for (std::uint32_t side = 256; side > 0; side /= 2, ++t.levels) {
            for (std::uint32_t i = 0; i < side * side; ++i) {
                const std::uint64_t noise = random_.next();
                // A tenth of the texels are holes for the mask.
                const bool hole = noise % 10 == 0;
                for (unsigned c = 0; c < 3; ++c)
                    model_.texels.push_back(static_cast<std::byte>(0x60U | (noise >> (8 * c + 8) & 0x7fU)));
                model_.texels.push_back(static_cast<std::byte>(hole ? 0 : 255));
            }
        }
        model_.textures.push_back(t);
    }
    /// A square of half size 1 around `centre`, facing along the axis `out`.
    void add_sheet(int cells, const dvec3& out, const dvec3& centre) {
        const dvec3 u(out.y, out.z, out.x);
        const dvec3 v = glm::cross(out, u);
        const std::uint32_t first = next_vertex();
        for (int i = 0; i <= cells; ++i) {
            for (int j = 0; j <= cells; ++j) {
                const double a = 2.0 * i / cells - 1;
                const double b = 2.0 * j / cells - 1;
                add_vertex(centre + a * u + b * v, out, vec2(2 * a, 2 * b));
            }
        }
        const auto row = static_cast<std::uint32_t>(cells) + 1;
        for (std::uint32_t i = 0; i + 1 < row; ++i) {
            for (std::uint32_t j = 0; j + 1 < row; ++j) {
                const std::uint32_t a = first + i * row + j;
                add_triangle({a, a + row, a + row + 1});
                add_triangle({a, a + row + 1, a + 1});
            }
        }
    }
    [[nodiscard]] std::uint32_t next_vertex() const { return static_cast<std::uint32_t>(model_.vertices.size()) - first_vertex_; }
    void begin(Mesh& mesh) {
        first_vertex_ = static_cast<std::uint32_t>(model_.vertices.size());
        mesh.part.first_index = static_cast<std::uint32_t>(model_.indices.size());
        mesh.part.first_vertex = static_cast<std::uint32_t>(model_.vertices.size());
    }
    void add_vertex(const dvec3& position, const dvec3& normal, const vec2& uv) {
        model::Vertex v{};
        for (int i = 0; i < 3; ++i) {
            v.position[i] = static_cast<float>(position[i]);
            v.normal[i] = static_cast<std::int8_t>(std::lround(127 * normal[i]));
            v.colour[i] = static_cast<std::uint8_t>(160 + random_.below(90));
        }
        v.colour[3] = 255;
        v.uv[0] = uv.x;
        v.uv[1] = uv.y;
        model_.vertices.push_back(v);
    }
    void add_triangle(const std::array<std::uint32_t, 3>& corners) {
        model_.indices.insert(model_.indices.end(), corners.begin(), corners.end());
    }
    void finish(Mesh& mesh) const {
        mesh.part.index_count = static_cast<std::uint32_t>(model_.indices.size()) - mesh.part.first_index;
        mesh.part.vertex_count = static_cast<std::uint32_t>(model_.vertices.size()) - mesh.part.first_vertex;
        mesh.triangles = mesh.part.index_count / 3;
    }

    model::Model model_;
    Random random_;
    std::uint32_t first_vertex_ = 0;  ///< of the mesh being made
};

using Meshes = std::vector<std::vector<Mesh>>;  ///< [level][copy]

Meshes make_meshes(Builder& builder) {
    Meshes meshes;
    for (const int level : triangle_levels) {
        auto& copies = meshes.emplace_back();
        const int count = level <= 4096 ? copies_of_small : 2;
        for (int i = 0; i < count; ++i) copies.push_back(level == triangle_levels[0] ? builder.box() : builder.sphere(level));
    }
    return meshes;
}

/// Where and in how many places items of a cell stand: about `pixels` each over the view of Pose{}, at rising depth so that equal
/// meshes are never sorted side by side. place(i, node) adds the forms of the node made last.
template <class Place>
void place_items(Builder& builder, const std::vector<Mesh>& meshes, model::EffectMask effects, double pixels,
                 model::Viewport viewport, Place place) {
    const model::ViewScale scale = model::make_view_scale(Pose{}, viewport);
    const double f = static_cast<double>(scale.pixels_per_radian);
    const double angular = std::sqrt(pixels / std::numbers::pi) / f;  // radius over depth
    const model::CostModel guess = model::default_costs();
    const model::ItemCost cost =
        guess.item(static_cast<float>(meshes[0].triangles), static_cast<float>(pixels), guess.grid_for(effects));
    const double each_us = static_cast<double>(cost.submit_us + cost.raster_us);
    const auto count = static_cast<std::size_t>(std::clamp(cell_us / each_us, 1.0, static_cast<double>(max_items)));
    for (std::size_t i = 0; i < count; ++i) {
        const double depth = 20.0 * (1.0 + 0.002 * static_cast<double>(i));
        const double reach_x = std::max(0.0, static_cast<double>(scale.tan_half_x) - angular);
        const double reach_y = std::max(0.0, static_cast<double>(scale.tan_half_y) - angular);
        const double y = depth * builder.random().range(-reach_y, reach_y), x = depth * builder.random().range(-reach_x, reach_x);
        const dvec3 centre(x, y, -depth);
        const dvec3 radii(angular * depth);
        place(i, builder.node(centre, radii));
    }
}

CalibrationCell make_cell(Builder& builder, const std::vector<Mesh>& meshes, std::span<const Index> materials, double pixels,
                          model::Viewport viewport) {
    CalibrationCell cell;
    cell.effects = builder.model().materials[materials.front()].effects;
    place_items(builder, meshes, cell.effects, pixels, viewport, [&](std::size_t i, Index node) {
        const Index rep = builder.rep(meshes[i % meshes.size()], materials[i % materials.size()]);
        cell.items.push_back({node, rep});
        cell.triangles += builder.model().reps[rep].triangles;
    });
    cell.triangles /= static_cast<double>(cell.items.size());
    return cell;
}

/// For each effect with a price, spheres of many triangles and boxes of many pixels.
void make_price_cells(Builder& builder, const Meshes& meshes, model::Viewport viewport, CalibrationScene& scene) {
    constexpr std::size_t many_triangles = 5, few_triangles = 0;  // of triangle_levels
    constexpr double few_pixels = 1024, many_pixels = 65536;
    for (const effects::EffectModule& module : effects::all_effects()) {
        if (module.priced_on == 0) continue;
        const std::vector<Index> without = builder.materials(module.priced_on),
                                 with = builder.materials(module.priced_on | module.bit);
        for (const auto& kind : {std::pair{many_triangles, few_pixels}, {few_triangles, many_pixels}}) {
            const auto level = kind.first;
            const auto pixels = kind.second;
            PriceCell& cell = scene.prices.emplace_back();
            cell.effect = module.bit;
            place_items(builder, meshes[level], module.priced_on, pixels, viewport, [&](std::size_t i, Index node) {
                const Mesh& mesh = meshes[level][i % meshes[level].size()];
                cell.without.push_back({node, builder.rep(mesh, without[i % without.size()])});
                cell.with.push_back({node, builder.rep(mesh, with[i % with.size()])});
                cell.triangles += mesh.triangles;
            });
            cell.triangles /= static_cast<double>(cell.with.size());
            std::reverse(cell.without.begin(), cell.without.end());  // far to near
            std::reverse(cell.with.begin(), cell.with.end());
        }
    }
    // What they read; its bytes do not matter.
    builder.model().sun_seen.resize(builder.model().vertices.size(), {{200, 100, 200, 100}});
    builder.model().lamp_light.resize(builder.model().vertices.size(), {{90, 80, 70, 0}, {20, 20, 20, 0}});
    builder.model().light.fog_visibility_m = 500;
}

double mean_pixels(const CalibrationScene& scene, std::span<const gl::DrawItem> items, const model::ViewScale& scale) {
    const model::Model& model = scene.model;
    double sum = 0;
    for (const gl::DrawItem& item : items)
        sum += static_cast<double>(scene.estimator.pixels(model, item.rep, model.nodes[item.node].box, dvec3(0.0), scale));
    return sum / static_cast<double>(items.size());
}

void count_pixels(CalibrationScene& scene, model::Viewport viewport) {
    const model::ViewScale scale = model::make_view_scale(Pose{}, viewport);
    for (CalibrationCell& cell : scene.cells) cell.pixels = mean_pixels(scene, cell.items, scale);
    for (PriceCell& cell : scene.prices) cell.pixels = mean_pixels(scene, cell.with, scale);
}

constexpr double town_side_m = 400;
constexpr int blocks = 12;  // a side
constexpr int objects_a_block = 16;

/// An object at several levels of detail, the first of `meshes`.
void add_town_object(Builder& builder, const Meshes& meshes, Index material, const dvec3& centre, const dvec3& radii,
                     std::size_t levels, CalibrationScene& scene) {
    TownObject object;
    object.node = builder.node(centre, radii);
    object.effects = builder.model().materials[material].effects;
    object.first_rep = static_cast<Index>(builder.model().reps.size());
    for (std::size_t level = 0; level < levels; ++level, ++object.levels) {
        const auto copies = static_cast<std::uint32_t>(meshes[level].size());
        builder.rep(meshes[level][builder.random().below(copies)], material);
    }
    scene.town.push_back(object);
    scene.town_box.grow(builder.model().nodes[object.node].box);
}

/// Blocks of ground, with things of 0.4 to 5 m on them, some flat, some tall.
void make_town(Builder& builder, const Meshes& meshes, const std::vector<std::vector<Index>>& materials,
               CalibrationScene& scene) {
    Random& random = builder.random();
    const double block = town_side_m / blocks;
    Meshes grounds;
    for (const int cells : {1, 4, 12}) grounds.push_back({builder.ground(cells)});
    const auto any = [&](const std::vector<Index>& list) { return list[random.below(static_cast<std::uint32_t>(list.size()))]; };
    for (int b = 0; b < blocks * blocks; ++b) {
        const int column = b % blocks, row = b / blocks;
        const dvec3 corner(block * column - 0.5 * town_side_m, 0, block * row - 0.5 * town_side_m + 1000);
        // Ground is never see-through or full of holes.
        const std::size_t ground = random.below(static_cast<std::uint32_t>(std::min<std::size_t>(4, materials.size())));
        add_town_object(builder, grounds, any(materials[ground]), corner + dvec3(0.5 * block, 0.0, 0.5 * block),
                        dvec3(0.5 * block, 0.01, 0.5 * block), grounds.size(), scene);
        for (int i = 0; i < objects_a_block; ++i) {
            const double radius = 0.4 * std::exp(2.5 * random.unit());
            const dvec3 radii = radius * any_in(random, {0.4, 0.3, 0.4}, {1.0, 1.5, 1.0});
            const dvec3 centre = corner + any_in(random, {0, 0.4 * radii.y, 0}, {block, radii.y, block});
            const auto& list = materials[random.below(static_cast<std::uint32_t>(materials.size()))];
            const std::size_t levels = 3 + random.below(4);
            add_town_object(builder, meshes, any(list), centre, radii, levels, scene);
        }
    }
}

}  // namespace

std::span<const model::EffectMask> calibration_classes(bool quick) {
    return std::span<const model::EffectMask>(all_classes).subspan(0, quick ? 4 : all_classes.size());
}

CalibrationScene make_calibration_scene(model::Viewport viewport, bool quick, std::uint64_t seed) {
    Builder builder(seed);
    CalibrationScene scene;
    const Meshes meshes = make_meshes(builder);
    std::vector<std::vector<Index>> materials;  // [class]
    for (const model::EffectMask effects : calibration_classes(quick)) materials.push_back(builder.materials(effects));
    for (const std::vector<Index>& of_class : materials) {
        for (std::size_t t = 0; t < meshes.size(); t += quick ? 2 : 1) {
            for (std::size_t p = 0; p < pixel_levels.size(); ++p) {
                scene.cells.push_back(make_cell(builder, meshes[t], of_class, pixel_levels[p], viewport));
            }
        }
    }
    make_town(builder, meshes, materials, scene);
    make_price_cells(builder, meshes, viewport, scene);
    scene.model = std::move(builder.model());
    scene.estimator = model::PixelEstimator(scene.model);
    count_pixels(scene, viewport);
    return scene;
}

TownView random_town_view(const CalibrationScene& scene, model::Viewport viewport, Random& random) {
    TownView view;
    const Box& box = scene.town_box;
    view.pose.position = any_in(random, {box.min.x, 1.0, box.min.z}, {box.max.x, 12.0, box.max.z});
    const double pitch = random.range(-0.3, 0.2), heading = random.range(0, 2 * std::numbers::pi);
    view.pose.orientation = glm::angleAxis(heading, dvec3(0, 1, 0)) * glm::angleAxis(pitch, dvec3(1, 0, 0));
    const double reach = 25.0 * std::pow(16.0, random.unit());
    const auto detail = static_cast<double>(random.below(5));
    // Some frames of one class only: what a scene without the others looks like.
    const bool pure = random.unit() < 0.4;
    const model::EffectMask only = scene.town[random.below(static_cast<std::uint32_t>(scene.town.size()))].effects;
    const model::Frustum frustum = model::make_frustum(view.pose, viewport, 4 * town_side_m);
    for (const TownObject& object : scene.town) {
        if (pure && object.effects != only) continue;
        const model::Node& node = scene.model.nodes[object.node];
        const double distance = node.box.distance(view.pose.position);
        if (distance > reach || !model::visible(frustum, node.box)) continue;
        const double level = detail + 1.0 - std::log2(1.0 + distance / 25.0);
        const auto chosen = static_cast<std::uint32_t>(std::clamp(level, 0.0, static_cast<double>(object.levels - 1)));
        view.items.push_back({object.node, object.first_rep + chosen});
    }
    return view;
}

}  // namespace surefoot::measure
