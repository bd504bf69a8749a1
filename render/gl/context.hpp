// A GL context of one backend: made, made current, released; presents where there is a window.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "render/gl/api.hpp"
#include "render/gl/device.hpp"
#include "render/gl/pixel_rows.hpp"

namespace surefoot::gl {

/// Made current on the thread that opens it.
class Context {
public:
    virtual ~Context() = default;
    virtual bool make_current() = 0;
    virtual void release() = 0;
    [[nodiscard]] virtual void* find(const char* function) const = 0;
    [[nodiscard]] virtual std::string name() const = 0;  ///< for error messages
    /// Whether the driver reports resets, through glGetGraphicsResetStatus.
    [[nodiscard]] virtual bool reports_resets() const { return false; }

    /// True where the default framebuffer is a window: the frame is blitted there, then present() swaps.
    [[nodiscard]] virtual bool has_window() const { return false; }
    /// The window and its events; null without one.
    [[nodiscard]] virtual std::shared_ptr<WindowEvents> window() const { return nullptr; }
    /// Of the default framebuffer. Without a size: the picture's own.
    [[nodiscard]] virtual Surface surface() const { return {}; }
    /// Memory that the picture is copied to before present(), where there is no window.
    [[nodiscard]] virtual PixelRows pixel_rows() { return {}; }
    /// What was drawn must be done before present(): the screen does not wait for it.
    [[nodiscard]] virtual bool presents_at_once() const { return false; }
    /// Hands the picture over, and waits until it is shown where the display tells.
    virtual rt::Shown present() { return {rt::ShownBy::hand_over, 0, 0}; }
    /// Device::refreshes(), watch_screen() and the screen's part of lost().
    [[nodiscard]] virtual rt::Refreshes refreshes() const { return {0, 0}; }
    virtual std::vector<std::string> watch_screen() { return {}; }
    virtual void wait_for_flips(bool /*wait*/) {}
    [[nodiscard]] virtual bool lost() const { return false; }
};

Result<std::unique_ptr<Context>> open_egl_surfaceless();
Result<std::unique_ptr<Context>> open_egl_device();
Result<std::unique_ptr<Context>> open_osmesa();
Result<std::unique_ptr<Context>> open_window(const DeviceOptions& options);
Result<std::unique_ptr<Context>> open_kms(const ScreenOptions& options, model::Viewport picture);

/// Opens the backend of options.kind (not null).
Result<std::unique_ptr<Context>> open_context(const DeviceOptions& options);

}  // namespace surefoot::gl
