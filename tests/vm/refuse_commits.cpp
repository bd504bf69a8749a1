// Loaded before a program's libraries in a guest: while the file /run/refuse exists, no picture gets onto a screen. The card's
// driver seems to refuse every atomic commit as invalid, with a mode and without.
#include <dlfcn.h>
#include <drm.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>

extern "C" int ioctl(int file, unsigned long request, ...) noexcept {
    using Ioctl = int (*)(int, unsigned long, void*);
    static const auto real = reinterpret_cast<Ioctl>(dlsym(RTLD_NEXT, "ioctl"));
    std::va_list rest;
    va_start(rest, request);
    void* const argument = va_arg(rest, void*);
    va_end(rest);
    if (request == DRM_IOCTL_MODE_ATOMIC && ::access("/run/refuse", F_OK) == 0) {
        errno = EINVAL;
        return -1;
    }
    return real(file, request, argument);
}
