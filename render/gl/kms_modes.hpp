// Screens and their modes as plain data: reading "1920x1080@60", choosing a screen and its mode. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::gl {

/// A mode that a screen can show.
struct ScreenMode {
    std::uint32_t width = 0, height = 0;  ///< pixels
    std::int64_t refresh_ns = 0;          ///< of its timings, exactly rounded
    bool preferred = false;               ///< by the screen
    bool interlaced = false;
};

/// What a user requests.
struct ModeRequest {
    std::uint32_t width = 0, height = 0;  ///< 0: the screen's preferred mode
    double rate_hz = 0;                   ///< 0: the preferred one of that size, else the fastest
};

/// A connector of a card, and what hangs on it.
struct Screen {
    std::string card;  ///< "/dev/dri/card0"
    std::string name;  ///< "HDMI-A-1"
    std::uint32_t connector = 0;
    bool connected = false;
    std::vector<ScreenMode> modes;
    std::optional<bool> counts_refreshes;  ///< whether pictures can be held to them; not known of a screen that shows nothing
};

/// Every connector of every card here. Asks the screens themselves, so it may take a second. An Error where there is no card, or
/// none that this user may open.
Result<std::vector<Screen>> find_screens();

/// "1920x1080", "1920x1080@60", "@59.94" or "" (the preferred mode). Anything else is an Error.
Result<ModeRequest> read_mode(std::string_view text);

/// "1920x1080@59.94".
std::string in_words(const ScreenMode& mode);
double rate_hz(const ScreenMode& mode);

/// The screen of this name; "": the first that is connected. An Error lists those that are there.
Result<const Screen*> choose_screen(std::span<const Screen> screens, std::string_view name);

/// The screen's mode that fits the request. A rate may differ by half a per cent: 59.94 is 60. An Error lists the modes.
Result<ScreenMode> choose_mode(const Screen& screen, const ModeRequest& request);

}  // namespace surefoot::gl
