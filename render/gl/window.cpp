// The context of a window: an EGL surface on it, by a connection to the X server of its own. Works under Xvfb.
#include <array>
#include <memory>
#include <utility>

#include "render/gl/egl.hpp"
#include "render/gl/window_events.hpp"
#include "render/gl/x11.hpp"

namespace surefoot::gl {

namespace {

/// The driver's own connection. Nobody reads its events: it selects none, and the window belongs to another.
class DrawingConnection {
public:
    explicit DrawingConnection(const x11::Functions& x) : x_(x), display_(x.OpenDisplay(nullptr)) {}
    ~DrawingConnection() {
        if (display_ != nullptr) x_.CloseDisplay(display_);
    }
    DrawingConnection(const DrawingConnection&) = delete;
    DrawingConnection& operator=(const DrawingConnection&) = delete;

    [[nodiscard]] x11::Id visual() const { return x_.VisualIDFromVisual(x_.DefaultVisual(display_, x_.DefaultScreen(display_))); }
    [[nodiscard]] x11::Display* display() const { return display_; }
    void flush() { x_.Flush(display_); }

private:
    x11::Functions x_;
    x11::Display* display_;
};

class WindowContext final : public EglContext {
public:
    WindowContext(const Egl& egl, EGLDisplay display, std::shared_ptr<WindowEvents> window,
                  std::unique_ptr<DrawingConnection> connection)
        : EglContext(egl, display, false, "X11 window"), window_(std::move(window)), connection_(std::move(connection)) {}
    ~WindowContext() override {
        destroy();
        egl_.Terminate(display_);  // this display is of this window's own connection
    }
    WindowContext(const WindowContext&) = delete;
    WindowContext& operator=(const WindowContext&) = delete;

    Result<void> create_with_surface() {
        EGLConfig config = nullptr;
        if (!window_config(connection_->visual(), config)) {
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
    [[nodiscard]] std::shared_ptr<WindowEvents> window() const override { return window_; }
    [[nodiscard]] Surface surface() const override {
        const WindowSize size = window_->size();
        return {size.width, size.height, false};
    }
    rt::Shown present() override {
        if (PresentTimes* const times = window_->present_times()) times->handed();
        egl_.SwapBuffers(display_, surface_);
        connection_->flush();  // a software driver leaves its picture in Xlib's buffer
        return {rt::ShownBy::hand_over, 0, 0};
    }

private:
    std::shared_ptr<WindowEvents> window_;
    std::unique_ptr<DrawingConnection> connection_;  // goes first
};

}  // namespace

Result<std::unique_ptr<Context>> open_window(const DeviceOptions& options) {
    auto window = WindowEvents::open(options.viewport, options.window_title, options.fullscreen);
    if (!window) return window.error();
    auto x = x11::load();
    if (!x) return x.error();
    auto connection = std::make_unique<DrawingConnection>(*x);
    if (connection->display() == nullptr)
        return Error{"window", "The X server refuses a second connection", "Close other programs, or use --backend egl",
                     ErrorKind::no_device};
    auto egl = load_egl();
    if (!egl) return egl.error();
    EGLDisplay display = egl->GetPlatformDisplay(EGL_PLATFORM_X11_KHR, connection->display(), nullptr);
    if (display == EGL_NO_DISPLAY || egl->Initialize(display, nullptr, nullptr) != EGL_TRUE) {
        return Error{"X11 window", "EGL cannot use this X server: " + egl->error_text(),
                     "Install libegl-mesa0, or use --backend egl", ErrorKind::no_device};
    }
    auto context = std::make_unique<WindowContext>(*egl, display, std::move(*window), std::move(connection));
    if (auto made = context->create_with_surface(); !made) return made.error();
    return std::unique_ptr<Context>(std::move(context));
}

}  // namespace surefoot::gl
