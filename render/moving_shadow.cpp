// Planning and judging the shadow map (moving_shadow.hpp).
#include "render/moving_shadow.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot {

namespace {

using model::Index;

constexpr float min_sun = 0.02F;        // of the sun's light and of its height: below, nothing has a shadow that shows
constexpr double min_distance_m = 1;    // distances of pixels are no less
constexpr double min_height = 0.196;    // of the sun, for the length of shadows: five times the height, as the bake has it
constexpr float pass_ns_per_texel = 2;  // of an empty map, as on llvmpipe with two cores: nothing calibrates it
constexpr double rim_texels = 4;        // empty ones round the map: what is beyond them is in the sun

dvec3 box_corner(const Box& box, unsigned c) {
    return {(c & 1U) != 0 ? box.max.x : box.min.x, (c & 2U) != 0 ? box.max.y : box.min.y, (c & 4U) != 0 ? box.max.z : box.min.z};
}

bool shines(const model::Daylight& light) {
    return std::max({light.sun_light.r, light.sun_light.g, light.sun_light.b}) > min_sun && light.sun_direction.y > min_sun;
}

double sun_height(const ShadowScene& scene) { return std::max(static_cast<double>(scene.light.sun_direction.y), min_height); }

/// From what casts to the bottom of the world, along the light.
double followed_m(const ShadowScene& scene, const Box& box) {
    return std::max(0.0, box.max.y - scene.model.nodes[0].box.min.y) / sun_height(scene);
}

Box with_shadow(const ShadowScene& scene, const Box& box) {
    const dvec3 way = -dvec3(scene.light.sun_direction) * followed_m(scene, box);
    Box both = box;
    both.grow(box.min + way);
    both.grow(box.max + way);
    return both;
}

/// From the eye to the nearest of a box and all places that its shadow may fall on. The square of it is convex along the light.
double shadow_distance_m(const ShadowScene& scene, const dvec3& eye, const Box& box) {
    const dvec3 towards(scene.light.sun_direction);
    double from_m = 0, to_m = followed_m(scene, box);
    for (int i = 0; i < 16; ++i) {
        const double middle_m = 0.5 * (from_m + to_m);
        const dvec3 at = eye + towards * middle_m;
        (glm::dot(at - glm::clamp(at, box.min, box.max), towards) > 0 ? to_m : from_m) = middle_m;
    }
    return std::min(box.distance(eye + towards * from_m), box.distance(eye + towards * to_m));
}

double px_per_m(const ShadowEye& eye, double distance_m) {
    return 1 / (std::max(min_distance_m, distance_m) * model::pixel_angle(eye.pose, eye.viewport));
}

/// Of a box and its shadow, where that is nearest to the eye.
double px_per_m(const ShadowScene& scene, const ShadowEye& eye, const Box& box) {
    return px_per_m(eye, shadow_distance_m(scene, eye.pose.position, box));
}

/// How far a shadow goes with what casts it: on level ground or on what faces the sun, whichever is more. What the light only
/// grazes has longer ways, and hardly any light.
double shadow_way_m(const ShadowScene& scene, const dvec3& way) {
    const dvec3 towards(scene.light.sun_direction);
    const double down = way.y / sun_height(scene);
    return std::max(glm::length(dvec2(way.x - towards.x * down, way.z - towards.z * down)),
                    glm::length(way - towards * glm::dot(way, towards)));
}

}  // namespace

