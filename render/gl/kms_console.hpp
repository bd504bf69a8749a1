// The text console below a screen: while pictures are shown it neither draws nor goes dark.
#pragma once

namespace surefoot::gl {

/// Puts the console that this process was started on into graphics mode, and back at its end. Nothing where it has none: then
/// nobody types there, and the kernel's text lies below the picture.
class GraphicsConsole {
public:
    GraphicsConsole();
    ~GraphicsConsole();
    GraphicsConsole(const GraphicsConsole&) = delete;
    GraphicsConsole& operator=(const GraphicsConsole&) = delete;

private:
    int file_ = -1;
    int mode_before_ = 0;
};

}  // namespace surefoot::gl
