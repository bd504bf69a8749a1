// How many fragments a driver draws: its own count, where it has one. Benches alone wait for such counts.
#pragma once

#include <dlfcn.h>

#include <cstdint>
#include <type_traits>

namespace surefoot::bench {

/// What was drawn: fragments that the rasteriser made, hidden and cut out ones among them, and those that were written.
struct Fragments {
    double made = 0, written = 0;
};

/// Counts what is drawn between begin() and end(), in the context that is current. The driver may count whole blocks of pixels
/// where a triangle covers a part of one: llvmpipe counts 4 x 4.
class FragmentCounter {
public:
    /// False: the driver does not count, and there is nothing to end.
    bool begin() {
        if (begin_query_ == nullptr && !load()) return false;
        while (get_error_() != no_error) continue;
        begin_query_(samples_passed, queries_[0]);
        begin_query_(fragment_shader_invocations, queries_[1]);
        return get_error_() == no_error;
    }
    [[nodiscard]] Fragments end() {
        end_query_(fragment_shader_invocations);
        end_query_(samples_passed);
        std::uint64_t written = 0, made = 0;
        get_result_(queries_[0], query_result, &written);
        get_result_(queries_[1], query_result, &made);
        return {static_cast<double>(made), static_cast<double>(written)};
    }

private:
    using Word = unsigned int;  // GLenum, GLuint
    static constexpr Word no_error = 0, samples_passed = 0x8914, fragment_shader_invocations = 0x82F4, query_result = 0x8866;

    bool load() {
        void* egl = dlopen("libEGL.so.1", RTLD_LAZY | RTLD_NOLOAD);
        if (egl == nullptr) return false;
        const auto find = reinterpret_cast<void* (*)(const char*)>(dlsym(egl, "eglGetProcAddress"));
        if (find == nullptr) return false;
        const auto get = [&](auto& function, const char* name) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(find(name));
            return function != nullptr;
        };
        void (*generate)(int, Word*) = nullptr;
        if (!get(generate, "glGenQueries") || !get(end_query_, "glEndQuery") || !get(get_error_, "glGetError") ||
            !get(get_result_, "glGetQueryObjectui64v") || !get(begin_query_, "glBeginQuery"))
            return false;
        generate(2, queries_);
        return true;
    }

    Word queries_[2] = {0, 0};
    void (*begin_query_)(Word, Word) = nullptr;
    void (*end_query_)(Word) = nullptr;
    Word (*get_error_)() = nullptr;
    void (*get_result_)(Word, Word, std::uint64_t*) = nullptr;
};

}  // namespace surefoot::bench
