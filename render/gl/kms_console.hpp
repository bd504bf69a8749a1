// The text console below a screen: while pictures are shown it neither draws nor goes dark.
#pragma once

namespace surefoot::gl {

/// Puts the console that this process was started on into graphics mode, and back at its end. Nothing where the process has no
/// console. `keyboard_off`: Ctrl-C there would end a service; a person who walks wants it.
class GraphicsConsole {
public:
    explicit GraphicsConsole(bool keyboard_off);
    ~GraphicsConsole();
    GraphicsConsole(const GraphicsConsole&) = delete;
    GraphicsConsole& operator=(const GraphicsConsole&) = delete;

private:
    int file_ = -1;
    int mode_before_ = 0, keyboard_before_ = 0;
    bool keyboard_off_ = false;
};

}  // namespace surefoot::gl
