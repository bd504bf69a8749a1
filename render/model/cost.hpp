// The cost model of one machine: tables over (log2 triangles, log2 pixels, state class), and weights for whole frames.
// Plain data and its evaluation; render/measure fills it in. Source: Maciel 1994, 3.3.1; here a measured table replaces max(G,
// R).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/model/effects.hpp"
#include "render/model/resolution.hpp"
#include "rt/base/modes.hpp"

namespace surefoot::model {

/// Predicted time of one item. submit: on the frame thread (calls, vertices, binning). raster: on the rasterisers.
struct ItemCost {
    float submit_us = 0;
    float raster_us = 0;
    friend ItemCost operator*(const ItemCost& cost, float factor) { return {cost.submit_us * factor, cost.raster_us * factor}; }
    ItemCost& operator+=(const ItemCost& more) {
        submit_us += more.submit_us;
        raster_us += more.raster_us;
        return *this;
    }
};

/// One state class: knots at triangles 2^0..2^(nt-1) and pixels 2^0..2^(np-1). Linear in the argument between knots: exact for
/// linear costs, and without logarithms in the frame.
struct CostGrid {
    EffectMask effects = 0;
    std::uint32_t triangle_steps = 0, pixel_steps = 0;  ///< nt, np
    std::vector<ItemCost> cells;                        ///< [t * np + p]
};

/// What an effect adds to an item of any state class: linear, so prices of several effects add up. An effect that a class's grid
/// holds already is not added; it is taken off again where it is hidden.
struct EffectPrice {
    EffectMask effect = 0;  ///< one bit
    float submit_ns_per_triangle = 0, raster_ns_per_triangle = 0, raster_ns_per_pixel = 0;
};

/// frame_us = fixed + sum_submit * S + sum_raster * R + max(S, R) * M, with S, R the sums over items.
struct FrameCombine {
    float fixed_us = 500;
    float submit_weight = 1;
    float raster_weight = 0.5F;
    float max_weight = 0;
    [[nodiscard]] float frame_us(float submit_us, float raster_us) const {
        return fixed_us + submit_weight * submit_us + raster_weight * raster_us +
               max_weight * (submit_us > raster_us ? submit_us : raster_us);
    }
    /// Of frame_us, what `undone_us` of the raster time adds.
    [[nodiscard]] float left_us(float submit_us, float raster_us, float undone_us) const {
        return frame_us(submit_us, raster_us) - frame_us(submit_us, raster_us - undone_us);
    }
};

/// What a lower resolution loses of the value, by resolution_steps: 0 at first, never falling, at most 1.
using BlurLoss = std::array<float, resolution_steps.size()>;

/// The cost table of a machine, fitted to a model of a whole frame.
struct CostModel {
    std::vector<CostGrid> grids;      ///< at least one. Found by exact mask, else by most common bits among the supersets
    std::vector<EffectPrice> prices;  ///< one an effect at most. Empty: an engine takes effects::usual_prices()
    FrameCombine combine;
    /// Raster time of every rasterised pixel beyond the cells, whatever its state class. 0: the cells alone; else a fit measured
    /// it.
    float ns_per_pixel = 0;
    float headroom = 1.25F;             ///< 90 % quantile of actual / predicted whole-frame cost at calibration
    float slice_us = 30;                ///< cost of ending a slice (flush and fence)
    float enlarge_ns_per_pixel = 1.6F;  ///< of the whole picture, where it is drawn at a lower resolution
    /// Of an item's raster time: what each sample of a pixel beyond the first adds.
    float sample_share = 0.77F;
    float sample_pass_ns_per_pixel = 2.5F;  ///< of what is drawn: to clear and resolve each sample beyond the first
    float trilinear_factor = 1.24F;         ///< raster time of textured items, against bilinear
    /// Of the picture as it is drawn, in every frame: with_background() and at_quality() find it. No file holds it.
    float drawn_pass_ns_per_pixel = 0;
    float rest_pass_ns_per_pixel = 8;  ///< of one pass over the picture at rest; typical, no calibration measures it
    /// Of the image cache. A picture, by its box's faces: transparent pixels cost as much as others. A new one, beside what it
    /// shows: a pass, and its texels.
    float picture_us = 1, picture_ns_per_pixel = 5.6F, capture_us = 20, capture_ns_per_texel = 1;
    float background_ns_per_pixel = 3.7F;  ///< of what is behind everything (background_effects), in models that call for it
    float behind_ns_per_pixel = 0;         ///< the same in this model's pictures: with_background() sets it. No file holds it
    /// Six times the mean squared error (0..1) of full detail that is enlarged. Typical of five scenes; a fit measures its model.
    BlurLoss blur_loss{0.0F, 0.005F, 0.0067F, 0.0085F, 0.0107F};
    rt::TextureFilter filter = rt::TextureFilter::automatic;  ///< that it was measured by; automatic: as the device chooses
    std::string machine;  ///< CPU, renderer, rasteriser count; a table of another machine is refused
    bool timer_query_honest = false;
    bool calibrated = false;  ///< false: built-in defaults
    /// False: the constants above, which no file holds.
    bool enlarge_measured = false, blur_measured = false, samples_measured = false, trilinear_measured = false,
         background_measured = false, prices_measured = false, pictures_measured = false;

    /// Interpolated. Arguments below 1 count as 1; beyond the grid the cost is extrapolated linearly. Never negative. A NaN
    /// argument gives the largest cell.
    [[nodiscard]] ItemCost item(float triangles, float pixels, const CostGrid& grid) const;
    [[nodiscard]] const CostGrid& grid_for(EffectMask effects) const;
    [[nodiscard]] float blur_loss_at(float resolution) const;  ///< of the step that is drawn for it
    /// How the items of a frame add up that is drawn at `resolution`: with the passes over what is drawn.
    [[nodiscard]] FrameCombine combine_at(float resolution, const Viewport& picture) const;
    /// Time to enlarge a picture of `resolution` to its full size, us; 0 at full resolution.
    [[nodiscard]] float enlarge_us(float resolution, const Viewport& picture) const {
        const float pixels = static_cast<float>(picture.width) * static_cast<float>(picture.height);
        return resolution < 1.0F ? 1e-3F * enlarge_ns_per_pixel * pixels : 0.0F;
    }
    /// Time to clear, copy, add or divide the picture at rest, us.
    [[nodiscard]] float rest_pass_us(const Viewport& picture) const {
        return 1e-3F * rest_pass_ns_per_pixel * static_cast<float>(picture.width) * static_cast<float>(picture.height);
    }
    /// Time of what is behind everything, us; 0 where there is nothing.
    [[nodiscard]] float behind_us(const Viewport& drawn) const {
        return 1e-3F * behind_ns_per_pixel * static_cast<float>(drawn.width) * static_cast<float>(drawn.height);
    }
};

/// How frames are drawn, and by which filter the table was measured. Filters are not `automatic` here.
struct Quality {
    std::uint32_t samples = 1;  ///< of a pixel
    rt::TextureFilter filter = rt::TextureFilter::bilinear, of_table = rt::TextureFilter::bilinear;
};

/// The costs of frames that are drawn so. A table is measured with one sample a pixel.
CostModel at_quality(CostModel costs, const Quality& quality);

/// The costs of pictures that have something behind everything.
CostModel with_background(CostModel costs);

/// Conservative costs for an uncalibrated machine (llvmpipe on two cores).
CostModel default_costs();

}  // namespace surefoot::model
