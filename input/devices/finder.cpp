// The finder: compares what is listed with what is known, so that lost or doubled events do no harm.
#include "input/devices/finder.hpp"

#include <fmt/format.h>
#include <libudev.h>

#include <algorithm>
#include <cerrno>
#include <set>

#include "input/devices/hid_list.hpp"

namespace surefoot::input {

namespace {

constexpr std::int64_t look_around_ns = 2'000'000'000;        // with a monitor: in case udevd is not there
constexpr std::int64_t look_around_without_ns = 200'000'000;  // without: still within 250 ms

std::string place_text(const PluggedDevice& p) { return p.name.empty() ? p.node : fmt::format("{} ({})", p.node, p.name); }

Error open_error(const PluggedDevice& p, int code, const std::string& what) {
    if (code == EACCES || code == EPERM) {
        return {place_text(p), "The device cannot be opened and is tried again: " + what,
                "Install 70-surefoot.rules in /etc/udev/rules.d, run `udevadm control --reload` and "
                "`udevadm trigger --subsystem-match=hidraw`, and add this user to the group surefoot-input",
                ErrorKind::no_device};
    }
    return {place_text(p), "The device cannot be opened and is tried again: " + what, "Unplug it and plug it in again",
            ErrorKind::no_device};
}

}  // namespace

std::string PluggedDevice::identity() const {
    // Interfaces of one device share its serial; the end of the socket tells them apart.
    const auto interface = socket.rfind('/');
    const std::string part = interface == std::string::npos ? std::string() : socket.substr(interface);
    return fmt::format("{:04x}:{:04x} {}", vendor, product, serial.empty() ? socket : serial + part);
}

bool steers_by_class(const PluggedDevice& p) {
    return p.device.device_class == DeviceClass::navigation || p.device.device_class == DeviceClass::buttons;
}

Result<Finder> Finder::create(FinderOptions options) {
    Finder f;
    f.options_ = std::move(options);
    f.context_.reset(udev_new());
    if (!f.context_) return Error{"udev", "The library cannot be used: no memory", "Close other programs", ErrorKind::no_memory};
    auto monitor = UdevMonitor::listen(f.context_.get());
    if (monitor)
        f.monitor_ = std::move(*monitor);
    else
        f.without_monitor_ = monitor.error();
    return f;
}

std::int64_t Finder::due_ns() const {
    std::int64_t due = scan_due_ns_;
    for (const auto& [place, entry] : entries_)
        if (entry.state == State::waiting) due = std::min(due, entry.retry.next_ns);
    return due;
}

std::vector<Discovery> Finder::look(std::int64_t now_ns) {
    std::vector<Discovery> out;
    UdevMonitor::Changes changes;
    if (monitor_) changes = monitor_->take_changes();
    for (auto& [place, entry] : entries_) {
        const bool touched = std::find(changes.changed.begin(), changes.changed.end(), place) != changes.changed.end();
        if (entry.state == State::waiting && (touched || changes.lost)) entry.retry.hurry(now_ns);
    }
    if (changes.any || now_ns >= scan_due_ns_) scan(out, now_ns);
    for (auto& [place, entry] : entries_)
        if (entry.state == State::waiting && entry.retry.due(now_ns)) try_open(out, entry, now_ns);
    return out;
}

void Finder::scan(std::vector<Discovery>& out, std::int64_t now_ns) {
    scan_due_ns_ = now_ns + (monitor_ ? look_around_ns : look_around_without_ns);
    const auto nodes = list_nodes(context_.get());
    std::set<std::string> there;
    for (const ListedNode& n : nodes) there.insert(n.place);
    // Lost devices are reported before found ones, so that a replugged device is not counted as two.
    for (auto i = entries_.begin(); i != entries_.end();) {
        if (there.contains(i->first)) {
            ++i;
            continue;
        }
        if (i->second.state == State::open) {
            Discovery d;
            d.kind = Discovery::Kind::lost;
            d.device = i->second.device;
            d.plugged = i->second.plugged;
            d.why = {place_text(*d.plugged), "The device was unplugged", "Plug it in again", ErrorKind::no_device};
            out.push_back(std::move(d));
        }
        i = entries_.erase(i);
    }
    for (const ListedNode& n : nodes) {
        if (entries_.contains(n.place)) continue;
        std::optional<Error> trouble;
        Entry entry;
        entry.plugged = std::make_shared<const PluggedDevice>(read_node(context_.get(), n, trouble));
        classify(out, n.place, entry, trouble);
    }
}

void Finder::classify(std::vector<Discovery>& out, const std::string& place, Entry& entry, const std::optional<Error>& trouble) {
    const PluggedDevice& p = *entry.plugged;
    Discovery d;
    d.kind = Discovery::Kind::refused;
    d.plugged = entry.plugged;
    if (trouble) {
        d.refused = Refused::descriptor;
        d.why = *trouble;
        out.push_back(std::move(d));
    } else if (!options_.wanted(p)) {
        d.refused = Refused::unwanted;
        d.why = {place_text(p), "The device does not steer: " + p.device.reason,
                 "Name it in a [[device]] of the steering file to use it all the same", ErrorKind::unsupported};
        out.push_back(std::move(d));
    } else {
        entry.state = State::waiting;  // due at once
    }
    entries_.emplace(place, std::move(entry));
}

void Finder::try_open(std::vector<Discovery>& out, Entry& entry, std::int64_t now_ns) {
    Discovery d;
    d.plugged = entry.plugged;
    if (!options_.open || d.handle.open(entry.plugged->node)) {
        d.kind = Discovery::Kind::found;
        d.device = entry.device = next_number_++;
        if (options_.attachment_factory) d.attachment = options_.attachment_factory(*entry.plugged);
        entry.state = State::open;
        entry.last_reported.clear();
        out.push_back(std::move(d));
        return;
    }
    entry.retry.failed(now_ns);
    const int code = d.handle.code();
    if (code == ENOENT || code == ENODEV || code == ENXIO) return;  // just unplugged: the next scan reports it
    d.kind = Discovery::Kind::refused;
    d.refused = code == EACCES || code == EPERM ? Refused::permission : Refused::failed;
    d.why = open_error(*entry.plugged, code, d.handle.what());
    if (entry.last_reported == d.why.what) return;
    entry.last_reported = d.why.what;
    out.push_back(std::move(d));
}

void Finder::failed(int device, std::int64_t now_ns) {
    for (auto& [place, entry] : entries_) {
        if (entry.state != State::open || entry.device != device) continue;
        entry.state = State::waiting;
        entry.device = -1;
        entry.retry.failed(now_ns);
    }
}

}  // namespace surefoot::input
