// A source without any device: where a window alone steers.
#pragma once

#include <algorithm>
#include <vector>

#include "input/devices/source.hpp"
#include "rt/clock/clock.hpp"

namespace surefoot::input {

/// Has no events of its own, and waits for the descriptors that it is given.
class NoDevices final : public DeviceSource {
public:
    NoDevices() { watched_.reserve(max_watched); }

    void wait(std::int64_t until_ns) override {
        const std::int64_t left = std::max<std::int64_t>(0, until_ns - clock_.now_ns());
        const timespec wait{left / 1'000'000'000, left % 1'000'000'000};
        (void)ppoll(watched_.data(), watched_.size(), &wait, nullptr);
    }
    std::span<const DeviceEvent> take() override { return {}; }
    void watch_also(std::span<const pollfd> others) override {
        watched_.assign(others.begin(), others.begin() + static_cast<std::ptrdiff_t>(std::min(others.size(), max_watched)));
    }

private:
    static constexpr std::size_t max_watched = 80;
    rt::RealClock clock_;
    std::vector<pollfd> watched_;
};

}  // namespace surefoot::input
