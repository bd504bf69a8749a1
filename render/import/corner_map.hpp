// Finds the vertex of a face's corner (position, texture coordinate, normal). Open addressing; a look-up does not allocate.
#pragma once

#include <cstdint>
#include <vector>

namespace surefoot::importer {

/// A corner of an OBJ face: three indices.
struct Corner {
    std::uint32_t position, uv, normal;
    bool operator==(const Corner&) const = default;
};

/// A hash table of corners. One thread.
class CornerMap {
public:
    /// The number that this corner has; `next` becomes its number when it is new.
    std::uint32_t find_or_add(const Corner& corner, std::uint32_t next) {
        if ((count_ + 1) * 4 > slots_.size() * 3) grow();
        Slot& slot = slot_of(corner);
        if (slot.number != empty) return slot.number;
        slot = {corner, next};
        ++count_;
        return next;
    }

private:
    static constexpr std::uint32_t empty = 0xffffffffU;
    struct Slot {
        Corner corner{};
        std::uint32_t number = empty;
    };

    static std::uint64_t hash(const Corner& c) {
        std::uint64_t h = (std::uint64_t{c.position} << 32U | c.uv) * 0x9e3779b97f4a7c15ULL;
        h = (h ^ (h >> 29U) ^ c.normal) * 0xbf58476d1ce4e5b9ULL;
        return h ^ (h >> 32U);
    }
    Slot& slot_of(const Corner& corner) {
        const std::size_t mask = slots_.size() - 1;
        std::size_t i = hash(corner) & mask;
        while (slots_[i].number != empty && !(slots_[i].corner == corner)) i = (i + 1) & mask;
        return slots_[i];
    }
    void grow() {
        std::vector<Slot> old = std::move(slots_);
        slots_.assign(old.empty() ? 64 : old.size() * 2, Slot{});
        for (const Slot& slot : old) {
            if (slot.number != empty) slot_of(slot.corner) = slot;
        }
    }
    std::vector<Slot> slots_;
    std::size_t count_ = 0;
};

}  // namespace surefoot::importer
