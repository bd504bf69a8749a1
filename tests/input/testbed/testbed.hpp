// Synthetic hidraw devices for the real hidapi and libudev: sysfs, nodes, ioctls and udev events by umockdev.
#pragma once

#include <gtest/gtest.h>
#include <umockdev.h>

#include <atomic>
#include <deque>
#include <set>
#include <string>
#include <thread>

#include "input/devices/live.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input::test {

/// What stands behind a node.
enum class Wire {
    pipe,      ///< keeps reports apart and drops the newest when 63 wait, as hidraw does; cannot hang up
    terminal,  ///< hangs up when pulled, as hidraw does; reports run together if they come faster than they are read
};

/// One plugged device; pull() it before it is plugged again.
struct Plug {
    std::string node, place, hid_place;
    int fd = -1;    ///< the device's end
    int tail = -1;  ///< a terminal's other end, to see what waits there
};

struct Facts {
    std::string node = "hidraw0";
    std::string socket = "usb-0000:00:14.0-1/input0";
    std::string serial{};
    Wire wire = Wire::pipe;
    bool readable = true;
};

/// Counts how long this process has stood still though it wanted to run: stopped, or its machine was. Limits on time are for the
/// rest.
class HoldUps {
public:
    HoldUps();
    ~HoldUps();
    HoldUps(const HoldUps&) = delete;
    HoldUps& operator=(const HoldUps&) = delete;
    [[nodiscard]] double ms() const;

private:
    std::atomic<std::int64_t> ns_{0}, beat_ns_{0};
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

/// A limit on waiting that runs on by at most 100 ms a look: whoever was stopped in between has as much patience as before.
class Patience {
public:
    explicit Patience(int ms);
    bool over();

private:
    std::int64_t left_ns_, looked_ns_;
};

class Testbed {
public:
    Testbed();
    ~Testbed();
    Testbed(const Testbed&) = delete;
    Testbed& operator=(const Testbed&) = delete;

    /// A device of tests/input/devices appears: node, sysfs, then udev's "add".
    Plug plug(const Recording& recording, const Facts& facts = {});
    /// False: dropped, because nobody has read for so long.
    static bool send(Plug& plug, std::span<const std::byte> report);
    /// Of a terminal: waits until everything sent was read, so that the next report does not run together with it.
    static bool taken(const Plug& plug, int within_ms);
    /// As a cable: the node hangs up first (a terminal), then sysfs and udev tell.
    void pull(Plug& plug);
    /// Hangs up; udev says nothing yet.
    void hang_up(Plug& plug);
    /// udev's rules have run: the node may be read.
    void permit(const Plug& plug, bool send_event = true);

    [[nodiscard]] const std::string& root() const { return root_; }
    [[nodiscard]] double held_up_ms() const { return hold_ups_.ms(); }

private:
    HoldUps hold_ups_;
    UMockdevTestbed* bed_;
    std::string root_;
    std::set<std::string> answering_;
    int plugged_ = 0;
};

/// While it lives, this thread and those that it starts obey the modes of files even as root: else no permission is ever refused.
class NoOverride {
public:
    NoOverride();
    ~NoOverride();
    NoOverride(const NoOverride&) = delete;
    NoOverride& operator=(const NoOverride&) = delete;
};

std::int64_t now_ns();
std::size_t open_descriptors();

/// Polls until an event of that kind comes (true), or for `within_ms`. All events are appended to the log.
class Watcher {
public:
    explicit Watcher(DeviceSource& source) : source_(source) {}
    struct Seen {
        DeviceEvent event;
        std::vector<std::byte> bytes;
        Error why;
    };
    const Seen* next(DeviceEvent::Kind kind, int within_ms = 2000);
    /// Everything within so long.
    void watch_for(int ms);
    [[nodiscard]] std::size_t count(DeviceEvent::Kind kind) const;
    std::deque<Seen> seen;  ///< what next() returned stays where it is

private:
    void take(std::span<const DeviceEvent> events);
    DeviceSource& source_;
    std::size_t looked_at_ = 0;
};

}  // namespace surefoot::input::test
