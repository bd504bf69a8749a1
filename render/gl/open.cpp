// Opening a device.
#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <thread>

#include "render/gl/backends.hpp"
#include "render/gl/context.hpp"
#include "render/gl/gl_device.hpp"

namespace surefoot::gl {

namespace {

/// One a core (figures: render/gl/README.md); beyond sixteen the barriers between scenes eat what they win.
int default_rasterisers() { return static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1U, 16U)); }

#ifdef SUREFOOT_WATCHES_THREADS
constexpr bool threads_are_watched = true;
#else
constexpr bool threads_are_watched = false;
#endif

}  // namespace

void prepare_process(int rasterisers) {
    // llvmpipe reads it when its screen is made; other drivers do not care.
    setenv("LP_NUM_THREADS", std::to_string(effective_rasterisers(rasterisers)).c_str(), 1);
}

int effective_rasterisers(int rasterisers) { return rasterisers > 0 ? rasterisers : default_rasterisers(); }

Result<std::unique_ptr<Context>> open_context(const DeviceOptions& options) {
    if (threads_are_watched && options.kind != BackendKind::null) {
        return Error{"libEGL, libOSMesa",
                     "GL libraries cannot be opened under the thread sanitizer: the driver's threads are not built with it",
                     "Use a build without it, or walk with --backend null", ErrorKind::unsupported};
    }
    const Backend& backend = backend_of(options.kind);
    if (backend.draws()) return backend.open(options);
    return Error{"backend '" + std::string(backend.name) + "'", "The backend has no GL context",
                 "Use one of: " + drawing_backends(), ErrorKind::unsupported};
}

model::EffectMask left_out(std::span<const model::EffectMask> switches, model::EffectMask hidden) {
    model::EffectMask out = 0;
    for (const model::EffectMask group : switches)
        if ((group & ~hidden) == 0) out |= group;
    return out;
}

Result<std::unique_ptr<Device>> open_device(const DeviceOptions& options) {
    if (options.kind == BackendKind::null) return open_null_device(options, options.null);
    if (options.viewport.width == 0 || options.viewport.height == 0) {
        return Error{"viewport", "The viewport has no pixels", "Give a --size of at least 1x1", ErrorKind::misuse};
    }
    if (options.switches.size() > max_switches)
        return Error{"switches", "There are " + std::to_string(options.switches.size()) + " groups of effects to switch",
                     "Give at most " + std::to_string(max_switches), ErrorKind::misuse};
    auto context = open_context(options);
    if (!context) return context.error();
    return GlDevice::make(std::move(*context), options);
}

std::vector<std::string> driver_thread_prefixes() {
    // Mesa names its queues "<program>:<queue><n>" within 15 characters, the rasterisers "llvmpipe-<n>".
    const std::string program = program_invocation_short_name;
    std::vector<std::string> prefixes{"llvmpipe-"};
    for (const std::string queue : {"disk$", "gdrv", "gl"}) {
        prefixes.push_back(program.substr(0, 13 - queue.size() - 1) + ":" + queue);
    }
    return prefixes;
}

}  // namespace surefoot::gl
