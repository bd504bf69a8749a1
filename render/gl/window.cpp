// A window: X11 opened at run time, an EGL surface on it. Works under Xvfb.
#include <array>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "render/gl/egl.hpp"

namespace surefoot::gl {

namespace {

// Of <X11/Xlib.h>: only what is called here, so that building needs no X11 headers.
struct XDisplay;
using XId = unsigned long;

struct X11 {
    XDisplay* (*OpenDisplay)(const char*) = nullptr;
    int (*CloseDisplay)(XDisplay*) = nullptr;
    int (*DefaultScreen)(XDisplay*) = nullptr;
    void* (*DefaultVisual)(XDisplay*, int) = nullptr;
    XId (*VisualIDFromVisual)(void*) = nullptr;
    XId (*DefaultRootWindow)(XDisplay*) = nullptr;
    XId (*CreateSimpleWindow)(XDisplay*, XId, int, int, unsigned, unsigned, unsigned, unsigned long, unsigned long) = nullptr;
    int (*DestroyWindow)(XDisplay*, XId) = nullptr;
    int (*StoreName)(XDisplay*, XId, const char*) = nullptr;
    int (*MapWindow)(XDisplay*, XId) = nullptr;
    int (*Sync)(XDisplay*, int) = nullptr;
    int (*Pending)(XDisplay*) = nullptr;
    int (*NextEvent)(XDisplay*, void*) = nullptr;
    XId (*InternAtom)(XDisplay*, const char*, int) = nullptr;
    int (*SetWMProtocols)(XDisplay*, XId, XId*, int) = nullptr;
};

Result<X11> load_x11() {
    auto library = Library::open("libX11.so.6", "libx11-6");
    if (!library) return library.error();
    X11 x;
    const bool found =
        library->get(x.OpenDisplay, "XOpenDisplay") && library->get(x.CloseDisplay, "XCloseDisplay") &&
        library->get(x.DefaultScreen, "XDefaultScreen") && library->get(x.DefaultVisual, "XDefaultVisual") &&
        library->get(x.VisualIDFromVisual, "XVisualIDFromVisual") && library->get(x.DefaultRootWindow, "XDefaultRootWindow") &&
        library->get(x.CreateSimpleWindow, "XCreateSimpleWindow") && library->get(x.DestroyWindow, "XDestroyWindow") &&
        library->get(x.StoreName, "XStoreName") && library->get(x.MapWindow, "XMapWindow") && library->get(x.Sync, "XSync") &&
        library->get(x.Pending, "XPending") && library->get(x.NextEvent, "XNextEvent") &&
        library->get(x.InternAtom, "XInternAtom") && library->get(x.SetWMProtocols, "XSetWMProtocols");
    if (!found)
        return Error{"libX11.so.6", "The library lacks functions", "Reinstall the Debian package libx11-6",
                     ErrorKind::unsupported};
    return x;
}

/// The connection and the window; destroyed after the EGL context that draws into it.
class XWindow {
public:
    explicit XWindow(const X11& x) : x_(x) {}
    ~XWindow() {
        if (window_ != 0) x_.DestroyWindow(display_, window_);
        if (display_ != nullptr) x_.CloseDisplay(display_);
    }
    XWindow(const XWindow&) = delete;
    XWindow& operator=(const XWindow&) = delete;

