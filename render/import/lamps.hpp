// Lamps and glowing surfaces, as all readers of files need them.
#pragma once

#include <cstdint>
#include <vector>

#include "render/import/scene.hpp"

namespace surefoot::importer {

/// Luminous intensity of what the eye gets of it: candela, weighted by the luminance of the colour (ITU-R BT.709).
double brightness(const Lamp& lamp);

/// Takes any number of lamps and keeps the brightest max_lamps of them. Of equally bright ones the earlier stays.
class BrightestLamps {
public:
    void add(Lamp lamp);
    /// Those that were taken and are not kept.
    [[nodiscard]] std::uint64_t left_out() const { return taken_ - kept_.size(); }
    /// The kept ones, in the order in which they came. Leaves nothing behind.
    std::vector<Lamp> take();

private:
    /// A lamp among the brightest so far.
    struct Kept {
        double brightness;
        std::uint64_t order;
        Lamp lamp;
    };
    static bool better(const Kept& a, const Kept& b);

    std::vector<Kept> kept_;  ///< a heap with the darkest in front
    std::uint64_t taken_ = 0;
};

/// Replaces the scene's lamps by those kept, and adds a warning if any is left out.
void keep_brightest(Scene& scene, BrightestLamps lamps);
/// The same for the lamps that a scene has.
void keep_brightest(Scene& scene);

/// Sets a material's emission, in linear RGB. Parts that are negative or not finite become 0, and parts too large for a float's
/// arithmetic become the largest one allowed. Returns whether any was changed.
bool set_emission(Material& material, const dvec3& linear);

}  // namespace surefoot::importer
