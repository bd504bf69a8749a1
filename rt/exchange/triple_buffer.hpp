// The latest value from one writer to one reader, wait-free on both sides: neither ever waits, old values are overwritten.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "rt/base/check.hpp"
#include "rt/base/thread_annotations.hpp"

namespace surefoot::rt {

/// Three slots: the writer fills one, the reader holds one, the third is exchanged. Reserve T's memory through slot() before use;
/// later nothing is copied or allocated. One writer thread and one reader thread.
template <class T>
class TripleBuffer {
public:
    TripleBuffer() = default;
    explicit TripleBuffer(const T& initial) : slots_{Slot{initial}, Slot{initial}, Slot{initial}} {}
    TripleBuffer(const TripleBuffer&) = delete;
    TripleBuffer& operator=(const TripleBuffer&) = delete;

    /// Before the threads start: slot 0, 1, 2, to reserve memory in each.
    T& slot(std::size_t i) { return slots_[i].value; }

    /// Writer: the slot to fill. It holds the value of an earlier publication.
    T& back() {
        writer_.plays();
        return slots_[back_].value;
    }
    /// Writer: hands the filled slot over; back() is another from now on.
    void publish() {
        writer_.plays();
        const std::uint8_t before = middle_.exchange(static_cast<std::uint8_t>(back_ | fresh), std::memory_order_acq_rel);
        back_ = before & index_mask;
        CHECK(back_ < slots_.size(), "The slot that came back is one of three");
    }

    /// Reader: takes the newest published value, if there is one since the last call.
    bool refresh() {
        reader_.plays();
        if ((middle_.load(std::memory_order_relaxed) & fresh) == 0) return false;
        const std::uint8_t before = middle_.exchange(front_, std::memory_order_acq_rel);
        front_ = before & index_mask;
        CHECK(front_ < slots_.size(), "The slot that was handed over is one of three");
        return true;
    }
    /// Reader: the value of the last refresh(), or the initial value. The reader may change it.
    T& front() {
        reader_.plays();
        return slots_[front_].value;
    }
    [[nodiscard]] const T& front() const {
        reader_.plays();
        return slots_[front_].value;
    }

private:
    static constexpr std::uint8_t index_mask = 3, fresh = 4;
    struct alignas(64) Slot {
        T value{};
    };
    [[no_unique_address]] ThreadRole writer_, reader_;
    std::array<Slot, 3> slots_{};
    alignas(64) std::uint8_t back_ GUARDED_BY(writer_) = 0;
    alignas(64) std::atomic<std::uint8_t> middle_{1};
    alignas(64) std::uint8_t front_ GUARDED_BY(reader_) = 2;
};

}  // namespace surefoot::rt
