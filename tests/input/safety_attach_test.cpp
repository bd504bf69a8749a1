// Numbers of devices: given again once a device is gone, but not those of devices whose stop or dead-man holds the walk.
#include <gtest/gtest.h>

#include "tests/input/stick_fixture.hpp"

namespace surefoot::input {
namespace {

using test::Walk;

TEST(Attach, NumbersAreGivenAgainForEver) {
    Walk walk;
    for (int i = 0; i < 1000; ++i) {
        const int device = walk.plug();
        ASSERT_EQ(device, 0);
        walk.hold(device, 128, 128, 2);
        walk.detach(device);
        walk.tick();
    }
    for (int i = 0; i < static_cast<int>(max_devices); ++i) EXPECT_EQ(walk.plug(), i);
    EXPECT_EQ(walk.plug(), -1) << "too many";
}

TEST(Attach, AnAbsentStopKeepsItsNumberAndHoldsTheWalk) {
    DeviceMapping m = test::stick_mapping();
    m.buttons = {{{"button-1", 0, 0, ""}, Action::stop, 1, 0, 0, false},
                 {{"button-2", 0, 0, ""}, Action::stop_reset, 1, 0, 0, false}};
    Walk walk;
    const int stop = walk.plug(m);
    walk.hold(stop, 128, 128, 5);
    walk.detach(stop);
    walk.tick();
    const int other = walk.plug();
    EXPECT_NE(other, stop);
    walk.hold(other, 128, 128, 5);
    walk.hold(other, 128, 0, 100);
    EXPECT_EQ(walk.speed(), 0);
    EXPECT_EQ(walk.plug(m, Reporting::learn, stop), stop);
    test::set(walk.state, 2, 0);
    test::set(walk.state, 3, 0);
    walk.hold(stop, 128, 128, 5);
    EXPECT_TRUE(walk.safety().latched) << "back, but still latched";
    test::set(walk.state, 3, 1);
    walk.hold(stop, 128, 128, 5);
    EXPECT_FALSE(walk.safety().latched);
}

}  // namespace
}  // namespace surefoot::input
