// Listing screens and the holders of a card (kms_list.hpp).
#include "render/gl/kms_list.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "rt/base/file.hpp"

namespace surefoot::gl {

namespace {

namespace fs = std::filesystem;

/// The kernel's names of connectors, by its numbers.
constexpr std::array connector_names{"Unknown", "VGA",       "DVI-I", "DVI-D", "DVI-A",     "Composite", "SVIDEO",
                                     "LVDS",    "Component", "DIN",   "DP",    "HDMI-A",    "HDMI-B",    "TV",
                                     "eDP",     "Virtual",   "DSI",   "DPI",   "Writeback", "SPI",       "USB"};

/// Of the picture that is on the screen now.
std::optional<bool> counts_refreshes(const Drm& drm, int file, const drmModeConnector& connector) {
    drmModeEncoder* encoder = connector.encoder_id != 0 ? drm.GetEncoder(file, connector.encoder_id) : nullptr;
    if (encoder == nullptr) return std::nullopt;
    const std::uint32_t crtc = encoder->crtc_id;
    drm.FreeEncoder(encoder);
    std::uint64_t sequence = 0, time_ns = 0;
    if (crtc == 0) return std::nullopt;
    if (drm.CrtcGetSequence(file, crtc, &sequence, &time_ns) == 0) return time_ns != 0;
    return errno == EOPNOTSUPP ? std::optional(false) : std::nullopt;
}

void add_screens(const Drm& drm, int file, const std::string& card, std::vector<Screen>& screens) {
    drmModeRes* resources = drm.GetResources(file);
    if (resources == nullptr) return;  // it only computes
    for (int i = 0; i < resources->count_connectors; ++i) {
        drmModeConnector* connector = drm.GetConnector(file, resources->connectors[i]);
        if (connector == nullptr) continue;
        const bool known = connector->connector_type < connector_names.size();
        Screen screen;
        screen.card = card;
        screen.name =
            fmt::format("{}-{}", known ? connector_names[connector->connector_type] : "Unknown", connector->connector_type_id);
        screen.connector = connector->connector_id;
        screen.connected = connector->connection == DRM_MODE_CONNECTED && connector->count_modes > 0;
        for (int m = 0; m < connector->count_modes; ++m) screen.modes.push_back(mode_of(connector->modes[m]));
        screen.counts_refreshes = counts_refreshes(drm, file, *connector);
        drm.FreeConnector(connector);
        screens.push_back(std::move(screen));
    }
    drm.FreeResources(resources);
}

/// What is in a folder that may change or go meanwhile; nothing throws.
std::vector<fs::path> entries_of(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) found.push_back(at->path());
    return found;
}

/// "/dev/dri/card0" and so on, in order.
std::vector<std::string> cards() {
    std::vector<std::string> found;
    for (const fs::path& entry : entries_of("/dev/dri"))
        if (entry.filename().string().starts_with("card")) found.push_back(entry.string());
    std::ranges::sort(found);
    return found;
}

bool has_open(const fs::path& process, const std::string& card) {
    std::error_code error;
    return std::ranges::any_of(entries_of(process / "fd"),
                               [&](const fs::path& file) { return fs::read_symlink(file, error) == card; });
}

}  // namespace

ScreenMode mode_of(const drmModeModeInfo& timings) {
    ScreenMode mode;
    mode.width = timings.hdisplay;
    mode.height = timings.vdisplay;
    mode.preferred = (timings.type & DRM_MODE_TYPE_PREFERRED) != 0;
    mode.interlaced = (timings.flags & DRM_MODE_FLAG_INTERLACE) != 0;
    if (timings.clock > 0) {  // kHz
        double lines = timings.vtotal;
        if ((timings.flags & DRM_MODE_FLAG_DBLSCAN) != 0) lines *= 2;
        if (timings.vscan > 1) lines *= timings.vscan;
        if (mode.interlaced) lines /= 2;
        mode.refresh_ns = std::llround(timings.htotal * lines * 1e6 / timings.clock);
    }
    return mode;
}

std::string rights_remedy() { return "Add the user to the group of the card's file, usually `video`, and log in again"; }

Result<std::vector<Screen>> list_screens(const Drm& drm) {
    std::vector<Screen> screens;
    std::string refused;
    for (const std::string& card : cards()) {
        const int file = ::open(card.c_str(), O_RDWR | O_CLOEXEC);
        if (file < 0) {
            if (errno == EACCES || errno == EPERM) refused = card;
            continue;
        }
        add_screens(drm, file, card, screens);
        ::close(file);
    }
    if (screens.empty() && !refused.empty())
        return Error{refused, "This user may not open the graphics card", rights_remedy(), ErrorKind::no_device};
    if (screens.empty())
        return Error{"screen", "No graphics card here has a screen: /dev/dri holds no card with a connector",
                     "Load the card's kernel driver, or use --backend egl", ErrorKind::no_device};
    return screens;
}

Result<std::vector<Screen>> find_screens() {
    auto drm = load_drm();
    if (!drm) return drm.error();
    return list_screens(*drm);
}

std::string holders_of(const std::string& card) {
    constexpr std::size_t max_named = 4;
    std::string text;
    std::size_t named = 0;
    for (const fs::path& entry : entries_of("/proc")) {
        const std::string id = entry.filename().string();
        if (id.empty() || id.find_first_not_of("0123456789") != std::string::npos) continue;
        if (id == std::to_string(::getpid()) || !has_open(entry, card) || named++ >= max_named) continue;
        auto name = read_text(entry / "comm", 64);
        if (name && name->ends_with('\n')) name->pop_back();
        text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", name ? *name : "a program", id);
    }
    return text;
}

}  // namespace surefoot::gl
