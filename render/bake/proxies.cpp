// A cluster's mesh, valid from everywhere, and boxes: merged from the actual objects.
#include "render/bake/proxies.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::bake {

const Level& level_within(const LodChain& chain, std::uint32_t most) {
    const Level* best = &chain.levels.front();
    for (const Level& level : chain.levels) {
        if (level.triangles <= most) best = &level;
    }
    return *best;
}

namespace {

/// Appends a level of an object in the world frame relative to `centre`, in baked colours or in its own materials.
void append(Geometry& to, const LodChain& chain, const Level& level, const dmat4& world, model::Index proxy_material) {
    const dmat3 linear(world);
    // Normals by the cofactors: right under shear and mirroring, and no inverse of what may be singular.
    const dmat3 cofactor(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]), glm::cross(linear[0], linear[1]));
    const bool mirrored = glm::dot(linear[0], cofactor[0]) < 0;
    std::vector<std::uint32_t> map(chain.full.vertices.size(), model::none);
    for (const GeometryPart& part : level.parts) {
        const model::Index material = proxy_material != model::none ? proxy_material : part.material;
        auto same = std::find_if(to.parts.begin(), to.parts.end(), [&](const GeometryPart& q) { return q.material == material; });
        if (same == to.parts.end()) {
            to.parts.push_back({material, {}});
            same = to.parts.end() - 1;
        }
        for (std::size_t i = 0; i < part.indices.size(); ++i) {
            const std::size_t corner = mirrored ? i - i % 3 + (3 - i % 3) % 3 : i;
            const std::uint32_t index = part.indices[corner];
            if (map[index] == model::none) {
                map[index] = static_cast<std::uint32_t>(to.vertices.size());
                model::Vertex v = chain.full.vertices[index];
                const dvec3 p = dvec3(world * dvec4(chain.full.centre + dvec3(position_of(v)), 1.0)) - to.centre;
                dvec3 n = cofactor * dvec3(v.normal[0], v.normal[1], v.normal[2]) * (mirrored ? -1.0 : 1.0);
                const double length = glm::length(n);
                n = length > 0 ? n / length : dvec3(0, 1, 0);
                for (int k = 0; k < 3; ++k) {
                    v.position[k] = static_cast<float>(p[k]);
                    v.normal[k] = static_cast<std::int8_t>(std::lround(127.0 * n[k]));
                }
                if (proxy_material != model::none) std::copy_n(chain.full.baked[index].begin(), 4, v.colour);
                to.vertices.push_back(v);
                to.baked.push_back(chain.full.baked[index]);
            }
            same->indices.push_back(map[index]);
        }
    }
}

std::vector<ColouredTriangle> coloured(const Geometry& g) {
    std::vector<ColouredTriangle> out;
    for (const GeometryPart& part : g.parts) {
        for (std::size_t i = 0; i + 2 < part.indices.size(); i += 3) {
            ColouredTriangle t;
            for (std::size_t k = 0; k < 3; ++k) {
                t.corners[k] = position_of(g.vertices[part.indices[i + k]]);
                t.colours[k] = g.baked[part.indices[i + k]];
            }
            out.push_back(t);
        }
    }
    return out;
}

/// Captured from merged geometry whose frame is centred on the box. The error: what a captured point moves when it is put
/// on the face (its depth), or what is captured on no face at all stays behind (half the box, then), plus a texel.
BoxForm make_box(const Geometry& merged, const Box& box, std::uint32_t pixels, bool textured, float input_error_m) {
    BoxForm form;
    form.box = box;
    form.pixels = pixels;
    form.textured = textured;
    const vec3 half(glm::max(box.half(), dvec3(1e-4)));
    form.faces = capture_faces(coloured(merged), half, pixels);
    float depth = 0;
    for (const FaceCapture& face : form.faces) depth = std::max(depth, face.depth_m);
    const float longest = 2 * std::max({half.x, half.y, half.z});
    // A point hidden behind others lies at most half the shortest way from some face.
    form.error_m = std::max(depth, std::min({half.x, half.y, half.z})) + longest / static_cast<float>(pixels) + input_error_m;
    return form;
}

Geometry merge(const ProxyInput& input, const dvec3& centre, std::span<const std::uint32_t> members, float& error_m) {
    Geometry merged;
    merged.centre = centre;
    std::uint64_t full = 0;
    for (const std::uint32_t m : members) full += input.forms[input.objects[m].mesh].triangles;
    error_m = 0;
    for (const std::uint32_t m : members) {
        const PlacedObject& object = input.objects[m];
        const MeshForm& form = input.forms[object.mesh];
        // Each object gets its share of the input by its size.
        const double share = static_cast<double>(form.triangles) / static_cast<double>(std::max<std::uint64_t>(1, full));
        const auto most = static_cast<std::uint32_t>(std::max(24.0, share * input.most_input));
        const Level& level = level_within(form.chain, most);
        append(merged, form.chain, level, object.world, input.proxy_material);
        error_m = std::max(error_m, static_cast<float>(level.error_m * largest_stretch(dmat3(object.world))));
    }
    return merged;
}

}  // namespace

ClusterForm make_cluster(const ProxyInput& input, const Box& box, std::span<const std::uint32_t> members, std::uint32_t children_coarsest) {
    ClusterForm out;
    float input_error = 0;
    Geometry merged = merge(input, box.centre(), members, input_error);
    out.box = make_box(merged, box, members.size() > 64 ? 32 : 24, input.textured_boxes, input_error);
    const std::uint32_t finest = std::max(24U, children_coarsest / 2);
    ChainOptions options = input.chain;
    options.proxy_material = input.proxy_material;
    options.proxy_below = 0;  // it is in baked colours already
    options.smallest = std::clamp(finest / 3, 16U, 64U);
    options.first_share = static_cast<double>(finest) / static_cast<double>(std::max<std::size_t>(1, merged.triangles()));
    out.chain = make_chain(std::move(merged), options);
    auto& levels = out.chain.levels;
    while (levels.size() > 1 && (levels.back().triangles > finest || levels.back().error_m == 0)) levels.pop_back();
    for (Level& level : levels) level.error_m += input_error;
    out.has_box = out.box.error_m > levels.front().error_m && levels.front().triangles > 12;
    return out;
}

BoxForm make_object_box(const ProxyInput& input, const PlacedObject& object, std::uint32_t pixels) {
    float input_error = 0;
    const std::uint32_t self = static_cast<std::uint32_t>(&object - input.objects.data());
    const Geometry merged = merge(input, object.box.centre(), std::span(&self, 1), input_error);
    return make_box(merged, object.box, pixels, input.textured_boxes, input_error);
}

}  // namespace surefoot::bake
