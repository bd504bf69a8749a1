// The fuzz targets' bodies: used by libFuzzer (fuzz_*.cpp) and, with seeded mutations, by every build's tests.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "input/hid/decoder.hpp"
#include "input/replay/recording.hpp"

namespace surefoot::fuzz {

/// What must hold of any bytes. Aborts where it does not, in every build.
inline void require(bool holds) {
    if (!holds) std::abort();
}

/// Any bytes as a descriptor: refused with a place inside, or a layout whose every index and offset is in bounds.
inline void descriptor(std::span<const std::byte> bytes) {
    input::Layout layout;
    if (const auto refusal = input::parse_descriptor(bytes, layout)) {
        require(refusal->offset <= bytes.size() && !refusal->what.empty());
        return;
    }
    for (const input::Field& f : layout.fields) {
        require(f.run_count > 0 && std::size_t{f.first_run} + f.run_count <= layout.runs.size());
        require(f.usages >= f.count && f.usages <= input::max_usages);
        const input::Report* r = layout.find(f.kind, f.report_id);
        require(r != nullptr && f.bit_offset + f.size * f.count <= r->bits && r->bits <= input::max_report_bits);
        require(f.collection == input::no_collection || f.collection < layout.collections.size());
        if (f.usages > 0) (void)layout.usage_of(f, f.usages - 1);
    }
    const input::HidDevice device = input::describe_device(std::move(layout), {});
    require(device.controls.size() <= input::max_controls && device.controls.size() == device.sources.size());
    require(!device.reason.empty());
    for (const input::ControlInfo& c : device.controls) {
        require(!c.name.empty());
        require(c.kind == input::ControlKind::button || c.logical_min < c.logical_max);
    }
}

/// The first two bytes split the rest into a descriptor and reports of the declared sizes; values stay in their ranges.
inline void reports(std::span<const std::byte> bytes) {
    if (bytes.size() < 2) return;
    const std::size_t split = std::to_integer<std::size_t>(bytes[0]) | std::to_integer<std::size_t>(bytes[1]) << 8U;
    bytes = bytes.subspan(2);
    const auto head = bytes.first(std::min(split, bytes.size()));
    auto rest = bytes.subspan(head.size());
    input::Layout layout;
    if (input::parse_descriptor(head, layout)) return;
    const input::HidDevice device = input::describe_device(std::move(layout), {0x046d, 0xc626});
    input::ReportDecoder decoder(device);
    input::DeviceState state;
    for (int n = 0; n < 64 && !rest.empty(); ++n) {
        const std::size_t wanted = decoder.expected_bytes(std::to_integer<std::uint8_t>(rest[0]));
        const auto report = rest.first(std::min(rest.size(), wanted == 0 ? 1 : wanted));
        const auto before = state.reports;
        const auto fate = decoder.decode(report, n + 1, state);
        require((fate == input::ReportFate::accepted) == (state.reports == before + 1));
        rest = rest.subspan(report.size());
        for (std::size_t c = 0; c < device.controls.size(); ++c) {
            if (!state.has_value.test(c)) continue;
            const input::ControlInfo& info = device.controls[c];
            const auto v = state.value[c];
            if (info.kind == input::ControlKind::hat) require(v >= 0 && v <= 7);
            if (info.kind == input::ControlKind::button) require(v == 0 || v == 1);
            if (info.kind == input::ControlKind::axis) require(v >= info.logical_min && v <= info.logical_max);
        }
    }
}

/// Any text as a recording: refused with a line, or written and read again to the same bits.
inline void recording(std::span<const std::byte> bytes) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    (void)input::looks_like_recording(bytes);
    auto first = input::parse_recording(text, "fuzz");
    if (!first) {
        require(first.error().place.starts_with("fuzz: line "));
        return;
    }
    const std::string written = input::write_recording(*first);
    auto second = input::parse_recording(written, "again");
    require(second.ok());
    require(second->descriptor == first->descriptor && second->bytes == first->bytes);
    require(second->reports.size() == first->reports.size() && second->vendor == first->vendor &&
            second->product == first->product);
    for (std::size_t i = 0; i < first->reports.size(); ++i) {
        require(first->reports[i].time_us == second->reports[i].time_us && first->reports[i].size == second->reports[i].size);
    }
    require(input::write_recording(*second) == written);
}

}  // namespace surefoot::fuzz
