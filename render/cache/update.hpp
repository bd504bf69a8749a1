// One frame of the image cache: which boxes get a new picture, which pictures serve again, and what is drawn as triangles.
// Pure functions of data: no graphics API, no clock, no threads. Source: Schaufler and Stuerzlinger 1996, figures 4 and 5.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "render/cache/boxes.hpp"
#include "render/cache/validity.hpp"
#include "render/model/view.hpp"
#include "rt/base/result.hpp"

namespace surefoot::cache {

/// By which tests a picture is valid.
enum class ValidityRules : std::uint8_t {
    corrected,  ///< all errors together, children's too, within the smallest pixel
    published,  ///< each angle alone within the mean pixel; figure 4 to the letter, without upkeep
};

/// A picture has no more texels a side than this.
constexpr std::uint32_t max_side_texels = 8192;

/// How a cache works.
struct CacheOptions {
    ValidityRules rules = ValidityRules::corrected;
    std::uint32_t min_texels = 64, max_texels = 256;  ///< sides of pictures; powers of two
    std::uint64_t max_bytes = 256ULL << 20U;          ///< of all pictures
    std::uint32_t max_generation = 4;                 ///< pictures of pictures of ..., to max_levels; 0: all are of triangles
    double child_share = 0.95;                        ///< of the error that a picture may have: what it inherits at most
    std::uint32_t upkeep_refreshes = 8;               ///< ahead: at so many begins no further child, with all below it; 0: none
    std::uint32_t upkeep_frames = 16;                 ///< their parent's picture is expected to fail within so many frames
    bool surround = true;                             ///< pictures are kept all round the eye; else only in the view
};
/// Errors: texels that are no powers of two up to max_side_texels, too many generations, a share that is none.
Result<void> check_cache_options(const CacheOptions& options);

/// What the eye sees in a frame. Pixels: pixel_angles().
struct CacheView {
    dvec3 eye{0.0};
    PixelAngles pixels;
    std::uint32_t frame = 0;                  ///< rises by one a frame
    const model::Frustum* frustum = nullptr;  ///< what is drawn; null: all round the eye
};

/// The pictures between two frames.
struct CacheState {
    std::vector<Picture> pictures;         ///< one a box; Picture::texels is 0 where there is none
    std::vector<std::uint32_t> last_used;  ///< frame in which it was drawn, or drawn from
    std::uint64_t bytes = 0;               ///< of all pictures
};
CacheState empty_state(const BoxTree& tree);

constexpr std::uint64_t bytes_a_texel = 4;
constexpr std::uint64_t bytes_of(std::uint32_t texels) { return bytes_a_texel * texels * texels; }

/// What a frame needs to know of a box, seen from one eye. Each box by itself: workers may fill the array in any parts.
struct BoxFacts {
    dvec3 eye{0.0};           ///< they hold for this one alone
    std::uint32_t frame = 0;  ///< and for this frame
    bool in_view = true;
    std::optional<Picture> fresh;  ///< the picture that it can get now; nothing: none is fine enough
    double error_rad = 0;          ///< of the picture that it has; infinite: that may not be used
};
/// Fills facts[first] to facts[last - 1]. All spans are as long as the tree has boxes.
void evaluate_boxes(const BoxTree& tree, const CacheView& view, const CacheOptions& options, const CacheState& state, Index first,
                    Index last, std::span<BoxFacts> facts);

/// What a frame does with a box.
enum class BoxUse : std::uint8_t {
    unused,
    fresh,            ///< gets a picture of triangles
    combined,         ///< gets a picture of its children's pictures
    reused,           ///< is drawn by the picture that it had
    not_replaceable,  ///< a leaf that is drawn as triangles
};

/// A picture to be made.
struct Refresh {
    Index box = 0;
    bool from_children = false;
    bool ahead = false;  ///< below a picture that is still valid
};

/// A box to be drawn: by its picture, or its triangles clipped to it.
struct BoxDraw {
    Index box = 0;
    bool picture = true;
};

/// Boxes by their use. fresh and combined count all refreshes, reused and not_replaceable what is drawn.
struct CacheCounts {
    std::uint32_t fresh = 0, combined = 0, reused = 0, not_replaceable = 0;
    std::uint32_t ahead = 0;  ///< of fresh and combined: refreshed ahead
};

/// A frame of the cache, and the state after it.
struct CachePlan {
    std::vector<Index> dropped;      ///< boxes that lose their pictures first, for room
    std::vector<Refresh> refreshes;  ///< in this order: children before what is combined from them
    std::vector<BoxDraw> draws;      ///< back to front; they cover every box in view that has triangles once
    std::vector<BoxUse> uses;        ///< one a box
    CacheCounts counts;
    double max_error_rad = 0;  ///< of the pictures that are drawn; 0 without any
    CacheState after;
};

/// Decides alone, from facts that were filled for the same view and state. Options must be in range. Allocates.
CachePlan plan_frame(const BoxTree& tree, const CacheView& view, const CacheOptions& options, const CacheState& state,
                     std::span<const BoxFacts> facts);
/// The same, filling the facts itself.
CachePlan plan_frame(const BoxTree& tree, const CacheView& view, const CacheOptions& options, const CacheState& state);

}  // namespace surefoot::cache
