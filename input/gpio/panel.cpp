// The panel: lines to contacts, encoders and controls.
#include "input/gpio/panel.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "rt/base/check.hpp"
#include "rt/threads/guard.hpp"

namespace surefoot::input {

namespace {

constexpr std::size_t edges_at_once = 64;
constexpr int drains_a_service = 64;  // a line that toggles for ever must not hold us for ever

bool is_encoder(LineRole role) { return role == LineRole::encoder_a || role == LineRole::encoder_b; }

ControlInfo control_of(const LineConfig& line) {
    ControlInfo info;
    info.name = line.name;
    info.collection = "gpio";
    info.usage_page = is_encoder(line.role) ? 0x01 : 0x09;
    info.usage = is_encoder(line.role) ? 0x37 : 0;
    info.kind = is_encoder(line.role) ? ControlKind::axis : ControlKind::button;
    info.relative = is_encoder(line.role);
    info.logical_max = 1;
    return info;
}

}  // namespace

Result<void> check_lines(std::span<const LineConfig> lines) {
    const auto refuse = [](const LineConfig& line, std::string what, std::string remedy) {
        return Error{fmt::format("gpio line '{}'", line.name), std::move(what), std::move(remedy), ErrorKind::misuse};
    };
    if (lines.size() > max_lines)
        return Error{"gpio", fmt::format("The file declares {} lines; at most 64 are allowed", lines.size()), "Remove some",
                     ErrorKind::out_of_limits};
    for (const LineConfig& line : lines) {
        if (line.name.empty() || line.request.chip.empty() || line.request.line.empty())
            return refuse(line, "The line has no name, chip or offset", "Give all three");
        const auto count = [&](auto&& fits) { return std::count_if(lines.begin(), lines.end(), fits); };
        const auto same_name = count([&](const LineConfig& other) { return other.name == line.name; });
        const auto same_place = count([&](const LineConfig& other) {
            return other.request.chip == line.request.chip && other.request.line == line.request.line;
        });
        if (same_place != 1) return refuse(line, "Another entry uses the same line", "Give each line one role");
        if (!is_encoder(line.role)) {
            if (same_name != 1)
                return refuse(line, "The name is used twice", "Choose another name: only an encoder's two lines share one");
            continue;
        }
        const LineRole other_role = line.role == LineRole::encoder_a ? LineRole::encoder_b : LineRole::encoder_a;
        const auto partners = count([&](const LineConfig& other) {
            return other.name == line.name && other.role == other_role && other.request.chip == line.request.chip;
        });
        if (same_name != 2 || partners != 1)
            return refuse(line, "The encoder line has no partner",
                          "Give an encoder one encoder_a and one encoder_b of the same name and chip");
    }
    return {};
}

GpioPanel::GpioPanel(std::vector<LineConfig> lines, OpenLines opener, void* context, Opening where)
    : configs_(std::move(lines)), state_of_(configs_.size()) {
    LinesToOpen to_open{{}, opener, context, "surefoot"};
    for (std::size_t i = 0; i < configs_.size(); ++i) {
        LineConfig& config = configs_[i];
        if (config.role == LineRole::stop) config.normally_closed = true;
        to_open.requests.push_back(config.request);
        if (config.role == LineRole::button) {
            state_of_[i].control = controls_.size();
            controls_.push_back(control_of(config));
        }
        if (config.role != LineRole::encoder_a) continue;
        for (std::size_t k = 0; k < configs_.size(); ++k)
            if (configs_[k].role == LineRole::encoder_b && configs_[k].name == config.name) {
                encoders_.push_back({{}, i, k, controls_.size(), 0});
                state_of_[i].partner = k;
                state_of_[k].partner = i;
            }
        controls_.push_back(control_of(config));
    }
    CHECK(configs_.size() <= max_lines, "At most 64 lines pass the check");
    opener_ = make_line_opener(std::move(to_open), where);
}

std::span<const pollfd> GpioPanel::polled() const { return opened_ ? opened_->lines->polled() : std::span<const pollfd>{}; }

bool GpioPanel::asserted_by(std::size_t line, bool active) const { return active != configs_[line].normally_closed; }

void GpioPanel::service(std::int64_t now_ns) {
    if (!opened_) take_opened(now_ns);
    if (opened_ && drain(now_ns)) publish(now_ns);
}

void GpioPanel::take_opened(std::int64_t now_ns) {
    while (auto made = opener_->next(now_ns)) {
        if (made->lines) {
            opened_ = std::move(made);
            return start();
        }
        problem_ = format_message(made->error);
        was_closed_ = true;
        opener_->give_back(std::move(made), now_ns);
    }
}

void GpioPanel::start() {
    problem_.size = 0;
    ++opens_;
    levels_ = opened_->levels;
    for (std::size_t i = 0; i < configs_.size(); ++i) {
        Line& line = state_of_[i];
        const auto lost = line.contact.lost_edges;
        line.contact = {};
        line.contact.lost_edges = lost;
        line.sequence = line.releases_taken = line.presses_taken = 0;
        // A contact that is asserted when we come is asserted, but no press.
        line.contact.level = line.contact.asserted = asserted_by(i, levels_[i]);
    }
    for (Encoder& encoder : encoders_) {
        encoder.decoder.known = false;
        turn(encoder);
    }
}

/// With the reason that call_library() has left.
void GpioPanel::close(std::int64_t now_ns) {
    problem_ = format_message(opened_->error);
    opener_->give_back(std::move(opened_), now_ns);
    was_closed_ = true;
    state_.connected = false;
    state_.has_value.reset();
    for (Line& line : state_of_) {
        const auto lost = line.contact.lost_edges;
        line.contact = {};
        line.contact.lost_edges = lost;
    }
}

/// Only this is the library's. False, and the reason kept: the chip is gone.
template <class Read>
bool GpioPanel::call_library(const Read& read) {
    const rt::DriverScope library;
    const auto done = read(*opened_->lines);
    if (!done) opened_->error = done.error();
    return done.ok();
}

bool GpioPanel::drain(std::int64_t now_ns) {
    std::array<LineEdge, edges_at_once> edges;
    for (int i = 0; i < drains_a_service; ++i) {
        std::size_t count = 0;
        const bool there = call_library([&](GpioLines& lines) {
            auto got = lines.read(edges);
            count = got ? std::min(*got, edges.size()) : 0;
            return got;
        });
        if (!there) {
            close(now_ns);
            return false;
        }
        for (std::size_t k = 0; k < count; ++k) take(edges[k]);
        if (count < edges.size()) break;
    }
    if (!call_library([&](GpioLines& lines) { return lines.levels({levels_.data(), configs_.size()}); })) {
        close(now_ns);
        return false;
    }
    for (std::size_t i = 0; i < configs_.size(); ++i)
        reread(state_of_[i].contact, asserted_by(i, levels_[i]), now_ns, configs_[i].debounce_ns);
    // After all lines were read: an encoder whose two lines changed unseen has turned by an unknown way.
    for (Encoder& encoder : encoders_) turn(encoder);
    return true;
}

void GpioPanel::take(const LineEdge& got) {
    if (got.line >= state_of_.size()) return;
    Line& line = state_of_[got.line];
    const bool asserted = asserted_by(got.line, got.active);
    if (got.sequence != 0) {
        const std::uint32_t lost = got.sequence - line.sequence - 1;  // numbered from 1 since the request
        line.sequence = got.sequence;
        if (lost != 0) {  // among them may have been a stop, or a hand off the dead-man
            ++line.contact.presses;
            ++line.contact.raw_releases;
            line.contact.lost_edges += lost - (asserted == line.contact.level ? 1 : 0);  // that one is counted below
        }
    }
    edge(line.contact, asserted, got.stamp_ns, configs_[got.line].debounce_ns);
    for (Encoder& encoder : encoders_)
        if (encoder.a == got.line || encoder.b == got.line) turn(encoder);
}

void GpioPanel::turn(Encoder& encoder) {
    encoder.decoder.turn(state_of_[encoder.a].contact.level, state_of_[encoder.b].contact.level);
}

void GpioPanel::publish(std::int64_t now_ns) {
    bool changed = !state_.connected;
    for (std::size_t i = 0; i < configs_.size(); ++i) {
        if (configs_[i].role != LineRole::button) continue;
        const std::size_t control = state_of_[i].control;
        const std::int32_t value = state_of_[i].contact.asserted ? 1 : 0;
        changed = changed || state_.value[control] != value;
        state_.value[control] = value;
        state_.has_value.set(control);
    }
    bool turned = false;
    for (Encoder& encoder : encoders_) {
        const auto steps = encoder.decoder.steps - encoder.reported;
        encoder.reported = encoder.decoder.steps;
        turned = turned || steps != 0;
        state_.value[encoder.control] = static_cast<std::int32_t>(std::clamp<std::int64_t>(steps, -1'000'000, 1'000'000));
        state_.has_value.set(encoder.control);
    }
    if (changed || turned) {
        ++state_.reports;
        state_.stamp_ns = now_ns;
    }
    state_.connected = true;
}

Lines GpioPanel::take_lines() {
    Lines lines;
    const bool gone = !open() || was_closed_;
    was_closed_ = !open();
    lines.dead_man = !gone;
    for (std::size_t i = 0; i < configs_.size(); ++i) {
        Line& line = state_of_[i];
        const bool pressed_since = line.contact.presses != line.presses_taken;
        const bool released_since = line.contact.raw_releases != line.releases_taken;
        line.presses_taken = line.contact.presses;
        line.releases_taken = line.contact.raw_releases;
        switch (configs_[i].role) {
            case LineRole::stop:
                lines.stop = lines.stop || gone || line.contact.asserted || pressed_since;
                break;
            case LineRole::stop_reset:
                lines.stop_reset = lines.stop_reset || (!gone && line.contact.asserted);
                break;
            case LineRole::dead_man:
                lines.has_dead_man = true;
                lines.dead_man = lines.dead_man && line.contact.level && !released_since;
                break;
            default:
                break;
        }
    }
    return lines;
}

std::uint64_t GpioPanel::lost_edges() const {
    std::uint64_t sum = 0;
    for (const Line& line : state_of_) sum += line.contact.lost_edges;
    return sum;
}

std::uint64_t GpioPanel::illegal_encoder_steps() const {
    std::uint64_t sum = 0;
    for (const Encoder& encoder : encoders_) sum += encoder.decoder.illegal;
    return sum;
}

}  // namespace surefoot::input
