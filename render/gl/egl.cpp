// EGL at run time, and its surfaceless and device backends (egl.hpp).
#include "render/gl/egl.hpp"

#include <array>
#include <cstdio>
#include <utility>

namespace surefoot::gl {

bool lists_word(const char* list, std::string_view word) {
    if (list == nullptr) return false;
    std::string_view rest(list);
    while (!rest.empty()) {
        const std::size_t end = rest.find(' ');
        if (rest.substr(0, end) == word) return true;
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end + 1);
    }
    return false;
}

bool Egl::client_has(std::string_view extension) const {
    return lists_word(QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), extension);
}

std::string Egl::error_text() const {
    const EGLint code = GetError();
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "EGL error 0x%04x", static_cast<unsigned>(code));
    return text.data();
}

Result<Egl> load_egl() {
    auto library = Library::open("libEGL.so.1", "libegl1 (and libegl-mesa0)");
    if (!library) return library.error();
    Egl egl;
    const bool found =
        library->get(egl.GetError, "eglGetError") && library->get(egl.QueryString, "eglQueryString") &&
        library->get(egl.Initialize, "eglInitialize") && library->get(egl.Terminate, "eglTerminate") &&
        library->get(egl.BindAPI, "eglBindAPI") && library->get(egl.ChooseConfig, "eglChooseConfig") &&
        library->get(egl.GetConfigAttrib, "eglGetConfigAttrib") && library->get(egl.CreateContext, "eglCreateContext") &&
        library->get(egl.DestroyContext, "eglDestroyContext") &&
        library->get(egl.CreateWindowSurface, "eglCreateWindowSurface") &&
        library->get(egl.DestroySurface, "eglDestroySurface") && library->get(egl.MakeCurrent, "eglMakeCurrent") &&
        library->get(egl.SwapBuffers, "eglSwapBuffers") && library->get(egl.SwapInterval, "eglSwapInterval") &&
        library->get(egl.GetProcAddress, "eglGetProcAddress") && library->get(egl.GetCurrentContext, "eglGetCurrentContext");
    if (found) {
        egl.GetPlatformDisplay =
            reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(egl.GetProcAddress("eglGetPlatformDisplayEXT"));
    }
    if (!found || egl.GetPlatformDisplay == nullptr) {
        return Error{"libEGL.so.1", "The library lacks functions of EGL 1.5", "Install a current libegl1 (Mesa 22 or newer)",
                     ErrorKind::unsupported};
    }
    return egl;
}

DisplayAttributes display_attributes(const Egl& egl) {
    DisplayAttributes attributes;
    if (egl.client_has("EGL_KHR_display_reference")) {
        attributes.list[0] = EGL_TRACK_REFERENCES_KHR;
        attributes.list[1] = EGL_TRUE;
        attributes.counted = true;
    }
    return attributes;
}

EglContext::EglContext(const Egl& egl, EGLDisplay display, bool counted, std::string name)
    : egl_(egl), display_(display), counted_(counted), name_(std::move(name)) {}

EglContext::~EglContext() {
    destroy();
    if (counted_) egl_.Terminate(display_);
}

void EglContext::destroy() {
    if (context_ == EGL_NO_CONTEXT && surface_ == EGL_NO_SURFACE) return;
    if (egl_.GetCurrentContext() == context_) EglContext::release();
    if (context_ != EGL_NO_CONTEXT) egl_.DestroyContext(display_, context_);
    if (surface_ != EGL_NO_SURFACE) egl_.DestroySurface(display_, surface_);
    context_ = EGL_NO_CONTEXT;
    surface_ = EGL_NO_SURFACE;
}

bool EglContext::window_config(unsigned long visual, EGLConfig& config) const {
    const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_WINDOW_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    std::array<EGLConfig, 128> configs{};
    EGLint count = 0;
    egl_.ChooseConfig(display_, wanted.data(), configs.data(), static_cast<EGLint>(configs.size()), &count);
    for (EGLint i = 0; i < count; ++i) {
        EGLint native = 0;
        config = configs[static_cast<std::size_t>(i)];
        egl_.GetConfigAttrib(display_, config, EGL_NATIVE_VISUAL_ID, &native);
        if (static_cast<std::uint32_t>(native) == visual) return true;
    }
    return false;
}

void EglContext::create_of_version(EGLConfig config, EGLint minor, bool reports_resets) {
    const std::array<EGLint, 9> wanted{EGL_CONTEXT_MAJOR_VERSION,
                                       4,
                                       EGL_CONTEXT_MINOR_VERSION,
                                       minor,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                       reports_resets ? EGL_CONTEXT_OPENGL_RESET_NOTIFICATION_STRATEGY : EGL_NONE,
                                       reports_resets ? EGL_LOSE_CONTEXT_ON_RESET : EGL_NONE,
                                       EGL_NONE};
    context_ = egl_.CreateContext(display_, config, EGL_NO_CONTEXT, wanted.data());
    reports_resets_ = reports_resets && context_ != EGL_NO_CONTEXT;
}

