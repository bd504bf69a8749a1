// An OpenGL without a driver: every function of the table does nothing and returns 0, but those that count or fail on demand.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <set>
#include <string>
#include <type_traits>
#include <vector>

#include "render/gl/api.hpp"
#include "render/gl/context.hpp"

namespace surefoot::test {

/// What the functions of the fake count and answer; one at a time.
struct FakeGl {
    std::vector<GLenum> wait_results;  ///< of glClientWaitSync in turn; the last one again and again
    int waits = 0, presents = 0;
    int shaders = 0, programs = 0, syncs = 0;  ///< made and not deleted
    int buffers = 0, textures = 0, vertex_arrays = 0, framebuffers = 0, renderbuffers = 0;
    int maps = 0, bad_map = 0;  ///< bad_map: the how many-th mapping fails, from 1
    GLenum framebuffer_status = GL_FRAMEBUFFER_COMPLETE;
    int framebuffers_asked = 0, bad_framebuffer = 0;  ///< bad_framebuffer: the how many-th check fails, from 1
    int errors_asked = 0, bad_error = 0;              ///< bad_error: the how many-th glGetError says out of memory, from 1
    GLenum lost_error = GL_NO_ERROR;                  ///< else what glGetError says without end, as of a lost context
    GLint max_texture_size = 4096;
    GLint max_samples = 4, samples = 0;  ///< samples: of the newest renderbuffer
    int compiles = 0, bad_compile = 0;   ///< bad_compile: the how many-th compile fails, from 1
    bool links = true;
    int linked = 0;  ///< times that a program was
    GLuint names = 0;
    std::set<std::string> uniforms{};            ///< that programs were asked for
    int blended_passes = 0;                      ///< times that blending began
    std::set<GLenum> enabled{};                  ///< by glEnable, and not disabled
    std::size_t clip_planes = 0;                 ///< that were enabled at once at most
    int array_draws = 0;                         ///< calls of glDrawArrays: passes over a picture
    int cleared = 0, max_cleared = 0;            ///< glClear calls that nothing has waited for; the largest number of them
    std::vector<std::vector<std::byte>> mapped;  ///< memory of the mapped buffers
    /// Objects of every kind, made and not deleted.
    [[nodiscard]] int objects() const {
        return buffers + textures + vertex_arrays + framebuffers + renderbuffers + shaders + programs;
    }

