// Wired controls as the rest of input/ sees them: emergency stop, dead-man, buttons and encoders, from lines that may break,
// bounce, lose edges or vanish.
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
#include "input/notes.hpp"
#include "input/safety/safety.hpp"

namespace surefoot::input {

enum class LineRole : std::uint8_t { button, stop, stop_reset, dead_man, encoder_a, encoder_b };

struct LineConfig {
    std::string name;  ///< of the control; an encoder's two lines have the same
    LineRole role = LineRole::button;
    LineRequest request;
    bool normally_closed = false;  ///< asserted while the contact is open, so that a broken wire asserts. Always so for stops
    std::int64_t settle_ns = 10'000'000;  ///< of the release; also of stops and resets, never of a dead-man
};

/// Names are unique but for encoders, encoders have two lines of one chip, at most 64 lines. Error: the line's name and what.
Result<void> check_lines(std::span<const LineConfig> lines);

/// Reads the lines; one thread. What the GPIO library needs to read them, or to say that it cannot, is counted as the driver's;
/// nothing else allocates, where the lines are opened beside.
class GpioPanel {
public:
    /// `lines` must have passed check_lines. `opener` and `context`: open_lines, or a fake.
    GpioPanel(std::vector<LineConfig> lines, OpenLines opener, void* context, Opening where = Opening::here);

    /// Returns when the lines have been tried once.
    void wait_for_first_try() { opener_->wait_for_first(); }
    /// Call when a polled descriptor is readable and at every tick: takes lines that were opened, drains, reads levels again,
    /// settles.
    void service(std::int64_t now_ns);

    /// For safety/; its "since the last step" parts begin anew. While the chip is gone: stop asserted, dead-man not held. Closed
    /// until now counts as gone: the first call tells of a stop, which latches; a caller that starts anew takes it and lets it
    /// go.
    Lines take_lines();
    /// Buttons ("name") and encoders ("name", relative: steps since the last report) for map/, index-parallel to state().
    [[nodiscard]] const std::vector<ControlInfo>& controls() const { return controls_; }
    [[nodiscard]] const DeviceState& state() const { return state_; }
    [[nodiscard]] std::span<const pollfd> polled() const;

    [[nodiscard]] bool open() const { return opened_ != nullptr; }
    [[nodiscard]] std::string_view problem() const { return problem_.view(); }  ///< of the last failure; empty: open
    [[nodiscard]] std::uint64_t lost_edges() const;
    [[nodiscard]] std::uint64_t illegal_steps() const;
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
    bool ask_library(const Read& read);
    bool drain(std::int64_t now_ns);
    void take(const LineEdge& edge);
    void turn(std::size_t line);
    void publish(std::int64_t now_ns);
    [[nodiscard]] bool asserted_by(std::size_t line, bool active) const;

    std::vector<LineConfig> configs_;
    std::unique_ptr<LineOpener> opener_;
    std::unique_ptr<OpenedLines> opened_;  ///< null, or with lines
    NoteLine problem_;
    std::vector<Line> state_of_;
    std::vector<Encoder> encoders_;
    std::vector<ControlInfo> controls_;
    DeviceState state_;
    std::array<bool, max_lines> levels_{};
    std::uint64_t opens_ = 0;
    bool was_closed_ = true;  ///< since the last take_lines()
};

}  // namespace surefoot::input
