// Of Xlib what is called here: functions loaded at run time, and events as they lie in memory. Building needs no X11 headers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "rt/base/result.hpp"

namespace surefoot::gl::x11 {

struct Display;  ///< Xlib's own
using Id = unsigned long;

/// Pointers to the functions of Xlib. Each name without its X.
struct Functions {
    Display* (*OpenDisplay)(const char*) = nullptr;
    int (*CloseDisplay)(Display*) = nullptr;
    int (*ConnectionNumber)(Display*) = nullptr;
    int (*DefaultScreen)(Display*) = nullptr;
    int (*DisplayWidth)(Display*, int) = nullptr;
    int (*DisplayHeight)(Display*, int) = nullptr;
    void* (*DefaultVisual)(Display*, int) = nullptr;
    Id (*VisualIDFromVisual)(void*) = nullptr;
    Id (*DefaultRootWindow)(Display*) = nullptr;
    Id (*CreateSimpleWindow)(Display*, Id, int, int, unsigned, unsigned, unsigned, unsigned long, unsigned long) = nullptr;
    int (*DestroyWindow)(Display*, Id) = nullptr;
    int (*StoreName)(Display*, Id, const char*) = nullptr;
    int (*SelectInput)(Display*, Id, long) = nullptr;
    int (*MapWindow)(Display*, Id) = nullptr;
    int (*MoveResizeWindow)(Display*, Id, int, int, unsigned, unsigned) = nullptr;
    int (*SetInputFocus)(Display*, Id, int, unsigned long) = nullptr;
    int (*Sync)(Display*, int) = nullptr;
    int (*Flush)(Display*) = nullptr;
    int (*Pending)(Display*) = nullptr;
    int (*NextEvent)(Display*, void*) = nullptr;
    int (*SendEvent)(Display*, Id, int, long, void*) = nullptr;
    Id (*InternAtom)(Display*, const char*, int) = nullptr;
    int (*SetWMProtocols)(Display*, Id, Id*, int) = nullptr;
    int (*ChangeProperty)(Display*, Id, Id, Id, int, int, const unsigned char*, int) = nullptr;
    int (*GetWindowProperty)(Display*, Id, Id, long, long, int, Id, Id*, int*, unsigned long*, unsigned long*,
                             unsigned char**) = nullptr;
    int (*Free)(void*) = nullptr;
    int (*GrabPointer)(Display*, Id, int, unsigned, int, int, Id, Id, unsigned long) = nullptr;
    int (*UngrabPointer)(Display*, unsigned long) = nullptr;
    int (*WarpPointer)(Display*, Id, Id, int, int, unsigned, unsigned, int, int) = nullptr;
    Id (*CreateBitmapFromData)(Display*, Id, const char*, unsigned, unsigned) = nullptr;
    Id (*CreatePixmapCursor)(Display*, Id, Id, void*, void*, unsigned, unsigned) = nullptr;
    int (*FreePixmap)(Display*, Id) = nullptr;
    int (*RefreshKeyboardMapping)(void*) = nullptr;
    void* (*SetErrorHandler)(int (*)(Display*, void*)) = nullptr;
    Id (*KeycodeToKeysym)(Display*, unsigned char, int, int) = nullptr;
    int (*SetDetectableAutoRepeat)(Display*, int, int*) = nullptr;
    int (*InitThreads)() = nullptr;  ///< null where the library lacks it
};

/// Prepares the library for threads too. Call it before the process opens its first connection.
Result<Functions> load();

/// Requests of this process that X servers have refused so far, and the last of them by its protocol numbers.
struct Refusals {
    std::uint32_t count = 0;
    int error = 0, request = 0;  ///< of the last
    /// "BadValue (error 2) of request 1"; empty where there is none.
    [[nodiscard]] std::string text() const;
};
Refusals refusals();
/// Counts refused requests from now on. Xlib's own handler would end the process.
void count_refusals(const Functions& x);

/// What all events begin with.
struct AnyEvent {
    int type;
    unsigned long serial;
    int sent;
    Display* display;
    Id window;
};

/// KeyPress, KeyRelease, ButtonPress, ButtonRelease and MotionNotify.
struct PointerEvent {
    AnyEvent any;
    Id root, child;
    unsigned long time_ms;
    int x, y, x_root, y_root;
    unsigned state, detail;  ///< the key's code, or the button
    int same_screen;
};

/// EnterNotify and LeaveNotify.
struct CrossingEvent {
    AnyEvent any;
    Id root, child;
    unsigned long time_ms;
    int x, y, x_root, y_root;
    int mode, detail, same_screen, focus;
    unsigned state;
};

/// FocusIn and FocusOut.
struct FocusEvent {
    AnyEvent any;
    int mode, detail;
};

/// KeymapNotify: the keys that are down, a bit a code.
struct KeymapEvent {
    AnyEvent any;
    unsigned char keys[32];
};

/// XErrorEvent: no event of the queue.
struct ErrorEvent {
    int type;
    Display* display;
    Id resource;
    unsigned long serial;
    unsigned char error, request, minor;
};

/// ConfigureNotify.
struct ConfigureEvent {
    AnyEvent any;
    Id configured;
    int x, y, width, height, border;
    Id above;
    int override_redirect;
};

/// ClientMessage of five numbers.
struct MessageEvent {
    AnyEvent any;
    Id type;
    int format;
    long data[5];
};

/// Room for any event, as Xlib fills it: 24 longs.
union Event {
    int type;
    AnyEvent any;
    PointerEvent pointer;
    CrossingEvent crossing;
    FocusEvent focus;
    KeymapEvent keymap;
    ConfigureEvent configure;
    MessageEvent message;
    std::array<long, 24> room;
};
static_assert(sizeof(Event) == 24 * sizeof(long));

}  // namespace surefoot::gl::x11
