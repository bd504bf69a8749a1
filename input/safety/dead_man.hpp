// The dead-man switch: the walk moves only while it is held. Release stops at once; a press counts after 20 ms. If it is held
// long without motion, it must be pressed again: a weight on the switch is not a hand.
#pragma once

#include <cstdint>

namespace surefoot::input {

/// Times of the dead-man switch.
struct DeadManSettings {
    std::int64_t press_ns = 20'000'000;           ///< a press counts once it lasted so long without a break
    std::int64_t idle_limit_ns = 30'000'000'000;  ///< held so long without motion, it must be pressed again; 0: never
};

/// State of the dead-man switch between two steps.
struct DeadMan {
    std::int64_t down_since_ns = -1, last_walk_ns = 0;
    bool engaged = false;
    bool must_release = false;  ///< held too long without motion: it must be released and pressed again
};

/// One step. Returns whether the walk may move. `pressed`: now, and in all reports since the last step. `walking`: motion is
/// requested.
inline bool step(DeadMan& switch_, const DeadManSettings& settings, bool pressed, bool walking, std::int64_t now_ns) {
    if (!pressed) {
        switch_ = DeadMan{};
        return false;
    }
    if (switch_.down_since_ns < 0) switch_.down_since_ns = switch_.last_walk_ns = now_ns;
    if (walking && !switch_.must_release) switch_.last_walk_ns = now_ns;
    if (settings.idle_limit_ns > 0 && now_ns - switch_.last_walk_ns > settings.idle_limit_ns) switch_.must_release = true;
    switch_.engaged = !switch_.must_release && now_ns - switch_.down_since_ns >= settings.press_ns;
    return switch_.engaged;
}

}  // namespace surefoot::input
