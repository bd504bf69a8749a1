// surefoot devices watch: what the controls say, live: bars on a terminal, lines elsewhere, JSON lines with --json.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>

#include "input/controls.hpp"
#include "rt/clock/clock.hpp"
#include "tools/cli/devices.hpp"
#include "tools/cli/live_devices.hpp"
#include "tools/cli/options.hpp"
#include "tools/cli/screen.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {

using input::DeviceEvent;
using nlohmann::ordered_json;

constexpr std::int64_t bars_ns = 33'000'000, plain_ns = 100'000'000;

struct WatchArguments {
    std::string device;
    double seconds = 0;
    bool json = false;
};

double seconds_at(std::int64_t stamp_ns, std::int64_t start_ns) { return static_cast<double>(stamp_ns - start_ns) * 1e-9; }

const char* event_name(DeviceEvent::Kind kind) {
    return kind == DeviceEvent::Kind::added     ? "added"
           : kind == DeviceEvent::Kind::removed ? "removed"
           : kind == DeviceEvent::Kind::refused ? "refused"
                                                : "report";
}

ordered_json values_json(const LiveStates::Device& d) {
    ordered_json values = ordered_json::object();
    const auto& controls = d.plugged->device.controls;
    for (std::size_t i = 0; i < controls.size(); ++i)
        values[controls[i].name] = d.state.has_value.test(i) ? ordered_json(d.state.value[i]) : ordered_json(nullptr);
    return values;
}

