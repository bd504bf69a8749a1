// Learns a mapping by demonstration: asks for one movement after the other, and recognises the control that moved furthest.
//
//   rest (everything keeps still) ─► question ─► one control moved far ─► it is back, or stays ─► learned ─► rest before the next
//                                         └─► skipped, or time is up ─────────────────────────────────────┘
//
// A state machine without clock, device or terminal: reports, key strokes and times are given to it.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "input/map/mapping.hpp"

namespace surefoot::input {

/// Times and thresholds of teaching.
struct TeachLimits {
    std::int64_t still_ns = 300'000'000;            ///< all controls must keep still for so long before the next question
    std::int64_t max_rest_wait_ns = 3'000'000'000;  ///< after so long, a trembling control counts as still
    std::int64_t stays_ns = 700'000'000;            ///< a lever that does not come back is taken after so long
    std::int64_t answer_limit_ns = 15'000'000'000;  ///< an unanswered question is skipped after so long
    double tremor = 0.04;                           ///< of the range: what still counts as keeping still
    double moved = 0.5;                             ///< of the travel: a movement beyond it answers the question
    double relative_counts = 300;                   ///< of balls and wheels: so many counts are a full movement
};

/// One answer: this control, moved so, is that action.
struct Learned {
    Action action = Action::none;
    double sign = 1;  ///< -1: the question was for the opposite direction, such as down
    int device = 0;
    std::size_t control = 0;
    Rest rest = Rest::centre;
    bool positive = true;       ///< the control's value grew (a hat: to the right, or up)
    std::uint8_t hat_axis = 0;  ///< 0: right, 1: up
};

/// The open question, and what the controls did since. One thread calls all members.
class Teach {
public:
    enum class Phase : std::uint8_t { rest, question, done };

    explicit Teach(const TeachLimits& limits = {});

    /// Returns its number for observe(). Devices may come at any time.
    int add_device(DeviceIdentity identity, std::vector<ControlInfo> controls);
    /// After each accepted report.
    void observe(int device, const DeviceState& state, std::int64_t now_ns);
    void tick(std::int64_t now_ns);
    /// Skips the open question.
    void skip(std::int64_t now_ns);
    /// No more questions.
    void finish() { phase_ = Phase::done; }

    [[nodiscard]] Phase phase() const { return phase_; }
    /// The prompt for the user: "Move the control that walks forward", ...
    [[nodiscard]] std::string question() const;
    [[nodiscard]] Action action() const { return steps_.empty() ? Action::none : steps_.front().action; }
    [[nodiscard]] double seconds_left(std::int64_t now_ns) const;
    /// The control that moved furthest since the question, and how far (0..1); none below a tenth.
    struct Leader {
        int device = 0;
        std::size_t control = 0;
        double moved = 0;
    };
    [[nodiscard]] std::optional<Leader> leader() const;
    [[nodiscard]] std::span<const Learned> learned() const { return learned_; }
    [[nodiscard]] const ControlInfo& control(int device, std::size_t control) const;

    /// A mapping for each device that has an answer, matched by its ids.
    [[nodiscard]] std::vector<DeviceMapping> mappings() const;

private:
    struct Step {
        Action action = Action::none;
        double sign = 1;
    };
    struct Control {
        bool known = false;          ///< has a rest
        double rest = 0, value = 0;  ///< counts; relative: the sum since the question
        double low = 0, high = 0;    ///< while resting
        double moved = 0;            ///< furthest, signed, of the travel
        std::int8_t hat[2] = {0, 0};
    };
    struct Device {
        DeviceIdentity identity;
        std::vector<ControlInfo> infos;
        std::vector<Control> controls;
    };

    void see(Device& device, std::size_t control, const DeviceState& state, std::int64_t now_ns);
    [[nodiscard]] static double deflection(const ControlInfo& info, const Control& control, const TeachLimits& limits);
    [[nodiscard]] bool eligible(const Device& device, std::size_t control) const;
    [[nodiscard]] bool used(int device, std::size_t control, std::uint8_t hat_axis) const;
    void wait_for_rest(std::int64_t now_ns);
    void begin_question(std::int64_t now_ns);
    void answer(const Leader& leader, std::int64_t now_ns);
    void next(std::int64_t now_ns);

    TeachLimits limits_;
    std::vector<Device> devices_;
    std::deque<Step> steps_;
    std::vector<Learned> learned_;
    Phase phase_ = Phase::rest;
    std::int64_t since_ns_ = -1, still_since_ns_ = -1, moved_since_ns_ = -1;
};

}  // namespace surefoot::input
