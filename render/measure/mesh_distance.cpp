// Branch and bound of the distance between meshes (mesh_distance.hpp).
#include "render/measure/mesh_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/measure/triangle_coverage.hpp"
#include "rt/base/random.hpp"

namespace surefoot::measure {

namespace {

constexpr std::uint32_t no_triangle = 0xffffffffU;
constexpr std::size_t max_covering = 80;  ///< more triangles than this near a piece: cut it first

/// A corner of a (part of a) triangle, with the nearest triangle of the other mesh once that was asked for.
struct Corner {
    vec3 position;
    TriangleTree::Hit hit;
};

/// A triangle or a cut piece of one.
struct Piece {
    std::array<Corner, 3> corners;
    float upper = 0;
    std::uint32_t witness = no_triangle;  ///< the triangle of the other mesh that upper is owed to, where it is one
    bool covered = false;                 ///< covering was tried
};

/// Worst piece first; ties by number, which is the order of making.
struct Entry {
    float upper;
    std::uint32_t piece;
    bool operator<(const Entry& other) const { return upper < other.upper || (upper == other.upper && piece > other.piece); }
};

class BranchAndBound {
public:
    BranchAndBound(const MeshView& from, const TriangleTree& to, const DistanceLimits& limits, std::span<const float> initial)
        : from_(from), to_(to), limits_(limits), lower_(limits.known_lower), hits_(from.positions.size()) {
        margin_ = 1e-6 * to.diagonal();
        queries_left_ = limits.max_queries != 0 ? limits.max_queries : 20000 + from.triangles() / 4;
        if (initial.empty()) {
            query_all_corners();
        } else {
            for (std::uint32_t t = 0; t < from.triangles(); ++t) queue_.push_back({initial[t], t});
            unknown_ = from.triangles();
        }
        std::make_heap(queue_.begin(), queue_.end());
    }

    DistanceBounds run() {
        while (!queue_.empty() && queue_.front().upper > enough() && queries_left_ > 0) {
            std::pop_heap(queue_.begin(), queue_.end());
            const Entry worst = queue_.back();
            queue_.pop_back();
            if (worst.piece < unknown_) {
                look_at(worst);
            } else if (!pieces_[worst.piece - unknown_].covered) {
                coverage(worst);
            } else {
                cut(worst.piece);
            }
        }
        float upper = std::max(resolved_, reached_);
        if (!queue_.empty()) upper = std::max(upper, queue_.front().upper);
        return {reached_, upper};
    }

private:
    [[nodiscard]] float enough() const { return std::max(lower_ * (1.0F + limits_.relative), limits_.absolute); }

    void found(float distance) {
        reached_ = std::max(reached_, distance);
        lower_ = std::max(lower_, distance);
    }

    const TriangleTree::Hit& query(std::uint32_t vertex) {
        TriangleTree::Hit& hit = hits_[vertex];
        if (hit.triangle == no_triangle) {
            hit = to_.nearest(from_.positions[vertex], last_hit_);
            last_hit_ = hit.triangle;
            found(hit.distance);
            queries_left_ -= queries_left_ > 0 ? 1 : 0;
        }
        return hit;
    }

    Piece triangle(std::uint32_t t) {
        Piece piece;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t vertex = from_.indices[3 * t + k];
            piece.corners[k] = {from_.positions[vertex], query(vertex)};
        }
        return piece;
    }

    // All corners first: the largest corner distance then rules most triangles out before any is kept.
    void query_all_corners() {
        queries_left_ += from_.indices.size();
        for (const std::uint32_t vertex : from_.indices) query(vertex);
        for (std::uint32_t t = 0; t < from_.triangles(); ++t) {
            Piece piece = triangle(t);
            piece.upper = std::numeric_limits<float>::infinity();
            bound(piece);
            keep(piece, false);
        }
    }

    /// Lowers the piece's bound: no point of it is farther from `triangle` than its farthest corner.
    void try_witness(Piece& piece, std::uint32_t triangle) const {
        if (triangle == no_triangle) return;
        float worst = 0;
        for (const Corner& corner : piece.corners) {
            const float at_least =
                corner.hit.triangle == triangle ? corner.hit.distance : to_.distance_to(triangle, corner.position);
            worst = std::max(worst, at_least);
            if (worst >= piece.upper) return;
        }
        piece.upper = worst;
        piece.witness = triangle;
    }

    /// Also by the corners: a corner's distance, and the way from there.
    void bound(Piece& piece) const {
        const auto& c = piece.corners;
        try_witness(piece, piece.witness);
        for (std::size_t i = 0; i < 3; ++i) {
            const float way = std::max(glm::length(c[i].position - c[(i + 1) % 3].position),
                                       glm::length(c[i].position - c[(i + 2) % 3].position));
            piece.upper = std::min(piece.upper, c[i].hit.distance + way);
            if (i == 0 || c[i].hit.triangle != c[i - 1].hit.triangle) try_witness(piece, c[i].hit.triangle);
        }
    }

    void keep(const Piece& piece, bool heap) {
        if (piece.upper <= enough()) {
            resolved_ = std::max(resolved_, piece.upper);
            return;
        }
        queue_.push_back({piece.upper, static_cast<std::uint32_t>(unknown_ + pieces_.size())});
        pieces_.push_back(piece);
        if (heap) std::push_heap(queue_.begin(), queue_.end());
    }

    void look_at(const Entry& entry) {
        Piece piece = triangle(entry.piece);
        piece.upper = entry.upper;
        bound(piece);
        keep(piece, true);
    }

