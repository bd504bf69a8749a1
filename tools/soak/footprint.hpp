// Samples memory, descriptors and threads of this process over hours. A thread of its own reads them from /proc.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "tools/soak/summary.hpp"

namespace surefoot::soak {

/// Now; the time is the caller's to fill in.
SoakSample read_footprint();

/// Samples into memory that was set aside before, so that watching for growth does not grow.
class Footprint {
public:
    explicit Footprint(std::size_t max_samples) { samples_.reserve(max_samples); }
    ~Footprint() { stop(); }
    Footprint(const Footprint&) = delete;
    Footprint& operator=(const Footprint&) = delete;

    /// Takes one now, as of this time; beyond the most, none.
    void take(double time_s);
    /// From now on a thread takes one every `every_s`, times counted from start_ns. `also` is called before each.
    void watch(std::int64_t start_ns, double every_s, std::function<void(double time_s)> also = {});
    void stop();
    /// After stop().
    [[nodiscard]] const std::vector<SoakSample>& samples() const { return samples_; }

private:
    std::vector<SoakSample> samples_;
    std::atomic<bool> stopping_{false};
    std::thread thread_;
};

}  // namespace surefoot::soak
