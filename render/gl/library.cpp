// Shared libraries opened at run time (library.hpp).
#include "render/gl/library.hpp"

#include <dlfcn.h>

namespace surefoot::gl {

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
