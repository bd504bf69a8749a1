// Drawing for rows (picture.hpp).
#include "tools/selftest/picture.hpp"

#include <cmath>

#include "render/effects/effects.hpp"
#include "render/gl/backends.hpp"
#include "render/model/flat_root.hpp"
#include "render/model/pixels.hpp"

namespace surefoot::selftest {

std::unique_ptr<gl::Device> open_picture(model::Viewport viewport, const Effort& effort, Outcome& outcome) {
    gl::DeviceOptions options;
    options.viewport = viewport;
    options.max_items = 1U << 14U;
    options.sky = {0, 0, 1};
    std::vector<gl::BackendKind> kinds{gl::BackendKind::egl, gl::BackendKind::osmesa};
    if (!effort.backend.empty()) {
        const auto backend = gl::backend_named(effort.backend);
        if (!backend) {
            outcome.not_run = backend.error().text();
            return nullptr;
        }
        kinds = {(*backend)->kind};
    }
    for (const gl::BackendKind kind : kinds) {
        options.kind = kind;
        auto device = gl::open_device(options);
        if (device) {
            outcome.not_run.clear();
            return std::move(*device);
        }
        outcome.not_run = device.error().text();
    }
    return nullptr;
}

bool load(gl::Device& device, const model::Model& model, Outcome& outcome) {
    device.draws.plays();
    const auto loaded = device.load(model, effects::assemble_program);
    if (!loaded) outcome.none_of("models that the device refuses (" + loaded.error().text() + ")", 1);
    return loaded.ok();
}

gl::PixelImage draw(gl::Device& device, std::span<const gl::DrawItem> items, const Pose& pose) {
    device.draws.plays();
    device.begin_frame(pose);
    for (const gl::DrawItem& item : items) {
        device.draw({&item, 1});
        device.end_slice();
    }
    device.end_items();
    device.finish_frame();
    auto image = device.read_pixels();
    return image ? std::move(*image) : gl::PixelImage{};
}

std::vector<gl::DrawItem> finest_of(const model::Model& model) {
    std::vector<gl::DrawItem> items;
    for (model::Index n = 0; n < model.nodes.size(); ++n) {
        const model::Node& node = model.nodes[n];
        if (node.child_count == 0) items.push_back({n, node.first_rep + node.rep_count - 1});
    }
    return items;
}

Squares::Squares() {
    model_.names = std::string(1, '\0');
    model_.nodes.emplace_back();
    model_.placements.emplace_back();
    model_.sun_direction = glm::normalize(dvec3(0.36, 0.80, 0.48));
}

model::Index Squares::add(const dvec3& origin, const vec3& along, const vec3& up, std::array<float, 3> colour,
                          const mat3& linear) {
    model::Model& m = model_;
    model::Material material;
    material.colour = {colour[0], colour[1], colour[2], 1};
    material.two_sided = true;
    m.materials.push_back(material);
    model::Part part;
    part.material = static_cast<model::Index>(m.materials.size() - 1);
    part.first_index = static_cast<std::uint32_t>(m.indices.size());
    part.first_vertex = static_cast<std::uint32_t>(m.vertices.size());
    part.index_count = 6;
    part.vertex_count = 4;
    model::Node node;
    for (const vec3& at : {vec3(0), along, along + up, up}) {
        model::Vertex v{};
        for (int axis = 0; axis < 3; ++axis) v.position[axis] = at[axis];
        for (auto& byte : v.colour) byte = 255;
        v.normal[2] = 127;
        m.vertices.push_back(v);
        node.box.grow(origin + dvec3(linear * at));
    }
    m.indices.insert(m.indices.end(), {0, 1, 2, 0, 2, 3});
    m.parts.push_back(part);
    model::Placement placement;
    placement.origin = origin;
    placement.linear = linear;
    m.placements.push_back(placement);
    model::Representation rep;
    rep.placement = static_cast<model::Index>(m.placements.size() - 1);
    rep.first_part = static_cast<model::Index>(m.parts.size() - 1);
    rep.part_count = 1;
    rep.triangles = 2;
    rep.area_m2 = model::rasterised_area(m, rep);
    m.reps.push_back(rep);
    node.parent = 0;
    node.first_rep = static_cast<model::Index>(m.reps.size() - 1);
    node.rep_count = 1;
    node.triangles = 2;
    node.object = static_cast<model::Index>(m.nodes.size() - 1);
    node.kind = model::NodeKind::object;
    m.nodes.push_back(node);
    return static_cast<model::Index>(m.nodes.size() - 1);
}

model::Model Squares::finish() {
    model::make_flat_root(model_);
    return model_;
}

bool is_colour(const gl::PixelImage& image, std::uint32_t x, std::uint32_t y, std::array<std::uint8_t, 3> colour) {
    const std::size_t at = 4 * (static_cast<std::size_t>(y) * image.width + x);
    if (at + 3 >= image.rgba.size()) return false;
    return image.rgba[at] == colour[0] && image.rgba[at + 1] == colour[1] && image.rgba[at + 2] == colour[2];
}

}  // namespace surefoot::selftest