    // Several triangles together: rules the piece out, or finds a point of it that none of them is near.
    void coverage(const Entry& entry) {
        Piece& piece = pieces_[entry.piece - unknown_];
        piece.covered = true;
        const auto& c = piece.corners;
        const double within = enough();
        const vec3 reach(static_cast<float>(within));
        const vec3 low = glm::min(glm::min(c[0].position, c[1].position), c[2].position) - reach;
        const vec3 high = glm::max(glm::max(c[0].position, c[1].position), c[2].position) + reach;
        std::size_t near = 0;
        to_.each_in(low, high, [&](const vec3&, const vec3&, const vec3&) { return ++near <= max_covering; });
        if (near > max_covering) {
            cut(entry.piece);
            return;
        }
        TriangleCoverage coverage(c[0].position, c[1].position, c[2].position, margin_);
        to_.each_in(low, high, [&](const vec3& p, const vec3& q, const vec3& r) {
            return coverage.subtract(p, q, r, within) && !coverage.done();
        });
        queries_left_ -= queries_left_ > 0 ? 1 : 0;
        if (coverage.done()) {
            resolved_ = std::max(resolved_, static_cast<float>(coverage.reach() + margin_));
            return;
        }
        const TriangleTree::Hit hit = to_.nearest(coverage.uncovered(), piece.witness);
        found(hit.distance);
        try_witness(piece, hit.triangle);
        if (piece.upper <= enough()) {
            resolved_ = std::max(resolved_, piece.upper);
            return;
        }
        queue_.push_back({piece.upper, entry.piece});
        std::push_heap(queue_.begin(), queue_.end());
    }

    void cut(std::uint32_t number) {
        const Piece piece = pieces_[number - unknown_];
        std::size_t longest = 0;
        float length = -1;
        for (std::size_t i = 0; i < 3; ++i) {
            const float edge = glm::length(piece.corners[i].position - piece.corners[(i + 1) % 3].position);
            if (edge > length) {
                length = edge;
                longest = i;
            }
        }
        const Corner &a = piece.corners[longest], &b = piece.corners[(longest + 1) % 3], &c = piece.corners[(longest + 2) % 3];
        Corner middle{0.5F * (a.position + b.position), {}};
        middle.hit = to_.nearest(middle.position, a.hit.triangle);
        found(middle.hit.distance);
        queries_left_ -= queries_left_ > 0 ? 1 : 0;
        for (const auto& corners : {std::array{a, middle, c}, std::array{middle, b, c}}) {
            Piece half{corners, piece.upper, piece.witness};
            bound(half);
            keep(half, true);
        }
    }

    const MeshView& from_;
    const TriangleTree& to_;
    DistanceLimits limits_;
    float lower_;         ///< known_lower included
    float reached_ = 0;   ///< by a point of this mesh
    float resolved_ = 0;  ///< largest bound of what was ruled out
    double margin_ = 0;   ///< slivers narrower than this are not looked at; added to what they bound
    std::size_t queries_left_ = 0;
    std::size_t unknown_ = 0;  ///< queue numbers below it are triangles not looked at yet
    std::uint32_t last_hit_ = no_triangle;
    std::vector<TriangleTree::Hit> hits_;
    std::vector<Piece> pieces_;
    std::vector<Entry> queue_;
};

// Float arithmetic on positions relative to the mesh: a few units in the last place of the largest coordinate.
float rounding(const MeshView& from, const TriangleTree& to) {
    vec3 largest(0.0F);
    for (const vec3& p : from.positions) largest = glm::max(largest, glm::abs(p));
    return 4e-7F * (glm::length(largest) + to.diagonal());
}

}  // namespace

DistanceBounds directed_distance(const MeshView& from, const TriangleTree& to, const DistanceLimits& limits,
                                 std::span<const float> initial_upper) {
    DistanceBounds bounds = BranchAndBound(from, to, limits, initial_upper).run();
    bounds.upper += rounding(from, to);
    return bounds;
}

DistanceBounds two_sided_distance(const MeshView& a, const MeshView& b, const DistanceLimits& limits) {
    const TriangleTree tree_a(a), tree_b(b);
    const DistanceBounds there = directed_distance(a, tree_b, limits);
    DistanceLimits back_limits = limits;
    back_limits.known_lower = std::max(limits.known_lower, there.lower);
    const DistanceBounds back = directed_distance(b, tree_a, back_limits);
    return {std::max(there.lower, back.lower), std::max(there.upper, back.upper)};
}

SampledDistance sampled_distance(const MeshView& from, const TriangleTree& to, std::size_t count, std::uint64_t seed) {
    std::vector<double> sums;
    double area = 0;
    for (std::size_t t = 0; t < from.triangles(); ++t) {
        const dvec3 a = from.positions[from.indices[3 * t]], b = from.positions[from.indices[3 * t + 1]],
                    c = from.positions[from.indices[3 * t + 2]];
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
        sums.push_back(area);
    }
    Random random(seed);
    std::vector<float> distances;
    double sum = 0;
    std::uint32_t hint = no_triangle;
    for (std::size_t i = 0; i < count; ++i) {
        const double at = area * (static_cast<double>(i) + random.unit()) / static_cast<double>(count);
        const auto t = std::min<std::size_t>(
            static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), at) - sums.begin()), sums.size() - 1);
        double u = random.unit(), v = random.unit();
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const dvec3 a = from.positions[from.indices[3 * t]], b = from.positions[from.indices[3 * t + 1]],
                    c = from.positions[from.indices[3 * t + 2]];
        const auto hit = to.nearest(vec3(a + u * (b - a) + v * (c - a)), hint);
        hint = hit.triangle;
        distances.push_back(hit.distance);
        sum += hit.distance;
    }
    if (distances.empty()) return {};
    std::sort(distances.begin(), distances.end());
    return {distances.back(), distances[distances.size() / 2], static_cast<float>(sum / static_cast<double>(distances.size()))};
}

}  // namespace surefoot::measure
