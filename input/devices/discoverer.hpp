// Runs the finder in the reader's thread (tools), or in its own thread that hands over complete devices (the walk).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "input/devices/finder.hpp"

namespace surefoot::input {

/// Finds devices, on its caller's thread or on its own. One thread calls all members.
class Discoverer {
public:
    virtual ~Discoverer() = default;
    /// The next discovery, or null. Those that are `found` stay with the reader until it gives them back.
    virtual std::unique_ptr<Discovery> next(std::int64_t now_ns) = 0;
    /// Returns a discovery that the reader no longer needs. `failed`: reading its device failed, so it may be opened again.
    virtual void give_back(std::unique_ptr<Discovery> discovery, bool failed, std::int64_t now_ns) = 0;
    /// Readable when next() has something, or may have; -1: call next() at due_ns().
    [[nodiscard]] virtual int fd() const = 0;
    [[nodiscard]] virtual std::int64_t due_ns() const = 0;
};

/// A discoverer that looks for devices inside next(), on the thread that calls it.
std::unique_ptr<Discoverer> inline_discoverer(Finder finder);
constexpr const char* devices_thread_name = "sf-devices";
/// Starts a thread named devices_thread_name, at SCHED_OTHER. Opening and closing devices never delays the reader, whose calls
/// neither allocate, free nor lock.
Result<std::unique_ptr<Discoverer>> threaded_discoverer(Finder finder);

}  // namespace surefoot::input
