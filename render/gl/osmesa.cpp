// OSMesa: Mesa's software renderer without any window system.
#include <array>
#include <cstdint>
#include <memory>

#include "render/gl/api.hpp"
#include "render/gl/context.hpp"

namespace surefoot::gl {

namespace {

// Of <GL/osmesa.h>, which includes <GL/gl.h> and so clashes with glcorearb.h.
using OsMesaContext = struct osmesa_context*;
using Proc = void (*)();
constexpr int osmesa_format = 0x22;
constexpr int osmesa_rgba = 0x1908;
constexpr int osmesa_depth_bits = 0x30;
constexpr int osmesa_profile = 0x33;
constexpr int osmesa_core_profile = 0x34;
constexpr int osmesa_major = 0x36;
constexpr int osmesa_minor = 0x37;
constexpr int buffer_side = 16;  // frames go to a framebuffer object; OSMesa wants a buffer all the same

class OsMesa final : public Context {
public:
    static Result<std::unique_ptr<Context>> open();
    ~OsMesa() override {
        if (context_ == nullptr) return;
        if (current_() == context_) release();
        destroy_(context_);
    }
    OsMesa(const OsMesa&) = delete;
    OsMesa& operator=(const OsMesa&) = delete;

    bool make_current() override {
        return make_current_(context_, pixels_.data(), GL_UNSIGNED_BYTE, buffer_side, buffer_side) != 0;
    }
    void release() override { make_current_(nullptr, nullptr, GL_UNSIGNED_BYTE, 0, 0); }
    [[nodiscard]] void* find(const char* function) const override { return reinterpret_cast<void*>(get_proc_(function)); }
    [[nodiscard]] std::string name() const override { return "OSMesa"; }

private:
    OsMesa() = default;
    OsMesaContext (*create_)(const int*, OsMesaContext) = nullptr;
    void (*destroy_)(OsMesaContext) = nullptr;
    unsigned char (*make_current_)(OsMesaContext, void*, unsigned, int, int) = nullptr;
    Proc (*get_proc_)(const char*) = nullptr;
    OsMesaContext (*current_)() = nullptr;
    OsMesaContext context_ = nullptr;
    std::array<std::uint8_t, 4 * buffer_side * buffer_side> pixels_{};
};

Result<std::unique_ptr<Context>> OsMesa::open() {
    const char* package = "libosmesa6";
    auto library = Library::open("libOSMesa.so.8", package);
    if (!library) {
        auto other = Library::open("libOSMesa.so.6", package);
        if (!other) return library.error();
        library = std::move(other);
    }
    std::unique_ptr<OsMesa> context(new OsMesa);
    if (!library->get(context->create_, "OSMesaCreateContextAttribs") ||
        !library->get(context->destroy_, "OSMesaDestroyContext") || !library->get(context->make_current_, "OSMesaMakeCurrent") ||
        !library->get(context->current_, "OSMesaGetCurrentContext") ||
        !library->get(context->get_proc_, "OSMesaGetProcAddress")) {
        return Error{"OSMesa", "The library is too old to make core contexts", "Install libosmesa6 of Mesa 22 or newer",
                     ErrorKind::unsupported};
    }
    for (const int minor : {5, 4, 3}) {
        const std::array<int, 11> wanted{osmesa_format,
                                         osmesa_rgba,
                                         osmesa_depth_bits,
                                         0,
                                         osmesa_profile,
                                         osmesa_core_profile,
                                         osmesa_major,
                                         4,
                                         osmesa_minor,
                                         minor,
                                         0};
        context->context_ = context->create_(wanted.data(), nullptr);
        if (context->context_ != nullptr) break;
    }
    if (context->context_ == nullptr || !context->make_current()) {
        return Error{"OSMesa", "The library makes no OpenGL 4.3 core context", "Install libosmesa6 of Mesa 22 or newer",
                     ErrorKind::unsupported};
    }
    return std::unique_ptr<Context>(std::move(context));
}

}  // namespace

Result<std::unique_ptr<Context>> open_osmesa() { return OsMesa::open(); }

}  // namespace surefoot::gl
