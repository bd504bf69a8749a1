// A real HID device made through /dev/uhid: the kernel's own HID core, hidraw and evdev stand on it.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "input/replay/recording.hpp"

namespace surefoot::vm {

/// Answers a GET_REPORT (numbered, with its id first) or takes a SET_REPORT; nothing: EIO.
struct Features {
    std::function<std::optional<std::vector<std::byte>>(std::uint8_t id)> get;
    std::function<bool(std::uint8_t id, std::span<const std::byte> data)> set;
};

class UhidDevice {
public:
    /// Plugged in when it is made: name, ids and descriptor are the recording's.
    explicit UhidDevice(const input::Recording& like, const std::string& serial = {}, Features features = {});
    ~UhidDevice() { unplug(); }
    UhidDevice(const UhidDevice&) = delete;
    UhidDevice& operator=(const UhidDevice&) = delete;

    /// False: the kernel did not take it.
    bool send(std::span<const std::byte> report);
    /// As a pulled cable. Returns when the kernel has taken everything down.
    void unplug();
    [[nodiscard]] bool plugged() const { return fd_ >= 0; }
    /// "hidraw3" when the kernel has made it; empty: not within so long. Needs a serial that no other device has.
    [[nodiscard]] std::string node(int within_ms = 2000) const;

private:
    void serve();
    int fd_ = -1;
    std::string serial_;
    Features features_;
    std::atomic<bool> ending_ = false;
    std::thread server_;
};

}  // namespace surefoot::vm
