// GL objects that are made step by step, and freed again unless every step succeeds.
#pragma once

#include <utility>

#include "render/gl/api.hpp"

namespace surefoot::gl {

/// Frees `value` where it goes out of scope, unless keep() was called.
template <class Objects>
struct Undone {
    using Free = void (*)(const Api& gl, Objects& objects);
    Undone(const Api& api, Free with) : gl(api), free(with) {}
    ~Undone() {
        if (free != nullptr) free(gl, value);
    }
    Undone(const Undone&) = delete;
    Undone& operator=(const Undone&) = delete;
    Objects keep() {
        free = nullptr;
        return std::move(value);
    }

    const Api& gl;
    Free free;
    Objects value;
};

}  // namespace surefoot::gl
