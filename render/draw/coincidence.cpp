// Finding what lies in one place (coincidence.hpp).
#include "render/draw/coincidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

namespace surefoot::draw {

namespace {

using model::Index;

constexpr std::uint8_t max_rank = 31;
/// Thinner than this share of its size is flat.
constexpr double flat_share = 0x1p-21;
/// Boxes are compared in cells of this share of their size: what is a millimetre apart at a kilometre is not in one place.
constexpr double cell_share = 0x1p-30;
/// Cells begin off the round numbers that models are made of, so that rounding does not part two of them.
constexpr double cell_offset = 0.381966;

/// A part of a leaf's full detail, placed.
struct Entry {
    Box box;
    std::uint32_t rank_at = 0;  ///< in DepthBiasRanks::ranks
    int flat_axis = -1;
    std::array<std::int64_t, 6> key{};
};

Box box_of(const model::Model& m, const model::Part& part) {
    Box box;
    for (std::uint32_t i = 0; i < part.index_count; ++i) {
        const float* p = m.vertices[part.first_vertex + m.indices[part.first_index + i]].position;
        box.grow(dvec3(p[0], p[1], p[2]));
    }
    return box;
}

Box placed(const Box& box, const model::Placement& placement) {
    const dmat3 linear(placement.linear);
    const dvec3 centre = placement.origin + linear * box.centre(), half = box.half();
    const dvec3 reach = glm::abs(linear[0]) * half.x + glm::abs(linear[1]) * half.y + glm::abs(linear[2]) * half.z;
    return {centre - reach, centre + reach};
}

std::int64_t cell_of(double value, double cell) {
    return static_cast<std::int64_t>(std::floor(std::clamp(value / cell, -9e18, 9e18) + cell_offset));
}

void describe(Entry& e) {
    const dvec3 size = e.box.max - e.box.min;
    const double largest = std::max({size.x, size.y, size.z, 1e-9});
    const double cell = std::exp2(std::ceil(std::log2(largest))) * cell_share;
    for (int axis = 0; axis < 3; ++axis) {
        if (size[axis] <= flat_share * largest) e.flat_axis = axis;
    }
    for (int axis = 0; axis < 3; ++axis) {
        e.key[static_cast<std::size_t>(axis)] = cell_of(e.box.min[axis], cell);
        e.key[3 + static_cast<std::size_t>(axis)] = cell_of(e.box.max[axis], cell);
    }
}

bool overlap(const Entry& a, const Entry& b) {
    for (int axis = 0; axis < 3; ++axis) {
        if (axis == a.flat_axis) continue;
        const double slack = 1e-6 * std::min(a.box.max[axis] - a.box.min[axis], b.box.max[axis] - b.box.min[axis]);
        if (a.box.max[axis] - slack <= b.box.min[axis] || b.box.max[axis] - slack <= a.box.min[axis]) return false;
    }
    return true;
}

/// Within entries[begin, end), all in one plane or one box: swept along `axis`.
void rank_group(std::vector<Entry>& entries, std::size_t begin, std::size_t end, std::vector<std::uint8_t>& ranks) {
    if (end - begin < 2) return;
    const int axis = entries[begin].flat_axis == 0 ? 1 : 0;
    std::sort(entries.begin() + static_cast<std::ptrdiff_t>(begin), entries.begin() + static_cast<std::ptrdiff_t>(end),
              [axis](const Entry& a, const Entry& b) {
                  return a.box.min[axis] != b.box.min[axis] ? a.box.min[axis] < b.box.min[axis] : a.rank_at < b.rank_at;
              });
    std::vector<std::size_t> open;  // those that reach as far as here
    for (std::size_t i = begin; i < end; ++i) {
        const Entry& now = entries[i];
        std::erase_if(open, [&](std::size_t o) { return entries[o].box.max[axis] <= now.box.min[axis]; });
        std::uint64_t taken = 0;
        for (const std::size_t o : open) {
            if (overlap(entries[o], now)) taken |= 1ULL << ranks[entries[o].rank_at];
        }
        std::uint8_t rank = 0;
        while (rank < max_rank && (taken >> rank & 1U) != 0) ++rank;
        ranks[now.rank_at] = rank;
        if (open.size() < 512) open.push_back(i);  // a heap of thousands in one place: the first ones decide
    }
}

template <class Same>
void rank_groups(std::vector<Entry>& entries, const Same& same, std::vector<std::uint8_t>& ranks) {
    for (std::size_t begin = 0; begin < entries.size();) {
        std::size_t end = begin + 1;
        while (end < entries.size() && same(entries[begin], entries[end])) ++end;
        rank_group(entries, begin, end, ranks);
        begin = end;
    }
}

}  // namespace

DepthBiasRanks depth_bias_ranks(const model::Model& m) {
    DepthBiasRanks out;
    out.first_of_rep.reserve(m.reps.size());
    std::uint32_t total = 0;
    for (const model::Representation& rep : m.reps) {
        out.first_of_rep.push_back(total);
        total += rep.part_count;
    }
    out.ranks.assign(total, 0);

    std::vector<Box> boxes;
    for (const model::Part& part : m.parts) boxes.push_back(box_of(m, part));
    std::vector<Entry> solid, flat;
    for (Index n = 0; n < m.nodes.size(); ++n) {
        const model::Node& node = m.nodes[n];
        if (node.child_count > 0 || node.rep_count == 0) continue;
        const Index r = node.first_rep + node.rep_count - 1;
        const model::Representation& rep = m.reps[r];
        for (std::uint32_t k = 0; k < rep.part_count; ++k) {
            if (boxes[rep.first_part + k].empty()) continue;
            Entry e;
            e.box = placed(boxes[rep.first_part + k], m.placements[rep.placement]);
            e.rank_at = out.first_of_rep[r] + k;
            describe(e);
            (e.flat_axis < 0 ? solid : flat).push_back(e);
        }
    }
    std::sort(solid.begin(), solid.end(),
              [](const Entry& a, const Entry& b) { return std::tie(a.key, a.rank_at) < std::tie(b.key, b.rank_at); });
    rank_groups(
        solid, [](const Entry& a, const Entry& b) { return a.key == b.key; }, out.ranks);
    // A plane's place in cells of the Earth's size in float, or the wall and the poster would have cells of their own.
    const auto plane = [](const Entry& e) {
        const double at = e.box.min[e.flat_axis];
        return std::pair(e.flat_axis,
                         cell_of(at, std::max(std::exp2(std::ceil(std::log2(std::abs(at) + 1e-9))) * 0x1p-24, 1e-6)));
    };
    std::sort(flat.begin(), flat.end(), [&](const Entry& a, const Entry& b) {
        const auto pa = plane(a), pb = plane(b);
        return pa != pb ? pa < pb : a.rank_at < b.rank_at;
    });
    rank_groups(
        flat, [&](const Entry& a, const Entry& b) { return plane(a) == plane(b); }, out.ranks);

    for (const model::Node& node : m.nodes) {
        if (node.child_count > 0 || node.rep_count == 0) continue;
        const Index finest = node.first_rep + node.rep_count - 1;
        const model::Representation& full = m.reps[finest];
        const auto material_of = [&](const model::Representation& rep, std::uint32_t k) {
            return m.parts[rep.first_part + k].material;
        };
        for (Index r = node.first_rep; r < finest; ++r) {
            const model::Representation& rep = m.reps[r];
            for (std::uint32_t k = 0; k < rep.part_count; ++k) {
                std::uint32_t as = rep.part_count == full.part_count ? k : 0;  // of the same material, else in the same place
                for (std::uint32_t j = 0; j < full.part_count && material_of(full, as) != material_of(rep, k); ++j)
                    if (material_of(full, j) == material_of(rep, k)) as = j;
                out.ranks[out.first_of_rep[r] + k] = full.part_count == 0 ? 0 : out.ranks[out.first_of_rep[finest] + as];
            }
        }
    }
    return out;
}

}  // namespace surefoot::draw
