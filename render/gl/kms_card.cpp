// Driving a screen through its card (kms_card.hpp).
#include "render/gl/kms_card.hpp"

#include <drm_fourcc.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "render/gl/kms_list.hpp"
#include "render/gl/window_fit.hpp"
#include "rt/base/file.hpp"

namespace surefoot::gl {

namespace {

constexpr auto connector_type = DRM_MODE_OBJECT_CONNECTOR;
constexpr auto crtc_type = DRM_MODE_OBJECT_CRTC;
constexpr auto plane_type = DRM_MODE_OBJECT_PLANE;

/// The connector's mode as the kernel has it; false where it has no such mode.
bool timings_of(const drmModeConnector& connector, const ScreenMode& mode, drmModeModeInfo& out) {
    for (int i = 0; i < connector.count_modes; ++i) {
        const ScreenMode one = mode_of(connector.modes[i]);
        if (one.width != mode.width || one.height != mode.height || one.interlaced != mode.interlaced ||
            one.refresh_ns != mode.refresh_ns)  // 60 and 59.94 Hz are two modes
            continue;
        out = connector.modes[i];
        return true;
    }
    return false;
}

std::uint64_t turn_of(int rotation_deg) {
    return rotation_deg == 90    ? DRM_MODE_ROTATE_90
           : rotation_deg == 180 ? DRM_MODE_ROTATE_180
           : rotation_deg == 270 ? DRM_MODE_ROTATE_270
                                 : DRM_MODE_ROTATE_0;
}

}  // namespace

std::int64_t card_now_ns() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

Result<std::unique_ptr<KmsCard>> KmsCard::open(const Drm& drm, const Screen& screen, const ScreenMode& mode, int rotation_deg) {
    auto card = std::unique_ptr<KmsCard>(new KmsCard(drm, screen, mode));
    card->file_ = ::open(screen.card.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (card->file_ < 0)
        return Error{screen.card, fmt::format("The card cannot be opened: {}", std::strerror(errno)), rights_remedy(),
                     ErrorKind::no_device};
    if (drm.SetClientCap(card->file_, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1) != 0 ||
        drm.SetClientCap(card->file_, DRM_CLIENT_CAP_ATOMIC, 1) != 0)
        return Error{screen.card, "The card's driver has no atomic modesetting", "Use an X server and --backend window",
                     ErrorKind::unsupported};
    if (auto found = card->find_objects(rotation_deg); !found) return found.error();
    return card;
}

KmsCard::~KmsCard() {
    if (file_ < 0) return;
    if (mode_blob_ != 0) drm_.DestroyPropertyBlob(file_, mode_blob_);
    ::close(file_);  // leaves the screen to others
}

std::uint32_t KmsCard::property(std::uint32_t object, std::uint32_t type, const char* name) const {
    std::uint32_t found = 0;
    drmModeObjectProperties* all = drm_.ObjectGetProperties(file_, object, type);
    for (std::uint32_t i = 0; all != nullptr && i < all->count_props && found == 0; ++i) {
        drmModePropertyRes* one = drm_.GetProperty(file_, all->props[i]);
        if (one == nullptr) continue;
        if (std::strcmp(one->name, name) == 0) found = one->prop_id;
        drm_.FreeProperty(one);
    }
    if (all != nullptr) drm_.FreeObjectProperties(all);
    return found;
}

std::uint64_t KmsCard::property_value(std::uint32_t object, std::uint32_t type, const char* name) const {
    const std::uint32_t wanted = property(object, type, name);
    std::uint64_t value = 0;
    drmModeObjectProperties* all = drm_.ObjectGetProperties(file_, object, type);
    for (std::uint32_t i = 0; all != nullptr && i < all->count_props; ++i)
        if (all->props[i] == wanted) value = all->prop_values[i];
    if (all != nullptr) drm_.FreeObjectProperties(all);
    return value;
}

/// Picture generators that show on other connectors now.
std::vector<std::uint32_t> KmsCard::crtcs_of_others() const {
    std::vector<std::uint32_t> taken;
    drmModeRes* resources = drm_.GetResources(file_);
    for (int i = 0; resources != nullptr && i < resources->count_connectors; ++i) {
        if (resources->connectors[i] == screen_.connector) continue;
        drmModeConnector* other = drm_.GetConnectorCurrent(file_, resources->connectors[i]);
        if (other == nullptr) continue;
        drmModeEncoder* encoder = other->encoder_id != 0 ? drm_.GetEncoder(file_, other->encoder_id) : nullptr;
        if (encoder != nullptr) {
            if (encoder->crtc_id != 0) taken.push_back(encoder->crtc_id);
            drm_.FreeEncoder(encoder);
        }
        drm_.FreeConnector(other);
    }
    if (resources != nullptr) drm_.FreeResources(resources);
    return taken;
}

/// Bits of the plane's property `rotation` that it offers; 0: it has none.
std::uint64_t KmsCard::offered_rotations() const {
    std::uint64_t bits = 0;
    drmModePropertyRes* rotation = plane_.rotation != 0 ? drm_.GetProperty(file_, plane_.rotation) : nullptr;
    if (rotation == nullptr) return 0;
    for (int i = 0; i < rotation->count_enums; ++i) bits |= std::uint64_t{1} << (rotation->enums[i].value & 63U);
    drm_.FreeProperty(rotation);
    return bits;
}

Result<void> KmsCard::find_crtc() {
    const Error none{"screen " + screen_.name, "The card has no free picture generator (CRTC) for it", "Unplug another screen",
                     ErrorKind::no_device};
    const std::vector<std::uint32_t> taken = crtcs_of_others();
    drmModeRes* resources = drm_.GetResources(file_);
    drmModeConnector* connector = drm_.GetConnectorCurrent(file_, screen_.connector);
    if (resources != nullptr && connector != nullptr) {
        std::uint32_t driven_by = 0, reachable = 0;
        for (int i = 0; i < connector->count_encoders; ++i) {
            drmModeEncoder* encoder = drm_.GetEncoder(file_, connector->encoders[i]);
            if (encoder == nullptr) continue;
            reachable |= encoder->possible_crtcs;
            if (encoder->encoder_id == connector->encoder_id) driven_by = encoder->crtc_id;
            drm_.FreeEncoder(encoder);
        }
        for (int i = 0; i < resources->count_crtcs; ++i) {
            const bool free = std::ranges::find(taken, resources->crtcs[i]) == taken.end();
            if ((reachable & (1U << static_cast<unsigned>(i))) == 0 || !free) continue;
            if (crtc_.id == 0 || resources->crtcs[i] == driven_by) {
                crtc_.id = resources->crtcs[i];
                crtc_.index = static_cast<std::uint32_t>(i);
            }
        }
        if (!timings_of(*connector, mode_, timings_)) crtc_.id = 0;
    }
    if (connector != nullptr) drm_.FreeConnector(connector);
    if (resources != nullptr) drm_.FreeResources(resources);
    if (crtc_.id == 0) return none;
    return {};
}

Result<void> KmsCard::find_planes(int rotation_deg) {
    drmModePlaneRes* planes = drm_.GetPlaneResources(file_);
    for (std::uint32_t i = 0; planes != nullptr && i < planes->count_planes; ++i) {
        drmModePlane* plane = drm_.GetPlane(file_, planes->planes[i]);
        if (plane == nullptr) continue;
        if ((plane->possible_crtcs & (1U << crtc_.index)) != 0) {
            Plane found;
            found.id = plane->plane_id;
            found.framebuffer = property(found.id, plane_type, "FB_ID");
            found.crtc = property(found.id, plane_type, "CRTC_ID");
            const bool primary = property_value(found.id, plane_type, "type") == DRM_PLANE_TYPE_PRIMARY;
            if (primary && plane_.id == 0)
                plane_ = found;
            else
                other_planes_.push_back(found);
        }
        drm_.FreePlane(plane);
    }
    if (planes != nullptr) drm_.FreePlaneResources(planes);
    constexpr std::array source{"SRC_X", "SRC_Y", "SRC_W", "SRC_H"}, shown{"CRTC_X", "CRTC_Y", "CRTC_W", "CRTC_H"};
    bool complete = plane_.id != 0 && plane_.framebuffer != 0 && plane_.crtc != 0;
    for (std::size_t i = 0; i < source.size() && complete; ++i) {
        plane_.source[i] = property(plane_.id, plane_type, source[i]);
        plane_.shown[i] = property(plane_.id, plane_type, shown[i]);
        complete = plane_.source[i] != 0 && plane_.shown[i] != 0;
    }
    if (!complete)
        return Error{"screen " + screen_.name, "The card has no primary plane for it", "Use an X server and --backend window",
                     ErrorKind::unsupported};
    plane_.rotation = property(plane_.id, plane_type, "rotation");
    turns_ = rotation_deg == 0 || (offered_rotations() & turn_of(rotation_deg)) != 0;
    turned_ = turns_ ? turn_of(rotation_deg) : DRM_MODE_ROTATE_0;
    return {};
}

Result<void> KmsCard::find_objects(int rotation_deg) {
    if (auto found = find_crtc(); !found) return found;
    if (auto found = find_planes(rotation_deg); !found) return found;
    crtc_.mode = property(crtc_.id, crtc_type, "MODE_ID");
    crtc_.active = property(crtc_.id, crtc_type, "ACTIVE");
    connector_crtc_ = property(screen_.connector, connector_type, "CRTC_ID");
    swaps_sides_ = rotation_deg == 90 || rotation_deg == 270;
    link_status_ = property(screen_.connector, connector_type, "link-status");
    constexpr std::array adjustments{"GAMMA_LUT", "DEGAMMA_LUT", "CTM", "VRR_ENABLED"};
    for (std::size_t i = 0; i < adjustments.size(); ++i) adjustments_[i] = property(crtc_.id, crtc_type, adjustments[i]);
    if (swaps_sides_ && !turns_)
        return Error{"rotation", fmt::format("This card cannot turn pictures by {} degrees", rotation_deg), "Use 0 or 180",
                     ErrorKind::unsupported};
    if (drm_.CreatePropertyBlob(file_, &timings_, sizeof timings_, &mode_blob_) != 0 || crtc_.mode == 0 || crtc_.active == 0 ||
        connector_crtc_ == 0)
        return Error{"screen " + screen_.name, "The card's driver lacks properties of atomic modesetting",
                     "Use an X server and --backend window", ErrorKind::unsupported};
    return {};
}

rt::Refreshes KmsCard::refreshes() const {
    std::uint64_t sequence = 0, time_ns = 0;
    if (!counts_refreshes_ || drm_.CrtcGetSequence(file_, crtc_.id, &sequence, &time_ns) != 0) return {0, 0};
    return {mode_.refresh_ns, static_cast<std::int64_t>(time_ns)};
}

ShownBuffer KmsCard::add_buffer(std::uint32_t handle, std::uint32_t stride, std::uint32_t width, std::uint32_t height,
                                int& error) {
    const std::array<std::uint32_t, 4> handles{handle}, strides{stride}, offsets{};
    ShownBuffer buffer = 0;
    error =
        drm_.AddFB2(file_, width, height, DRM_FORMAT_XRGB8888, handles.data(), strides.data(), offsets.data(), &buffer, 0) == 0
            ? 0
            : errno;
    return error == 0 ? buffer : 0;
}

void KmsCard::remove_buffer(ShownBuffer buffer) {
    if (buffer != 0) drm_.RmFB(file_, buffer);
}

/// Linux 6.1 lets an ordinary user ask again only on the thread that opened the card, even where it is master.
int KmsCard::take() {
    if (drm_.IsMaster(file_) != 0) return 0;
    return drm_.SetMaster(file_) == 0 ? 0 : errno;
}

bool KmsCard::add_to(drmModeAtomicReq* request, ShownBuffer buffer) const {
    bool added = true;
    const auto add = [&](std::uint32_t object, std::uint32_t name, std::uint64_t value) {
        added = drm_.AtomicAddProperty(request, object, name, value) >= 0 && added;
    };
    add(screen_.connector, connector_crtc_, crtc_.id);
    add(crtc_.id, crtc_.mode, mode_blob_);
    add(crtc_.id, crtc_.active, 1);
    if (link_status_ != 0) add(screen_.connector, link_status_, DRM_MODE_LINK_STATUS_GOOD);
    for (const std::uint32_t adjustment : adjustments_)  // none of another program's stays
        if (adjustment != 0) add(crtc_.id, adjustment, 0);
    const std::uint64_t width = timings_.hdisplay, height = timings_.vdisplay;
    std::array<std::uint64_t, 4> source{0, 0, (swaps_sides_ ? height : width) << 16U, (swaps_sides_ ? width : height) << 16U};
    std::array<std::uint64_t, 4> shown{0, 0, width, height};
    if (enlarged_width_ != 0) {
        const FittedPicture fit = fit_picture(enlarged_width_, enlarged_height_, timings_.hdisplay, timings_.vdisplay);
        source = {0, 0, std::uint64_t{enlarged_width_} << 16U, std::uint64_t{enlarged_height_} << 16U};
        shown = {static_cast<std::uint64_t>(fit.x), static_cast<std::uint64_t>(fit.y), static_cast<std::uint64_t>(fit.width),
                 static_cast<std::uint64_t>(fit.height)};
    }
    add(plane_.id, plane_.framebuffer, buffer);
    add(plane_.id, plane_.crtc, crtc_.id);
    for (std::size_t i = 0; i < source.size(); ++i) {
        add(plane_.id, plane_.source[i], source[i]);
        add(plane_.id, plane_.shown[i], shown[i]);
    }
    if (plane_.rotation != 0) add(plane_.id, plane_.rotation, turned_);
    for (const Plane& other : other_planes_) {  // a pointer that another program left
        if (property_value(other.id, plane_type, "CRTC_ID") != crtc_.id) continue;
        add(other.id, other.framebuffer, 0);
        add(other.id, other.crtc, 0);
    }
    return added;
}

int KmsCard::commit_mode(ShownBuffer buffer, std::uint32_t flags) const {
    drmModeAtomicReq* request = drm_.AtomicAlloc();
    if (request == nullptr) return ENOMEM;
    int error = add_to(request, buffer) ? 0 : ENOMEM;
    if (error == 0 && drm_.AtomicCommit(file_, request, DRM_MODE_ATOMIC_ALLOW_MODESET | flags, nullptr) != 0) error = errno;
    drm_.AtomicFree(request);
    return error;
}

/// Whether the card would set the mode with a plain buffer of that size: 0 or an errno.
int KmsCard::try_buffer(std::uint32_t width, std::uint32_t height) {
    drm_mode_create_dumb plain{};
    plain.width = width;
    plain.height = height;
    plain.bpp = 32;
    if (drm_.Ioctl(file_, DRM_IOCTL_MODE_CREATE_DUMB, &plain) != 0) return errno;
    int error = 0;
    const ShownBuffer buffer = add_buffer(plain.handle, plain.pitch, width, height, error);
    if (error == 0) error = commit_mode(buffer, DRM_MODE_ATOMIC_TEST_ONLY);
    remove_buffer(buffer);
    drm_mode_destroy_dumb no_more{plain.handle};
    drm_.Ioctl(file_, DRM_IOCTL_MODE_DESTROY_DUMB, &no_more);
    return error;
}

bool KmsCard::enlarge(std::uint32_t width, std::uint32_t height) {
    const bool smaller = width > 0 && height > 0 && width <= timings_.hdisplay && height <= timings_.vdisplay &&
                         (width < timings_.hdisplay || height < timings_.vdisplay);
    if (!smaller || turned_ != DRM_MODE_ROTATE_0 || !turns_) return false;
    enlarged_width_ = width;
    enlarged_height_ = height;
    if (try_buffer(width, height) == 0) return true;
    enlarged_width_ = enlarged_height_ = 0;
    return false;
}

int KmsCard::set_mode(ShownBuffer buffer) {
    const int error = commit_mode(buffer, 0);
    std::uint64_t sequence = 0, time_ns = 0;
    if (error == 0) counts_refreshes_ = drm_.CrtcGetSequence(file_, crtc_.id, &sequence, &time_ns) == 0 && time_ns != 0;
    return error;
}

/// One property of one object, from the stack: libdrm's request would allocate in every frame.
int KmsCard::flip(ShownBuffer buffer) {
    std::uint32_t object = plane_.id, count = 1, name = plane_.framebuffer;
    std::uint64_t value = buffer;
    drm_mode_atomic commit{};
    commit.flags = DRM_MODE_PAGE_FLIP_EVENT | DRM_MODE_ATOMIC_NONBLOCK;
    commit.count_objs = 1;
    commit.objs_ptr = reinterpret_cast<std::uintptr_t>(&object);
    commit.count_props_ptr = reinterpret_cast<std::uintptr_t>(&count);
    commit.props_ptr = reinterpret_cast<std::uintptr_t>(&name);
    commit.prop_values_ptr = reinterpret_cast<std::uintptr_t>(&value);
    commit.user_data = flips_ + 1;
    if (drm_.Ioctl(file_, DRM_IOCTL_MODE_ATOMIC, &commit) != 0) return errno;
    ++flips_;
    return 0;
}

/// The event of the last flip. Those of flips that were given up may come before it, and signals too.
Flip KmsCard::wait_flip(std::int64_t timeout_ns) {
    const std::int64_t until_ns = card_now_ns() + timeout_ns;
    while (true) {
        const std::int64_t left_ns = std::max<std::int64_t>(0, until_ns - card_now_ns());
        const timespec wait{static_cast<time_t>(left_ns / 1'000'000'000), static_cast<long>(left_ns % 1'000'000'000)};
        pollfd readable{file_, POLLIN, 0};
        const int ready = ::ppoll(&readable, 1, &wait, nullptr);
        if (ready < 0 && errno == EINTR) continue;
        if (ready <= 0) return {};
        alignas(drm_event_vblank) std::array<char, 1024> events;
        const ssize_t size = ::read(file_, events.data(), events.size());
        if (size <= 0 && errno != EAGAIN && errno != EINTR) return {};
        for (ssize_t at = 0; at + static_cast<ssize_t>(sizeof(drm_event)) <= size;) {
            drm_event event{};
            std::memcpy(&event, events.data() + at, sizeof event);
            if (event.length < sizeof event) break;
            if (event.type == DRM_EVENT_FLIP_COMPLETE && at + static_cast<ssize_t>(sizeof(drm_event_vblank)) <= size) {
                drm_event_vblank flip{};
                std::memcpy(&flip, events.data() + at, sizeof flip);
                if (flip.user_data == flips_)
                    return {true, std::int64_t{flip.tv_sec} * 1'000'000'000 + std::int64_t{flip.tv_usec} * 1000};
            }
            at += event.length;
        }
    }
}

bool KmsCard::link_failed() {
    std::uint64_t status = DRM_MODE_LINK_STATUS_GOOD;
    drmModeObjectProperties* all =
        link_status_ != 0 ? drm_.ObjectGetProperties(file_, screen_.connector, connector_type) : nullptr;
    for (std::uint32_t i = 0; all != nullptr && i < all->count_props; ++i)
        if (all->props[i] == link_status_) status = all->prop_values[i];
    if (all != nullptr) drm_.FreeObjectProperties(all);
    return status == DRM_MODE_LINK_STATUS_BAD;
}

bool KmsCard::connected(bool probe) {
    if (!probe) {
        // What the driver last knew, without a word to the screen.
        const std::string card = screen_.card.substr(screen_.card.rfind('/') + 1);
        const auto status = read_text(fmt::format("/sys/class/drm/{}-{}/status", card, screen_.name), 64);
        return !status || status->starts_with("connected");
    }
    drmModeConnector* connector = drm_.GetConnector(file_, screen_.connector);
    if (connector == nullptr) return true;  // flips tell that the card is gone
    const bool there = connector->connection == DRM_MODE_CONNECTED;
    drm_.FreeConnector(connector);
    return there;
}

bool KmsCard::has_mode() {
    drmModeConnector* connector = drm_.GetConnector(file_, screen_.connector);
    if (connector == nullptr) return true;
    drmModeModeInfo timings{};
    const bool there = timings_of(*connector, mode_, timings);
    drm_.FreeConnector(connector);
    return there;
}

std::string KmsCard::holders() { return holders_of(screen_.card); }

}  // namespace surefoot::gl
