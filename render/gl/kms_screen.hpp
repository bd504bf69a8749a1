// A screen as the frame thread drives it: shows each picture at the next refresh, and gets a screen back that was taken away. It
// knows no kernel: a ScreenPort does.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "rt/base/shown.hpp"

namespace surefoot::gl {

/// The kernel's id of a buffer that a card can show.
using ShownBuffer = std::uint32_t;

/// What the kernel says of a flip.
struct Flip {
    bool done = false;         ///< false: no event came within the time
    std::int64_t time_ns = 0;  ///< CLOCK_MONOTONIC
};

/// What a screen is driven by: a card of the kernel, or a test's. Each int is an errno; 0: done.
class ScreenPort {
public:
    virtual ~ScreenPort() = default;

    // ---- the thread that presents; flips and their events allocate nothing ----
    /// Becomes the one program that may show. EBUSY, EACCES, EPERM: another one holds the card.
    virtual int take() = 0;
    /// Sets the mode anew, with this picture on it and nothing else. Returns when it is shown.
    virtual int set_mode(ShownBuffer buffer) = 0;
    /// Shows the buffer at the next refresh. Returns at once; wait_flip() tells when that was.
    virtual int flip(ShownBuffer buffer) = 0;
    virtual Flip wait_flip(std::int64_t timeout_ns) = 0;
    /// The card counts refreshes and stamps them. Known once the mode is set.
    [[nodiscard]] virtual bool counts_refreshes() const = 0;

    // ---- any other thread ----
    /// Whether a screen hangs there. `probe`: asks the screen itself, which may take a tenth of a second.
    virtual bool connected(bool probe) = 0;
    /// Whether it still has the mode. Asked after it was plugged in again.
    virtual bool has_mode() = 0;
    /// Whether the link to the screen failed: it stays dark until its mode is set anew.
    virtual bool link_failed() = 0;
    /// Programs that hold the card: "Xorg (412)"; empty where that cannot be found out.
    virtual std::string holders() = 0;
};

/// Why no picture is shown.
enum class ScreenState : std::uint8_t {
    not_set,  ///< the mode is to be set, with the next picture
    showing,
    held,     ///< another program has the card
    refused,  ///< the card refused the mode, or never told of a flip
    gone,     ///< the card is gone, or the screen lost the mode: it must be opened again
};

/// present() is called by one thread; watch() by another.
class KmsScreen {
public:
    /// `name`: for messages. `now_ns`: CLOCK_MONOTONIC.
    KmsScreen(ScreenPort& port, std::string name, std::int64_t refresh_ns, std::int64_t (*now_ns)());
    KmsScreen(const KmsScreen&) = delete;
    KmsScreen& operator=(const KmsScreen&) = delete;

    /// Whether present() returns when the picture is shown, which it does at first. Else it returns when the picture is queued,
    /// and tells no time. Before the first frame.
    void wait_for_flips(bool wait) { waits_ = wait; }
    /// Shows the buffer at the next refresh. One flip is in flight at most: it waits for the one before. While the screen is away
    /// it tries to get it back twice a second, and shows nothing.
    rt::Shown present(ShownBuffer buffer);
    [[nodiscard]] ScreenState state() const { return state_.load(std::memory_order_relaxed); }

    /// Whether the screen is there. Returns what has changed since the last call, a line each. Call it a few times a second.
    std::vector<std::string> watch();

private:
    rt::Shown set_mode(ShownBuffer buffer);
    rt::Shown flip(ShownBuffer buffer);
    rt::Shown fail(int error);
    void watch_plug(std::vector<std::string>& lines);

    ScreenPort& port_;
    std::string name_;
    std::int64_t refresh_ns_;
    std::int64_t (*now_ns_)();
    std::int64_t retry_ns_ = 0;  ///< before that nothing is tried
    bool waits_ = true;
    bool in_flight_ = false;  ///< a flip that nobody has waited for
    std::atomic<ScreenState> state_{ScreenState::not_set};
    std::atomic<int> error_{0};           ///< of the last refusal
    std::atomic<bool> set_anew_{false};   ///< by watch(): the screen was plugged in again
    std::atomic<bool> lost_mode_{false};  ///< by watch()
    // ---- watch()'s own ----
    ScreenState reported_ = ScreenState::not_set;
    bool plugged_ = true;
    std::int64_t watched_ns_ = 0, probed_ns_ = 0, link_ns_ = 0;
};

}  // namespace surefoot::gl
