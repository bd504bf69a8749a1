// A cache of unpacked blocks: eight places for each value of a hash; of those, what was met longest ago goes first.
#include "render/model/ground/near_blocks.hpp"

#include <cmath>
#include <limits>

namespace surefoot::model {

NearBlocks::NearBlocks(const Ground& ground) : ground_(ground), slots_(std::size_t{ways} * sets), tags_(slots_.size()) {
    near_.reserve(slots_.size());
}

NearBlocks::Sides::Sides(const Box& box) {
    constexpr float far = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const auto at = static_cast<std::size_t>(axis);
        min[at] = std::nextafter(static_cast<float>(box.min[axis]), -far);
        max[at] = std::nextafter(static_cast<float>(box.max[axis]), far);
    }
}

/// Where the block is, or may be put: a slot of this gathering holds another, and there is no place.
std::size_t NearBlocks::slot_of(std::uint64_t key) const {
    const std::uint64_t mixed = key * 0x9E3779B97F4A7C15ULL;
    const std::size_t first = ways * static_cast<std::size_t>((mixed >> 32) % sets);
    std::size_t oldest = first;
    for (std::size_t at = first; at < first + ways; ++at) {
        if (tags_[at].key == key) return at;
        if (tags_[at].gathering < tags_[oldest].gathering) oldest = at;
    }
    return oldest;
}

template <class Place>
void NearBlocks::add(std::uint32_t instance, const GroundMesh& mesh, std::uint32_t block, const Place& place) {
    const std::uint64_t key = (std::uint64_t{instance} << 32) | block;
    const std::size_t at = slot_of(key);
    Tag& tag = tags_[at];
    Slot& slot = slots_[at];
    if (tag.key != key) {
        if (tag.gathering == gathering_) {
            complete_ = false;
            return;
        }
        tag.key = key;
        tag.box = {};
        slot.count = 0;
        const auto all = [](const GroundTriangle&) { return true; };
        ground_tree::in_block(ground_, mesh, ground_.blocks[block], place, all, [&](const GroundTriangle& t) {
            const Box box = ground_tree::box_of(t);
            const Sides sides(box);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                slot.min[axis][slot.count] = sides.min[axis];
                slot.max[axis][slot.count] = sides.max[axis];
            }
            slot.known[slot.count] = {};
            slot.triangles[slot.count++] = t;
            tag.box.grow(box);
        });
    }
    tag.gathering = gathering_;
    near_.push_back({tag.box, &slot});
}

void NearBlocks::gather(const Box& box) noexcept {
    near_.clear();
    known_ = complete_ = true;
    box_ = box;
    ++gathering_;
    if (ground_.meshes.empty()) return;
    constexpr std::uint32_t in_world = ~0U;
    const GroundMesh& world = ground_.meshes[0];
    ground_tree::blocks_in_mesh(ground_, world, {world, box},
                                [&](std::uint32_t block) { add(in_world, world, block, [](const dvec3& p) { return p; }); });
    ground_tree::instances_near(ground_, box, [&](std::uint32_t number) {
        const GroundInstance& instance = ground_.instances[number];
        const GroundMesh& mesh = ground_.meshes[instance.mesh];
        const dmat3 linear(instance.linear);
        ground_tree::blocks_in_mesh(ground_, mesh, {mesh, ground_tree::in_frame_of(instance, box)}, [&](std::uint32_t block) {
            add(number, mesh, block, [&](const dvec3& p) { return instance.origin + linear * p; });
        });
    });
}

}  // namespace surefoot::model
