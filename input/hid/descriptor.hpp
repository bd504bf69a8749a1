// A HID report descriptor as flat arrays: collections, reports and fields with exact bit offsets, as Linux lays them out.
//
// Source: "Device Class Definition for Human Interface Devices" 1.11, sections 5 and 6.2.2. Where the text leaves a choice, the
// choices and limits of Linux's hid-core hold, because the kernel decides what reaches hidraw. Every descriptor that the kernel
// accepts is accepted here with the same layout. classify.cpp decides whether the device may steer. Accepted oddities are listed
// in `notes`, each with its byte and its reason.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rt/base/result.hpp"

namespace surefoot::input {

constexpr std::size_t max_descriptor_bytes = 4096;          ///< HID_MAX_DESCRIPTOR_SIZE of the kernel
constexpr std::uint32_t max_push_depth = 4;                 ///< PUSH items open at once
constexpr std::uint32_t max_fields_per_report = 256;        ///< further ones consume their bits and are noted, as in the kernel
constexpr std::uint32_t max_usages = 12288;                 ///< of one field; also the largest Report Count
constexpr std::uint32_t max_report_size = 256;              ///< bits of one element
constexpr std::uint32_t max_report_bits = (16384 - 1) * 8;  ///< all of one report, without its id byte
constexpr std::size_t max_notes = 32;                       ///< kept; further ones are counted

enum class ReportKind : std::uint8_t { input, output, feature };

/// Bits of a main item's data (HID 1.11, 6.2.2.5).
namespace flag {
constexpr std::uint32_t constant = 0x001, variable = 0x002, relative = 0x004, wrap = 0x008, nonlinear = 0x010,
                        no_preferred = 0x020, null_state = 0x040, is_volatile = 0x080, buffered = 0x100;
}

/// Collection types (HID 1.11, 6.2.2.6).
namespace collection_type {
constexpr std::uint8_t physical = 0, application = 1, logical = 2;
}

constexpr std::uint32_t no_collection = 0xffffffffU;

/// Full usages are 32 bits: page << 16 | usage.
constexpr std::uint32_t full_usage(std::uint32_t page, std::uint32_t usage) { return (page << 16U) | (usage & 0xffffU); }

/// A collection of the descriptor.
struct Collection {
    std::uint32_t usage = 0;
    std::uint32_t parent = no_collection;  ///< index, or no_collection
    std::uint16_t level = 0;               ///< 0: outermost
    std::uint16_t offset = 0;              ///< byte of its item
    std::uint8_t type = 0;
};

/// Consecutive usages of a field, as one usage item or one minimum-maximum pair gave them.
struct UsageRun {
    std::uint32_t first = 0, count = 0;
    std::uint16_t page = 0;
    bool extended = false;  ///< `first` is a full usage (4-byte item); else its low 16 bits count within `page`

    [[nodiscard]] std::uint32_t at(std::uint32_t k) const { return extended ? first + k : full_usage(page, first + k); }
};

/// One main item with at least one usage. An item without usages is padding: it consumes bits and makes no field.
struct Field {
    ReportKind kind = ReportKind::input;
    std::uint8_t report_id = 0;    ///< 0: its reports carry no id
    std::uint16_t offset = 0;      ///< byte of the main item in the descriptor
    std::uint32_t bit_offset = 0;  ///< from the first bit behind the id byte
    std::uint32_t size = 0;        ///< bits of one element, 0..256
    std::uint32_t count = 0;       ///< elements
    std::uint32_t flags = 0;       ///< see flag::
    std::int32_t logical_min = 0, logical_max = 0;
    std::int32_t physical_min = 0, physical_max = 0;  ///< times 10^exponent, in `unit`
    std::uint32_t unit = 0;                           ///< HID's nibbles
    std::int32_t exponent = 0;
    std::uint32_t first_run = 0, run_count = 0;  ///< in Layout::runs
    std::uint32_t usages = 0;                    ///< at least `count`: the last usage repeats
    std::uint32_t collection = no_collection;    ///< innermost

    [[nodiscard]] bool variable() const { return (flags & flag::variable) != 0; }
    [[nodiscard]] bool constant() const { return (flags & flag::constant) != 0; }
    [[nodiscard]] bool relative() const { return (flags & flag::relative) != 0; }
};

/// The layout of all reports of one kind and id.
struct Report {
    ReportKind kind = ReportKind::input;
    std::uint8_t id = 0;
    std::uint32_t bits = 0;    ///< padding included, id byte not
    std::uint32_t fields = 0;  ///< kept in Layout::fields
    [[nodiscard]] std::uint32_t bytes() const { return (bits + 7) / 8; }
};

/// An oddity of a descriptor that is accepted all the same.
struct DescriptorNote {
    std::uint32_t offset = 0;  ///< byte in the descriptor
    std::string what;
};

/// Fields are in the order of the descriptor; reports in the order in which they were first named.
struct Layout {
    std::vector<Collection> collections;
    std::vector<UsageRun> runs;
    std::vector<Field> fields;
    std::vector<Report> reports;
    std::array<bool, 3> numbered{};     ///< by ReportKind: every report of that kind begins with its id
    std::vector<DescriptorNote> notes;  ///< the first max_notes
    std::uint32_t note_count = 0;

    /// The k-th usage of a field, k < field.usages; the last one repeats.
    [[nodiscard]] std::uint32_t usage_of(const Field& field, std::uint32_t k) const;
    /// Usage of the nearest enclosing collection of that type; 0 where there is none.
    [[nodiscard]] std::uint32_t enclosing(std::uint32_t collection, std::uint8_t type) const;
    /// Indexes of `fields`, report by report: inputs, outputs, features; reports in the order in which they were first
    /// named. The order in which the kernel prints them (debugfs hid/*/rdesc).
    [[nodiscard]] std::vector<std::uint32_t> fields_by_report() const;
    /// The declared report, or null.
    [[nodiscard]] const Report* find(ReportKind kind, std::uint8_t id) const;
};

/// Why a descriptor is refused.
struct Refusal {
    std::uint32_t offset = 0;  ///< of the first byte of the item at fault
    std::string what, remedy;
};

/// Reads `bytes` into `layout`. Memory below 1 MiB and time below 10 ms for any input.
std::optional<Refusal> parse_descriptor(std::span<const std::byte> bytes, Layout& layout);

/// The same; the error's place is "`place`: byte N".
Result<Layout> read_descriptor(std::span<const std::byte> bytes, const std::string& place);

}  // namespace surefoot::input
