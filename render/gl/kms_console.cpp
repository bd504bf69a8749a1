// The text console (kms_console.hpp).
#include "render/gl/kms_console.hpp"

#include <fcntl.h>
#include <linux/kd.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <initializer_list>

namespace surefoot::gl {

GraphicsConsole::GraphicsConsole(bool keyboard_off) {
    // Standard input is the console of a service that was given one; a shell's programs may have it redirected.
    for (const int file : {::fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0), ::open("/dev/tty", O_RDWR | O_CLOEXEC | O_NOCTTY)}) {
        const bool taken =
            file >= 0 && file_ < 0 && ::ioctl(file, KDGETMODE, &mode_before_) == 0 && ::ioctl(file, KDSETMODE, KD_GRAPHICS) == 0;
        if (taken)
            file_ = file;
        else if (file >= 0)
            ::close(file);
    }
    if (keyboard_off && file_ >= 0 && ::ioctl(file_, KDGKBMODE, &keyboard_before_) == 0)
        keyboard_off_ = ::ioctl(file_, KDSKBMODE, K_OFF) == 0;
}

GraphicsConsole::~GraphicsConsole() {
    if (file_ < 0) return;
    if (keyboard_off_) ::ioctl(file_, KDSKBMODE, keyboard_before_);
    ::ioctl(file_, KDSETMODE, mode_before_);
    ::close(file_);
}

}  // namespace surefoot::gl
