// What the tests of hid/ share: bytes written as people write them, and the devices in tests/input/devices.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "input/hid/decoder.hpp"
#include "input/replay/recording.hpp"

namespace surefoot::input {

/// "05 01 a1 01" to bytes.
inline std::vector<std::byte> hex(std::string_view text) {
    std::vector<std::byte> bytes;
    unsigned value = 0, digits = 0;
    for (const char c : text) {
        if (c == ' ' || c == '\n') continue;
        value = value * 16 + static_cast<unsigned>(c <= '9' ? c - '0' : c - 'a' + 10);
        if (++digits % 2 == 0) {
            bytes.push_back(static_cast<std::byte>(value));
            value = 0;
        }
    }
    return bytes;
}

inline std::string device_folder() { return std::string(SUREFOOT_SOURCE_DIR) + "/tests/input/devices"; }

inline Recording recorded(const std::string& name) {
    auto r = read_recording(device_folder() + "/" + name + ".hid");
    EXPECT_TRUE(r.ok()) << (r.ok() ? "" : r.error().text());
    return r.ok() ? std::move(*r) : Recording{};
}

inline Layout layout_of(std::span<const std::byte> bytes) {
    Layout layout;
    const auto refusal = parse_descriptor(bytes, layout);
    EXPECT_FALSE(refusal) << "byte " << refusal->offset << ": " << refusal->what;
    return layout;
}

/// As the tool describes it: with the recording's ids and name.
inline HidDevice device_of(const Recording& r) { return describe_device(layout_of(r.descriptor), {r.vendor, r.product, r.name}); }
inline HidDevice device(const std::string& name) { return device_of(recorded(name)); }

inline int control(const HidDevice& d, std::string_view name) {
    for (std::size_t i = 0; i < d.controls.size(); ++i)
        if (d.controls[i].name == name) return static_cast<int>(i);
    ADD_FAILURE() << "no control " << name;
    return 0;
}

/// A device with its decoder and state; null: no value.
struct Live {
    explicit Live(HidDevice d) : device(std::move(d)), decoder(device) {}
    ReportFate feed(std::string_view report) { return decoder.decode(hex(report), ++clock, state); }
    std::optional<std::int32_t> operator[](std::string_view name) const {
        const auto c = static_cast<std::size_t>(control(device, name));
        return state.has_value.test(c) ? std::optional(state.value[c]) : std::nullopt;
    }
    HidDevice device;
    ReportDecoder decoder;
    DeviceState state;
    std::int64_t clock = 0;
};

}  // namespace surefoot::input
