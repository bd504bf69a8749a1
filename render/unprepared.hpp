// What a frame draws where no prepared set may be used: the last cut's forms, with the coarse levels of the model as stand-ins.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/item_costs.hpp"
#include "render/model/model.hpp"
#include "render/model/view.hpp"

namespace surefoot {

/// An item of the plan.
struct UnpreparedItem {
    gl::DrawItem item;
    model::ItemCost cost;
    float pixels = 0;     ///< of the view, as estimated
    float error_rad = 0;  ///< angular error at this pose
    bool floor = false;   ///< the form that is valid everywhere, of a node that has finer ones
};

/// Items below one node of the coarse levels, and what may stand in for all of them.
struct UnpreparedGroup {
    std::uint32_t first = 0, count = 0;  ///< in items()
    model::ItemCost cost;                ///< of its items together
    UnpreparedItem stand_in;
};

/// Belongs to the frame thread. Sized once; then nothing allocates.
class Unprepared {
public:
    /// Chooses the coarse levels: about 256 nodes that cover the model, the largest opened first.
    void reserve(const model::Model& model);
    /// At most so many items in a plan.
    [[nodiscard]] std::size_t capacity() const;

    /// Covers what the pose sees. `shown` is by node, as in SelectState. A node of the last cut keeps its form where that is
    /// legal at this pose, else it shows its form that is valid everywhere. What was not in the last cut shows the coarse levels.
    /// If that takes too many items, everything shows the coarse levels. Costs are without the `hidden` effects. Groups with most
    /// pixels come first.
    void plan(std::span<const model::Index> shown, const model::Frustum& frustum, const Pose& pose, const model::ViewScale& scale,
              const model::ItemCosts& costs, model::EffectMask hidden = 0);
    [[nodiscard]] std::span<const UnpreparedGroup> groups() const { return groups_; }
    [[nodiscard]] std::span<const UnpreparedItem> items() const { return items_; }

private:
    enum class Level : std::uint8_t { below, coarse, above };  ///< where a node is, seen from the coarse levels
    struct Step {
        model::Index node = 0;
        std::uint32_t group = 0;
    };
    struct View;
    bool walk(std::span<const model::Index> shown, const View& view);
    std::uint32_t begin_group(model::Index node, const View& view);
    bool add(model::Index node, model::Index rep, std::uint32_t group, const View& view);
    [[nodiscard]] UnpreparedItem item_of(model::Index node, model::Index rep, const View& view) const;

    const model::Model* model_ = nullptr;
    std::vector<Level> level_;  ///< by node
    std::vector<Step> stack_;
    std::vector<UnpreparedGroup> groups_;
    std::vector<UnpreparedItem> items_;
};

}  // namespace surefoot
