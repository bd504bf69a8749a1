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

void BeforeSky::reserve(std::uint32_t max_candidates, std::uint32_t max_hidden) {
    first_.resize(max_candidates);
    count_.resize(max_candidates);
    hidden_.resize(max_candidates);
    at_rank_.resize(std::size_t{max_candidates} + max_hidden);
    of_leaf_.resize(max_candidates);
    at_.resize(max_candidates);
    blocks_.resize(static_cast<std::size_t>(across) * down);
}

void BeforeSky::begin(std::span<const Candidate> candidates, std::span<const HiddenNode> hidden) {
    candidates_ = candidates;
    const std::size_t n = candidates.size();
    std::fill_n(of_leaf_.begin(), n, 0.0F);
    std::fill_n(at_.begin(), n, 0.0F);
    std::fill_n(hidden_.begin(), n, 0U);
    std::fill(blocks_.begin(), blocks_.end(), ItemBuffer::Point{});
    if (n == 0) return;
    for (const HiddenNode& node : hidden) ++hidden_[node.parent];
    for (std::size_t i = 0; i < n; ++i) count_[i] = hidden_[i] + (candidates[i].child_count == 0 ? 1U : 0U);
    for (std::size_t i = n; i-- > 1;) count_[candidates[i].parent] += count_[i];
    first_[0] = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t own = hidden_[i] + (candidates[i].child_count == 0 ? 1U : 0U);
        std::fill_n(at_rank_.begin() + first_[i], own, i);
        std::uint32_t next = first_[i] + own;
        for (Index k = 0; k < candidates[i].child_count; ++k) {
            const Index child = candidates[i].first_child + k;
            first_[child] = next;
            next += count_[child];
        }
    }
    for (const HiddenNode& node : hidden) cover(node.outline, first_[node.parent]);
}

void BeforeSky::cover(const Outline& outline, std::uint32_t rank) {
    const Middles x = middles(outline.left, outline.right, across), y = middles(outline.low, outline.high, down);
    for (int j = y.first; j <= y.last; ++j)
        for (int i = x.first; i <= x.last; ++i)
            blocks_[static_cast<std::size_t>(j) * across + static_cast<std::size_t>(i)].cover(rank);
}

std::uint32_t BeforeSky::common_ancestor(std::uint32_t first, std::uint32_t last) const {
    std::uint32_t a = at_rank_[first], b = at_rank_[last];
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
