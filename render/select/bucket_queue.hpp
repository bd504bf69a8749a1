// A monotone priority queue without allocation: 4096 buckets of log-quantised keys, linked through the candidates.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>

#include "render/model/model.hpp"

namespace surefoot::select {

/// Largest key first; equal (quantised) keys in order of arrival. A key above the last popped one counts as equal to it. So the
/// bucket pointer only moves down, as a search down a tree of monotone benefits allows.
/// 128 buckets an octave: keys closer than 0.8 % are equal. 32 octaves below 2; smaller keys share the last bucket.
class BucketQueue {
public:
    static constexpr std::uint32_t buckets = 4096;

    /// heads: 2 * buckets entries; next: one a candidate.
    BucketQueue(std::span<std::uint32_t> heads, std::span<std::uint32_t> next)
        : head_(heads.first(buckets)), tail_(heads.subspan(buckets, buckets)), next_(next) {
        std::fill(head_.begin(), head_.end(), model::none);
    }
    static std::uint32_t bucket_of(float key) {  // without a branch: it is called for every step
        const float at_least_zero = key > 0.0F ? key : 0.0F;
        constexpr auto top = static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(2.0F) >> 16U);
        const auto below = top - static_cast<std::int32_t>(std::bit_cast<std::uint32_t>(at_least_zero) >> 16U);
        return static_cast<std::uint32_t>(std::clamp(below, 0, static_cast<std::int32_t>(buckets) - 1));
    }
    void push(float key, std::uint32_t id) {
        const std::uint32_t bucket = std::max(bucket_of(key), current_);
        next_[id] = model::none;
        if (head_[bucket] == model::none) {
            head_[bucket] = id;
        } else {
            next_[tail_[bucket]] = id;
        }
        tail_[bucket] = id;
        ++size_;
    }
    std::uint32_t pop() {
        while (head_[current_] == model::none) ++current_;
        const std::uint32_t id = head_[current_];
        head_[current_] = next_[id];
        --size_;
        return id;
    }
    [[nodiscard]] bool empty() const { return size_ == 0; }

private:
    std::span<std::uint32_t> head_, tail_, next_;
    std::uint32_t current_ = 0;
    std::uint32_t size_ = 0;
};

}  // namespace surefoot::select
