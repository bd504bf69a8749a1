// The live source. If a device hangs up, its own read reports it as removed, before udev does.
#include "input/devices/live.hpp"

#include <algorithm>

namespace surefoot::input {

namespace {

constexpr std::size_t largest_report = 16384 + 1;  // the kernel's HID_MAX_BUFFER_SIZE and an id
constexpr std::size_t bytes_per_take = 1U << 20U;
constexpr std::int64_t poll_again_ns = 2'000'000;  // where a descriptor could not be found
// Room for events and devices is set aside: sixteen devices that flood, and sixty-four that are open.
constexpr std::size_t max_reports = 16 * max_drain, max_open_devices = 64, max_others = 64;
constexpr std::size_t max_events = max_reports + 4 * max_open_devices;  // each of them drained, gone and come anew

}  // namespace

LiveDevices::LiveDevices(std::unique_ptr<Discoverer> discoverer, std::optional<Error> trouble)
    : discoverer_(std::move(discoverer)),
      bytes_(bytes_per_take + largest_report),
      unplugged_{"", "The device was unplugged, or cannot be read any more", "Plug it in again", ErrorKind::no_device},
      trouble_(std::move(trouble)) {
    open_.reserve(max_open_devices);
    retired_.reserve(2 * max_open_devices);
    others_.reserve(max_others);
    watched_.reserve(1 + max_open_devices + max_others);
    events_.reserve(max_events);
    watch();
}

LiveDevices::~LiveDevices() {
    open_.clear();
    retired_.clear();
}

void LiveDevices::watch() {
    watched_.clear();
    watched_.push_back({discoverer_->fd(), POLLIN, 0});  // poll() passes over -1
    unwatchable_ = false;
    for (const auto& d : open_) {
        watched_.push_back({d->handle.fd(), POLLIN, 0});
        unwatchable_ = unwatchable_ || d->handle.fd() < 0;
    }
    watched_.insert(watched_.end(), others_.begin(), others_.end());
}

void LiveDevices::watch_also(std::span<const pollfd> others) {
    others_.assign(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(std::min(others.size(), max_others)));
    watch();
}

void LiveDevices::wait(std::int64_t until_ns) {
    const std::int64_t now = clock_.now_ns();
    until_ns = std::min(until_ns, discoverer_->due_ns());
    if (unwatchable_ || !retired_.empty()) until_ns = std::min(until_ns, now + poll_again_ns);
    const std::int64_t left = std::max<std::int64_t>(0, until_ns - now);
    const timespec wait{left / 1'000'000'000, left % 1'000'000'000};
    (void)ppoll(watched_.data(), watched_.size(), &wait, nullptr);
}

std::span<const DeviceEvent> LiveDevices::take() {
    events_.clear();
    used_ = 0;
    const std::int64_t now = clock_.now_ns();
    for (Retired& t : retired_) discoverer_->give_back(std::move(t.discovery), t.failed, now);
    retired_.clear();
    for (std::size_t i = 0; i < open_.size();) {
        if (drain(*open_[i]))
            ++i;
        else
            lost(i, true, now);
    }
    discover(now);
    return events_;
}

/// False: it is gone.
bool LiveDevices::drain(Discovery& device) {
    std::uint32_t reports = 0;
    int size = 0;
    const auto full = [&] { return reports == max_drain || used_ >= bytes_per_take || events_.size() >= max_reports; };
    while (!full()) {
        const auto room = std::span(bytes_).subspan(used_, largest_report);
        size = device.handle.read(room);
        if (size <= 0) break;
        DeviceEvent e;
        e.device = device.device;
        e.stamp_ns = clock_.now_ns();
        e.bytes = room.first(static_cast<std::size_t>(size));
        used_ += e.bytes.size();
        ++reports;
        events_.push_back(std::move(e));
    }
    const bool cut = full();  // not read to the end: the rest is old by then
    if (reports > 0 || cut) {
        DeviceEvent e;
        e.kind = DeviceEvent::Kind::drained;
        e.device = device.device;
        e.stamp_ns = clock_.now_ns();
        e.reports = cut ? max_drain : reports;
        events_.push_back(std::move(e));
    }
    return size >= 0;
}

/// Closed only after the next take(), and not by this thread: the events of this one still point into it.
void LiveDevices::lost(std::size_t at, bool failed, std::int64_t now_ns) {
    auto device = std::move(open_[at]);
    open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(at));
    watch();
    DeviceEvent e;
    e.kind = DeviceEvent::Kind::removed;
    e.device = device->device;
    e.stamp_ns = now_ns;
    e.plugged = device->plugged;
    e.why = &unplugged_;
    events_.push_back(std::move(e));
    retired_.push_back({std::move(device), failed});
}

void LiveDevices::discover(std::int64_t now_ns) {
    // What finds no room now waits with the discoverer.
    while (retired_.size() + 2 <= retired_.capacity() && open_.size() < max_open_devices && events_.size() < max_events) {
        auto d = discoverer_->next(now_ns);
        if (!d) return;
        if (d->kind == Discovery::Kind::lost) {
            // A device that hung up was reported before.
            for (std::size_t i = 0; i < open_.size(); ++i)
                if (open_[i]->device == d->device) {
                    lost(i, false, now_ns);
                    events_.back().why = &d->why;
                    break;
                }
            retired_.push_back({std::move(d), false});
            continue;
        }
        DeviceEvent e;
        e.stamp_ns = now_ns;
        e.plugged = d->plugged;
        if (d->kind == Discovery::Kind::found) {
            e.kind = DeviceEvent::Kind::added;
            e.device = d->device;
            e.attachment = d->attachment.get();
            open_.push_back(std::move(d));
            watch();
        } else {
            e.kind = DeviceEvent::Kind::refused;
            e.refused = d->refused;
            e.why = &d->why;
            retired_.push_back({std::move(d), false});
        }
        events_.push_back(std::move(e));
    }
}

Result<std::unique_ptr<LiveDevices>> open_live(FinderOptions options, bool threaded) {
    auto finder = Finder::create(std::move(options));
    if (!finder) return finder.error();
    std::optional<Error> trouble = finder->without_monitor();
    if (!threaded) return std::make_unique<LiveDevices>(inline_discoverer(std::move(*finder)), std::move(trouble));
    auto discoverer = threaded_discoverer(std::move(*finder));
    if (!discoverer) return discoverer.error();
    return std::make_unique<LiveDevices>(std::move(*discoverer), std::move(trouble));
}

}  // namespace surefoot::input
