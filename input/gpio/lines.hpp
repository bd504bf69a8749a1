// GPIO lines behind one interface: libgpiod 1.6, libgpiod 2, or none; and a fake in the tests.
#pragma once

#include <poll.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::input {

enum class Bias : std::uint8_t { as_is, pull_up, pull_down, off };

/// One line to be opened.
struct LineRequest {
    std::string chip;  ///< "gpiochip0", "/dev/gpiochip0", or a chip's label
    std::string line;  ///< a line's name, or its offset as a number
    bool active_low = false;
    Bias bias = Bias::as_is;
};

/// One edge, as the kernel stamped it.
struct LineEdge {
    std::uint32_t line = 0;      ///< index into the requests
    bool active = false;         ///< after active_low
    std::int64_t stamp_ns = 0;   ///< the kernel's, CLOCK_MONOTONIC
    std::uint32_t sequence = 0;  ///< of this line, from 1; 0 where the kernel does not number them (libgpiod 1)
};

/// Requested lines, released by the destructor. One thread calls all members.
class GpioLines {
public:
    GpioLines() = default;
    GpioLines(const GpioLines&) = delete;
    GpioLines& operator=(const GpioLines&) = delete;
    virtual ~GpioLines() = default;

    /// What to poll for POLLIN; stays the same while the object lives.
    [[nodiscard]] virtual std::span<const pollfd> polled() const = 0;
    /// Reads waiting edges, oldest first for each line. Returns their number; 0: none is left. Never blocks. Error: the chip is
    /// gone.
    virtual Result<std::size_t> read(std::span<LineEdge> edges) = 0;
    /// All lines now, index-parallel to the requests, true: active. Error: the chip is gone.
    virtual Result<void> levels(std::span<bool> active) = 0;
};

using OpenLines = Result<std::unique_ptr<GpioLines>> (*)(std::span<const LineRequest> requests, std::string_view consumer,
                                                         void* context);

/// Lines of one chip are one request, so that both lines of an encoder are read at the same moment. Errors name line and chip,
/// and for a busy line its user. `context` is not used.
Result<std::unique_ptr<GpioLines>> open_lines(std::span<const LineRequest> requests, std::string_view consumer, void* context);
/// "libgpiod 1.6.3", or why there is none.
std::string gpio_back_end();

}  // namespace surefoot::input
