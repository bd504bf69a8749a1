// Ranges of leaves that cover a point, and their deepest common ancestor.
#include "render/prepare/before_sky.hpp"

#include <algorithm>
#include <cmath>

namespace surefoot::prepare {

namespace {

/// The blocks whose middles lie in -1..1 between two ends.
struct Middles {
    int first = 0, last = -1;
};
Middles middles(float low, float high, int count) {
    const auto scaled = [&](float x) { return 0.5F * (std::clamp(x, -1.0F, 1.0F) + 1.0F) * static_cast<float>(count) - 0.5F; };
    if (!(high > low)) return {};
    return {static_cast<int>(std::ceil(scaled(low))), std::min(count - 1, static_cast<int>(std::floor(scaled(high))))};
}

}  // namespace

void BeforeSky::reserve(std::uint32_t max_candidates) {
    first_.resize(max_candidates);
    count_.resize(max_candidates);
    leaf_at_.resize(max_candidates);
    of_leaf_.resize(max_candidates);
    at_.resize(max_candidates);
    blocks_.resize(static_cast<std::size_t>(across) * down);
}

void BeforeSky::begin(std::span<const Candidate> candidates) {
    candidates_ = candidates;
    const std::size_t n = candidates.size();
    std::fill_n(of_leaf_.begin(), n, 0.0F);
    std::fill_n(at_.begin(), n, 0.0F);
    std::fill(blocks_.begin(), blocks_.end(), ItemBuffer::Point{});
    for (std::size_t i = 0; i < n; ++i) count_[i] = candidates[i].child_count == 0 ? 1 : 0;
    for (std::size_t i = n; i-- > 1;) count_[candidates[i].parent] += count_[i];
    if (n > 0) first_[0] = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
        std::uint32_t next = first_[i];
        if (candidates[i].child_count == 0) leaf_at_[next] = i;
        for (Index k = 0; k < candidates[i].child_count; ++k) {
            const Index child = candidates[i].first_child + k;
            first_[child] = next;
            next += count_[child];
        }
    }
}

void BeforeSky::cover(const Outline& outline, std::uint32_t rank) {
    const Middles x = middles(outline.left, outline.right, across), y = middles(outline.low, outline.high, down);
    for (int j = y.first; j <= y.last; ++j)
        for (int i = x.first; i <= x.last; ++i)
            blocks_[static_cast<std::size_t>(j) * across + static_cast<std::size_t>(i)].cover(rank);
}

void BeforeSky::cover_with_hidden(const Outline& outline) {
    if (candidates_.empty()) return;
    cover(outline, 0);
    cover(outline, count_[0]);  // beyond the last leaf
}

std::uint32_t BeforeSky::common_ancestor(std::uint32_t first, std::uint32_t last) const {
    if (last >= count_[0]) return 0;
    std::uint32_t a = leaf_at_[first], b = leaf_at_[last];
    while (a != b) {  // parents have smaller numbers
        if (a > b)
            a = candidates_[a].parent;
        else
            b = candidates_[b].parent;
    }
    return a;
}

void BeforeSky::show(std::uint32_t leaf, float pixels, float weight, const ItemBuffer& buffer, int x, int y) {
    const ItemBuffer::Point& point = buffer.at(x, y);
    const ItemBuffer::Point& around = blocks_[static_cast<std::size_t>(y / block) * across + static_cast<std::size_t>(x / block)];
    const std::uint32_t own = rank(leaf);
    const std::uint32_t ancestor =
        common_ancestor(std::min({point.first, around.first, own}), std::max({point.last, around.last, own}));
    if (ancestor == 0 && candidates_.size() > 1) return;
    of_leaf_[leaf] += pixels;
    at_[ancestor] += pixels * weight;
}

SkyPixels BeforeSky::pixels() const {
    return {std::span(of_leaf_).first(candidates_.size()), std::span(at_).first(candidates_.size())};
}

}  // namespace surefoot::prepare