MovingShadow::MovingShadow(const model::Model& model, const ShadowLimits& limits) : limits_(limits) {
    if (model.motions.empty() || (model.called_for() & model::effect_moving_shadow) == 0) return;
    casts_.reserve(model.reps.size());
    for (const model::Representation& rep : model.reps) casts_.push_back(model::casting_of(model, rep) == model::Casting::casts);
    std::vector<bool> leaf_casts(model.nodes.size(), false);            // its own one, or one below that moves as it does
    for (Index n = static_cast<Index>(model.nodes.size()); n-- > 0;) {  // parents come before their children
        const model::Node& node = model.nodes[n];
        const Index motion = model::motion_of(model, node);
        if (motion == model::none) continue;
        if (node.child_count == 0) leaf_casts[n] = casts_[node.first_rep + node.rep_count - 1];
        if (!leaf_casts[n]) continue;
        const bool follows = node.parent != model::none && model::motion_of(model, model.nodes[node.parent]) == motion;
        if (follows)
            leaf_casts[node.parent] = true;
        else
            roots_.push_back(n);
    }
    std::reverse(roots_.begin(), roots_.end());
    near_.reserve(std::min(roots_.size(), limits_.poses) + limits_.poses / 2);
    planned_.reserve(limits_.casters);
    drawn_.resize(limits_.casters);
    items_.reserve(limits_.items);
}

/// Largest on the picture first; ids break ties. A pose is worked out only for what may be in reach at some time.
void MovingShadow::find_near(const ShadowScene& scene, const ShadowEye& eye) {
    const model::Frustum frustum =
        model::make_frustum(eye.pose, eye.viewport, model::far_corners_m(scene.model.nodes[0].box), eye.radius_m, eye.angle_rad);
    const auto may_reach = [&](const Box& box) {
        const Box with = with_shadow(scene, box);
        return box.diagonal() * px_per_m(eye, with.distance(eye.pose.position)) >= min_size_px && model::visible(frustum, with);
    };
    const auto size_px = [&](const Box& box) {
        const double px = may_reach(box) ? box.diagonal() * px_per_m(scene, eye, box) : 0.0;
        return px >= min_size_px ? px : 0.0;
    };
    near_.resize(roots_.size() <= limits_.poses ? 0 : std::min(near_.size(), limits_.poses / 2));
    std::size_t poses = near_.size();
    for (Near& one : near_) one.size_px = size_px(scene.moving.box(one.node, scene.poses));
    const std::size_t boxes = std::min(roots_.size(), limits_.boxes);
    for (std::size_t i = 0; i < boxes && poses < limits_.poses; ++i) {
        const Index n = roots_[next_root_];
        next_root_ = next_root_ + 1 < roots_.size() ? next_root_ + 1 : 0;
        if (!may_reach(scene.model.nodes[n].box)) continue;
        near_.push_back({n, size_px(scene.moving.box(n, scene.poses))});
        ++poses;
    }
    std::erase_if(near_, [](const Near& one) { return !(one.size_px > 0); });
    std::sort(near_.begin(), near_.end(),
              [](const Near& a, const Near& b) { return a.size_px != b.size_px ? a.size_px > b.size_px : a.node < b.node; });
    const auto same = [](const Near& a, const Near& b) { return a.node == b.node; };
    near_.erase(std::unique(near_.begin(), near_.end(), same), near_.end());
}

bool MovingShadow::plan(const ShadowScene& scene, const ShadowEye& eye) {
    items_.clear();
    visits_ = 0;
    planned_.clear();
    if (!any() || !shines(scene.light)) return false;
    planned_towards_ = scene.light.sun_direction;
    find_near(scene, eye);
    if (near_.empty() || !fit(scene)) return false;
    std::size_t held = 0;
    while (held < planned_.size() && choose_forms(scene, planned_[held].node)) ++held;
    planned_.resize(held);
    return !items_.empty();
}

