// What devices are for: classes with reasons, control names, quirks row by row.
#include "input/hid/usages.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input {
namespace {

TEST(HidClass, EveryDeviceOfTheFolder) {
    const std::pair<const char*, DeviceClass> expected[] = {
        {"boot-mouse", DeviceClass::reject},
        {"boot-keyboard", DeviceClass::reject},
        {"dualshock4-like", DeviceClass::navigation},
        {"spacenavigator-like", DeviceClass::navigation},
        {"stick-14-bit", DeviceClass::navigation},
        {"f310-like", DeviceClass::navigation},
        {"pedals", DeviceClass::navigation},
        {"xbox-bluetooth-like", DeviceClass::navigation},
        {"trackball", DeviceClass::trackball},
        {"trackball-constant-buttons", DeviceClass::reject},
        {"six-axis-array-buttons", DeviceClass::navigation},
        {"push-pop", DeviceClass::navigation},
        {"four-byte-usages", DeviceClass::navigation},
        {"delimiters", DeviceClass::navigation},
        {"usage-page-after-usage", DeviceClass::navigation},
        {"nested-applications", DeviceClass::navigation},
        {"hat-240", DeviceClass::navigation},
        {"button-box", DeviceClass::buttons},
        {"touch-pad", DeviceClass::reject},
        {"media-keys", DeviceClass::reject},
        {"headset", DeviceClass::reject},
        {"vendor-only", DeviceClass::reject},
        {"absolute-mouse", DeviceClass::reject},
        {"pad-without-axes", DeviceClass::buttons},
        {"sparse-usages", DeviceClass::navigation},
        {"ids-in-two-collections", DeviceClass::navigation},
        {"wide-values", DeviceClass::navigation},
        {"no-range", DeviceClass::navigation},
        {"three-byte-value", DeviceClass::navigation},
        {"physical-units", DeviceClass::navigation},
        {"flags", DeviceClass::navigation},
    };
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(device_folder())) files += entry.path().extension() == ".hid";
    EXPECT_EQ(files, std::size(expected)) << "a device in the folder has no expected class here";
    for (const auto& [name, expected_class] : expected) {
        const HidDevice d = device(name);
        // The ELECOM shape counts only where no other maker is known.
        EXPECT_STREQ(class_name(d.device_class), class_name(expected_class)) << name << ": " << d.reason;
        EXPECT_FALSE(d.reason.empty()) << name;
        std::size_t axes = 0;
        for (const auto& c : d.controls) axes += c.kind == ControlKind::axis;
        EXPECT_TRUE(d.device_class != DeviceClass::navigation || axes >= 1U) << name;
    }
}

TEST(HidClass, AJoystickThatForgotItsApplicationIsOne) {
    const HidDevice d = describe_device(layout_of(hex("05 01 09 04 a1 00 15 81 25 7f 75 08 95 02 09 30 09 31 81 02 c0")), {});
    EXPECT_EQ(d.device_class, DeviceClass::navigation) << d.reason;
}

TEST(HidClass, AButtonBoxMayLeaveItsApplicationUndefined) {
    // Usage 0 of Generic Desktop, 32 buttons: a real device (1fd1:03ea).
    const std::string head = "05 01 09 00 a1 01 ", buttons = "05 09 19 01 29 20 15 00 25 01 95 20 75 01 81 02 ";
    const auto of = [](const std::string& text) { return describe_device(layout_of(hex(text)), {0x1fd1, 0x03ea}); };
    const HidDevice box = of(head + buttons + "c0");
    EXPECT_EQ(box.device_class, DeviceClass::buttons) << box.reason;
    EXPECT_EQ(box.reason, "a button box that names no application, with 32 buttons");
    EXPECT_EQ(box.controls.size(), 32U);
    EXPECT_EQ(of("a1 01 " + buttons + "c0").device_class, DeviceClass::buttons) << "no usage at all";
    // What has nothing but axes there says nothing of what they measure; a mouse or keyboard beside it is what the device is.
    EXPECT_EQ(of(head + "09 30 09 31 15 00 26 ff 00 75 08 95 02 81 02 c0").device_class, DeviceClass::reject);
    const std::string mouse = "05 01 09 02 a1 01 09 30 09 31 15 81 25 7f 75 08 95 02 81 06 c0";
    EXPECT_EQ(of(head + buttons + "c0 " + mouse).device_class, DeviceClass::reject);
    EXPECT_EQ(of("06 00 ff 09 01 a1 01 " + buttons + "c0").device_class, DeviceClass::reject) << "a vendor's own";
}

TEST(HidClass, TrackballsAreRecognised) {
    const Recording mouse = recorded("boot-mouse"), shaped = recorded("trackball-constant-buttons");
    const auto of = [](const Recording& r, DeviceId id) { return describe_device(layout_of(r.descriptor), id).device_class; };
    EXPECT_EQ(of(mouse, {}), DeviceClass::reject);
    EXPECT_EQ(of(mouse, {0, 0, "Logitech USB TrackBall"}), DeviceClass::trackball);
    EXPECT_EQ(of(shaped, {}), DeviceClass::trackball) << "by shape, where no id is known";
    EXPECT_EQ(of(shaped, {0x056e, 0x9999}), DeviceClass::trackball);
    EXPECT_EQ(of(shaped, {0x046d, 0x9999}), DeviceClass::reject);
}

