// The kms back end: EGL on the card's own buffers (GBM), or plain buffers that the processor fills.
#include <drm_fourcc.h>
#include <sys/mman.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "render/gl/egl.hpp"
#include "render/gl/kms_card.hpp"
#include "render/gl/kms_console.hpp"
#include "render/gl/kms_list.hpp"

namespace surefoot::gl {

namespace {

/// A card that drives its screen. Buffers are freed before it.
struct OpenScreen {
    Drm drm;
    std::unique_ptr<KmsCard> card;
    std::unique_ptr<KmsScreen> screen;
    std::optional<GraphicsConsole> console;  ///< once the card is ours
    Surface surface;                         ///< of its buffers
    std::string name;
};

/// Buffers of the screen's size come from GBM; EGL draws into them.
class GbmContext final : public EglContext {
public:
    GbmContext(const Egl& egl, EGLDisplay display, const Gbm& gbm, gbm_device* device, std::unique_ptr<OpenScreen> screen)
        : EglContext(egl, display, false, "screen " + screen->name), gbm_(gbm), device_(device), screen_(std::move(screen)) {}
    ~GbmContext() override {
        for (const Known& known : known_)
            if (known.buffer != 0) screen_->card->remove_buffer(known.buffer);
        for (gbm_bo* kept : {older_, newer_})
            if (kept != nullptr) gbm_.ReleaseBuffer(gbm_surface_, kept);  // before its surface of EGL is gone
        destroy();
        egl_.Terminate(display_);
        if (gbm_surface_ != nullptr) gbm_.DestroySurface(gbm_surface_);
        gbm_.DestroyDevice(device_);
    }
    GbmContext(const GbmContext&) = delete;
    GbmContext& operator=(const GbmContext&) = delete;

    Result<void> create_with_surface() {
        const Error none{name(), "The card's driver makes no buffers to draw into: " + egl_.error_text(),
                         "Install libegl-mesa0 and libgl1-mesa-dri", ErrorKind::unsupported};
        EGLConfig config = nullptr;
        if (!window_config(GBM_FORMAT_XRGB8888, config)) return none;
        gbm_surface_ = gbm_.CreateSurface(device_, screen_->surface.width, screen_->surface.height, GBM_FORMAT_XRGB8888,
                                          GBM_BO_USE_SCANOUT | GBM_BO_USE_RENDERING);
        if (gbm_surface_ == nullptr) return none;
        egl_.BindAPI(EGL_OPENGL_API);
        surface_ = egl_.CreateWindowSurface(display_, config, reinterpret_cast<EGLNativeWindowType>(gbm_surface_), nullptr);
        if (surface_ == EGL_NO_SURFACE) return none;
        return create(config);
    }
    /// Of a context that could not be made.
    std::unique_ptr<OpenScreen> take_screen() { return std::move(screen_); }
    [[nodiscard]] bool has_window() const override { return true; }
    [[nodiscard]] Surface surface() const override { return screen_->surface; }
    [[nodiscard]] bool presents_at_once() const override { return true; }
    rt::Shown present() override {
        egl_.SwapBuffers(display_, surface_);
        gbm_bo* drawn = gbm_.LockFrontBuffer(gbm_surface_);
        if (drawn == nullptr) return {};
        const rt::Shown shown = screen_->screen->present(buffer_of(drawn));
        if (shown.by == rt::ShownBy::nothing) {
            gbm_.ReleaseBuffer(gbm_surface_, drawn);  // what is on the screen stays there
            return shown;
        }
        // Of the two before this one, the older is on the screen no more.
        if (older_ != nullptr) gbm_.ReleaseBuffer(gbm_surface_, older_);
        older_ = std::exchange(newer_, drawn);
        return shown;
    }
    [[nodiscard]] rt::Refreshes refreshes() const override { return screen_->card->refreshes(); }
    std::vector<std::string> watch_screen() override { return screen_->screen->watch(); }
    void wait_for_flips(bool wait) override { screen_->screen->wait_for_flips(wait); }
    [[nodiscard]] bool lost() const override { return screen_->screen->state() == ScreenState::gone; }

private:
    /// A buffer of the surface that the card knows.
    struct Known {
        std::uint32_t handle = 0;
        ShownBuffer buffer = 0;
    };

    /// GBM makes four buffers at most; each is made known once.
    ShownBuffer buffer_of(gbm_bo* drawn) {
        const std::uint32_t handle = gbm_.BufferHandle(drawn).u32;
        for (Known& known : known_) {
            if (known.handle == handle && known.buffer != 0) return known.buffer;
            if (known.buffer != 0) continue;
            int error = 0;
            known.handle = handle;
            known.buffer = screen_->card->add_buffer(handle, gbm_.BufferStride(drawn), screen_->surface.width,
                                                     screen_->surface.height, error);
            return known.buffer;
        }
        return 0;
    }

