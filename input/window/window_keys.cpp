// The table of keys.
#include "input/window/window_keys.hpp"

#include <algorithm>
#include <array>

namespace surefoot::input {

namespace {

constexpr std::array key_table = {
    WindowKey{"a", 'a', 0x04},
    WindowKey{"b", 'b', 0x05},
    WindowKey{"c", 'c', 0x06},
    WindowKey{"d", 'd', 0x07},
    WindowKey{"e", 'e', 0x08},
    WindowKey{"f", 'f', 0x09},
    WindowKey{"g", 'g', 0x0a},
    WindowKey{"h", 'h', 0x0b},
    WindowKey{"i", 'i', 0x0c},
    WindowKey{"j", 'j', 0x0d},
    WindowKey{"k", 'k', 0x0e},
    WindowKey{"l", 'l', 0x0f},
    WindowKey{"m", 'm', 0x10},
    WindowKey{"n", 'n', 0x11},
    WindowKey{"o", 'o', 0x12},
    WindowKey{"p", 'p', 0x13},
    WindowKey{"q", 'q', 0x14},
    WindowKey{"r", 'r', 0x15},
    WindowKey{"s", 's', 0x16},
    WindowKey{"t", 't', 0x17},
    WindowKey{"u", 'u', 0x18},
    WindowKey{"v", 'v', 0x19},
    WindowKey{"w", 'w', 0x1a},
    WindowKey{"x", 'x', 0x1b},
    WindowKey{"y", 'y', 0x1c},
    WindowKey{"z", 'z', 0x1d},
    WindowKey{"1", '1', 0x1e},
    WindowKey{"2", '2', 0x1f},
    WindowKey{"3", '3', 0x20},
    WindowKey{"4", '4', 0x21},
    WindowKey{"5", '5', 0x22},
    WindowKey{"6", '6', 0x23},
    WindowKey{"7", '7', 0x24},
    WindowKey{"8", '8', 0x25},
    WindowKey{"9", '9', 0x26},
    WindowKey{"0", '0', 0x27},
    WindowKey{"enter", 0xff0d, 0x28},
    WindowKey{"backspace", 0xff08, 0x2a},
    WindowKey{"tab", 0xff09, 0x2b},
    WindowKey{"space", ' ', 0x2c},
    WindowKey{"insert", 0xff63, 0x49},
    WindowKey{"home", 0xff50, 0x4a},
    WindowKey{"page-up", 0xff55, 0x4b},
    WindowKey{"delete", 0xffff, 0x4c},
    WindowKey{"end", 0xff57, 0x4d},
    WindowKey{"page-down", 0xff56, 0x4e},
    WindowKey{"right", 0xff53, 0x4f},
    WindowKey{"left", 0xff51, 0x50},
    WindowKey{"down", 0xff54, 0x51},
    WindowKey{"up", 0xff52, 0x52},
    WindowKey{"left-ctrl", 0xffe3, 0xe0},
    WindowKey{"left-shift", 0xffe1, 0xe1},
    WindowKey{"right-ctrl", 0xffe4, 0xe4},
    WindowKey{"right-shift", 0xffe2, 0xe5},
};
static_assert(key_table.size() <= 64, "A report has a bit for each key");

}  // namespace

std::span<const WindowKey> window_keys() { return key_table; }

int window_key_of(std::uint32_t symbol) {
    const auto found = std::ranges::find(key_table, symbol, &WindowKey::symbol);
    return found == key_table.end() ? -1 : static_cast<int>(found - key_table.begin());
}

}  // namespace surefoot::input
