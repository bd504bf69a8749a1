// Notes of the input thread: they read as all other errors do, and need no memory.
#include "input/messages.hpp"

#include <gtest/gtest.h>

#include <string>

#include "rt/threads/guard.hpp"

namespace surefoot::input {
namespace {

TEST(Messages, AnErrorReadsAsItDoesElsewhereAndNeedsNoMemory) {
    const Error errors[] = {{"/dev/hidraw0", "The device may not be read", "Install the udev rule"},
                            {"/dev/hidraw0", "The device was unplugged", ""},
                            {"", "No device steers", "Plug one in"},
                            {"gpiochip0", "", "Name another chip"},
                            {"s.toml:3", "The key 'x' is unknown", "Did you mean 'y'?"},
                            {"a", "It ends itself.", "So does this."}};
    for (const Error& error : errors) {
        const std::string wanted = error.text();
        MessageLine line;
        const std::uint64_t before = rt::guard_counters().own_violations;
        {
            const rt::OwnScope own;
            line = format_message(error);
        }
        EXPECT_EQ(rt::guard_counters().own_violations, before);
        EXPECT_EQ(line.view(), wanted);
    }
}

TEST(Messages, WhatIsTooLongIsCutOff) {
    const Error error{"a", std::string(2000, 'x'), ""};
    EXPECT_EQ(format_message(error).view(), error.text().substr(0, MessageLine{}.text.size()));
}

}  // namespace
}  // namespace surefoot::input
