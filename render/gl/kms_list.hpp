// Which screens this machine has, as the kernel lists them, and who holds a card.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "render/gl/drm.hpp"
#include "render/gl/kms_modes.hpp"

namespace surefoot::gl {

/// find_screens(), by a library that is loaded.
Result<std::vector<Screen>> list_screens(const Drm& drm);

ScreenMode mode_of(const drmModeModeInfo& timings);

/// Other programs that have the card open: "Xorg (412), surefootd (519)". Those of other users show only to root.
std::string holders_of(const std::string& card);

/// What a user does who may not open a card.
std::string rights_remedy();

}  // namespace surefoot::gl
