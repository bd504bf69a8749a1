// A GL context of one backend: made, made current, released; presents where there is a window.
#pragma once

#include <memory>
#include <string>

#include "render/gl/api.hpp"
#include "render/gl/device.hpp"

namespace surefoot::gl {

/// Made current on the thread that opens it.
class Context {
public:
    virtual ~Context() = default;
    virtual bool make_current() = 0;
    virtual void release() = 0;
    [[nodiscard]] virtual void* find(const char* function) const = 0;
    [[nodiscard]] virtual std::string name() const = 0;  ///< for error messages
    /// True where the default framebuffer is a window: the frame is blitted there, then present() swaps.
    [[nodiscard]] virtual bool has_window() const { return false; }
    virtual void present() {}
    /// The window and its events; null without one.
    [[nodiscard]] virtual std::shared_ptr<WindowEvents> window() const { return nullptr; }
    /// Whether the driver reports resets, through glGetGraphicsResetStatus.
    [[nodiscard]] virtual bool reports_resets() const { return false; }
};

Result<std::unique_ptr<Context>> open_egl_surfaceless();
Result<std::unique_ptr<Context>> open_egl_device();
Result<std::unique_ptr<Context>> open_osmesa();
Result<std::unique_ptr<Context>> open_window(const DeviceOptions& options);

/// Opens the backend of options.kind (not null).
Result<std::unique_ptr<Context>> open_context(const DeviceOptions& options);

}  // namespace surefoot::gl
