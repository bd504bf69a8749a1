// EGL loaded at run time, and code shared by its three backends (surfaceless, device, window).
#pragma once

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <memory>
#include <string>
#include <string_view>

#include "render/gl/api.hpp"
#include "render/gl/context.hpp"

namespace surefoot::gl {

/// Pointers to the functions of EGL, loaded at run time.
struct Egl {
    decltype(&eglGetError) GetError = nullptr;
    decltype(&eglQueryString) QueryString = nullptr;
    decltype(&eglInitialize) Initialize = nullptr;
    decltype(&eglTerminate) Terminate = nullptr;
    decltype(&eglBindAPI) BindAPI = nullptr;
    decltype(&eglChooseConfig) ChooseConfig = nullptr;
    decltype(&eglGetConfigAttrib) GetConfigAttrib = nullptr;
    decltype(&eglCreateContext) CreateContext = nullptr;
    decltype(&eglDestroyContext) DestroyContext = nullptr;
    decltype(&eglCreateWindowSurface) CreateWindowSurface = nullptr;
    decltype(&eglDestroySurface) DestroySurface = nullptr;
    decltype(&eglMakeCurrent) MakeCurrent = nullptr;
    decltype(&eglSwapBuffers) SwapBuffers = nullptr;
    decltype(&eglSwapInterval) SwapInterval = nullptr;
    decltype(&eglGetCurrentContext) GetCurrentContext = nullptr;
    decltype(&eglGetProcAddress) GetProcAddress = nullptr;
    PFNEGLGETPLATFORMDISPLAYEXTPROC GetPlatformDisplay = nullptr;

    [[nodiscard]] bool client_has(std::string_view extension) const;
    [[nodiscard]] std::string error_text() const;  ///< of the last failure, e.g. "EGL_BAD_MATCH (0x3009)"
};

Result<Egl> load_egl();

/// Space-separated list holds the word.
bool lists_word(const char* list, std::string_view word);

/// Attributes for GetPlatformDisplay: reference counting of eglInitialize and eglTerminate, if the library has it. Two devices of
/// one process may share a display. `counted`: the library counts; else the display is never terminated.
struct DisplayAttributes {
    EGLint list[3] = {EGL_NONE, EGL_NONE, EGL_NONE};
    bool counted = false;
};
DisplayAttributes display_attributes(const Egl& egl);

/// A context on an EGL display; owns display reference, context and, for a window, the surface.
class EglContext : public Context {
public:
    EglContext(const Egl& egl, EGLDisplay display, bool counted, std::string name);
    ~EglContext() override;
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

    /// The configuration whose windows have this native visual; false where there is none.
    [[nodiscard]] bool window_config(unsigned long visual, EGLConfig& config) const;
    /// Core context, 4.5 down to 4.3, made current; surfaceless unless `surface` was set before.
    Result<void> create(EGLConfig config);
    bool make_current() override;
    void release() override;
    [[nodiscard]] void* find(const char* function) const override;
    [[nodiscard]] std::string name() const override { return name_; }
    [[nodiscard]] bool reports_resets() const override { return reports_resets_; }
    [[nodiscard]] EGLDisplay display() const { return display_; }

protected:
    /// Destroys context and surface. Unbinds only its own context: another device's may be current on this thread.
    void destroy();

    Egl egl_;
    EGLDisplay display_;
    EGLContext context_ = EGL_NO_CONTEXT;
    EGLSurface surface_ = EGL_NO_SURFACE;

private:
    void create_of_version(EGLConfig config, EGLint minor, bool reports_resets);
    bool counted_, reports_resets_ = false;
    std::string name_;
};

}  // namespace surefoot::gl