/// One line an event; false where nobody reads them any more.
bool print_json_line(const DeviceEvent& e, const LiveStates::Device* d, std::int64_t start_ns) {
    ordered_json line = {{"time_s", seconds_at(e.stamp_ns, start_ns)}, {"event", event_name(e.kind)}};
    if (e.plugged) line["device"] = device_json(*e.plugged);
    if (e.why != nullptr) line["reason"] = e.why->text();
    if (e.kind == DeviceEvent::Kind::report && d != nullptr) {
        line["node"] = d->plugged->node;
        line["accepted"] = d->state.stamp_ns == e.stamp_ns;
        line["values"] = values_json(*d);
    }
    return std::fputs((json_text(line, -1) + "\n").c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
}

/// What has a value other than rest, in one line.
std::string plain_line(const LiveStates::Device& d) {
    std::string text;
    const auto& controls = d.plugged->device.controls;
    for (std::size_t i = 0; i < controls.size(); ++i)
        if (d.state.has_value.test(i) && (controls[i].kind != input::ControlKind::button || d.state.value[i] != 0))
            text += fmt::format(" {}={}", controls[i].name, d.state.value[i]);
    return text;
}

constexpr std::array<const char*, 8> directions = {"north", "north-east", "east", "south-east",
                                                   "south", "south-west", "west", "north-west"};

/// From the middle of the bar to `value`.
std::string bar(const input::ControlInfo& c, std::int32_t value, std::size_t width) {
    const double range = static_cast<double>(c.logical_max) - c.logical_min;
    const double at = range > 0 ? std::clamp((static_cast<double>(value) - c.logical_min) / range, 0.0, 1.0) : 0.0;
    return report::deflection_bar(at, width);
}

/// Axes one a line, hats by direction, all pressed buttons in one line; each at most `width` characters.
std::vector<std::string> control_lines(std::span<const input::ControlInfo> controls, const input::DeviceState& state,
                                       std::size_t width) {
    std::vector<std::string> lines;
    std::string pressed;
    bool buttons = false;
    for (std::size_t i = 0; i < controls.size() && i < input::max_controls; ++i) {
        const input::ControlInfo& c = controls[i];
        const bool has = state.has_value.test(i);
        if (c.kind == input::ControlKind::button) {
            buttons = true;
            if (has && state.value[i] != 0) pressed += " " + c.name;
        } else if (c.kind == input::ControlKind::hat) {
            const auto at = static_cast<std::size_t>(state.value[i]);
            lines.push_back(fmt::format("{:<16} {}", c.name, has && at < directions.size() ? directions[at] : "centre"));
        } else {
            const std::size_t cells = std::clamp<std::size_t>(width > 60 ? width - 40 : 20, 20, 61) | 1U;
            lines.push_back(has ? fmt::format("{:<16} [{}] {:>7}", c.name, bar(c, state.value[i], cells), state.value[i])
                                : fmt::format("{:<16} [{}] {:>7}", c.name, std::string(cells, ' '), "-"));
        }
    }
    if (buttons) lines.push_back(fmt::format("{:<16}{}", "pressed", pressed.empty() ? " none" : pressed));
    for (std::string& line : lines) line = report::cut_to(line, width);
    return lines;
}

std::vector<std::string> screen(LiveStates& states, const std::vector<std::string>& notes) {
    const std::size_t width = report::terminal_style(false).width;
    std::vector<std::string> lines;
    for (const auto& [number, d] : states.devices()) {
        const double age_s = static_cast<double>(rt::monotonic_ns() - d->first_ns) * 1e-9;
        lines.push_back(fmt::format("{}   {} reports, {:.0f}/s", device_line(*d->plugged), d->state.reports,
                                    age_s > 0 ? static_cast<double>(d->state.reports) / age_s : 0.0));
        for (std::string& line : control_lines(d->plugged->device.controls, d->state, width)) lines.push_back(std::move(line));
        lines.emplace_back();
    }
    if (states.devices().empty()) lines.emplace_back("No device that steers is plugged in. The command waits for one.");
    for (const std::string& note : notes) lines.push_back(note);
    lines.emplace_back("Press Ctrl-C to end.");
    return lines;
}

class Watch {
public:
    Watch(const WatchArguments& a, const Context& context, input::LiveDevices& source)
        : a_(a), context_(context), source_(source), bars_(!a.json && isatty(STDOUT_FILENO) == 1) {}

    int run() {
        std::unique_ptr<Redraw> redraw;
        if (bars_) redraw = std::make_unique<Redraw>();
        const std::int64_t start = rt::monotonic_ns(), end = end_after(a_.seconds);
        std::int64_t due = start;
        bool going = true;
        for (const DeviceEvent& e : source_.take()) going = take(e, start) && going;
        if (!bars_ && states_.devices().empty()) notify("No such device is plugged in. The command waits for one.");
        while (going && !context_.stop->load() && rt::monotonic_ns() < end) {
            for (const DeviceEvent& e : input::poll(source_, std::min(end, due))) going = take(e, start) && going;
            if (rt::monotonic_ns() < due) continue;
            due = rt::monotonic_ns() + (bars_ ? bars_ns : plain_ns);
            if (bars_)
                redraw->draw(screen(states_, messages_));
            else if (!a_.json)
                going = print_plain(start) && going;
        }
        return exit_success;
    }

private:
    bool take(const DeviceEvent& e, std::int64_t start) {
        const LiveStates::Device* d = states_.take(e);
        if (e.kind == DeviceEvent::Kind::drained) return true;
        if (a_.json) return print_json_line(e, d, start);
        if (e.kind == DeviceEvent::Kind::report) return true;
        if (e.kind == DeviceEvent::Kind::refused && e.refused == input::Refused::unwanted) return true;
        std::string text = e.why != nullptr ? e.why->text() : "plugged in";
        if (e.why == nullptr || e.why->place.empty()) text = device_line(*e.plugged) + ": " + text;
        if (bars_) {
            messages_.push_back(text);
            if (messages_.size() > 4) messages_.erase(messages_.begin());
            return true;
        }
        return std::fputs((text + "\n").c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    }
    bool print_plain(std::int64_t start) {
        for (auto& [number, d] : states_.devices()) {
            if (!d->changed) continue;
            d->changed = false;
            const std::string line =
                fmt::format("{:9.3f} {}{}\n", seconds_at(d->state.stamp_ns, start), d->plugged->node, plain_line(*d));
            if (std::fputs(line.c_str(), stdout) < 0 || std::fflush(stdout) != 0) return false;
        }
        return true;
    }

    const WatchArguments& a_;
    const Context& context_;
    input::LiveDevices& source_;
    bool bars_;
    LiveStates states_;
    std::vector<std::string> messages_;
};

}  // namespace

void add_devices_watch(CLI::App& devices, Context& context) {
    auto a = std::make_shared<WatchArguments>();
    CLI::App* c = devices.add_subcommand("watch", "Show the controls of devices live; devices may be plugged and unplugged");
    c->footer("Example:\n  surefoot devices watch\n  surefoot devices watch 046d:c626 --seconds 10 --json");
    add_device_choice(*c, a->device);
    c->add_option("--seconds", a->seconds, "Seconds after which the command ends")->check(number_within(0.01, 1e6, "s"));
    c->add_flag("--json", a->json, "Print one JSON object per line, for each report and each device added or removed");
    c->callback([&context, a] {
        context.run = [&context, a] {
            auto source = open_devices(a->device);
            if (!source) return fail(source.error());
            return Watch(*a, context, **source).run();
        };
    });
}

}  // namespace surefoot::cli
