// Showing pictures, and getting the screen back (kms_screen.hpp).
#include "render/gl/kms_screen.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace surefoot::gl {

namespace {

constexpr std::int64_t retry_every_ns = 500'000'000;
constexpr std::int64_t watch_every_ns = 500'000'000;
constexpr std::int64_t probe_every_ns = 10'000'000'000;  // a probe talks to the screen over a slow wire
constexpr std::int64_t min_flip_wait_ns = 250'000'000;   // cards without refreshes stamp a flip when it is done

bool held_by_another(int error) { return error == EBUSY || error == EACCES || error == EPERM; }
bool card_is_gone(int error) { return error == ENODEV || error == ENXIO || error == EBADF || error == EIO; }

}  // namespace

KmsScreen::KmsScreen(ScreenPort& port, std::string name, std::int64_t refresh_ns, std::int64_t (*now_ns)())
    : port_(port), name_(std::move(name)), refresh_ns_(refresh_ns), now_ns_(now_ns) {}

rt::Shown KmsScreen::present(ShownBuffer buffer) {
    if (lost_mode_.load(std::memory_order_relaxed)) state_.store(ScreenState::gone, std::memory_order_relaxed);
    if (set_anew_.exchange(false, std::memory_order_relaxed) && state() == ScreenState::showing)
        state_.store(ScreenState::not_set, std::memory_order_relaxed);
    switch (state()) {
        case ScreenState::gone:
            return {};
        case ScreenState::showing:
            return flip(buffer);
        case ScreenState::not_set:
        case ScreenState::held:
        case ScreenState::refused:
            break;
    }
    if (state() != ScreenState::not_set && now_ns_() < retry_ns_) return {};
    return set_mode(buffer);
}

/// Nothing that another program set may be relied on, so the whole mode is set.
rt::Shown KmsScreen::set_mode(ShownBuffer buffer) {
    in_flight_ = false;
    if (const int error = port_.take(); error != 0) return fail(error);
    if (const int error = port_.set_mode(buffer); error != 0) return fail(error);
    state_.store(ScreenState::showing, std::memory_order_relaxed);
    return {rt::ShownBy::hand_over, 0, 0};
}

rt::Shown KmsScreen::flip(ShownBuffer buffer) {
    const std::int64_t longest_wait_ns = std::max(3 * refresh_ns_, min_flip_wait_ns);
    if (std::exchange(in_flight_, false) && !port_.wait_flip(longest_wait_ns).done) return fail(ETIME);
    int error = port_.flip(buffer);
    if (error == EBUSY) {  // the flip before has not been shown yet
        (void)port_.wait_flip(longest_wait_ns);
        error = port_.flip(buffer);
    }
    if (error == EBUSY) error = ETIME;  // not another program: that is EACCES here
    if (error != 0) return fail(error);
    if (!waits_) {
        in_flight_ = true;
        return {rt::ShownBy::hand_over, 0, 0};
    }
    const std::int64_t queued_ns = now_ns_();
    const Flip shown = port_.wait_flip(longest_wait_ns);
    if (!shown.done) return fail(ETIME);
    if (!port_.counts_refreshes()) return {rt::ShownBy::hand_over, 0, 0};
    return {rt::ShownBy::display, shown.time_ns, queued_ns};
}

rt::Shown KmsScreen::fail(int error) {
    error_.store(error, std::memory_order_relaxed);
    const ScreenState state = card_is_gone(error)      ? ScreenState::gone
                              : held_by_another(error) ? ScreenState::held
                                                       : ScreenState::refused;
    // A screen that has just refused a flip may take the whole mode at once.
    const bool at_once = this->state() == ScreenState::showing && state == ScreenState::refused;
    state_.store(at_once ? ScreenState::not_set : state, std::memory_order_relaxed);
    retry_ns_ = now_ns_() + retry_every_ns;
    return {};
}

std::vector<std::string> KmsScreen::watch() {
    std::vector<std::string> lines;
    const ScreenState now = state();
    if (now != reported_) {
        const std::string refusal = std::strerror(error_.load(std::memory_order_relaxed));
        switch (now) {
            case ScreenState::held: {
                const std::string holders = port_.holders();
                lines.push_back(
                    fmt::format("screen {}: Another program holds it{}. Nothing is shown until that program leaves it.", name_,
                                holders.empty() ? "" : ": " + holders));
                break;
            }
            case ScreenState::refused:
                lines.push_back(
                    fmt::format("screen {}: The card refuses its mode ({}). It is asked twice a second.", name_, refusal));
                break;
            case ScreenState::gone:
                lines.push_back(fmt::format("screen {}: The card is gone, or the mode is.", name_));
                break;
            case ScreenState::showing:
                if (reported_ != ScreenState::not_set) lines.push_back(fmt::format("screen {}: It shows pictures again.", name_));
                break;
            case ScreenState::not_set:
                break;
        }
        // A change of the mode in between is no news.
        if (now != ScreenState::not_set) reported_ = now;
    }
    watch_plug(lines);
    return lines;
}

/// Flips continue while the screen is unplugged. Once it is plugged in again, it is dark until its mode is set.
void KmsScreen::watch_plug(std::vector<std::string>& lines) {
    const std::int64_t now = now_ns_();
    if (state() == ScreenState::gone || now - watched_ns_ < watch_every_ns) return;
    watched_ns_ = now;
    const bool probe = now - probed_ns_ >= probe_every_ns || !plugged_;
    if (probe) probed_ns_ = now;
    const bool plugged = port_.connected(probe);
    if (plugged && plugged_ && now - link_ns_ >= probe_every_ns && port_.link_failed()) {
        link_ns_ = now;
        lines.push_back(fmt::format("screen {}: Its link failed, so its mode is set.", name_));
        set_anew_.store(true, std::memory_order_relaxed);
    }
    if (plugged == plugged_) return;
    plugged_ = plugged;
    if (!plugged) {
        lines.push_back(fmt::format("screen {}: It was unplugged.", name_));
        return;
    }
    if (port_.has_mode()) {
        lines.push_back(fmt::format("screen {}: It was plugged in again, so its mode is set.", name_));
        set_anew_.store(true, std::memory_order_relaxed);
    } else {
        lines.push_back(fmt::format("screen {}: It was plugged in again, and has other modes now.", name_));
        lost_mode_.store(true, std::memory_order_relaxed);
    }
}

}  // namespace surefoot::gl