    Gbm gbm_;
    gbm_device* device_;
    std::unique_ptr<OpenScreen> screen_;
    gbm_surface* gbm_surface_ = nullptr;
    gbm_bo *newer_ = nullptr, *older_ = nullptr;  ///< the last two that were queued: one is on the screen, one may be waiting
    std::array<Known, 8> known_{};
};

/// Three plain buffers of the card, of the screen's size or of pictures that its plane enlarges, mapped: one on the screen, one
/// that waits for its refresh, one to fill. Pictures are drawn elsewhere and copied there.
class PlainContext final : public Context {
public:
    PlainContext(std::unique_ptr<Context> drawing, std::unique_ptr<OpenScreen> screen)
        : drawing_(std::move(drawing)), screen_(std::move(screen)) {}
    ~PlainContext() override {
        for (const Plain& plain : plain_) {
            screen_->card->remove_buffer(plain.buffer);
            if (plain.pixels != nullptr) ::munmap(plain.pixels, plain.size);
            drm_mode_destroy_dumb no_more{plain.handle};
            if (plain.handle != 0) screen_->drm.Ioctl(screen_->card->file(), DRM_IOCTL_MODE_DESTROY_DUMB, &no_more);
        }
    }
    PlainContext(const PlainContext&) = delete;
    PlainContext& operator=(const PlainContext&) = delete;

    Result<void> make_buffers() {
        for (Plain& plain : plain_)
            if (const int error = make(plain); error != 0)
                return Error{name(), std::string("The card gives no memory to show pictures from: ") + std::strerror(error),
                             "Choose a smaller mode", ErrorKind::no_device};
        return {};
    }
    bool make_current() override { return drawing_->make_current(); }
    void release() override { drawing_->release(); }
    [[nodiscard]] void* find(const char* function) const override { return drawing_->find(function); }
    [[nodiscard]] std::string name() const override { return "screen " + screen_->name; }
    [[nodiscard]] bool reports_resets() const override { return drawing_->reports_resets(); }
    [[nodiscard]] PixelRows pixel_rows() override {
        const Plain& plain = plain_[hidden_];
        return {plain.pixels, plain.stride / 4, screen_->surface};
    }
    rt::Shown present() override {
        const rt::Shown shown = screen_->screen->present(plain_[hidden_].buffer);
        if (shown.by != rt::ShownBy::nothing) hidden_ = (hidden_ + 1) % plain_.size();
        return shown;
    }
    [[nodiscard]] rt::Refreshes refreshes() const override { return screen_->card->refreshes(); }
    std::vector<std::string> watch_screen() override { return screen_->screen->watch(); }
    void wait_for_flips(bool wait) override { screen_->screen->wait_for_flips(wait); }
    [[nodiscard]] bool lost() const override { return screen_->screen->state() == ScreenState::gone; }

private:
    /// A buffer, and where it is mapped.
    struct Plain {
        std::uint32_t handle = 0;
        std::uint32_t stride = 0;  ///< bytes
        std::size_t size = 0;
        ShownBuffer buffer = 0;
        std::uint32_t* pixels = nullptr;
    };

    int make(Plain& plain) {
        const int file = screen_->card->file();
        drm_mode_create_dumb create{};
        create.width = screen_->surface.width;
        create.height = screen_->surface.height;
        create.bpp = 32;
        if (screen_->drm.Ioctl(file, DRM_IOCTL_MODE_CREATE_DUMB, &create) != 0) return errno;
        plain.handle = create.handle;
        plain.stride = create.pitch;
        plain.size = create.size;
        int error = 0;
        plain.buffer = screen_->card->add_buffer(create.handle, create.pitch, create.width, create.height, error);
        if (error != 0) return error;
        drm_mode_map_dumb map{};
        map.handle = create.handle;
        if (screen_->drm.Ioctl(file, DRM_IOCTL_MODE_MAP_DUMB, &map) != 0) return errno;
        void* mapped = ::mmap(nullptr, plain.size, PROT_READ | PROT_WRITE, MAP_SHARED, file, static_cast<off_t>(map.offset));
        if (mapped == MAP_FAILED) return errno;
        plain.pixels = static_cast<std::uint32_t*>(mapped);
        return 0;
    }

