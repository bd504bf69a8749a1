// Live devices as a source of events: polls open devices and drains them.
#pragma once

#include <poll.h>

#include <memory>
#include <vector>

#include "input/devices/discoverer.hpp"
#include "input/devices/source.hpp"
#include "rt/clock/clock.hpp"

namespace surefoot::input {

/// Maximum reports that one drain reads from one device. Far above 63: from there on safety/ assumes that the
/// kernel dropped some, and holds the device at rest. So a flooding device does not delay the others.
constexpr std::uint32_t max_drain = 256;

/// Devices of this machine, as the discoverer finds them.
class LiveDevices final : public DeviceSource {
public:
    /// trouble: a limitation of the discoverer.
    explicit LiveDevices(std::unique_ptr<Discoverer> discoverer, std::optional<Error> trouble = {});
    ~LiveDevices() override;

    void wait(std::int64_t until_ns) override;
    std::span<const DeviceEvent> take() override;
    void watch_also(std::span<const pollfd> others) override;
    [[nodiscard]] const std::optional<Error>& trouble() const override { return trouble_; }

    /// Open now.
    [[nodiscard]] std::size_t devices() const { return open_.size(); }

private:
    void discover(std::int64_t now_ns);
    bool drain(Discovery& device);
    void lost(std::size_t at, bool failed, std::int64_t now_ns);
    void watch();

    rt::RealClock clock_;
    std::unique_ptr<Discoverer> discoverer_;
    std::vector<std::unique_ptr<Discovery>> open_;
    struct Retired {
        std::unique_ptr<Discovery> discovery;
        bool failed = false;
    };
    std::vector<Retired> retired_;  ///< targets of pointers in the events of the last take()
    std::vector<pollfd> others_, watched_;
    std::vector<DeviceEvent> events_;
    std::vector<std::byte> bytes_;
    const Error unplugged_;
    std::optional<Error> trouble_;
    std::size_t used_ = 0;
    bool unwatchable_ = false;  ///< some device has no known file descriptor
};

/// Live devices. The finder runs in the same thread, or in its own (`threaded`). With a thread of its own, wait() and take()
/// neither allocate, free nor lock, even while devices come and go. Error: udev cannot be used.
Result<std::unique_ptr<LiveDevices>> open_live(FinderOptions options, bool threaded = false);

}  // namespace surefoot::input
