// From a file to a device that steers.
#include "input/replay/recorded_device.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "input/hid/decoder.hpp"

namespace surefoot::input {

namespace {

Result<void> check_times(const RecordedDevice& d) {
    const double span_s = d.duration_s();
    if (span_s <= max_recording_s) return {};
    return Error{d.file, fmt::format("The reports span {:.4g} s; at most {:.0f} s can be walked", span_s, max_recording_s),
                 "Cut the recording, or correct its times", ErrorKind::out_of_limits};
}

/// A walk in which nothing ever moved has no reason that anyone could see.
Result<void> check_reports(const RecordedDevice& d) {
    ReportDecoder decoder(d.device);
    DeviceState state;
    for (std::size_t i = 0; i < d.recording.reports.size(); ++i) {
        if (decoder.decode(d.recording.report(i), 0, state) == ReportFate::accepted) return {};
    }
    const RecordedReport& first = d.recording.reports.front();
    const auto id = static_cast<std::uint8_t>(
        decoder.numbered() && first.size > 0 ? std::to_integer<unsigned>(d.recording.report(0).front()) : 0U);
    const std::uint32_t expected = decoder.expected_bytes(id);
    return Error{fmt::format("{}: line {}", d.file, first.line),
                 expected > 0 ? fmt::format("None of the {} reports fits the descriptor: {} bytes where it declares {}",
                                            d.recording.reports.size(), first.size, expected)
                              : fmt::format("None of the {} reports fits the descriptor: it declares no input report {}",
                                            d.recording.reports.size(), id),
                 "Record the descriptor and the reports of one device together", ErrorKind::damaged};
}

/// The first fitting mapping of the file, else the default of the class.
Result<void> choose_mapping(RecordedDevice& d, const SteeringFile& steering, const std::string& steering_name) {
    const DeviceIdentity identity{d.recording.vendor, d.recording.product, d.recording.name, d.device.device_class};
    if (const DeviceMapping* chosen = find_mapping(steering.devices, identity)) {
        auto mapper = compile(*chosen, d.device.controls);
        if (!mapper) {
            const Error& e = mapper.error();
            return Error{fmt::format("{}: device '{}': {}", steering_name, chosen->name, e.place), e.what, e.remedy, e.kind};
        }
        d.mapper = std::move(*mapper);
        d.mapping = chosen->name;
        d.reporting = chosen->reporting;
        return {};
    }
    const DeviceMapping standard = default_mapping(d.device.controls, d.device.device_class);
    d.mapper = compile_what_fits(standard, d.device.controls);
    d.mapping = standard.name;
    d.reporting = standard.reporting;
    return {};
}

}  // namespace

double RecordedDevice::duration_s() const {
    std::int64_t last_us = 0;
    for (const RecordedReport& r : recording.reports) last_us = std::max(last_us, r.time_us);
    if (recording.reports.empty()) return 0;
    return static_cast<double>(std::max<std::int64_t>(0, last_us - recording.reports.front().time_us)) * 1e-6;
}

Result<RecordedDevice> open_recorded(const std::string& file, const SteeringFile& steering, const std::string& steering_name) {
    auto recording = read_recording(file);
    if (!recording) return recording.error();
    RecordedDevice d;
    d.file = file;
    d.recording = std::move(*recording);
    if (d.recording.descriptor.empty()) {
        return Error{file, "The recording has no R: line, which gives the report descriptor",
                     "Give a recording in hid-recorder's text format, whole from its first line", ErrorKind::damaged};
    }
    if (d.recording.reports.empty())
        return Error{file, "The recording holds no reports (E: lines)", "Record again while the device is moved",
                     ErrorKind::damaged};
    if (auto ok = check_times(d); !ok) return ok.error();
    Layout layout;
    if (const auto refusal = parse_descriptor(d.recording.descriptor, layout))
        return Error{fmt::format("{}: R: byte {}", file, refusal->offset), refusal->what, refusal->remedy, ErrorKind::damaged};
    d.device = describe_device(std::move(layout), {d.recording.vendor, d.recording.product, d.recording.name});
    if (auto ok = choose_mapping(d, steering, steering_name); !ok) return ok.error();
    if (d.mapper.bindings.empty()) {
        return Error{
            file,
            fmt::format("The recorded device does not steer: class {}, {}", class_name(d.device.device_class), d.device.reason),
            "Name its controls in a [[device]] of --steering FILE.toml, or record a joystick, gamepad or 3D mouse",
            ErrorKind::unsupported};
    }
    if (auto ok = check_reports(d); !ok) return ok.error();
    return d;
}

}  // namespace surefoot::input
