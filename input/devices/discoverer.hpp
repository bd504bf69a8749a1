// The finder at work: in the reader's own thread (tools), or in a thread beside it that hands devices over complete (the walk).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "input/devices/finder.hpp"

namespace surefoot::input {

class Discoverer {
public:
    virtual ~Discoverer() = default;
    /// The next discovery, or null. Those that are `found` stay with the reader until it gives them back.
    virtual std::unique_ptr<Discovery> next(std::int64_t now_ns) = 0;
    /// A discovery that the reader is done with. `failed`: reading its device failed, so it may be opened again.
    virtual void give_back(std::unique_ptr<Discovery> discovery, bool failed, std::int64_t now_ns) = 0;
    /// Readable when next() has something, or may have; -1: ask at due_ns().
    [[nodiscard]] virtual int fd() const = 0;
    [[nodiscard]] virtual std::int64_t due_ns() const = 0;
};

/// Looks whenever it is asked.
std::unique_ptr<Discoverer> discover_here(Finder finder);
constexpr const char* devices_thread_name = "sf-devices";
/// A thread of its own named devices_thread_name, at SCHED_OTHER: neither opening a device nor closing one ever holds up the reader,
/// whose calls allocate nothing, free nothing and take no lock.
Result<std::unique_ptr<Discoverer>> discover_beside(Finder finder);

}  // namespace surefoot::input
