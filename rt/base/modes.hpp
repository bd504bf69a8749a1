// Modes of a walk that several rooms know: the policy for late frames, the clock, the texture filter, the image cache. And what
// became of a guarantee. Enums, with their names in settings and reports.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "rt/base/named.hpp"

namespace surefoot::rt {

/// What happens to a late frame. Names as in OpenGL Performer (Rohlf & Helman 1994).
/// lock:     frames are shown on grid points only. A late frame is shown on the first grid point after it is done, and the next
///           frame starts there. The slots that it ran over are skipped whole. Latency is a whole number of periods.
/// floating: (`float`) a late frame is shown when it is done, and the next frame starts at once, in the slot that has begun.
///           Only slots that have passed entirely are skipped.
/// A frame that is in time is shown at the end of its slot (lock) or when done (floating). The next one starts on the next grid
/// point.
enum class LatePolicy : std::uint8_t { lock, floating };

/// The clock of a walk: the machine's, or a virtual one that predicted costs advance.
enum class ClockKind : std::uint8_t { real, virtual_time };

/// How textures are read where they are drawn smaller than they are. bilinear: from the nearest mip level. trilinear: from the
/// two nearest ones, blended. adaptive: frame by frame, where a driver takes longer for two.
enum class TextureFilter : std::uint8_t { automatic, bilinear, trilinear, adaptive };

/// Whether a steered eye walks: on floors and around walls, or flies through them.
enum class WalkingMode : std::uint8_t { automatic, walk, fly };

/// Of what the image cache keeps pictures. view: of boxes in view, as fine as where they are seen. surround: of boxes all round
/// the eye, as fine as at the picture's corner, so that a turn makes none anew.
enum class ImageCache : std::uint8_t { off, view, surround };

/// What became of the accuracy that a frame guarantees. none: nothing is guaranteed. Why it was not kept: over_budget: no
/// cut of it was found within the budget. no_form: what is prepared has nothing better. stand_ins: the frame ran out of time, so
/// the rest of its cut was drawn coarse. unprepared: no prepared set was new enough.
enum class Guarantee : std::uint8_t { none, kept, over_budget, no_form, stand_ins, unprepared };

/// Who tells when a picture was shown. display: the display itself. hand_over: it does not tell, so the time at which it was
/// handed over stands for it. nothing: no picture was shown.
enum class ShownBy : std::uint8_t { nothing, hand_over, display };

/// In the enums' order.
inline constexpr std::array<std::string_view, 3> shown_by_names = {"nothing", "hand-over", "display"};
inline constexpr std::array<std::string_view, 6> guarantee_names = {"none",    "kept",      "over_budget",
                                                                    "no_form", "stand_ins", "unprepared"};
inline constexpr std::array late_policies = {
    Named{"lock", "frames appear on the grid only; a late frame skips whole slots"},
    Named{"float", "a late frame is shown as soon as it is done"},
};
inline constexpr std::array clock_kinds = {
    Named{"real", "the machine's clock"},
    Named{"virtual", "predicted costs advance the clock; the same cost table gives the same frames"},
};

inline constexpr std::array walking_modes = {
    Named{"auto", "devices whose mapping flies do, as that of 3D mice; all others walk"},
    Named{"walk", "all devices walk"},
    Named{"fly", "all devices fly, through walls too"},
};

inline constexpr std::array texture_filters = {
    Named{"auto", "bilinear on a software driver, else trilinear"},
    Named{"bilinear", "from the nearest mip level"},
    Named{"trilinear", "blended from the two nearest mip levels; a software driver takes longer for it"},
    Named{"adaptive", "trilinear; on a software driver only while all is in full detail and time is left"},
};

inline constexpr std::array image_caches = {
    Named{"off", "none: all is drawn as forms"},
    Named{"view", "of what is in view"},
    Named{"surround", "of what is all round the eye: a turn needs no new ones, a step more of them"},
};

constexpr std::string_view name_of(Guarantee guarantee) { return guarantee_names[static_cast<std::size_t>(guarantee)]; }
constexpr std::string_view name_of(ShownBy by) { return shown_by_names[static_cast<std::size_t>(by)]; }
constexpr std::string_view name_of(LatePolicy late) { return late_policies[static_cast<std::size_t>(late)].name; }
constexpr std::string_view name_of(ClockKind clock) { return clock_kinds[static_cast<std::size_t>(clock)].name; }
constexpr std::string_view name_of(ImageCache cache) { return image_caches[static_cast<std::size_t>(cache)].name; }
constexpr std::string_view name_of(TextureFilter filter) { return texture_filters[static_cast<std::size_t>(filter)].name; }

}  // namespace surefoot::rt
