// surefoot devices map: asks for one movement after the other and writes the mapping that they show.
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "input/map/steering_file.hpp"
#include "input/map/teach.hpp"
#include "rt/base/file.hpp"
#include "rt/clock/clock.hpp"
#include "tools/cli/devices.hpp"
#include "tools/cli/live_devices.hpp"
#include "tools/cli/options.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {

using input::DeviceEvent;
using input::Teach;

constexpr std::int64_t prompt_ns = 50'000'000;

struct MapArguments {
    std::string device, file;
    double timeout_s = 15;
    bool json = false;
};

/// Enter on stdin, a terminal or not; its end is not an Enter.
class Keys {
public:
    bool enter() {
        pollfd p{STDIN_FILENO, POLLIN, 0};
        if (over_ || ::poll(&p, 1, 0) <= 0) return false;
        char text[256];
        const ssize_t n = read(STDIN_FILENO, text, sizeof text);
        if (n <= 0) over_ = true;
        return n > 0 && std::find(text, text + n, '\n') != text + n;
    }

private:
    bool over_ = false;
};

class Session {
public:
    Session(const MapArguments& a, const Context& context, input::LiveDevices& source)
        : context_(context), source_(source), limits_(limits(a)), teach_(limits_) {}

    /// False: stopped, or no device came and nobody is there to plug one in.
    bool run() {
        Keys keys;
        const std::int64_t patience_ns = std::max<std::int64_t>(limits_.answer_limit_ns, 2'000'000'000),
                           begun_ns = rt::monotonic_ns();
        while (teach_.phase() != Teach::Phase::done) {
            if (context_.stop->load()) {
                end_progress(context_);
                return false;
            }
            if (numbers_.empty() && !context_.terminal && rt::monotonic_ns() - begun_ns > patience_ns) return false;
            for (const DeviceEvent& e : input::poll(source_, rt::monotonic_ns() + prompt_ns)) take(e);
            const std::size_t before = teach_.learned().size();
            if (keys.enter()) teach_.skip(rt::monotonic_ns());
            if (!numbers_.empty()) teach_.tick(rt::monotonic_ns());
            print_learned(before);
            show();
        }
        end_progress(context_);
        return true;
    }
    [[nodiscard]] const Teach& teach() const { return teach_; }

private:
    static input::TeachLimits limits(const MapArguments& a) {
        input::TeachLimits l;
        l.answer_limit_ns = static_cast<std::int64_t>(a.timeout_s * 1e9);
        return l;
    }
    void take(const DeviceEvent& e) {
        const LiveStates::Device* d = states_.take(e);
        if (e.kind == DeviceEvent::Kind::added) {
            const auto& p = *e.plugged;
            numbers_[e.device] = teach_.add_device({p.vendor, p.product, p.name, p.device.device_class}, p.device.controls);
            print(fmt::format("{}: connected", device_line(p)));
        } else if (e.kind == DeviceEvent::Kind::removed ||
                   (e.kind == DeviceEvent::Kind::refused && e.refused != input::Refused::unwanted)) {
            print(e.why->text());
        } else if (e.kind == DeviceEvent::Kind::report && d != nullptr && d->state.stamp_ns == e.stamp_ns) {
            const std::size_t before = teach_.learned().size();
            teach_.observe(numbers_[e.device], d->state, e.stamp_ns);
            print_learned(before);
        }
    }
    void print(const std::string& text) const {
        end_progress(context_);
        (void)std::fputs((text + "\n").c_str(), stderr);
    }
    void print_learned(std::size_t before) {
        for (const auto& l : teach_.learned().subspan(before))
            print(fmt::format("  {}{}: {}", input::name_of(l.action), l.sign < 0 ? " (reversed)" : "",
                              teach_.control(l.device, l.control).name));
    }
    /// On a terminal one line that changes; elsewhere each question once.
    void show() {
        const std::string question = teach_.phase() == Teach::Phase::rest ? "Release all controls" : teach_.question();
        if (!context_.terminal) {
            if (teach_.phase() == Teach::Phase::question && question != shown_) print(question + " (Enter: skip)");
            if (teach_.phase() == Teach::Phase::question) shown_ = question;
            return;
        }
        std::string line = std::string(report::clear_line) + question;
        if (numbers_.empty()) line += " (no device yet: plug one in)";
        if (teach_.phase() == Teach::Phase::question)
            line += fmt::format("  [Enter: skip, {:.0f} s]", teach_.seconds_left(rt::monotonic_ns()));
        if (const auto l = teach_.leader())
            line += fmt::format("  {} {:3.0f} %", teach_.control(l->device, l->control).name, 100 * std::abs(l->moved));
        (void)std::fputs(line.c_str(), stderr);
        std::fflush(stderr);
    }

    const Context& context_;
    input::LiveDevices& source_;
    LiveStates states_;
    input::TeachLimits limits_;
    Teach teach_;
    std::map<int, int> numbers_;  ///< of the source to those of Teach
    std::string shown_;
};

/// What is in the file already stays, but for the mappings of the same devices.
Result<input::SteeringFile> merged(const std::string& file, std::vector<input::DeviceMapping> shown) {
    input::SteeringFile steering;
    std::error_code ignored;
    if (!file.empty() && std::filesystem::exists(file, ignored)) {
        auto old = input::read_steering(file);
        if (!old) return old.error();
        steering = std::move(*old);
    }
    std::erase_if(steering.devices, [&](const input::DeviceMapping& m) {
        return std::any_of(shown.begin(), shown.end(), [&](const input::DeviceMapping& n) {
            return m.match.vendor == n.match.vendor && m.match.product == n.match.product;
        });
    });
    steering.devices.insert(steering.devices.begin(), std::make_move_iterator(shown.begin()),
                            std::make_move_iterator(shown.end()));
    return steering;
}

int run_map(const MapArguments& a, const Context& context) {
    if (!a.device.empty()) {
        if (auto device = one_device(a.device); !device) return fail(device.error());
    }
    if (!a.file.empty()) {
        if (auto old = merged(a.file, {}); !old) return fail(old.error());  // before the work, not after it
        if (auto writable = probe_writable(a.file); !writable) return fail(writable.error());
    }
    auto source = open_devices(a.device);
    if (!source) return fail(source.error());
    Session session(a, context, **source);
    if (!session.run()) {
        if (context.stop->load()) return fail({"map", "The mapping was stopped, and nothing is written", "", ErrorKind::stopped});
        return fail({"map", "There is no device, so nothing is written",
                     "Plug one in. `surefoot devices` shows why a device is refused", ErrorKind::no_device});
    }
    const auto shown = session.teach().mappings();
    if (shown.empty())
        return fail({"map", "No control was moved, so nothing is written", "Move each control when its name is shown",
                     ErrorKind::misuse});
    auto steering = merged(a.file, shown);
    if (!steering) return fail(steering.error());
    const std::string text = input::steering_text(*steering);
    if (!a.file.empty()) {
        if (auto wrote = write_text(a.file, text); !wrote) return fail(wrote.error());
    }
    if (a.json) {
        nlohmann::ordered_json learned = nlohmann::ordered_json::array();
        for (const auto& l : session.teach().learned())
            learned.push_back({{"action", input::name_of(l.action)},
                               {"control", session.teach().control(l.device, l.control).name},
                               {"collection", session.teach().control(l.device, l.control).collection}});
        print_json({{"file", a.file}, {"devices", shown.size()}, {"learned", std::move(learned)}, {"toml", text}});
    } else if (a.file.empty()) {
        fmt::print("{}", text);
    } else {
        fmt::print("{}: {} devices mapped\n", a.file, shown.size());
    }
    return exit_success;
}

}  // namespace

void add_devices_map(CLI::App& devices, Context& context) {
    auto a = std::make_shared<MapArguments>();
    CLI::App* c = add_command(devices, "map", "Write a mapping interactively: move the control that it asks for",
                              "surefoot devices map -o steering.toml", a->json);
    add_device_choice(*c, a->device);
    c->add_option("-o,--output", a->file, "Steering file; its other entries are kept (else the mapping goes to stdout)");
    c->add_option("--timeout", a->timeout_s, "Seconds until a question is skipped")->check(number_within(0.1, 3600, "s"));
    c->callback([&context, a] { context.run = [&context, a] { return run_map(*a, context); }; });
}

}  // namespace surefoot::cli