    Result<void> open(model::Viewport viewport, const std::string& title) {
        const char* where = std::getenv("DISPLAY");
        const std::string remedy =
            "Run inside an X session, start one with `Xvfb :99 &` and set DISPLAY=:99, or use --backend egl";
        if (where == nullptr || *where == 0) return Error{"window", "DISPLAY is not set", remedy, ErrorKind::no_device};
        display_ = x_.OpenDisplay(where);
        if (display_ == nullptr)
            return Error{"window", std::string("No X server answers at DISPLAY ") + where, remedy, ErrorKind::no_device};
        window_ = x_.CreateSimpleWindow(display_, x_.DefaultRootWindow(display_), 0, 0, viewport.width, viewport.height, 0, 0, 0);
        // Closing is the program's to decide: without this the window manager would cut the connection, and Xlib exit().
        XId closing = x_.InternAtom(display_, "WM_DELETE_WINDOW", 0);
        x_.SetWMProtocols(display_, window_, &closing, 1);
        x_.StoreName(display_, window_, title.c_str());
        x_.MapWindow(display_, window_);
        x_.Sync(display_, 0);
        return {};
    }
    [[nodiscard]] XId visual() const { return x_.VisualIDFromVisual(x_.DefaultVisual(display_, x_.DefaultScreen(display_))); }
    void drop_events() {
        alignas(8) std::array<std::byte, 256> event;  // XEvent is 192 bytes
        while (x_.Pending(display_) > 0) x_.NextEvent(display_, event.data());
    }
    [[nodiscard]] XDisplay* display() const { return display_; }
    [[nodiscard]] XId id() const { return window_; }

private:
    X11 x_;
    XDisplay* display_ = nullptr;
    XId window_ = 0;
};

class WindowContext final : public EglContext {
public:
    WindowContext(const Egl& egl, EGLDisplay display, std::unique_ptr<XWindow> window)
        : EglContext(egl, display, false, "X11 window"), window_(std::move(window)) {}
    ~WindowContext() override {
        destroy();
        egl_.Terminate(display_);  // this display is of this window's own connection
    }
    WindowContext(const WindowContext&) = delete;
    WindowContext& operator=(const WindowContext&) = delete;

    Result<void> create_with_surface() {
        EGLConfig config = nullptr;
        if (!matching_config(config)) {
            return Error{name(), "No EGL configuration fits the screen's visual", "Use a 24-bit screen, or --backend egl",
                         ErrorKind::unsupported};
        }
        egl_.BindAPI(EGL_OPENGL_API);
        surface_ = egl_.CreateWindowSurface(display_, config, window_->id(), nullptr);
        if (surface_ == EGL_NO_SURFACE)
            return Error{name(), "No surface can be made: " + egl_.error_text(), "Use --backend egl", ErrorKind::no_device};
        if (auto made = create(config); !made) return made.error();
        egl_.SwapInterval(display_, 0);  // the frame grid decides when, not the driver
        return {};
    }
    [[nodiscard]] bool has_window() const override { return true; }
    rt::Shown present() override {
        egl_.SwapBuffers(display_, surface_);
        window_->drop_events();
        return {rt::ShownBy::hand_over, 0, 0};
    }

private:
    bool matching_config(EGLConfig& config) const {
        const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_WINDOW_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
        std::array<EGLConfig, 128> configs{};
        EGLint count = 0;
        egl_.ChooseConfig(display_, wanted.data(), configs.data(), static_cast<EGLint>(configs.size()), &count);
        for (EGLint i = 0; i < count; ++i) {
            EGLint visual = 0;
            config = configs[static_cast<std::size_t>(i)];
            egl_.GetConfigAttrib(display_, config, EGL_NATIVE_VISUAL_ID, &visual);
            if (static_cast<XId>(visual) == window_->visual()) return true;
        }
        return false;
    }
    std::unique_ptr<XWindow> window_;
};

}  // namespace

Result<std::unique_ptr<Context>> open_window(model::Viewport viewport, const std::string& title) {
    auto x = load_x11();
    if (!x) return x.error();
    auto window = std::make_unique<XWindow>(*x);
    if (auto opened = window->open(viewport, title); !opened) return opened.error();
    auto egl = load_egl();
    if (!egl) return egl.error();
    EGLDisplay display = egl->GetPlatformDisplay(EGL_PLATFORM_X11_KHR, window->display(), nullptr);
    if (display == EGL_NO_DISPLAY || egl->Initialize(display, nullptr, nullptr) != EGL_TRUE) {
        return Error{"X11 window", "EGL cannot use this X server: " + egl->error_text(),
                     "Install libegl-mesa0, or use --backend egl", ErrorKind::no_device};
    }
    auto context = std::make_unique<WindowContext>(*egl, display, std::move(window));
    if (auto made = context->create_with_surface(); !made) return made.error();
    return std::unique_ptr<Context>(std::move(context));
}

}  // namespace surefoot::gl
