// What is drawn again and again on a terminal: a whole screen with keys, or some lines in place. Afterwards the terminal is as it
// was.
#pragma once

#include <termios.h>

#include <cstdint>
#include <span>
#include <string>

namespace surefoot::cli {

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

/// Redraws some lines in place on stdout; the cursor is hidden as long as it lives.
class Redraw {
public:
    Redraw();
    ~Redraw();
    Redraw(const Redraw&) = delete;
    Redraw& operator=(const Redraw&) = delete;
    /// Cut to the terminal's size; the last line counts what does not fit.
    void draw(std::span<const std::string> lines);

private:
    std::size_t drawn_ = 0;
};

}  // namespace surefoot::cli
