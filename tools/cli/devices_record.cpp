// surefoot devices record: raw reports to a file, in hid-recorder's text format, so that a fault in the field becomes a test.
#include <fmt/format.h>

#include "input/replay/recording.hpp"
#include "rt/base/file.hpp"
#include "rt/clock/clock.hpp"
#include "tools/cli/devices.hpp"
#include "tools/cli/live_devices.hpp"
#include "tools/cli/options.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {

using input::DeviceEvent;

constexpr std::int64_t progress_ns = 200'000'000;
constexpr std::uint32_t ring_of_kernel = 63;  // so many at once: it was full, and newer ones were dropped

struct RecordArguments {
    std::string device, file;
    double seconds = 0;
    bool json = false;
};

input::Recording head_of(const input::PluggedDevice& d) {
    input::Recording r;
    r.descriptor = d.descriptor;
    r.name = d.name;
    r.place = d.socket;
    r.bus = d.bus;
    r.vendor = d.vendor;
    r.product = d.product;
    return r;
}

/// The first plugging of one device, until it is pulled.
class Recorder {
public:
    Recorder(const Context& context, const RecordArguments& a, AtomicFile& file) : context_(context), a_(a), file_(file) {}

    Result<void> run(input::LiveDevices& source) {
        const std::int64_t end = end_after(a_.seconds);
        std::int64_t due = 0;
        while (ended_.empty() && !context_.stop->load() && rt::monotonic_ns() < end) {
            for (const DeviceEvent& e : input::poll(source, std::min(end, rt::monotonic_ns() + progress_ns)))
                if (auto taken = take(e); !taken) return taken;
            if (!text_.empty()) {
                bytes_ += text_.size();
                if (auto wrote = file_.write(text_); !wrote) return wrote;
                text_.clear();
            }
            if (bytes_ > input::max_recording_bytes / 2) ended_ = "full";
            if (context_.terminal && rt::monotonic_ns() >= due) {
                due = rt::monotonic_ns() + progress_ns;
                (void)std::fputs(fmt::format("{}{} reports", report::clear_line, reports_).c_str(), stderr);
            }
        }
        end_progress(context_);
        if (ended_.empty()) ended_ = context_.stop->load() ? "stopped" : "time";
        return {};
    }
    [[nodiscard]] std::uint64_t reports() const { return reports_; }
    [[nodiscard]] std::uint64_t overflows() const { return overflows_; }
    [[nodiscard]] const std::string& ended() const { return ended_; }
    [[nodiscard]] double seconds() const { return static_cast<double>(last_ns_ - first_ns_) * 1e-9; }

private:
    Result<void> take(const DeviceEvent& e) {
        switch (e.kind) {
            case DeviceEvent::Kind::added:
                if (device_ < 0) {
                    device_ = e.device;
                    notify(fmt::format("The reports of {} ({}) are recorded to {}. Press Ctrl-C to end.", e.plugged->node,
                                       e.plugged->name, a_.file));
                }
                return {};
            case DeviceEvent::Kind::refused:
                return e.refused == input::Refused::unwanted ? Result<void>() : Result<void>(*e.why);
            case DeviceEvent::Kind::removed:
                if (e.device == device_) ended_ = "unplugged";
                return {};
            case DeviceEvent::Kind::report:
                if (e.device != device_) return {};
                if (reports_++ == 0) first_ns_ = e.stamp_ns;
                last_ns_ = e.stamp_ns;
                input::append_report(text_, (e.stamp_ns - first_ns_) / 1000, e.bytes);
                return {};
            case DeviceEvent::Kind::drained:
                if (e.device != device_ || e.reports < ring_of_kernel) return {};
                ++overflows_;
                text_ += "# the kernel's ring was full here: reports are missing\n";
                return {};
        }
        return {};
    }

    const Context& context_;
    const RecordArguments& a_;
    AtomicFile& file_;
    std::string text_, ended_;
    int device_ = -1;
    std::uint64_t reports_ = 0, overflows_ = 0;
    std::size_t bytes_ = 0;
    std::int64_t first_ns_ = 0, last_ns_ = 0;
};

int run_record(const RecordArguments& a, const Context& context) {
    auto device = one_device(a.device);
    if (!device) return fail(device.error());
    auto source = open_devices((*device)->node);
    if (!source) return fail(source.error());
    auto file = AtomicFile::create(a.file);
    if (!file) return fail(file.error());
    if (auto wrote = file->write(input::recording_head(head_of(**device))); !wrote) return fail(wrote.error());
    Recorder recorder(context, a, *file);
    if (auto recorded = recorder.run(**source); !recorded) return fail(recorded.error());
    if (auto done = file->commit(); !done) return fail(done.error());
    if (recorder.ended() == "unplugged")
        notify(fmt::format("{}: The device was unplugged, so the recording ends.", (*device)->node));
    if (recorder.ended() == "full") notify(fmt::format("{}: The recording has reached its maximum size and ends.", a.file));
    if (recorder.overflows() > 0)
        notify(fmt::format("Reports were lost {} times, because this machine did not read them in time.", recorder.overflows()));
    if (a.json) {
        print_json({{"file", a.file},
                    {"device", device_json(**device)},
                    {"reports", recorder.reports()},
                    {"seconds", recorder.seconds()},
                    {"overflows", recorder.overflows()},
                    {"ended", recorder.ended()}});
    } else {
        fmt::print("{}: {} reports in {:.1f} s of {}\n", a.file, recorder.reports(), recorder.seconds(), (*device)->name);
    }
    return exit_success;
}

}  // namespace

void add_devices_record(CLI::App& devices, Context& context) {
    auto a = std::make_shared<RecordArguments>();
    CLI::App* c = add_command(devices, "record", "Record the raw reports of one device to a file, until Ctrl-C",
                              "surefoot devices record hidraw0 -o stick.hid --seconds 10", a->json);
    c->add_option("device", a->device, "Device: its node (hidraw0), its ids (046d:c626) or a part of its name")->required();
    c->add_option("-o,--output", a->file, "File to write, in hid-recorder's text format")->required();
    c->add_option("--seconds", a->seconds, "Seconds after which the recording ends")->check(number_within(0.01, 1e6, "s"));
    c->callback([&context, a] { context.run = [&context, a] { return run_record(*a, context); }; });
}

}  // namespace surefoot::cli
