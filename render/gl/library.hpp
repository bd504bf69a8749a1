// A shared library opened at run time: what is absent is an error that names the package to install.
#pragma once

#include <memory>
#include <string>

#include "rt/base/result.hpp"

namespace surefoot::gl {

/// Closed never: drivers leave threads and exit handlers behind that live in their code.
class Library {
public:
    /// name: soname; package: Debian package that brings it.
    static Result<Library> open(const char* name, const char* package);
    [[nodiscard]] void* find(const char* symbol) const;
    /// Fills `function`; false where the library has no such symbol.
    template <class F>
    bool get(F& function, const char* symbol) const {
        function = reinterpret_cast<F>(find(symbol));
        return function != nullptr;
    }

private:
    explicit Library(void* handle) : handle_(handle) {}
    void* handle_;
};

}  // namespace surefoot::gl
