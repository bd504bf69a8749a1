// One item of a report descriptor: its prefix and its value, signed or not (HID 1.11, 6.2.2.2 and 6.2.2.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace surefoot::input {

enum class ItemType : std::uint8_t { main, global, local, reserved };

namespace tag {
// main
constexpr std::uint8_t input = 8, output = 9, collection = 10, feature = 11, end_collection = 12;
// global
constexpr std::uint8_t usage_page = 0, logical_minimum = 1, logical_maximum = 2, physical_minimum = 3, physical_maximum = 4,
                       unit_exponent = 5, unit = 6, report_size = 7, report_id = 8, report_count = 9, push = 10, pop = 11;
// local
constexpr std::uint8_t usage = 0, usage_minimum = 1, usage_maximum = 2, delimiter = 10;
// any type
constexpr std::uint8_t long_item = 15;
}  // namespace tag

/// One item of a report descriptor.
struct Item {
    std::uint32_t offset = 0;  ///< byte of its prefix
    std::uint32_t size = 0;    ///< bytes of its value: 0, 1, 2, 4
    std::uint32_t raw = 0;     ///< little-endian, zero-extended
    ItemType type = ItemType::main;
    std::uint8_t tag = 0;
    bool long_form = false;
    bool cut_off = false;  ///< the descriptor ends inside it; `raw` is 0

    [[nodiscard]] std::uint32_t unsigned_value() const { return raw; }
    [[nodiscard]] std::int32_t signed_value() const {
        if (size == 1) return static_cast<std::int8_t>(raw);
        if (size == 2) return static_cast<std::int16_t>(raw);
        return static_cast<std::int32_t>(raw);
    }
};

/// The item at `at`, which is inside `bytes`.
inline Item fetch_item(std::span<const std::byte> bytes, std::uint32_t at) {
    const auto prefix = std::to_integer<std::uint32_t>(bytes[at]);
    Item item;
    item.offset = at;
    item.type = static_cast<ItemType>((prefix >> 2U) & 3U);
    item.tag = static_cast<std::uint8_t>(prefix >> 4U);
    item.long_form = item.tag == tag::long_item;
    item.size = (prefix & 3U) == 3U ? 4U : prefix & 3U;
    item.cut_off = bytes.size() - at - 1 < item.size;
    if (item.cut_off || item.long_form) return item;
    for (std::uint32_t i = 0; i < item.size; ++i) item.raw |= std::to_integer<std::uint32_t>(bytes[at + 1 + i]) << (8U * i);
    return item;
}

}  // namespace surefoot::input