Result<void> EglContext::create(EGLConfig config) {
    if (egl_.BindAPI(EGL_OPENGL_API) != EGL_TRUE) {
        return Error{name_, "The driver has no desktop OpenGL", "Install libgl1-mesa-dri, or use --backend osmesa",
                     ErrorKind::unsupported};
    }
    for (const EGLint minor : {5, 4, 3}) {
        create_of_version(config, minor, true);  // software GL refuses: it cannot be reset
        if (context_ == EGL_NO_CONTEXT) create_of_version(config, minor, false);
        if (context_ != EGL_NO_CONTEXT) break;
    }
    if (context_ == EGL_NO_CONTEXT) {
        return Error{name_, "The driver makes no OpenGL 4.3 core context: " + egl_.error_text(),
                     "Install libgl1-mesa-dri (22 or newer)", ErrorKind::unsupported};
    }
    if (!make_current()) {
        return Error{name_, "The context cannot be made current: " + egl_.error_text(), "See `surefoot doctor`",
                     ErrorKind::no_device};
    }
    return {};
}

bool EglContext::make_current() { return egl_.MakeCurrent(display_, surface_, surface_, context_) == EGL_TRUE; }
void EglContext::release() { egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
void* EglContext::find(const char* function) const { return reinterpret_cast<void*>(egl_.GetProcAddress(function)); }

namespace {

/// Initialises the display and makes a surfaceless context on it.
Result<std::unique_ptr<Context>> surfaceless_on(const Egl& egl, EGLDisplay display, bool counted, const std::string& name) {
    const std::string remedy = "Install libgl1-mesa-dri, or use --backend osmesa";
    if (display == EGL_NO_DISPLAY || egl.Initialize(display, nullptr, nullptr) != EGL_TRUE) {
        return Error{name, "The display cannot be initialised: " + egl.error_text(), remedy, ErrorKind::no_device};
    }
    auto context = std::make_unique<EglContext>(egl, display, counted, name);
    if (!lists_word(egl.QueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
        return Error{name, "The driver has no surfaceless contexts", remedy, ErrorKind::unsupported};
    }
    const std::array<EGLint, 5> wanted{EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (egl.ChooseConfig(display, wanted.data(), &config, 1, &count) != EGL_TRUE || count == 0) {
        return Error{name, "The driver offers no configuration for desktop OpenGL", remedy, ErrorKind::unsupported};
    }
    if (auto made = context->create(config); !made) return made.error();
    return std::unique_ptr<Context>(std::move(context));
}

}  // namespace

Result<std::unique_ptr<Context>> open_egl_surfaceless() {
    auto egl = load_egl();
    if (!egl) return egl.error();
    const std::string name = "EGL surfaceless";
    if (!egl->client_has("EGL_MESA_platform_surfaceless")) {
        return Error{name, "This EGL has no surfaceless platform", "Install libegl-mesa0, or use --backend device or osmesa",
                     ErrorKind::unsupported};
    }
    const DisplayAttributes attributes = display_attributes(*egl);
    EGLDisplay display = egl->GetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, nullptr, attributes.list);
    return surfaceless_on(*egl, display, attributes.counted, name);
}

Result<std::unique_ptr<Context>> open_egl_device() {
    auto egl = load_egl();
    if (!egl) return egl.error();
    const std::string name = "EGL device";
    PFNEGLQUERYDEVICESEXTPROC query = nullptr;
    if (egl->client_has("EGL_EXT_platform_device")) {
        query = reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(egl->GetProcAddress("eglQueryDevicesEXT"));
    }
    if (query == nullptr)
        return Error{name, "This EGL cannot list devices", "Use --backend egl or osmesa", ErrorKind::unsupported};
    std::array<EGLDeviceEXT, 32> devices{};
    EGLint count = 0;
    query(static_cast<EGLint>(devices.size()), devices.data(), &count);
    const DisplayAttributes attributes = display_attributes(*egl);
    Error last{name, "There is no device", "Give the user access to /dev/dri (group render), or use --backend egl",
               ErrorKind::no_device};
    for (EGLint i = 0; i < count; ++i) {
        EGLDisplay display =
            egl->GetPlatformDisplay(EGL_PLATFORM_DEVICE_EXT, devices[static_cast<std::size_t>(i)], attributes.list);
        auto context = surfaceless_on(*egl, display, attributes.counted, name + " " + std::to_string(i));
        if (context) return context;
        last = context.error();
    }
    return last;
}

}  // namespace surefoot::gl
