// The panel of wired controls: emergency stop, dead-man, buttons and encoders, on lines that may break, bounce, lose edges or
// vanish.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "input/controls.hpp"
#include "input/gpio/debounce.hpp"
#include "input/gpio/line_opener.hpp"
#include "input/gpio/lines.hpp"
#include "input/gpio/quadrature.hpp"
#include "input/messages.hpp"
#include "input/safety/safety.hpp"

namespace surefoot::input {

enum class LineRole : std::uint8_t { button, stop, stop_reset, dead_man, encoder_a, encoder_b };

/// One line of the panel, as the steering file describes it.
struct LineConfig {
    std::string name;  ///< of the control; an encoder's two lines have the same
    LineRole role = LineRole::button;
    LineRequest request;
    bool normally_closed = false;  ///< asserted while the contact is open, so a broken wire asserts; always true for stops
    std::int64_t debounce_ns = 10'000'000;  ///< debounce of the release; also for stops and resets, never for a dead-man
};

/// Checks: names are unique except for encoders; an encoder has two lines of one chip; at most 64 lines. Errors name the line.
Result<void> check_lines(std::span<const LineConfig> lines);

/// Reads the lines; one thread. Allocations of the GPIO library count as the driver's. With Opening::own_thread,
/// nothing else allocates.
class GpioPanel {
public:
    /// `lines` must have passed check_lines. `opener` and `context`: open_lines, or a fake.
    GpioPanel(std::vector<LineConfig> lines, OpenLines opener, void* context, Opening where = Opening::same_thread);

    /// Returns when the lines have been tried once.
    void wait_for_first_try() { opener_->wait_for_first(); }
    /// Call it when a polled descriptor is readable, and at every tick. Takes opened lines, drains edges, reads levels again, and
    /// debounces.
    void service(std::int64_t now_ns);

    /// The state for safety/; resets its "since the last step" members. While the chip is missing: stop asserted, dead-man not
    /// held. Before the first opening the chip counts as missing, so the first call reports a stop, which would latch. A caller
    /// that starts must call it once and ignore the result.
    Lines take_lines();
    /// Buttons ("name") and encoders ("name", relative: steps since the last report) for map/, index-parallel to state().
    [[nodiscard]] const std::vector<ControlInfo>& controls() const { return controls_; }
    [[nodiscard]] const DeviceState& state() const { return state_; }
    [[nodiscard]] std::span<const pollfd> polled() const;

    [[nodiscard]] bool open() const { return opened_ != nullptr; }
    [[nodiscard]] std::string_view problem() const { return problem_.view(); }  ///< of the last failure; empty: open
    [[nodiscard]] std::uint64_t lost_edges() const;
    /// Missed steps of encoders. Their direction is unknown, so they do not count as steps.
    [[nodiscard]] std::uint64_t illegal_encoder_steps() const;
    [[nodiscard]] std::uint64_t opens() const { return opens_; }

private:
    struct Line {
        Contact contact;
        std::size_t control = 0;  ///< index into controls_; only of buttons and encoders
        std::size_t partner = 0;  ///< an encoder's other line
        std::uint32_t sequence = 0, releases_taken = 0, presses_taken = 0;
    };
    struct Encoder {
        Quadrature decoder;
        std::size_t a = 0, b = 0, control = 0;
        std::int64_t reported = 0;
    };
    void take_opened(std::int64_t now_ns);
    void start();
    void close(std::int64_t now_ns);
    template <class Read>
    bool call_library(const Read& read);
    bool drain(std::int64_t now_ns);
    void take(const LineEdge& edge);
    void turn(Encoder& encoder);
    void publish(std::int64_t now_ns);
    [[nodiscard]] bool asserted_by(std::size_t line, bool active) const;

    std::vector<LineConfig> configs_;
    std::unique_ptr<LineOpener> opener_;
    std::unique_ptr<OpenedLines> opened_;  ///< null, or with lines
    MessageLine problem_;
    std::vector<Line> state_of_;
    std::vector<Encoder> encoders_;
    std::vector<ControlInfo> controls_;
    DeviceState state_;
    std::array<bool, max_lines> levels_{};
    std::uint64_t opens_ = 0;
    bool was_closed_ = true;  ///< since the last take_lines()
};

}  // namespace surefoot::input
