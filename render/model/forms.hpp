// The forms in which a node may be drawn, by name: what RepKind stands for.
#pragma once

#include <array>

#include "render/model/model.hpp"
#include "rt/base/named.hpp"

namespace surefoot::model {

/// In RepKind's order.
inline constexpr std::array forms = {
    Named{"mesh", "triangles of its own, coarse to fine"},
    Named{"colour_box", "its box in a mean colour a side"},
    Named{"textured_box", "its box with pictures of it on the sides"},
};

constexpr const Named& form_of(RepKind kind) { return forms[static_cast<std::size_t>(kind)]; }

static_assert(form_of(RepKind::mesh).name == "mesh" && form_of(RepKind::textured_box).name == "textured_box");
static_assert(forms.size() == static_cast<std::size_t>(RepKind::textured_box) + 1);

}  // namespace surefoot::model
