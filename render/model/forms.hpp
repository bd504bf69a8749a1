// The forms in which a node may be drawn: a name and help for each RepKind.
#pragma once

#include <array>

#include "render/model/model.hpp"
#include "rt/base/named.hpp"

namespace surefoot::model {

/// In RepKind's order.
inline constexpr std::array forms = {
    Named{"mesh", "triangles, coarse to fine"},
    Named{"colour_box", "a box with one mean colour a side"},
    Named{"textured_box", "a box with captured images on its sides"},
};

constexpr const Named& form_of(RepKind kind) { return forms[static_cast<std::size_t>(kind)]; }

static_assert(form_of(RepKind::mesh).name == "mesh" && form_of(RepKind::textured_box).name == "textured_box");
static_assert(forms.size() == static_cast<std::size_t>(RepKind::textured_box) + 1);

}  // namespace surefoot::model
