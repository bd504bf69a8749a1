// The brightest of many lamps, and the emission of a material.
#include "render/import/lamps.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace surefoot::importer {

namespace {
/// The face of the sun has 1.6e9 cd/m². Squares and sums of it stay far below a float's limit.
constexpr double max_emission = 1e10;
}  // namespace

double brightness(const Lamp& lamp) { return lamp.candela * glm::dot(dvec3(lamp.colour), dvec3(0.2126, 0.7152, 0.0722)); }

bool BrightestLamps::better(const Kept& a, const Kept& b) {
    return a.brightness > b.brightness || (a.brightness == b.brightness && a.order < b.order);
}

void BrightestLamps::add(Lamp lamp) {
    Kept kept{brightness(lamp), taken_++, std::move(lamp)};
    if (kept_.size() == max_lamps) {
        if (!better(kept, kept_.front())) return;
        std::pop_heap(kept_.begin(), kept_.end(), better);
        kept_.back() = std::move(kept);
    } else {
        kept_.push_back(std::move(kept));
    }
    std::push_heap(kept_.begin(), kept_.end(), better);
}

std::vector<Lamp> BrightestLamps::take() {
    std::sort(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) { return a.order < b.order; });
    std::vector<Lamp> lamps;
    lamps.reserve(kept_.size());
    for (Kept& kept : kept_) lamps.push_back(std::move(kept.lamp));
    kept_.clear();
    taken_ = 0;
    return lamps;
}

void keep_brightest(Scene& scene, BrightestLamps lamps) {
    const std::uint64_t left_out = lamps.left_out();
    scene.lamps = lamps.take();
    if (left_out > 0)
        scene.warnings.push_back(
            fmt::format("{} lamps are left out: a scene has at most {}, and the brightest are kept. Let fewer and brighter lamps "
                        "give the same light",
                        left_out, max_lamps));
}

void keep_brightest(Scene& scene) {
    if (scene.lamps.size() <= max_lamps) return;
    BrightestLamps brightest;
    for (Lamp& lamp : scene.lamps) brightest.add(std::move(lamp));
    keep_brightest(scene, std::move(brightest));
}

bool set_emission(Material& material, const dvec3& linear) {
    bool changed = false;
    for (int c = 0; c < 3; ++c) {
        const double part = linear[c] > 0 && std::isfinite(linear[c]) ? std::min(linear[c], max_emission) : 0.0;
        changed = changed || !(part == linear[c]);
        material.emission[c] = static_cast<float>(part);
    }
    return changed;
}

}  // namespace surefoot::importer
