// A whole screen to draw on, and keys; the terminal is as it was when it goes.
#pragma once

#include <termios.h>

#include <cstdint>
#include <span>
#include <string>

#include "tools/monitor/view.hpp"

namespace surefoot::cli {

/// Colour, characters and size of stdout as it is now.
monitor::Look terminal_look(bool colour);

/// The other screen of the terminal on stdout, without a cursor; keys come at once and are not shown. Ctrl-Z does nothing
/// meanwhile (the shell would inherit the screen).
class FullScreen {
public:
    FullScreen();
    ~FullScreen();
    FullScreen(const FullScreen&) = delete;
    FullScreen& operator=(const FullScreen&) = delete;
    void draw(std::span<const std::string> lines);
    /// A key, or 0 when none came in time or a signal did.
    [[nodiscard]] char wait_key(std::int64_t timeout_ms);

private:
    termios before_{};
    bool keys_ = false;       ///< stdin is a terminal
    bool keys_over_ = false;  ///< stdin has ended
};

}  // namespace surefoot::cli
