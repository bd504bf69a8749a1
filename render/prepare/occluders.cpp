// Finds occluders: one pass over the leaves' full detail that keeps the largest, then corners and edges that they share.
#include "render/prepare/occluders.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "render/model/effects_below.hpp"

namespace surefoot::prepare {

namespace {

struct Found {
    std::array<dvec3, 3> at;
    double area_m2 = 0;
    std::uint64_t order = 0;
    bool two_sided = false;
};

bool larger(const Found& a, const Found& b) { return a.area_m2 != b.area_m2 ? a.area_m2 > b.area_m2 : a.order < b.order; }

/// Keeps the largest in a heap whose top is the least of them.
class Largest {
public:
    explicit Largest(std::size_t max_occluders) : max_(max_occluders) { heap_.reserve(max_occluders); }
    void offer(const Found& found) {
        if (heap_.size() == max_) {
            if (max_ == 0 || !larger(found, heap_.front())) return;
            std::pop_heap(heap_.begin(), heap_.end(), larger);
            heap_.back() = found;
        } else {
            heap_.push_back(found);
        }
        std::push_heap(heap_.begin(), heap_.end(), larger);
    }
    std::vector<Found> take() {
        std::sort(heap_.begin(), heap_.end(), larger);
        return std::move(heap_);
    }

private:
    std::size_t max_;
    std::vector<Found> heap_;
};

void offer_leaf(const model::Model& model, const model::Representation& rep, std::uint64_t& order, Largest& largest) {
    const model::Placement& placement = model.placements[rep.placement];
    const bool mirrored = glm::determinant(placement.linear) < 0;
    const dmat3 linear(placement.linear);
    model::for_triangles(model, rep, [&](const model::Material& material, const vec3& a, const vec3& b, const vec3& c) {
        if (material.alpha != model::AlphaMode::opaque) return;
        Found found;
        found.at = {placement.origin + linear * dvec3(a), placement.origin + linear * dvec3(b),
                    placement.origin + linear * dvec3(c)};
        if (mirrored) std::swap(found.at[1], found.at[2]);
        found.area_m2 = 0.5 * glm::length(glm::cross(found.at[1] - found.at[0], found.at[2] - found.at[0]));
        found.order = order++;
        found.two_sided = material.two_sided;
        if (found.area_m2 > 0 && std::isfinite(found.area_m2)) largest.offer(found);
    });
}

/// Gives corners in the same cell of a fine grid the same number. Corners on both sides of a cell's border are not joined. Then
/// less is hidden than possible, which is safe.
class Corners {
public:
    Corners(double cell_m, std::vector<dvec3>& corners) : cell_m_(cell_m), corners_(corners) {}
    std::uint32_t number(const dvec3& at) {
        const dvec3 cell = glm::floor(at / cell_m_ + 0.37);  // round figures are common: none shall lie on a border
        const auto [entry, fresh] = numbers_.try_emplace({cell.x, cell.y, cell.z}, static_cast<std::uint32_t>(corners_.size()));
        if (fresh) corners_.push_back(at);
        return entry->second;
    }

private:
    double cell_m_;
    std::vector<dvec3>& corners_;
    std::map<std::tuple<double, double, double>, std::uint32_t> numbers_;
};

}  // namespace

Occluders find_occluders(const model::Model& model, std::uint32_t max_occluders) {
    Occluders out;
    if (model.nodes.empty()) return out;
    out.has_rooms = model::has_rooms_apart(model);
    Largest largest(max_occluders);
    std::uint64_t order = 0;
    for (const model::Node& node : model.nodes) {
        if (node.child_count > 0) continue;
        const model::Representation& finest = model.reps[node.first_rep + node.rep_count - 1];
        if (model.placements[finest.placement].motion != model::none) continue;  // it may be gone in the next frame
        if (finest.kind == model::RepKind::mesh) offer_leaf(model, finest, order, largest);
    }
    // In a small model a tenth of a millimetre may be a gap that one looks through.
    const double cell_m = std::min(1e-4, std::max(1e-12, model.nodes[0].box.diagonal() * 0x1p-20));
    Corners corners(cell_m, out.corners);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> edges;
    for (const Found& found : largest.take()) {
        Occluder o;
        for (std::size_t k = 0; k < 3; ++k) o.corners[k] = corners.number(found.at[k]);
        if (o.corners[0] == o.corners[1] || o.corners[1] == o.corners[2] || o.corners[2] == o.corners[0]) continue;
        for (std::size_t k = 0; k < 3; ++k) {
            const auto ends = std::minmax(o.corners[k], o.corners[(k + 1) % 3]);
            o.edges[k] = edges.try_emplace({ends.first, ends.second}, static_cast<std::uint32_t>(edges.size())).first->second;
        }
        o.normal = glm::normalize(glm::cross(found.at[1] - found.at[0], found.at[2] - found.at[0]));
        o.offset = glm::dot(o.normal, found.at[0]);
        o.centre = (found.at[0] + found.at[1] + found.at[2]) / 3.0;
        for (const dvec3& at : found.at) o.radius_m = std::max(o.radius_m, glm::length(at - o.centre));
        o.area_m2 = found.area_m2;
        o.two_sided = found.two_sided;
        out.triangles.push_back(o);
    }
    out.edge_count = static_cast<std::uint32_t>(edges.size());
    return out;
}

}  // namespace surefoot::prepare
