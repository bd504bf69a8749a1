// Loading of Xlib.
#include "render/gl/x11.hpp"

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

}  // namespace

Result<Functions> load() {
    auto library = Library::open("libX11.so.6", "libx11-6");
    if (!library) return library.error();
    Functions x;
    if (!load_windows(*library, x) || !load_events(*library, x))
        return Error{"libX11.so.6", "The library lacks functions", "Reinstall the Debian package libx11-6",
                     ErrorKind::unsupported};
    return x;
}

}  // namespace surefoot::gl::x11
