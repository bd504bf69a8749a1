// The model that calibration draws: generated in memory, so that every machine measures the same work.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "render/gl/device.hpp"
#include "render/model/model.hpp"
#include "render/model/pixel_estimator.hpp"
#include "render/model/view.hpp"
#include "rt/base/random.hpp"

namespace surefoot::measure {

/// The state classes that are measured, the bare one first.
std::span<const model::EffectMask> calibration_classes(bool quick);

/// Items of one (class, triangles, pixels) cell, placed in front of Pose{}.
struct CalibrationCell {
    model::EffectMask effects = 0;
    double triangles = 0, pixels = 0;  ///< of one item, by the estimate of model/item_costs
    std::vector<gl::DrawItem> items;
};

/// The same items drawn in two ways: with an effect, and without it.
struct PriceCell {
    model::EffectMask effect = 0;
    double triangles = 0, pixels = 0;  ///< of one item
    std::vector<gl::DrawItem> without, with;
};

/// An object of the town: the same place at several levels of detail, coarse to fine.
struct TownObject {
    model::Index node = 0;
    model::Index first_rep = 0;
    std::uint32_t levels = 0;
    model::EffectMask effects = 0;
};

/// The generated model, its cells for single costs, and its town for whole frames.
struct CalibrationScene {
    model::Model model;
    model::PixelEstimator estimator;  ///< of the model
    std::vector<CalibrationCell> cells;
    std::vector<PriceCell> prices;  ///< two an effect that has a price: many triangles, and many pixels
    std::vector<TownObject> town;   ///< in blocks: neighbours in the list are neighbours in space
    Box town_box;
};

CalibrationScene make_calibration_scene(model::Viewport viewport, bool quick, std::uint64_t seed);

/// A random view of the town: the visible items with a level each, in drawing order.
struct TownView {
    Pose pose;
    std::vector<gl::DrawItem> items;
};
TownView random_town_view(const CalibrationScene& scene, model::Viewport viewport, Random& random);

}  // namespace surefoot::measure
