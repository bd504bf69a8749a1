// Notices a fall to the floor: most of the picture in floor forms, where the last cut had finer ones.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/model.hpp"
#include "render/select/select.hpp"

namespace surefoot {

/// Belongs to the frame thread. Sized once; then nothing allocates.
class FloorWatch {
public:
    void reserve(std::size_t nodes, std::size_t max_drawn);

    /// A new frame: nothing is drawn yet.
    void begin();
    /// A drawn item. pixels: of the view, estimated. floor: its node has finer forms or children, and this is its cheapest form.
    void add(const gl::DrawItem& item, float pixels, bool floor);

    /// Share of the drawn pixels that show floor forms; 0 if nothing is drawn.
    [[nodiscard]] float floor_share() const;
    /// Share of the drawn pixels that show a floor form where the cut `last` had a finer form, or descendants.
    [[nodiscard]] float fallen_share(std::span<const select::Shown> last);

private:
    struct FloorItem {
        gl::DrawItem item;
        float pixels = 0;
    };
    double pixels_ = 0, floor_pixels_ = 0;
    std::vector<FloorItem> floor_;
    std::vector<model::Index> last_form_;  ///< by node, during fallen_share(); none at all other times
};

}  // namespace surefoot
