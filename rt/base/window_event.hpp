// What the visitor of a window does: keys, pointer, focus, closing. Plain data, of no window system.
#pragma once

#include <array>
#include <cstdint>

namespace surefoot {

/// One event of a window, in the order in which the window system sent it.
struct WindowEvent {
    enum class Kind : std::uint8_t {
        key_down,     ///< also while the key repeats; a repeating key sends no key_up in between
        key_up,       ///< of a key that was down when the keyboard was another window's too
        button_down,  ///< of the pointer: 1 left, 2 middle, 3 right
        button_up,    ///< of the pointer
        motion,       ///< of the pointer
        focus_in,     ///< the keyboard belongs to the window, wherever the pointer is
        focus_out,    ///< no key_up comes from now on
        held_keys,    ///< which keys are down: after the focus came, or the pointer
        pointer_out,  ///< the pointer left the window
        resized,      ///< x, y: its new size
        close,        ///< the window is to be closed
    };
    Kind kind = Kind::motion;
    std::uint32_t code = 0;                   ///< of a key: below 256, one a key; of a button: its number
    std::uint32_t symbol = 0;                 ///< X keysym that the key has without modifiers
    std::int32_t x = 0, y = 0;                ///< of the pointer: pixels of the window, from its upper left corner
    std::int32_t x_screen = 0, y_screen = 0;  ///< of the pointer: pixels of the screen
    std::int64_t stamp_ns = 0;                ///< CLOCK_MONOTONIC when it was read
    std::array<std::uint8_t, 32> held = {};   ///< held_keys: a bit a code
};

}  // namespace surefoot
