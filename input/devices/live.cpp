// The live source. A device that hangs up is told as removed by its own read, before udev says so.
#include "input/devices/live.hpp"

#include <algorithm>

namespace surefoot::input {

namespace {

constexpr std::size_t largest_report = 16384 + 1;  // the kernel's HID_MAX_BUFFER_SIZE and an id
constexpr std::size_t bytes_per_take = 1U << 20U;
constexpr std::int64_t ask_again_ns = 2'000'000;  // where a descriptor could not be found

}  // namespace

LiveDevices::LiveDevices(std::unique_ptr<Discoverer> discoverer)
    : discoverer_(std::move(discoverer)), bytes_(bytes_per_take + largest_report) {
    constexpr std::size_t most_devices = 64;
    open_.reserve(most_devices);
    told_.reserve(most_devices);
    watched_.reserve(most_devices + 1);
    events_.reserve(most_devices * (max_drain + 2));
    watch();
}

LiveDevices::~LiveDevices() {
    open_.clear();
    told_.clear();
}

void LiveDevices::watch() {
    watched_.clear();
    watched_.push_back({discoverer_->fd(), POLLIN, 0});  // poll() passes over -1
    unwatchable_ = false;
    for (const auto& d : open_) {
        watched_.push_back({d->handle.fd(), POLLIN, 0});
        unwatchable_ = unwatchable_ || d->handle.fd() < 0;
    }
}

void LiveDevices::wait(std::int64_t until_ns) {
    const std::int64_t now = clock_.now_ns();
    until_ns = std::min(until_ns, discoverer_->due_ns());
    if (unwatchable_) until_ns = std::min(until_ns, now + ask_again_ns);
    const std::int64_t left = std::max<std::int64_t>(0, until_ns - now);
    const timespec wait{left / 1'000'000'000, left % 1'000'000'000};
    (void)ppoll(watched_.data(), watched_.size(), &wait, nullptr);
}

std::span<const DeviceEvent> LiveDevices::take() {
    events_.clear();
    used_ = 0;
    const std::int64_t now = clock_.now_ns();
    for (auto& d : told_) discoverer_->give_back(std::move(d), false, now);
    told_.clear();
    for (std::size_t i = 0; i < open_.size();) {
        if (drain(*open_[i]))
            ++i;
        else
            lost(i, {open_[i]->plugged->node, "was unplugged, or cannot be read any more", ""}, true, now);
    }
    discover(now);
    return events_;
}

/// False: it is gone.
bool LiveDevices::drain(Discovery& device) {
    std::uint32_t reports = 0;
    int size = 0;
    while (reports < max_drain && used_ < bytes_per_take) {
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
    const bool cut = reports == max_drain || used_ >= bytes_per_take;  // not read to the end: the rest is old by then
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

void LiveDevices::lost(std::size_t at, const Error& why, bool failed, std::int64_t now_ns) {
    auto device = std::move(open_[at]);
    open_.erase(open_.begin() + static_cast<std::ptrdiff_t>(at));
    watch();
    DeviceEvent e;
    e.kind = DeviceEvent::Kind::removed;
    e.device = device->device;
    e.stamp_ns = now_ns;
    e.plugged = device->plugged;
    device->why = why;
    e.why = &device->why;
    events_.push_back(std::move(e));
    if (failed) {
        // It goes back, and is closed, at once; the reason stays until the next take().
        auto reason = std::make_unique<Discovery>();
        reason->why = std::move(device->why);
        events_.back().why = &reason->why;
        told_.push_back(std::move(reason));
        discoverer_->give_back(std::move(device), true, now_ns);
    } else {
        told_.push_back(std::move(device));
    }
}

void LiveDevices::discover(std::int64_t now_ns) {
    while (auto d = discoverer_->next(now_ns)) {
        if (d->kind == Discovery::Kind::lost) {
            // A device that hung up before is told already.
            for (std::size_t i = 0; i < open_.size(); ++i)
                if (open_[i]->device == d->device) {
                    lost(i, d->why, false, now_ns);
                    break;
                }
            told_.push_back(std::move(d));
            continue;
        }
        DeviceEvent e;
        e.stamp_ns = now_ns;
        e.plugged = d->plugged;
        if (d->kind == Discovery::Kind::found) {
            e.kind = DeviceEvent::Kind::added;
            e.device = d->device;
            open_.push_back(std::move(d));
            watch();
        } else {
            e.kind = DeviceEvent::Kind::refused;
            e.refused = d->refused;
            e.why = &d->why;
            told_.push_back(std::move(d));
        }
        events_.push_back(std::move(e));
    }
}

Result<std::unique_ptr<LiveDevices>> open_live(FinderOptions options, bool beside) {
    auto finder = Finder::create(std::move(options));
    if (!finder) return finder.error();
    if (!beside) return std::make_unique<LiveDevices>(discover_here(std::move(*finder)));
    auto discoverer = discover_beside(std::move(*finder));
    if (!discoverer) return discoverer.error();
    return std::make_unique<LiveDevices>(std::move(*discoverer));
}

}  // namespace surefoot::input
