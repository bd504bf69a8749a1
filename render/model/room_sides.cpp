// Half-spaces by the normals of vertices (room_sides.hpp).
#include "render/model/room_sides.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace surefoot::model {

namespace {

constexpr std::size_t max_half_spaces = 8;  // the walls, floor and ceiling of a room; round things have more, and keep the sun
constexpr float margin = 127 * 1e-4F;       // of an eye in the plane of a wall, rounding decides
constexpr std::uint8_t all_hidden = 255;

vec3 position_of(const Vertex& v) { return {v.position[0], v.position[1], v.position[2]}; }

}  // namespace

RoomSides::RoomSides(const Model& model) {
    constexpr EffectMask needed = effect_sun | effect_openness, unlike = effect_lit_picture | effect_light_by_pixel;
    runs_.assign(model.parts.size(), {});
    bool any = false;
    for (Index p = 0; p < model.parts.size(); ++p) {
        const EffectMask effects = model.materials[model.parts[p].material].effects;
        if ((effects & needed) != needed || (effects & unlike) != 0) continue;
        const auto first = static_cast<std::uint32_t>(half_spaces_.size());
        if (add(model, model.parts[p])) {
            runs_[p] = {first, static_cast<std::uint32_t>(half_spaces_.size()) - first};
            any = true;
        } else {
            half_spaces_.resize(first);
        }
    }
    if (!any) runs_.clear();
}

/// False: no eye sees only closed sides, or too many half-spaces would say which.
bool RoomSides::add(const Model& model, const Part& part) {
    return part.index_count > 0 && (model.materials[part.material].two_sided ? add_sides(model, part) : add_fronts(model, part));
}

bool RoomSides::add_sides(const Model& model, const Part& part) {
    const std::size_t first = half_spaces_.size();
    for (std::uint32_t i = 0; i < part.index_count; ++i) {
        const Vertex& v = model.vertices[part.first_vertex + model.indices[part.first_index + i]];
        const vec3 normal(v.normal[0], v.normal[1], v.normal[2]);
        const bool front = v.hidden[0] == all_hidden;
        const bool has_back = normal != vec3(0.0F), back = v.hidden[1] == all_hidden;
        if (front && (!has_back || back)) continue;
        if (!front && (!has_back || !back)) return false;
        const vec3 to = front ? normal : -normal;
        if (!add_half_space(first, to, glm::dot(to, position_of(v)))) return false;
    }
    return true;
}

/// A triangle that sees sky must turn its back to the eye, which the device does not draw. Where all vertices see sky, nothing is
/// added: the whole part would have to.
bool RoomSides::add_fronts(const Model& model, const Part& part) {
    const std::size_t first = half_spaces_.size();
    bool any_closed = false;
    for (std::uint32_t i = 0; i + 2 < part.index_count; i += 3) {
        bool all_closed = true;
        std::array<vec3, 3> corner;
        for (std::uint32_t k = 0; k < 3; ++k) {
            const Vertex& v = model.vertices[part.first_vertex + model.indices[part.first_index + i + k]];
            corner[k] = position_of(v);
            const bool closed = v.hidden[0] == all_hidden;
            any_closed = any_closed || closed;
            all_closed = all_closed && closed;
        }
        if (all_closed) continue;
        const dvec3 normal = glm::cross(dvec3(corner[1]) - dvec3(corner[0]), dvec3(corner[2]) - dvec3(corner[0]));
        const double length = std::sqrt(glm::dot(normal, normal));
        if (!(length > 0)) return false;
        const vec3 to(-127.0 * (normal / length));
        float above = glm::dot(to, corner[0]);
        for (const vec3& at : corner) above = std::max(above, glm::dot(to, at));
        if (!add_half_space(first, to, above)) return false;
    }
    return any_closed;
}

/// above: without the margin. False: there are too many.
bool RoomSides::add_half_space(std::size_t first, const vec3& normal, float above) {
    above += margin;
    const auto same = std::find_if(half_spaces_.begin() + static_cast<std::ptrdiff_t>(first), half_spaces_.end(),
                                   [&](const HalfSpace& h) { return h.normal == normal; });
    if (same != half_spaces_.end())
        same->above = std::max(same->above, above);
    else if (half_spaces_.size() - first < max_half_spaces)
        half_spaces_.push_back({normal, above});
    else
        return false;
    return true;
}

bool RoomSides::shows_no_sky(Index part, const vec3& eye) const {
    if (!any(part)) return false;
    const Run run = runs_[part];
    for (std::uint32_t i = run.first; i < run.first + run.count; ++i)
        if (!(glm::dot(half_spaces_[i].normal, eye) > half_spaces_[i].above)) return false;
    return true;
}

vec3 eye_in_frame(const dvec3& origin, const mat3& linear, const dvec3& eye) {
    return vec3(glm::inverse(dmat3(linear)) * (eye - origin));
}

}  // namespace surefoot::model
