// Checks a walk's outputs before it starts, so that a long walk is not lost to a wrong file name.
#pragma once

#include "rt/base/result.hpp"
#include "tools/walk/walk.hpp"

namespace surefoot::walk {

/// Errors: an output that cannot be written, that is an input or another output, or that the backend cannot make (pictures of
/// the null backend). Creates and changes no file.
Result<void> check_outputs(const WalkRequest& request);

}  // namespace surefoot::walk
