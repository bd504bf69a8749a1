// A walk's outputs, asked for their places before it begins: an hour's walk is not lost for a wrong name.
#pragma once

#include "rt/base/result.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// Every output could be written now, none is another output or a file that is read, and none asks for what cannot be (pictures
/// of the null backend). Nothing is left behind; what is there is not touched.
Result<void> check_outputs(const WalkRequest& request);

}  // namespace surefoot::walk
