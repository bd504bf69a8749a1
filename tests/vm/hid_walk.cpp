// The walk itself: follows a real device, stops when it is pulled, resumes after neutral, and leaves a picture.
#include "tests/vm/hid_checks.hpp"

namespace surefoot::vm {

void check_walk(Checks& checks, const Guest&) { checks.not_run("walk", "this build has no live input"); }

}  // namespace surefoot::vm