    std::unique_ptr<Context> drawing_;
    std::unique_ptr<OpenScreen> screen_;
    std::array<Plain, 3> plain_{};
    std::size_t hidden_ = 0;  ///< the buffer to fill
};

/// One try. `held`: another program has the card.
Result<std::unique_ptr<OpenScreen>> try_screen(const Drm& drm, const ScreenOptions& options, const ModeRequest& request,
                                               bool& held) {
    auto screens = list_screens(drm);
    if (!screens) return screens.error();
    auto chosen = choose_screen(*screens, options.name);
    if (!chosen) return chosen.error();
    auto mode = choose_mode(**chosen, request);
    if (!mode) return mode.error();
    auto card = KmsCard::open(drm, **chosen, *mode, options.rotation_deg);
    if (!card) return card.error();
    auto open = std::make_unique<OpenScreen>();
    open->drm = drm;
    open->card = std::move(*card);
    open->name = (*chosen)->name;
    const bool swapped = options.rotation_deg == 90 || options.rotation_deg == 270;
    open->surface = {swapped ? mode->height : mode->width, swapped ? mode->width : mode->height,
                     options.rotation_deg == 180 && !open->card->turns()};
    if (const int error = open->card->take(); error != 0) {
        held = error == EBUSY || error == EACCES || error == EPERM;
        if (!held)
            return Error{"screen " + open->name, std::string("The card cannot be had: ") + std::strerror(error),
                         "See the kernel's log", ErrorKind::no_device};
        const std::string holders = open->card->holders();
        return Error{"screen " + open->name, "Another program holds it" + (holders.empty() ? std::string() : ": " + holders),
                     "End that program, or run it on another card", ErrorKind::no_device};
    }
    open->console.emplace(options.keyboard_off);
    open->screen = std::make_unique<KmsScreen>(*open->card, open->name, mode->refresh_ns, card_now_ns);
    return open;
}

Result<std::unique_ptr<OpenScreen>> wait_for_screen(const Drm& drm, const ScreenOptions& options) {
    auto request = read_mode(options.mode);
    if (!request) return request.error();
    while (true) {
        bool held = false;
        auto open = try_screen(drm, options, *request, held);
        if (open || !options.on_wait || !options.on_wait(open.error(), held)) return open;
        std::this_thread::sleep_for(std::chrono::seconds(1));  // each try asks all screens
    }
}

bool draws_by_processor(const Context& context) {
    const auto get_string = reinterpret_cast<PFNGLGETSTRINGPROC>(context.find("glGetString"));
    const auto* name = get_string != nullptr ? reinterpret_cast<const char*>(get_string(GL_RENDERER)) : nullptr;
    return name == nullptr || is_software(name);
}

/// An Error where the card's driver has none; the screen stays with the caller then. So it does under a software renderer, which
/// would write through a null pointer once the card is gone.
Result<std::unique_ptr<Context>> open_gbm(std::unique_ptr<OpenScreen>& screen, bool software_too) {
    auto gbm = load_gbm();
    if (!gbm) return gbm.error();
    auto egl = load_egl();
    if (!egl) return egl.error();
    gbm_device* device = gbm->CreateDevice(screen->card->file());
    const Error none{"screen " + screen->name, "The card has no driver for GBM", "Install libegl-mesa0 and libgl1-mesa-dri",
                     ErrorKind::unsupported};
    if (device == nullptr) return none;
    EGLDisplay display = egl->GetPlatformDisplay(EGL_PLATFORM_GBM_KHR, device, nullptr);
    if (display == EGL_NO_DISPLAY || egl->Initialize(display, nullptr, nullptr) != EGL_TRUE) {
        gbm->DestroyDevice(device);
        return none;
    }
    auto context = std::make_unique<GbmContext>(*egl, display, *gbm, device, std::move(screen));
    const auto made = context->create_with_surface();
    if (!made || (!software_too && draws_by_processor(*context))) {
        screen = context->take_screen();
        return made ? none : made.error();
    }
    return std::unique_ptr<Context>(std::move(context));
}

}  // namespace

Result<std::unique_ptr<Context>> open_kms(const ScreenOptions& options, model::Viewport picture) {
    auto drm = load_drm();
    if (!drm) return drm.error();
    auto screen = wait_for_screen(*drm, options);
    if (!screen) return screen.error();
    if (auto context = open_gbm(*screen, options.software_by_gbm)) return context;
    auto drawing = open_egl_surfaceless();
    if (!drawing) drawing = open_osmesa();
    if (!drawing) return drawing.error();
    OpenScreen& open = **screen;
    if (open.card->enlarge(picture.width, picture.height)) open.surface = {picture.width, picture.height, false};
    auto context = std::make_unique<PlainContext>(std::move(*drawing), std::move(*screen));
    if (auto made = context->make_buffers(); !made) return made.error();
    return std::unique_ptr<Context>(std::move(context));
}

}  // namespace surefoot::gl
