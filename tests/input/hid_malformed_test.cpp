// Malformed and odd descriptors: each refused at its byte, or accepted for the reason stated beside it.
#include "tests/input/hid_test.hpp"

namespace surefoot::input {
namespace {

constexpr int accepted = -1;

struct Seed {
    const char* what;
    const char* bytes;  ///< behind "05 01 09 04 a1 01" (6 bytes) where it begins with '+'
    int byte;           ///< of the refusal
};

const Seed seeds[] = {
    {"nothing at all", "", 0},
    {"an item of one byte cut off", "+ 09", 6},
    {"an item of two bytes cut off", "+ 26 ff", 6},
    {"an item of four bytes cut off", "+ 27 ff ff 00", 6},
    {"a long item", "05 01 fe 02 10 aa bb c0", 2},
    {"a long item without data", "fe 00 00", 0},
    {"a long item of any type", "+ f5", 6},
    {"an end without a begin", "05 01 c0", 2},
    {"one end too many", "+ c0 c0", 7},
    {"a collection left open: its begin", "+ 09 30", 4},
    {"the inner one of two left open", "+ a1 00 a1 00 c0", 6},
    {"POP without PUSH", "b4", 0},
    {"POP twice", "+ a4 b4 b4 c0", 8},
    {"five PUSH", "+ a4 a4 a4 a4 a4 c0", 10},
    {"four PUSH never popped: nothing is lost by it", "+ a4 a4 a4 a4 c0", accepted},
    {"id 0", "+ 85 00 c0", 6},
    {"id without a value is 0", "+ 84 c0", 6},
    {"id 256", "+ 86 00 01 c0", 6},
    {"id 2^32-1", "+ 87 ff ff ff ff c0", 6},
    {"id 255 is the last", "+ 85 ff 09 30 75 08 95 01 81 02 c0", accepted},
    {"12289 elements", "+ 96 01 30 c0", 6},
    {"2^32-1 elements", "+ 97 ff ff ff ff c0", 6},
    {"12288 elements: the kernel's limit", "+ 09 30 75 01 96 00 30 81 02 c0", accepted},
    {"elements of 257 bits", "+ 76 01 01 c0", 6},
    {"elements of 256 bits are laid out, but steer nothing", "+ 09 30 76 00 01 95 01 81 02 c0", accepted},
    {"elements of 33 bits are laid out, but steer nothing", "+ 09 30 75 21 95 01 81 02 c0", accepted},
    {"elements of no bits: real devices have them", "+ 09 30 75 00 95 05 81 02 c0", accepted},
    {"no elements: real devices have them", "+ 09 30 75 08 95 00 81 02 c0", accepted},
    {"global item 12", "05 01 c5 00", 2},
    {"global item 14", "05 01 e4", 2},
    {"a reserved type is passed over, as the kernel does", "0c 05 01", accepted},
    {"an unknown local item is passed over", "+ b9 01 c0", accepted},
    {"unknown main items are passed over", "05 01 00 10 d1 05", accepted},
    {"only a zero: an unknown main item; the class is reject", "00", accepted},
    {"a delimiter in a delimiter", "+ a9 01 a9 01 c0", 8},
    {"a delimiter closed, never opened", "+ a9 00 c0", 6},
    {"a delimiter open at the end", "+ c0 a9 01", 7},
    {"a delimiter open at a main item ends with it, as in the kernel", "+ a9 01 09 30 75 08 95 01 81 02 c0", accepted},
    {"a delimiter closed behind the main item that ended it", "+ a9 01 81 02 a9 00 c0", 10},
    {"minimum 127, maximum 81: read as 129", "+ 09 30 15 7f 25 81 75 08 95 01 81 02 c0", accepted},
    {"minimum 5 above maximum 1", "+ 09 30 15 05 25 01 75 08 95 01 81 02 c0", 16},
    {"minimum -1 above maximum -5", "+ 09 30 15 ff 25 fb 75 08 95 01 81 02 c0", 16},
    {"minimum equals maximum: laid out, but no axis", "+ 09 30 15 05 25 05 75 08 95 01 81 02 c0", accepted},
    {"an input outside every collection: laid out, but no control", "05 01 09 30 15 00 25 7f 75 08 95 01 81 02", accepted},
    {"a usage range upside down: cut as the kernel cuts it", "+ 19 05 29 03 15 00 25 01 75 01 95 08 81 02 c0", accepted},
    {"a usage range of 65537: cut to 12288 as in the kernel", "+ 1b 00 00 01 00 2b 00 00 02 00 15 00 25 01 75 01 95 08 81 02 c0",
     accepted},
    {"a usage range without end", "+ 1b f0 ff ff ff 2b ff ff ff ff 75 01 95 08 81 02 c0", 11},
    {"usages beyond 12288", "+ 19 01 2a 00 30 09 30 75 01 95 08 81 02 c0", 11},
    {"a report of 16384 bytes", "+ 09 30 75 08 96 00 30 81 02 96 00 10 81 02 c0", 18},
    {"a report of 16383 bytes", "+ 09 30 75 08 96 00 30 81 02 96 ff 0f 81 02 c0", accepted},
};

std::vector<std::byte> bytes_of(const char* text) {
    return *text == '+' ? hex(std::string("05 01 09 04 a1 01") + (text + 1)) : hex(text);
}

TEST(HidMalformed, EachSeedAtItsByteOrForItsReason) {
    for (const Seed& seed : seeds) {
        Layout layout;
        const auto refusal = parse_descriptor(bytes_of(seed.bytes), layout);
        EXPECT_EQ(refusal ? static_cast<int>(refusal->offset) : accepted, seed.byte)
            << seed.what << ": " << (refusal ? refusal->what : "accepted");
        if (refusal) {
            EXPECT_FALSE(refusal->what.empty() || refusal->remedy.empty()) << seed.what;
            continue;
        }
        // What is accepted though odd gives no axis, but for the two that are in order.
        const HidDevice d = describe_device(std::move(layout), {});
        EXPECT_FALSE(d.reason.empty());
        for (const auto& c : d.controls) {
            EXPECT_TRUE(c.kind != ControlKind::axis || c.logical_min < c.logical_max) << seed.what;
        }
    }
}

TEST(HidMalformed, WhatIsOddIsCounted) {
    const auto notes = [](const char* text) { return layout_of(bytes_of(text)).note_count; };
    EXPECT_EQ(notes("00"), 1U);
    EXPECT_EQ(notes("0c 05 01"), 1U);
    EXPECT_EQ(notes("05 01 09 30 25 7f 75 08 95 01 81 02"), 1U);
    EXPECT_EQ(notes("+ 09 30 25 7f 75 00 95 01 81 02 c0"), 1U);
    EXPECT_EQ(notes("+ 09 30 25 7f 75 08 95 01 81 02 c0"), 0U);
}

/// Decided once: the parser takes what the kernel takes, since the kernel delivers it; only the class decides who steers.
TEST(HidMalformed, TheThreeOpenCasesAreAcceptedAndSteerNothing) {
    std::string deep;
    for (int i = 0; i < 300; ++i) deep += "a1 00 ";
    for (int i = 0; i < 300; ++i) deep += "c0 ";
    for (const std::string& text : {deep, std::string("00"), std::string("05 01 09 30 09 31 15 00 25 7f 75 08 95 02 81 02")}) {
        const HidDevice d = describe_device(layout_of(hex(text)), {});
        EXPECT_EQ(d.device_class, DeviceClass::reject);
        EXPECT_TRUE(d.controls.empty());
        EXPECT_GE(d.layout.note_count, 1U);
    }
}

TEST(HidMalformed, NothingIsReadBeyond4096Bytes) {
    std::vector<std::byte> bytes(4096, std::byte{0x04});
    Layout layout;
    EXPECT_FALSE(parse_descriptor(bytes, layout));
    bytes.push_back(std::byte{0x04});
    const auto refusal = parse_descriptor(bytes, layout);
    ASSERT_TRUE(refusal);
    EXPECT_EQ(refusal->offset, 4096U);
    auto read = read_descriptor(bytes, "stick.bin");
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.error().place, "stick.bin: byte 4096");
}

}  // namespace
}  // namespace surefoot::input