/// The smallest square that holds what casts. Its side grows by steps and its middle goes by whole texels, so that edges do not
/// crawl while things move a little.
bool MovingShadow::fit(const ShadowScene& scene) {
    const dvec3 z = glm::normalize(dvec3(scene.light.sun_direction));
    const dvec3 x = glm::normalize(glm::cross(std::abs(z.y) < 0.99 ? dvec3(0, 1, 0) : dvec3(1, 0, 0), z)), y = glm::cross(z, x);
    Box all;  // along x, y and z
    const auto half_of = [](const Box& box) { return std::max({box.half().x, box.half().y, 0.01}); };
    for (const Near& one : near_) {
        if (planned_.size() == limits_.casters) break;
        const std::optional<model::MovingNode> moving = scene.moving.find(one.node, scene.poses);
        if (!moving) continue;
        Box with = all;
        for (unsigned c = 0; c < 8; ++c) {
            const dvec3 at = moving->pose(box_corner(moving->rest, c));
            with.grow(dvec3(glm::dot(at, x), glm::dot(at, y), glm::dot(at, z)));
        }
        if (!planned_.empty() && 2 * half_of(with) / gl::shadow_map_px > max_texel_m) continue;
        all = with;
        planned_.push_back({one.node, moving->pose});
    }
    if (planned_.empty() || !std::isfinite(all.diagonal())) return false;
    constexpr double side = gl::shadow_map_px;
    constexpr double steps = 8;  // to twice the size
    const double half_m = std::exp2(std::ceil(steps * std::log2(half_of(all) * side / (side - 2 * rim_texels))) / steps);
    const double texel_m = 2 * half_m / side;
    dvec3 middle = all.centre();
    for (int i = 0; i < 2; ++i) middle[i] = texel_m * std::floor(middle[i] / texel_m + 0.5);
    const double depth_m = 1.2 * std::max(2 * all.half().z, 0.1);
    view_.origin = x * middle.x + y * middle.y + z * middle.z;
    const dmat3 turn = glm::transpose(dmat3(x / half_m, y / half_m, z / depth_m));
    view_.from_origin = mat4(mat3(turn));
    view_.from_origin[3] = vec4(0, 0, 0.55F, 1);  // what casts has depths from 0.13 to 0.97
    view_.towards = vec3(z);
    view_.texel_m = static_cast<float>(texel_m);
    view_.depth_m = static_cast<float>(depth_m);
    return true;
}

/// Of the forms that are off by a texel at most, the one with the fewest triangles: a coarser one may have more, where full
/// detail was cut to its masks. Of children, where the node has none and all of them fit. False: the map is full.
bool MovingShadow::choose_forms(const ShadowScene& scene, Index index) {
    if (items_.size() == limits_.items) return false;
    const model::Model& m = scene.model;
    const model::Node& node = m.nodes[index];
    Index best = model::none;
    for (Index r = node.first_rep; r < node.first_rep + node.rep_count; ++r) {
        if (m.reps[r].error_m > view_.texel_m || !casts_[r]) continue;
        if (best == model::none || m.reps[r].triangles < m.reps[best].triangles) best = r;
    }
    if (best != model::none) {
        items_.push_back({index, best});
        return true;
    }
    const Index motion = model::motion_of(m, node);
    const std::size_t first = items_.size();
    // Forms that were taken back were visited for nothing, so visits are bounded too.
    bool all = node.child_count > 0 && first + node.child_count <= limits_.items && visits_ + 1 < limits_.items;
    visits_ += all ? 1 : 0;
    for (Index c = node.first_child; all && c < node.first_child + node.child_count; ++c)
        all = model::motion_of(m, m.nodes[c]) != motion || choose_forms(scene, c);
    if (all) return true;
    items_.resize(first);
    const Index finest = node.first_rep + node.rep_count - 1;
    if (casts_[finest]) items_.push_back({index, finest});
    return true;
}