TEST(HidClass, EachQuirkRowDoesItsWork) {
    const Recording mouse = recorded("boot-mouse"), six = recorded("spacenavigator-like");
    for (const Quirk& row : quirk_table()) {
        for (const std::uint16_t product : {row.first_product, row.last_product}) {
            const DeviceId id{row.vendor, product};
            if (row.effect == QuirkEffect::trackball) {
                EXPECT_EQ(describe_device(layout_of(mouse.descriptor), id).device_class, DeviceClass::trackball)
                    << id.vendor << ":" << product;
                continue;
            }
            const HidDevice d = describe_device(layout_of(six.descriptor), id);
            ASSERT_EQ(d.controls.size(), 8U);
            for (int a = 0; a < 6; ++a) EXPECT_FALSE(d.controls[static_cast<std::size_t>(a)].relative) << product;
            EXPECT_EQ(d.quirks.size(), 1U);
        }
    }
    const HidDevice stranger = describe_device(layout_of(six.descriptor), {0x1d50, 0x8000});
    EXPECT_TRUE(stranger.controls[0].relative) << "a stranger is taken at its word";
    EXPECT_TRUE(stranger.quirks.empty());
    const HidDevice cad_mouse = describe_device(layout_of(mouse.descriptor), {0x256f, 0xc650});
    EXPECT_EQ(cad_mouse.device_class, DeviceClass::reject);
    EXPECT_TRUE(cad_mouse.controls[0].relative) << "only below a multi-axis controller";
}

std::vector<std::string> names(const HidDevice& d) {
    std::vector<std::string> all;
    for (const auto& c : d.controls) all.push_back(c.name);
    return all;
}

TEST(HidControls, AreNamedByUsage) {
    using Names = std::vector<std::string>;
    EXPECT_EQ(names(device("pedals")), (Names{"accelerator", "brake", "clutch"}));
    EXPECT_EQ(names(device("boot-mouse")), (Names{"x", "y", "button-1", "button-2", "button-3"}));
    EXPECT_EQ(names(device("hat-240")), (Names{"x", "hat", "hat-2", "hat-3"}));
    EXPECT_EQ(names(device("sparse-usages")), (Names{"x", "y", "rx", "rx-2", "rx-3", "button-1", "button-2", "button-5",
                                                     "button-6", "button-7", "button-10", "button-9", "button-9-2"}));
    const HidDevice x = device("xbox-bluetooth-like");
    const Names all = names(x);
    EXPECT_EQ(Names(all.begin(), all.begin() + 7), (Names{"x", "y", "z", "rz", "brake", "accelerator", "hat"}));
    EXPECT_EQ(x.controls[0].collection, "Game Pad/Pointer");
    EXPECT_EQ(x.controls.back().name, "consumer-223");
}

TEST(HidControls, OfTwoApplicationsDoNotShareANameOrARank) {
    const HidDevice d = describe_device(layout_of(hex("05 01 09 02 a1 01 85 01 09 30 09 31 15 81 25 7f 75 08 95 02 81 06 c0"
                                                      "09 04 a1 01 85 02 09 30 09 31 81 02 c0")),
                                        {});
    EXPECT_EQ(names(d), (std::vector<std::string>{"x", "y", "mouse-x", "mouse-y"}));
    EXPECT_EQ(d.device_class, DeviceClass::navigation);
    EXPECT_EQ(d.controls[0].collection, "Joystick");
    EXPECT_EQ(d.controls[2].collection, "Mouse");
}

TEST(HidControls, KeepPhysicalRangesAndUnits) {
    const HidDevice d = device("physical-units");
    EXPECT_DOUBLE_EQ(d.controls[0].physical_min, -1.8);
    EXPECT_EQ(d.controls[0].unit, "deg");
    EXPECT_EQ(d.controls[1].unit, "cm");
    EXPECT_EQ(d.controls[3].unit, "cm·s^-1");
    EXPECT_EQ(unit_name(0), "");
}

TEST(HidControls, BeyondTheLimitAreCounted) {
    const HidDevice d = device("media-keys");
    EXPECT_EQ(d.controls.size(), max_controls);
    EXPECT_EQ(d.controls_left_out, 0x3ffU - max_controls);
}

TEST(HidControls, NothingSteersWithoutRangeOrSizeOrFromConstants) {
    EXPECT_EQ(names(device("no-range")), (std::vector<std::string>{"rz"}))
        << "the only field with a range, 8 bits and an element";
    for (const auto& c : device("flags").controls) EXPECT_NE(c.name, "x") << "declared constant";
    for (const auto& c : device("wide-values").controls) {
        EXPECT_NE(c.name, "z") << "a maximum of 2^32-1 is below its minimum in 32 bits";
        EXPECT_NE(c.name, "slider");
    }
}

}  // namespace
}  // namespace surefoot::input
