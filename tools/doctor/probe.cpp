// Trying, and putting back.
#include "tools/doctor/machine.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "render/gl/device.hpp"
#include "render/gl/kms_modes.hpp"
#include "render/measure/calibrate.hpp"
#include "rt/threads/capability.hpp"
#include "tools/walk/state.hpp"

namespace surefoot::doctor {

namespace {

/// Addresses only: nothing is touched.
bool locks(std::size_t bytes) {
    void* const memory = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) return false;
    const bool locked = mlock2(memory, bytes, MLOCK_ONFAULT) == 0;
    munmap(memory, bytes);
    return locked;
}

/// Opening asks for nothing yet: only a number written to it does.
std::optional<bool> opens_for_writing(const char* file) {
    const int fd = open(file, O_WRONLY | O_CLOEXEC);
    if (fd >= 0) {
        close(fd);
        return true;
    }
    return errno == ENOENT ? std::nullopt : std::optional(false);
}

RendererFound try_renderer() {
    RendererFound found;
    gl::DeviceOptions options;
    options.viewport = {64, 64};
    options.max_items = 64;
    const auto device = gl::open_device(options);
    if (!device) {
        found.error = device.error().place + ": " + device.error().what;
        found.remedy = device.error().remedy;
        return found;
    }
    found.name = (*device)->renderer();
    found.software = (*device)->software();
    found.machine = measure::machine_identity(found.name, 0);
    return found;
}

ScreensFound find_screens() {
    ScreensFound found;
    const auto screens = gl::find_screens();
    if (!screens) {
        found.error = screens.error().place + ": " + screens.error().what;
        found.remedy = screens.error().remedy;
        return found;
    }
    for (const gl::Screen& screen : *screens) {
        const auto mode = gl::choose_mode(screen, {});
        found.screens.push_back({screen.name, mode ? gl::in_words(*mode) : "", screen.connected, screen.counts_refreshes});
    }
    return found;
}

CostTableFound look_for_costs(const std::string& state_folder) {
    CostTableFound found;
    found.file = walk::cost_table_file(state_folder);
    std::error_code ignored;
    found.there = std::filesystem::exists(found.file, ignored);
    if (!found.there) return found;
    const auto costs = measure::read_costs(found.file, "");
    if (costs) {
        found.machine = costs->machine;
    } else {
        found.error = costs.error().what;
    }
    return found;
}

/// Of the disk that holds the folder, or would.
std::optional<std::uint64_t> free_bytes(std::filesystem::path folder) {
    std::error_code ignored;
    while (!std::filesystem::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
    struct statvfs disk {};
    if (statvfs(folder.empty() ? "." : folder.c_str(), &disk) != 0) return std::nullopt;
    return static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize;
}

}  // namespace

Probed probe_machine(const Wanted& wanted) {
    Probed probed;
    const rt::SavedLimits limits = rt::raise_limits(wanted.frame_priority);
    const rt::Capabilities capable = rt::probe_capabilities(wanted.frame_priority);
    probed.fifo_priority = capable.fifo_priority;
    probed.isolated = capable.isolated;
    probed.locks_memory = locks(1U << 30U);
    rt::restore_limits(limits);
    probed.holds_c_states = opens_for_writing("/dev/cpu_dma_latency");
    probed.renderer = try_renderer();
    probed.screens = find_screens();
    probed.costs = look_for_costs(wanted.state_folder);
    probed.free_state_bytes = free_bytes(wanted.state_folder);
    return probed;
}

}  // namespace surefoot::doctor
