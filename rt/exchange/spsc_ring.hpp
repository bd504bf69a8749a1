// A bounded ring from one producer to one consumer, wait-free on both sides. Drops and counts values that do not fit.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "rt/base/check.hpp"
#include "rt/base/thread_annotations.hpp"

namespace surefoot::rt {

/// A bounded ring. One thread pushes and one thread pops; neither waits.
template <class T>
class SpscRing {  // NOLINT(clang-analyzer-optin.performance.Padding): each side has a cache line of its own
    static_assert(std::is_nothrow_copy_assignable_v<T>, "a record must be plain data");

public:
    /// At least `capacity` places, rounded up to a power of two.
    explicit SpscRing(std::size_t capacity)
        : places_(std::bit_ceil(capacity < 2 ? std::size_t{2} : capacity)), mask_(places_.size() - 1) {
        CHECK(std::has_single_bit(places_.size()), "The number of places in a ring is a power of two");
    }
    SpscRing(const SpscRing&) = delete;
    SpscRing& operator=(const SpscRing&) = delete;

    /// Producer. False, and counted: full.
    bool try_push(const T& value) noexcept {
        producer_.plays();
        if (full()) {
            dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
            return false;
        }
        const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
        places_[tail & mask_] = value;
        tail_.store(tail + 1, std::memory_order_release);
        return true;
    }
    /// Producer: whether the next push would be dropped.
    [[nodiscard]] bool full() noexcept {
        producer_.plays();
        const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
        if (tail - head_seen_ > mask_) head_seen_ = head_.load(std::memory_order_acquire);
        return tail - head_seen_ > mask_;
    }
    /// Consumer. False: empty.
    bool try_pop(T& value) noexcept {
        consumer_.plays();
        const std::uint64_t head = head_.load(std::memory_order_relaxed);
        if (head == tail_seen_) {
            tail_seen_ = tail_.load(std::memory_order_acquire);
            if (head == tail_seen_) return false;
        }
        value = places_[head & mask_];
        head_.store(head + 1, std::memory_order_release);
        return true;
    }
    /// Any thread; exact once the producer has stopped.
    [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
    [[nodiscard]] std::size_t capacity() const noexcept { return places_.size(); }

private:
    [[no_unique_address]] ThreadRole producer_, consumer_;
    std::vector<T> places_;
    std::size_t mask_;
    alignas(64) std::atomic<std::uint64_t> tail_{0};  ///< written by the producer; on its cache line
    std::uint64_t head_seen_ GUARDED_BY(producer_) = 0;
    std::atomic<std::uint64_t> dropped_{0};
    alignas(64) std::atomic<std::uint64_t> head_{0};  ///< written by the consumer; on its cache line
    std::uint64_t tail_seen_ GUARDED_BY(consumer_) = 0;
};

}  // namespace surefoot::rt
