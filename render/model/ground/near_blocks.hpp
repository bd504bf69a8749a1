// The blocks of a ground near a body, unpacked. A body moves little from step to step, so most blocks are there already.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "render/model/ground/near.hpp"

namespace surefoot::model {

/// The constructor allocates; nothing else does, nor locks. One thread uses it. What is found does not depend on what was
/// gathered before, nor does its order.
class NearBlocks {
public:
    /// The ground must outlive this, and be valid and indexed.
    explicit NearBlocks(const Ground& ground);

    /// Makes all that meets the box ready, unless there is too much of it: then it is not complete.
    void gather(const Box& box) noexcept;
    /// Whether this box was gathered, completely or not.
    [[nodiscard]] bool gathered(const Box& box) const { return known_ && box_.contains(box); }
    [[nodiscard]] bool complete() const { return complete_; }
    /// Whether all that meets the box is ready.
    [[nodiscard]] bool holds(const Box& box) const { return complete_ && gathered(box); }

    /// What the user of a triangle last found out about it: how far it was at least from a body with its feet there.
    struct Known {
        dvec3 feet{0.0};
        double apart_m = -std::numeric_limits<double>::infinity();  ///< unknown
        bool exact = false;
    };

    /// Of a box that is held: use(const GroundTriangle&, Known&) for every triangle that meets it, and for some whose boxes do.
    /// Both stay where they are until the next gather(); what is known is kept beyond it while the block is near.
    template <class Use>
    void for_triangles(const Box& box, const Use& use) const {
        const Sides wanted(box);
        for (const Near& near : near_) {
            if (!ground_tree::overlap(box, near.box)) continue;
            Slot& slot = *near.slot;
            std::array<std::int32_t, max_block_triangles> meets;
            for (std::size_t t = 0; t < meets.size(); ++t)  // all at once, in vector registers
                meets[t] = std::int32_t{slot.min[0][t] <= wanted.max[0]} & std::int32_t{slot.max[0][t] >= wanted.min[0]} &
                           std::int32_t{slot.min[1][t] <= wanted.max[1]} & std::int32_t{slot.max[1][t] >= wanted.min[1]} &
                           std::int32_t{slot.min[2][t] <= wanted.max[2]} & std::int32_t{slot.max[2][t] >= wanted.min[2]};
            for (std::uint32_t t = 0; t < slot.count; ++t)
                if (meets[t] != 0) use(slot.triangles[t], slot.known[t]);
        }
    }

private:
    /// A box's sides, rounded outwards.
    struct Sides {
        std::array<float, 3> min, max;
        explicit Sides(const Box& box);
    };
    /// An unpacked block.
    struct Slot {
        std::uint32_t count = 0;
        std::array<std::array<float, max_block_triangles>, 3> min{}, max{};  ///< of the triangles' boxes, rounded outwards
        std::array<GroundTriangle, max_block_triangles> triangles{};
        std::array<Known, max_block_triangles> known{};
    };
    /// One that the last gather() met; the boxes lie together, where they are looked through at each step.
    struct Near {
        Box box;
        Slot* slot;
    };
    /// What a slot holds. Tags lie together: eight are looked through for each block of a gathering.
    struct Tag {
        Box box;
        std::uint64_t key = ~0ULL;    ///< instance and block
        std::uint64_t gathering = 0;  ///< number of the last gather() that met it
    };
    static constexpr std::uint32_t ways = 8, sets = 128;  ///< 4.2 MB

    std::size_t slot_of(std::uint64_t key) const;
    template <class Place>
    void add(std::uint32_t instance, const GroundMesh& mesh, std::uint32_t block, const Place& place);

    const Ground& ground_;
    std::vector<Slot> slots_;
    std::vector<Tag> tags_;   ///< of the slots
    std::vector<Near> near_;  ///< in the tree's order
    Box box_;
    std::uint64_t gathering_ = 0;
    bool known_ = false, complete_ = false;
};

}  // namespace surefoot::model
