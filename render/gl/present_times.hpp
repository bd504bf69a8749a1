// When the X server showed the pictures of a window, as its Present extension reports it. By a connection of its own, through
// libraries loaded at run time.
// Source: "The Present Extension" 1.2, PresentCompleteNotify: UST is in microseconds, on Linux of CLOCK_MONOTONIC.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>

#include "render/gl/x11.hpp"

namespace surefoot::gl {

/// One picture that the server is done with.
struct PresentedPicture {
    std::int64_t handed_ns = 0;  ///< it was handed to the driver
    std::int64_t shown_ns = 0;   ///< it was shown; 0: a newer one was shown in its place
};

/// The frame thread calls handed(), another one all else. Nobody waits.
class PresentTimes {
public:
    /// Null where the libraries or the server lack the extension.
    static std::unique_ptr<PresentTimes> open(x11::Id window);
    ~PresentTimes();
    PresentTimes(const PresentTimes&) = delete;
    PresentTimes& operator=(const PresentTimes&) = delete;

    /// Frame thread: a picture is handed to the driver, right now. Mesa numbers the pictures of a surface from 1, and so does
    /// this.
    void handed() noexcept;
    /// Readable when next() may have something.
    [[nodiscard]] int fd() const;
    /// The next picture; false: none waits. Pictures of other numbers or times than could be ours are passed over and counted.
    bool next(PresentedPicture& picture);
    [[nodiscard]] std::uint64_t passed_over() const { return passed_over_; }

private:
    struct Functions;
    PresentTimes() = default;

    std::unique_ptr<const Functions> x_;
    void* connection_ = nullptr;  ///< an xcb_connection_t
    std::uint8_t opcode_ = 0;
    std::array<std::atomic<std::int64_t>, 256> handed_ns_{};  ///< by the number's last 8 bits
    std::uint32_t number_ = 0;                                ///< of the last picture handed over; the frame thread's
    std::uint64_t passed_over_ = 0;
};

}  // namespace surefoot::gl
