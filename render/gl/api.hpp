// OpenGL functions loaded by name, one table a context, without linking libGL. Shared libraries opened at run time: a missing one
// is an error that names the Debian package.
#pragma once

#include <GL/glcorearb.h>

#include <functional>
#include <string>
#include <string_view>

#include "rt/base/result.hpp"

namespace surefoot::gl {

// name without "gl", type of its pointer
#define SUREFOOT_GL_FUNCTIONS(X)                                               \
    X(ActiveTexture, PFNGLACTIVETEXTUREPROC)                                   \
    X(AttachShader, PFNGLATTACHSHADERPROC)                                     \
    X(BeginQuery, PFNGLBEGINQUERYPROC)                                         \
    X(BindBuffer, PFNGLBINDBUFFERPROC)                                         \
    X(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                               \
    X(BindRenderbuffer, PFNGLBINDRENDERBUFFERPROC)                             \
    X(BindTexture, PFNGLBINDTEXTUREPROC)                                       \
    X(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                               \
    X(BindVertexBuffer, PFNGLBINDVERTEXBUFFERPROC)                             \
    X(BlendFuncSeparate, PFNGLBLENDFUNCSEPARATEPROC)                           \
    X(BlitFramebuffer, PFNGLBLITFRAMEBUFFERPROC)                               \
    X(BufferStorage, PFNGLBUFFERSTORAGEPROC)                                   \
    X(CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC)                 \
    X(Clear, PFNGLCLEARPROC)                                                   \
    X(ClearColor, PFNGLCLEARCOLORPROC)                                         \
    X(ClearDepthf, PFNGLCLEARDEPTHFPROC)                                       \
    X(ClientWaitSync, PFNGLCLIENTWAITSYNCPROC)                                 \
    X(ClipControl, PFNGLCLIPCONTROLPROC)                                       \
    X(CompileShader, PFNGLCOMPILESHADERPROC)                                   \
    X(CreateProgram, PFNGLCREATEPROGRAMPROC)                                   \
    X(CreateShader, PFNGLCREATESHADERPROC)                                     \
    X(CullFace, PFNGLCULLFACEPROC)                                             \
    X(DeleteBuffers, PFNGLDELETEBUFFERSPROC)                                   \
    X(DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC)                         \
    X(DeleteProgram, PFNGLDELETEPROGRAMPROC)                                   \
    X(DeleteRenderbuffers, PFNGLDELETERENDERBUFFERSPROC)                       \
    X(DeleteShader, PFNGLDELETESHADERPROC)                                     \
    X(DeleteSync, PFNGLDELETESYNCPROC)                                         \
    X(DeleteTextures, PFNGLDELETETEXTURESPROC)                                 \
    X(DeleteVertexArrays, PFNGLDELETEVERTEXARRAYSPROC)                         \
    X(DepthFunc, PFNGLDEPTHFUNCPROC)                                           \
    X(DepthMask, PFNGLDEPTHMASKPROC)                                           \
    X(Disable, PFNGLDISABLEPROC)                                               \
    X(DrawArrays, PFNGLDRAWARRAYSPROC)                                         \
    X(DrawElements, PFNGLDRAWELEMENTSPROC)                                     \
    X(Enable, PFNGLENABLEPROC)                                                 \
    X(EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC)               \
    X(EndQuery, PFNGLENDQUERYPROC)                                             \
    X(FenceSync, PFNGLFENCESYNCPROC)                                           \
    X(Finish, PFNGLFINISHPROC)                                                 \
    X(Flush, PFNGLFLUSHPROC)                                                   \
    X(FramebufferRenderbuffer, PFNGLFRAMEBUFFERRENDERBUFFERPROC)               \
    X(FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)                     \
    X(FramebufferTextureLayer, PFNGLFRAMEBUFFERTEXTURELAYERPROC)               \
    X(FrontFace, PFNGLFRONTFACEPROC)                                           \
    X(GenBuffers, PFNGLGENBUFFERSPROC)                                         \
    X(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                               \
    X(GenQueries, PFNGLGENQUERIESPROC)                                         \
    X(GenRenderbuffers, PFNGLGENRENDERBUFFERSPROC)                             \
    X(GenTextures, PFNGLGENTEXTURESPROC)                                       \
    X(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                               \
    X(GetAttribLocation, PFNGLGETATTRIBLOCATIONPROC)                           \
    X(GetError, PFNGLGETERRORPROC)                                             \
    X(GetIntegerv, PFNGLGETINTEGERVPROC)                                       \
    X(GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)                           \
    X(GetProgramiv, PFNGLGETPROGRAMIVPROC)                                     \
    X(GetQueryObjectui64v, PFNGLGETQUERYOBJECTUI64VPROC)                       \
    X(GetRenderbufferParameteriv, PFNGLGETRENDERBUFFERPARAMETERIVPROC)         \
    X(GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)                             \
    X(GetShaderiv, PFNGLGETSHADERIVPROC)                                       \
    X(GetString, PFNGLGETSTRINGPROC)                                           \
    X(GetStringi, PFNGLGETSTRINGIPROC)                                         \
    X(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)                         \
    X(LinkProgram, PFNGLLINKPROGRAMPROC)                                       \
    X(MapBufferRange, PFNGLMAPBUFFERRANGEPROC)                                 \
    X(MultiDrawElementsIndirect, PFNGLMULTIDRAWELEMENTSINDIRECTPROC)           \
    X(PixelStorei, PFNGLPIXELSTOREIPROC)                                       \
    X(ReadPixels, PFNGLREADPIXELSPROC)                                         \
    X(RenderbufferStorage, PFNGLRENDERBUFFERSTORAGEPROC)                       \
    X(RenderbufferStorageMultisample, PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC) \
    X(Scissor, PFNGLSCISSORPROC)                                               \
    X(ShaderSource, PFNGLSHADERSOURCEPROC)                                     \
    X(TexImage2D, PFNGLTEXIMAGE2DPROC)                                         \
    X(TexParameterf, PFNGLTEXPARAMETERFPROC)                                   \
    X(TexParameteri, PFNGLTEXPARAMETERIPROC)                                   \
    X(TexStorage3D, PFNGLTEXSTORAGE3DPROC)                                     \
    X(TexSubImage2D, PFNGLTEXSUBIMAGE2DPROC)                                   \
    X(TexSubImage3D, PFNGLTEXSUBIMAGE3DPROC)                                   \
    X(Uniform1f, PFNGLUNIFORM1FPROC)                                           \
    X(Uniform1i, PFNGLUNIFORM1IPROC)                                           \
    X(Uniform3f, PFNGLUNIFORM3FPROC)                                           \
    X(UniformMatrix4fv, PFNGLUNIFORMMATRIX4FVPROC)                             \
    X(UseProgram, PFNGLUSEPROGRAMPROC)                                         \
    X(VertexAttribBinding, PFNGLVERTEXATTRIBBINDINGPROC)                       \
    X(VertexAttribFormat, PFNGLVERTEXATTRIBFORMATPROC)                         \
    X(VertexBindingDivisor, PFNGLVERTEXBINDINGDIVISORPROC)                     \
    X(Viewport, PFNGLVIEWPORTPROC)

/// Pointers to the functions of GL, loaded at run time. Null: not loaded.
struct Api {
#define SUREFOOT_GL_MEMBER(name, type) type name = nullptr;
    SUREFOOT_GL_FUNCTIONS(SUREFOOT_GL_MEMBER)
#undef SUREFOOT_GL_MEMBER
    int version = 0;  ///< 45 for 4.5

    [[nodiscard]] bool has_extension(std::string_view name) const;
};

/// The first error since the last call, or none. Takes all that are recorded. A lost context may report them without end, so it
/// asks at most 16 times.
GLenum take_errors(const Api& gl);

/// Loads the table with a context current, and checks version (4.3 at least), clip control and buffer storage.
/// `find`: the context's GetProcAddress. glvnd returns a pointer for any name, so version and extensions decide.
Result<Api> load_api(const std::function<void*(const char*)>& find, const std::string& place);

/// Whether a renderer of this name (GL_RENDERER) draws by the processor.
bool is_software(std::string_view renderer);

/// Never closed: threads and exit handlers of drivers run in its code.
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
