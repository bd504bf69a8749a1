// Loading and checking the OpenGL function table (api.hpp).
#include "render/gl/api.hpp"

#include <dlfcn.h>

#include <string>

namespace surefoot::gl {

bool Api::has_extension(std::string_view name) const {
    GLint count = 0;
    GetIntegerv(GL_NUM_EXTENSIONS, &count);
    for (GLint i = 0; i < count; ++i) {
        const auto* text = reinterpret_cast<const char*>(GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
        if (text != nullptr && name == text) return true;
    }
    return false;
}

GLenum take_errors(const Api& gl) {
    constexpr int max_errors = 16;
    const GLenum first = gl.GetError();
    GLenum next = first;
    for (int i = 1; next != GL_NO_ERROR && i < max_errors; ++i) next = gl.GetError();
    return first;
}

Result<Api> load_api(const std::function<void*(const char*)>& find, const std::string& place) {
    Api api;
    const char* missing = nullptr;
#define SUREFOOT_GL_LOAD(name, type)                     \
    api.name = reinterpret_cast<type>(find("gl" #name)); \
    if (api.name == nullptr && missing == nullptr) missing = "gl" #name;
    SUREFOOT_GL_FUNCTIONS(SUREFOOT_GL_LOAD)
#undef SUREFOOT_GL_LOAD
    const std::string remedy = "Use a driver with OpenGL 4.5 core (Mesa 22 or newer), or --backend osmesa";
    if (api.GetIntegerv == nullptr || api.GetStringi == nullptr)
        return Error{place, "OpenGL cannot be loaded", remedy, ErrorKind::no_device};
    GLint major = 0;
    GLint minor = 0;
    api.GetIntegerv(GL_MAJOR_VERSION, &major);
    api.GetIntegerv(GL_MINOR_VERSION, &minor);
    api.version = 10 * major + minor;
    const std::string have = "OpenGL " + std::to_string(major) + "." + std::to_string(minor);
    if (api.version < 43) return Error{place, have + " is older than 4.3", remedy, ErrorKind::unsupported};
    if (api.version < 45 && !api.has_extension("GL_ARB_clip_control")) {
        return Error{place, have + " has no glClipControl, so depth would lose its precision", remedy, ErrorKind::unsupported};
    }
    if (api.version < 44 && !api.has_extension("GL_ARB_buffer_storage")) {
        return Error{place, have + " has no glBufferStorage", remedy, ErrorKind::unsupported};
    }
    if (missing != nullptr) return Error{place, have + " has no " + missing, remedy, ErrorKind::unsupported};
    return api;
}

Result<Library> Library::open(const char* name, const char* package) {
    void* handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
        const char* why = dlerror();
        return Error{name, std::string("The library cannot be opened") + (why != nullptr ? std::string(": ") + why : ""),
                     std::string("Install the Debian package ") + package, ErrorKind::not_found};
    }
    return Library(handle);
}

void* Library::find(const char* symbol) const { return dlsym(handle_, symbol); }

bool is_software(std::string_view renderer) {
    for (const std::string_view name : {"llvmpipe", "softpipe", "swrast", "Software"}) {
        if (renderer.find(name) != std::string_view::npos) return true;
    }
    return false;
}

}  // namespace surefoot::gl
