// Reports to values: bits extracted as Linux extracts them, into a DeviceState, without allocating.
//
// Same as the kernel (hid-core, hid-input): sign extension only if the logical minimum is below zero. Values outside the logical
// range are clamped; if the field has a null state, they are no value. Arrays list pressed buttons; a missing one is released; a
// roll-over code keeps the array's last state. Different on purpose:
//   - Short, long and undeclared reports change nothing and are counted. The kernel cuts long ones and drops short ones. Older
//     kernels fill short ones with zeros, which is full deflection on an unsigned axis.
//   - A null state of an axis or button is "no value". evdev keeps the last value.
//   - A hat is 0..7, and centred for any value outside its range. The kernel's division rounds some of these to north.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "input/controls.hpp"
#include "input/hid/device.hpp"

namespace surefoot::input {

enum class ReportFate : std::uint8_t { accepted, too_short, too_long, undeclared };

/// Counts of reports; all but `accepted` changed nothing.
struct ReportCounts {
    std::uint64_t accepted = 0, too_short = 0, too_long = 0, undeclared = 0;
};

/// Values of one device. Built once (allocates); decode() does not allocate, lock or fail.
class ReportDecoder {
public:
    explicit ReportDecoder(const HidDevice& device);

    /// `report` as hidraw gives it: the id first where the device numbers its reports.
    /// Accepted: state.value, has_value, reports and stamp_ns are brought up to date. Else only a count changes.
    ReportFate decode(std::span<const std::byte> report, std::int64_t stamp_ns, DeviceState& state);

    [[nodiscard]] const ReportCounts& counts() const { return counts_; }
    /// Bytes of the input report, id included; 0 where it is undeclared.
    [[nodiscard]] std::uint32_t expected_bytes(std::uint8_t id) const;
    [[nodiscard]] bool numbered() const { return numbered_; }
    /// Indexes of the controls that reports with this id carry; empty where undeclared.
    [[nodiscard]] std::vector<std::uint16_t> controls_in(std::uint8_t id) const;

private:
    struct Variable {
        std::uint32_t bit = 0;
        std::int32_t min = 0, max = 0;
        std::uint16_t control = 0;
        std::uint8_t size = 0;
        ControlKind kind = ControlKind::axis;
        bool null_state = false;
    };
    struct ArrayButton {
        std::uint32_t index = 0;  ///< in the field's usages
        std::uint16_t control = 0;
    };
    struct Array {
        std::uint32_t bit = 0, count = 0, usages = 0;
        std::int32_t min = 0, max = 0;
        std::uint32_t first_button = 0, button_count = 0;      ///< sorted by index
        std::uint32_t first_rollover = 0, rollover_count = 0;  ///< sorted
        std::uint8_t size = 0;
    };
    struct Stream {
        std::uint32_t bytes = 0;
        std::uint32_t first_variable = 0, variable_count = 0, first_array = 0, array_count = 0;
        bool declared = false;
    };

    void add_array(const HidDevice& device, std::uint32_t field, std::span<const ArrayButton> buttons);
    void read_variable(const Variable& v, std::span<const std::byte> data, DeviceState& state) const;
    void read_array(const Array& a, std::span<const std::byte> data, DeviceState& state) const;

    std::vector<Variable> variables_;
    std::vector<Array> arrays_;
    std::vector<ArrayButton> buttons_;
    std::vector<std::uint32_t> rollovers_;
    std::array<Stream, 256> streams_{};
    ReportCounts counts_;
    bool numbered_ = false;
};

/// `size` bits at `bit`, least significant first; size 1..32, all inside `data`.
std::uint32_t extract_bits(std::span<const std::byte> data, std::uint32_t bit, std::uint32_t size);
/// Two's complement of `size` bits.
std::int32_t sign_extend(std::uint32_t value, std::uint32_t size);

}  // namespace surefoot::input