    static FakeGl& get() {
        static FakeGl fake;
        return fake;
    }
};

template <class Function>
struct Nothing;
template <class R, class... A>
struct Nothing<R(APIENTRYP)(A...)> {
    static R APIENTRY call(A...) {
        if constexpr (!std::is_void_v<R>) return R{};
    }
};

/// glGen… and glDelete… of one kind: names that nobody else has, and a count of those that are there. 0 is deleted in silence.
template <int FakeGl::*count, class Gen, class Delete>
void count_names(Gen& gen, Delete& remove) {
    gen = [](GLsizei n, GLuint* names) {
        for (GLsizei i = 0; i < n; ++i) names[i] = ++FakeGl::get().names;
        FakeGl::get().*count += n;
    };
    remove = [](GLsizei n, const GLuint* names) {
        for (GLsizei i = 0; i < n; ++i) FakeGl::get().*count -= names[i] != 0 ? 1 : 0;
    };
}

inline gl::Api fake_api() {
    gl::Api api;
#define SUREFOOT_GL_FAKE(name, type) api.name = Nothing<type>::call;
    SUREFOOT_GL_FUNCTIONS(SUREFOOT_GL_FAKE)
#undef SUREFOOT_GL_FAKE
    api.version = 43;
    api.GetIntegerv = [](GLenum what, GLint* value) {
        *value = what == GL_MAJOR_VERSION   ? 4
                 : what == GL_MINOR_VERSION ? 5
                 : what == GL_MAX_SAMPLES   ? FakeGl::get().max_samples
                                            : FakeGl::get().max_texture_size;
    };
    api.RenderbufferStorageMultisample = [](GLenum, GLsizei samples, GLenum, GLsizei, GLsizei) {
        FakeGl::get().samples = samples;
    };
    api.GetRenderbufferParameteriv = [](GLenum, GLenum, GLint* value) { *value = FakeGl::get().samples; };
    api.GetError = []() -> GLenum {
        if (FakeGl::get().lost_error != GL_NO_ERROR && ++FakeGl::get().errors_asked < 10000) return FakeGl::get().lost_error;
        return ++FakeGl::get().errors_asked == FakeGl::get().bad_error ? GL_OUT_OF_MEMORY : GL_NO_ERROR;
    };
    count_names<&FakeGl::buffers>(api.GenBuffers, api.DeleteBuffers);
    count_names<&FakeGl::textures>(api.GenTextures, api.DeleteTextures);
    count_names<&FakeGl::vertex_arrays>(api.GenVertexArrays, api.DeleteVertexArrays);
    count_names<&FakeGl::framebuffers>(api.GenFramebuffers, api.DeleteFramebuffers);
    count_names<&FakeGl::renderbuffers>(api.GenRenderbuffers, api.DeleteRenderbuffers);
    api.CheckFramebufferStatus = [](GLenum) -> GLenum {
        FakeGl& fake = FakeGl::get();
        return ++fake.framebuffers_asked == fake.bad_framebuffer ? GL_FRAMEBUFFER_UNSUPPORTED : fake.framebuffer_status;
    };
    api.MapBufferRange = [](GLenum, GLintptr, GLsizeiptr bytes, GLbitfield) -> void* {
        if (++FakeGl::get().maps == FakeGl::get().bad_map) return nullptr;
        return FakeGl::get().mapped.emplace_back(static_cast<std::size_t>(bytes)).data();
    };
    api.CreateShader = [](GLenum) -> GLuint {
        ++FakeGl::get().shaders;
        return ++FakeGl::get().names;
    };
    api.DeleteShader = [](GLuint shader) { FakeGl::get().shaders -= shader != 0 ? 1 : 0; };
    api.CreateProgram = []() -> GLuint {
        ++FakeGl::get().programs;
        return ++FakeGl::get().names;
    };
    api.DeleteProgram = [](GLuint program) { FakeGl::get().programs -= program != 0 ? 1 : 0; };
    api.CompileShader = [](GLuint) { ++FakeGl::get().compiles; };
    api.GetShaderiv = [](GLuint, GLenum, GLint* ok) {
        *ok = FakeGl::get().compiles == FakeGl::get().bad_compile ? GL_FALSE : GL_TRUE;
    };
    api.LinkProgram = [](GLuint) { ++FakeGl::get().linked; };
    api.GetUniformLocation = [](GLuint, const GLchar* name) -> GLint {
        FakeGl::get().uniforms.insert(name);
        return 0;
    };
    api.DrawArrays = [](GLenum, GLint, GLsizei) { ++FakeGl::get().array_draws; };
    api.Enable = [](GLenum what) {
        FakeGl& fake = FakeGl::get();
        fake.blended_passes += what == GL_BLEND ? 1 : 0;
        fake.enabled.insert(what);
        const auto first = fake.enabled.lower_bound(GL_CLIP_DISTANCE0), last = fake.enabled.upper_bound(GL_CLIP_DISTANCE7);
        fake.clip_planes = std::max(fake.clip_planes, static_cast<std::size_t>(std::distance(first, last)));
    };
    api.Disable = [](GLenum what) { FakeGl::get().enabled.erase(what); };
    api.GetProgramiv = [](GLuint, GLenum, GLint* ok) { *ok = FakeGl::get().links ? GL_TRUE : GL_FALSE; };
    api.FenceSync = [](GLenum, GLbitfield) -> GLsync {
        ++FakeGl::get().syncs;
        return reinterpret_cast<GLsync>(&FakeGl::get());
    };
    api.DeleteSync = [](GLsync sync) { FakeGl::get().syncs -= sync != nullptr ? 1 : 0; };
    api.Clear = [](GLbitfield) {
        FakeGl& fake = FakeGl::get();
        fake.max_cleared = std::max(fake.max_cleared, ++fake.cleared);
    };
    api.Finish = [] { FakeGl::get().cleared = 0; };
    api.ClientWaitSync = [](GLsync, GLbitfield, GLuint64) -> GLenum {
        FakeGl& fake = FakeGl::get();
        fake.cleared = std::max(0, fake.cleared - 1);
        const auto at = static_cast<std::size_t>(fake.waits++);
        if (fake.wait_results.empty()) return GL_ALREADY_SIGNALED;
        return fake.wait_results[std::min(at, fake.wait_results.size() - 1)];
    };
    return api;
}

/// The fake as a context with a window; making it starts the counts anew.
class FakeContext final : public gl::Context {
public:
    FakeContext() {
        FakeGl::get() = {};
        const gl::Api api = fake_api();
#define SUREFOOT_GL_NAMED(name, type) functions_["gl" #name] = reinterpret_cast<void*>(api.name);
        SUREFOOT_GL_FUNCTIONS(SUREFOOT_GL_NAMED)
#undef SUREFOOT_GL_NAMED
    }
    bool make_current() override { return true; }
    void release() override {}
    [[nodiscard]] void* find(const char* function) const override {
        const auto found = functions_.find(function);
        return found == functions_.end() ? nullptr : found->second;
    }
    [[nodiscard]] std::string name() const override { return "fake"; }
    [[nodiscard]] bool has_window() const override { return true; }
    rt::Shown present() override {
        ++FakeGl::get().presents;
        return {rt::ShownBy::hand_over, 0, 0};
    }

private:
    std::map<std::string, void*> functions_;
};

}  // namespace surefoot::test
