// Builds the decoder's flat tables, and reads reports by them.
#include "input/hid/decoder.hpp"

#include <algorithm>

#include "input/hid/usages.hpp"

namespace surefoot::input {

std::uint32_t extract_bits(std::span<const std::byte> data, std::uint32_t bit, std::uint32_t size) {
    // At most 5 bytes touch 32 bits.
    const std::size_t first = bit / 8, last = (bit + size - 1) / 8;
    std::uint64_t window = 0;
    for (std::size_t i = last + 1; i-- > first;) window = (window << 8U) | std::to_integer<std::uint64_t>(data[i]);
    window >>= bit % 8U;
    return static_cast<std::uint32_t>(window & ((std::uint64_t{1} << size) - 1));
}

std::int32_t sign_extend(std::uint32_t value, std::uint32_t size) {
    const std::uint32_t sign = 1U << (size - 1);
    return static_cast<std::int32_t>((value ^ sign) - sign);
}

ReportDecoder::ReportDecoder(const HidDevice& device) {
    const Layout& l = device.layout;
    numbered_ = l.numbered[static_cast<std::size_t>(ReportKind::input)];

    // Controls by field: a device has at most max_controls, so sorting their sources is cheap.
    struct Bound {
        ControlSource source;
        std::uint16_t control;
    };
    std::vector<Bound> bound;
    bound.reserve(device.sources.size());
    for (const ControlSource& source : device.sources) bound.push_back({source, static_cast<std::uint16_t>(bound.size())});
    std::sort(bound.begin(), bound.end(), [&](const Bound& a, const Bound& b) {
        const auto id_a = l.fields[a.source.field].report_id, id_b = l.fields[b.source.field].report_id;
        if (id_a != id_b) return id_a < id_b;
        return a.source.field != b.source.field ? a.source.field < b.source.field : a.source.index < b.source.index;
    });

    for (const Report& r : l.reports) {
        if (r.kind != ReportKind::input) continue;
        streams_[r.id].declared = true;
        streams_[r.id].bytes = r.bytes() + (numbered_ ? 1 : 0);
    }
    std::vector<ArrayButton> pending;
    for (std::size_t i = 0; i < bound.size(); ++i) {
        const Bound& b = bound[i];
        const Field& f = l.fields[b.source.field];
        Stream& s = streams_[f.report_id];
        if (f.variable()) {
            if (s.variable_count++ == 0) s.first_variable = static_cast<std::uint32_t>(variables_.size());
            variables_.push_back({f.bit_offset + b.source.index * f.size, f.logical_min, f.logical_max, b.control,
                                  static_cast<std::uint8_t>(f.size), device.controls[b.control].kind,
                                  (f.flags & flag::null_state) != 0});
            continue;
        }
        pending.push_back({b.source.index, b.control});
        if (i + 1 < bound.size() && bound[i + 1].source.field == b.source.field) continue;
        if (s.array_count++ == 0) s.first_array = static_cast<std::uint32_t>(arrays_.size());
        add_array(device, b.source.field, pending);
        pending.clear();
    }
}

void ReportDecoder::add_array(const HidDevice& device, std::uint32_t field, std::span<const ArrayButton> buttons) {
    const Layout& l = device.layout;
    const Field& f = l.fields[field];
    Array a;
    a.bit = f.bit_offset;
    a.count = f.count;
    a.usages = f.usages;
    a.min = f.logical_min;
    a.max = f.logical_max;
    a.size = static_cast<std::uint8_t>(f.size);
    a.first_button = static_cast<std::uint32_t>(buttons_.size());
    a.button_count = static_cast<std::uint32_t>(buttons.size());
    buttons_.insert(buttons_.end(), buttons.begin(), buttons.end());
    a.first_rollover = static_cast<std::uint32_t>(rollovers_.size());
    std::uint32_t index = 0;
    for (std::uint32_t r = f.first_run; r < f.first_run + f.run_count; ++r)
        for (std::uint32_t k = 0; k < l.runs[r].count; ++k, ++index)
            if (l.runs[r].at(k) == usage_roll_over) rollovers_.push_back(index);
    a.rollover_count = static_cast<std::uint32_t>(rollovers_.size()) - a.first_rollover;
    arrays_.push_back(a);
}

std::uint32_t ReportDecoder::expected_bytes(std::uint8_t id) const { return streams_[numbered_ ? id : 0].bytes; }

std::vector<std::uint16_t> ReportDecoder::controls_in(std::uint8_t id) const {
    const Stream& s = streams_[numbered_ ? id : 0];
    std::vector<std::uint16_t> controls;
    for (std::uint32_t i = 0; i < s.variable_count; ++i) controls.push_back(variables_[s.first_variable + i].control);
    for (std::uint32_t i = 0; i < s.array_count; ++i) {
        const Array& a = arrays_[s.first_array + i];
        for (std::uint32_t k = 0; k < a.button_count; ++k) controls.push_back(buttons_[a.first_button + k].control);
    }
    std::sort(controls.begin(), controls.end());
    return controls;
}

void ReportDecoder::read_variable(const Variable& v, std::span<const std::byte> data, DeviceState& state) const {
    state.carried_over.reset(v.control);
    const std::uint32_t raw = extract_bits(data, v.bit, v.size);
    std::int32_t value = v.min < 0 ? sign_extend(raw, v.size) : static_cast<std::int32_t>(raw);
    if (v.min < v.max) {
        const bool outside = value < v.min || value > v.max;
        if (outside && (v.null_state || v.kind == ControlKind::hat)) {
            state.has_value.reset(v.control);
            return;
        }
        value = std::clamp(value, v.min, v.max);
    }
    if (v.kind == ControlKind::hat) {
        const std::int64_t steps = std::int64_t{v.max} - v.min + 1;
        value = static_cast<std::int32_t>((std::int64_t{value} - v.min) * 8 / steps);
    } else if (v.kind == ControlKind::button) {
        value = value != 0 ? 1 : 0;
    }
    state.value[v.control] = value;
    state.has_value.set(v.control);
}

void ReportDecoder::read_array(const Array& a, std::span<const std::byte> data, DeviceState& state) const {
    std::bitset<max_controls> pressed;
    const auto* buttons = buttons_.data() + a.first_button;
    for (std::uint32_t k = 0; k < a.button_count; ++k) state.carried_over.reset(buttons[k].control);
    const auto* rollovers = rollovers_.data() + a.first_rollover;
    for (std::uint32_t n = 0; n < a.count; ++n) {
        const std::uint32_t raw = extract_bits(data, a.bit + n * a.size, a.size);
        const std::int32_t value = a.min < 0 ? sign_extend(raw, a.size) : static_cast<std::int32_t>(raw);
        if (value < a.min || value > a.max) continue;
        const std::int64_t index = std::int64_t{value} - a.min;
        if (index >= a.usages) continue;
        if (std::binary_search(rollovers, rollovers + a.rollover_count, static_cast<std::uint32_t>(index))) return;
        const auto* found = std::lower_bound(buttons, buttons + a.button_count, index,
                                             [](const ArrayButton& b, std::int64_t i) { return std::int64_t{b.index} < i; });
        if (found != buttons + a.button_count && found->index == index) pressed.set(found->control);
    }
    for (std::uint32_t k = 0; k < a.button_count; ++k) {
        state.value[buttons[k].control] = pressed.test(buttons[k].control) ? 1 : 0;
        state.has_value.set(buttons[k].control);
    }
}

ReportFate ReportDecoder::decode(std::span<const std::byte> report, std::int64_t stamp_ns, DeviceState& state) {
    if (report.empty()) return ++counts_.too_short, ReportFate::too_short;
    const Stream& s = streams_[numbered_ ? std::to_integer<std::size_t>(report[0]) : 0];
    if (!s.declared) return ++counts_.undeclared, ReportFate::undeclared;
    if (report.size() < s.bytes) return ++counts_.too_short, ReportFate::too_short;
    if (report.size() > s.bytes) return ++counts_.too_long, ReportFate::too_long;
    const auto data = numbered_ ? report.subspan(1) : report;
    state.carried_over.set();
    for (std::uint32_t i = 0; i < s.variable_count; ++i) read_variable(variables_[s.first_variable + i], data, state);
    for (std::uint32_t i = 0; i < s.array_count; ++i) read_array(arrays_[s.first_array + i], data, state);
    ++counts_.accepted;
    ++state.reports;
    state.stamp_ns = stamp_ns;
    return ReportFate::accepted;
}

}  // namespace surefoot::input
