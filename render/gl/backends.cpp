// The list of all backends, in the order in which people see them.
#include "render/gl/backends.hpp"

#include <algorithm>
#include <array>

#include "render/gl/context.hpp"
#include "rt/base/check.hpp"

namespace surefoot::gl {

namespace {

using Options = const DeviceOptions&;

constexpr std::array all_backends = {
    Backend{usual_backend, "EGL without a surface, on the default driver", BackendKind::egl,
            [](Options) { return open_egl_surfaceless(); }},
    Backend{"device", "EGL on its first device, for a GPU without a display", BackendKind::device,
            [](Options) { return open_egl_device(); }},
    Backend{window_backend, "a window on the X server at $DISPLAY", BackendKind::window,
            [](Options options) { return open_window(options); }},
    Backend{"kms", "a screen without a window system, by the kernel's modesetting", BackendKind::kms,
            [](Options options) { return open_kms(options.screen, options.viewport); }},
    Backend{"osmesa", "Mesa software rendering in memory, without a driver", BackendKind::osmesa,
            [](Options) { return open_osmesa(); }},
    Backend{"null", "draws nothing and charges the predicted cost", BackendKind::null, nullptr},
};

}  // namespace

std::span<const Backend> backends() { return all_backends; }

const Backend& backend_of(BackendKind kind) {
    const auto found = std::ranges::find(all_backends, kind, &Backend::kind);
    CHECK(found != all_backends.end(), "Every kind of back end has its entry");
    return *found;
}

Result<const Backend*> backend_named(std::string_view name) {
    if (const Backend* backend = find_named(all_backends, name)) return backend;
    return Error{"backend '" + std::string(name) + "'", "There is no such backend", "Use one of: " + names_in_words(all_backends),
                 ErrorKind::misuse};
}

std::string drawing_backends() {
    std::string text;
    for (const Backend& backend : all_backends)
        if (backend.draws()) text += (text.empty() ? "" : ", ") + std::string(backend.name);
    return text;
}

}  // namespace surefoot::gl