float MovingShadow::price_us(const model::Model& model, const model::CostModel& costs) const {
    constexpr auto texels = static_cast<float>(gl::shadow_map_px * gl::shadow_map_px);
    const vec3 along = glm::abs(view_.towards);
    model::ItemCost sum{costs.slice_us, 1e-3F * pass_ns_per_texel * texels};
    for (const gl::DrawItem& item : items_) {
        const model::Representation& rep = model.reps[item.rep];
        const bool holes = (rep.effects & model::effect_alpha_mask) != 0;
        const model::CostGrid& grid = costs.grid_for(holes ? model::effect_texture | model::effect_alpha_mask : 0);
        const float area_m2 = rep.area_m2[0] * along.x + rep.area_m2[1] * along.y + rep.area_m2[2] * along.z;
        sum += costs.item(static_cast<float>(rep.triangles), std::min(texels, area_m2 / (view_.texel_m * view_.texel_m)), grid);
    }
    return costs.combine.frame_us(sum.submit_us, sum.raster_us) - costs.combine.fixed_us;
}

/// By how far a thing's shadow in the drawn map is off on the picture, where it is nearest to the eye; all of its size where it
/// is not there.
double MovingShadow::off_px(const ShadowScene& scene, const ShadowEye& eye, Index node) const {
    const std::optional<model::MovingNode> moving = scene.moving.find(node, scene.poses);
    if (!moving) return 0;
    const Box box = moving->box();
    const double px = px_per_m(scene, eye, box);
    const auto end = drawn_.begin() + static_cast<std::ptrdiff_t>(drawn_count_);
    const auto found = std::find_if(drawn_.begin(), end, [&](const Cast& cast) { return cast.node == node; });
    if (found == end) return box.diagonal() * px;
    double way_m = 0;
    for (unsigned c = 0; c < 8; ++c) {
        const dvec3 at = box_corner(moving->rest, c);
        way_m = std::max(way_m, shadow_way_m(scene, moving->pose(at) - found->pose(at)));
    }
    // The shadow turns with the sun about what casts it.
    const double turned = static_cast<double>(glm::length(scene.light.sun_direction - drawn_towards_));
    return (way_m + turned * followed_m(scene, box) / sun_height(scene)) * px;
}

bool MovingShadow::recent(const ShadowScene& scene, double worst_px) const {
    constexpr double still_px = 1e-3;
    return worst_px <= still_px || (worst_px <= max_off_px && std::abs(scene.time_s - drawn_s_) <= max_age_s);
}

float MovingShadow::value(const ShadowScene& scene, const ShadowEye& eye) const {
    constexpr float albedo = 0.5F, of_missing = 1.0F / 6;  // typical of lit surfaces; of a missing thing, as BlurLoss has it
    const vec3 sun = albedo * scene.light.sun_light * scene.light.sun_direction.y;
    const float share = std::min(1.0F, glm::dot(sun, sun) / 3.0F / of_missing);
    const bool shown = usable(scene, eye);
    const double picture_px = 1.0 * eye.viewport.width * eye.viewport.height;
    double pixels = 0;
    for (const Cast& cast : planned_) {
        const Box box = scene.moving.box(cast.node, scene.poses);
        const double wide_px = box.diagonal() * px_per_m(scene, eye, box);
        const double all_px = std::min(0.5 * wide_px * wide_px, picture_px);
        const double changed_px = shown ? std::min(all_px, 2 * wide_px * off_px(scene, eye, cast.node)) : all_px;
        pixels += changed_px * static_cast<double>(scene.model.nodes[cast.node].importance);
    }
    return static_cast<float>(pixels) * share;
}

void MovingShadow::drawn(double time_s) {
    std::copy(planned_.begin(), planned_.end(), drawn_.begin());
    drawn_count_ = planned_.size();
    drawn_towards_ = planned_towards_;
    drawn_s_ = time_s;
}

/// By what is in the drawn map: what came near since lacks its shadow for a while, and hides no other.
bool MovingShadow::usable(const ShadowScene& scene, const ShadowEye& eye) const {
    if (drawn_count_ == 0 || !shines(scene.light)) return false;
    double worst_px = 0;
    for (std::size_t i = 0; i < drawn_count_; ++i) worst_px = std::max(worst_px, off_px(scene, eye, drawn_[i].node));
    return recent(scene, worst_px);
}

}  // namespace surefoot
