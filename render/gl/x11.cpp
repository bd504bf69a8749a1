// Loading of Xlib, and what its servers refuse.
#include "render/gl/x11.hpp"

#include <fmt/format.h>

#include <atomic>
#include <iterator>
#include <string_view>

#include "render/gl/api.hpp"

namespace surefoot::gl::x11 {

namespace {

bool load_windows(const Library& library, Functions& x) {
    return library.get(x.OpenDisplay, "XOpenDisplay") && library.get(x.CloseDisplay, "XCloseDisplay") &&
           library.get(x.ConnectionNumber, "XConnectionNumber") && library.get(x.DefaultScreen, "XDefaultScreen") &&
           library.get(x.DisplayWidth, "XDisplayWidth") && library.get(x.DisplayHeight, "XDisplayHeight") &&
           library.get(x.DefaultVisual, "XDefaultVisual") && library.get(x.VisualIDFromVisual, "XVisualIDFromVisual") &&
           library.get(x.DefaultRootWindow, "XDefaultRootWindow") && library.get(x.CreateSimpleWindow, "XCreateSimpleWindow") &&
           library.get(x.DestroyWindow, "XDestroyWindow") && library.get(x.StoreName, "XStoreName") &&
           library.get(x.MapWindow, "XMapWindow") && library.get(x.MoveResizeWindow, "XMoveResizeWindow") &&
           library.get(x.SetInputFocus, "XSetInputFocus") && library.get(x.InternAtom, "XInternAtom") &&
           library.get(x.SetWMProtocols, "XSetWMProtocols") && library.get(x.ChangeProperty, "XChangeProperty") &&
           library.get(x.GetWindowProperty, "XGetWindowProperty") && library.get(x.Free, "XFree");
}

bool load_events(const Library& library, Functions& x) {
    return library.get(x.SelectInput, "XSelectInput") && library.get(x.Sync, "XSync") && library.get(x.Flush, "XFlush") &&
           library.get(x.Pending, "XPending") && library.get(x.NextEvent, "XNextEvent") &&
           library.get(x.SendEvent, "XSendEvent") && library.get(x.GrabPointer, "XGrabPointer") &&
           library.get(x.UngrabPointer, "XUngrabPointer") && library.get(x.WarpPointer, "XWarpPointer") &&
           library.get(x.CreateBitmapFromData, "XCreateBitmapFromData") &&
           library.get(x.CreatePixmapCursor, "XCreatePixmapCursor") && library.get(x.FreePixmap, "XFreePixmap") &&
           library.get(x.RefreshKeyboardMapping, "XRefreshKeyboardMapping") &&
           library.get(x.SetErrorHandler, "XSetErrorHandler") && library.get(x.KeycodeToKeysym, "XkbKeycodeToKeysym") &&
           library.get(x.SetDetectableAutoRepeat, "XkbSetDetectableAutoRepeat");
}

/// The handler has no argument of its caller's, so what it counts belongs to the process: the count, the error, the request.
std::atomic<std::uint64_t>& refused() {
    static std::atomic<std::uint64_t> all{0};
    return all;
}

int count_refusal(Display* /*display*/, void* event) {
    const auto& error = *static_cast<const ErrorEvent*>(event);
    const std::uint64_t last = (std::uint64_t{error.error} << 8U) | error.request;
    std::uint64_t before = refused().load();
    while (!refused().compare_exchange_weak(before, (((before >> 16U) + 1) << 16U) | last)) {
    }
    return 0;
}

constexpr std::string_view error_names[] = {"no error",  "BadRequest", "BadValue",         "BadWindow", "BadPixmap",
                                            "BadAtom",   "BadCursor",  "BadFont",          "BadMatch",  "BadDrawable",
                                            "BadAccess", "BadAlloc",   "BadColor",         "BadGC",     "BadIDChoice",
                                            "BadName",   "BadLength",  "BadImplementation"};

}  // namespace

Refusals refusals() {
    const std::uint64_t all = refused().load();
    return {static_cast<std::uint32_t>(all >> 16U), static_cast<int>((all >> 8U) & 0xffU), static_cast<int>(all & 0xffU)};
}

std::string Refusals::text() const {
    if (count == 0) return {};
    const auto known = static_cast<std::size_t>(error);
    const std::string_view name = known < std::size(error_names) ? error_names[known] : "an extension's";
    return fmt::format("{} (error {}) of request {}", name, error, request);
}

void count_refusals(const Functions& x) { x.SetErrorHandler(count_refusal); }

Result<Functions> load() {
    auto library = Library::open("libX11.so.6", "libx11-6");
    if (!library) return library.error();
    Functions x;
    if (!load_windows(*library, x) || !load_events(*library, x))
        return Error{"libX11.so.6", "The library lacks functions", "Reinstall the Debian package libx11-6",
                     ErrorKind::unsupported};
    if (library->get(x.InitThreads, "XInitThreads")) x.InitThreads();  // more often than once does no harm
    return x;
}

}  // namespace surefoot::gl::x11
