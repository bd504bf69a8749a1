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

Result<Api> load_api(const std::function<void*(const char*)>& find, const std::string& place) {
    Api api;
    const char* missing = nullptr;
#define SUREFOOT_GL_LOAD(name, type)                     \
    api.name = reinterpret_cast<type>(find("gl" #name)); \
    if (api.name == nullptr && missing == nullptr) missing = "gl" #name;
    SUREFOOT_GL_FUNCTIONS(SUREFOOT_GL_LOAD)
#undef SUREFOOT_GL_LOAD
    const std::string remedy = "use a driver with OpenGL 4.5 core (Mesa 22 or newer), or --backend osmesa";
    if (api.GetIntegerv == nullptr || api.GetStringi == nullptr) return Error{place, "OpenGL could not be loaded", remedy};
    GLint major = 0;
    GLint minor = 0;
    api.GetIntegerv(GL_MAJOR_VERSION, &major);
    api.GetIntegerv(GL_MINOR_VERSION, &minor);
    api.version = 10 * major + minor;
    const std::string have = "OpenGL " + std::to_string(major) + "." + std::to_string(minor);
    if (api.version < 43) return Error{place, have + " is older than 4.3", remedy};
    if (api.version < 45 && !api.has_extension("GL_ARB_clip_control")) {
        return Error{place, have + " has no glClipControl: depth would lose its precision", remedy};
    }
    if (api.version < 44 && !api.has_extension("GL_ARB_buffer_storage")) {
        return Error{place, have + " has no glBufferStorage", remedy};
    }
    if (missing != nullptr) return Error{place, have + " has no " + missing, remedy};
    return api;
}

Result<Library> Library::open(const char* name, const char* package) {
    void* handle = dlopen(name, RTLD_NOW | RTLD_LOCAL);
    if (handle == nullptr) {
        const char* why = dlerror();
        return Error{name, why != nullptr ? why : "cannot be opened", std::string("install the Debian package ") + package};
    }
    return Library(handle);
}

void* Library::find(const char* symbol) const { return dlsym(handle_, symbol); }

}  // namespace surefoot::gl
