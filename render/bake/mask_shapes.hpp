// Where the pictures of masked materials show something.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "render/model/model.hpp"

namespace surefoot::bake {

/// Where the picture of a masked material may show something: at full size, or in one of the next three mip levels. It is at most
/// 512 texels wide; a larger picture's texels are put together.
struct MaskShape {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint16_t> next, last;  ///< by texel: the first from here on in its row, and the last up to here; width: none
};

/// The shapes of a model's masks.
class MaskShapes {
public:
    /// wanted: by material of the model; others, and those beyond its end, have no shape. Materials share shapes.
    MaskShapes(const model::Model& model, const std::vector<bool>& wanted);
    /// Null: nothing is cut with this material.
    [[nodiscard]] const MaskShape* of(model::Index material) const {
        const std::size_t at = material < of_material_.size() ? of_material_[material] : shapes_.size();
        return at < shapes_.size() ? &shapes_[at] : nullptr;
    }

private:
    std::vector<MaskShape> shapes_;
    std::vector<std::size_t> of_material_;
};

}  // namespace surefoot::bake
