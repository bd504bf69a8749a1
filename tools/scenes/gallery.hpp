// The gallery: two spheres, a cylinder and a statue in a room of 4 x 3.5 m without walls. One of them is seen at a time.
// After Pasman & Jansen 2002, section 5, figure 11.
#pragma once

#include "tools/scenes/scenes.hpp"

namespace surefoot::scenes {

/// `scale` multiplies the triangles of spheres and cylinder; `seed` moves them by up to 5 cm. statue: placed at the end of the
/// room, 1.2 m long; empty: a knot.
GeneratedScene make_gallery(double scale, std::uint64_t seed, importer::Scene statue);

}  // namespace surefoot::scenes
