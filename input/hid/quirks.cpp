// The table of quirks. Ids from usb.ids, systemd's 70-mouse.hwdb, and the Linux drivers' hid-ids.h and hid-elecom.
#include "input/hid/quirks.hpp"

#include <algorithm>
#include <iterator>

namespace surefoot::input {

namespace {

constexpr std::string_view deflects = "3Dconnexion: the axes call themselves relative, but report how far the cap is held";
constexpr std::string_view a_ball = "a trackball by its id; its descriptor says mouse";

constexpr Quirk rows[] = {
    // Only below a Multi-axis Controller application: CadMouse and keyboards of the same maker stay what they are.
    {0x046d, 0xc603, 0xc640, QuirkEffect::deflections, deflects}, {0x256f, 0x0000, 0xffff, QuirkEffect::deflections, deflects},
    {0x045e, 0x0023, 0x0024, QuirkEffect::trackball, a_ball},  // Microsoft Trackball Optical, Explorer
    {0x046d, 0xc401, 0xc404, QuirkEffect::trackball, a_ball},  // Logitech TrackMan Marble, Wheel
    {0x046d, 0xc408, 0xc408, QuirkEffect::trackball, a_ball},  // Logitech Marble Mouse
    {0x046d, 0xb01d, 0xb01d, QuirkEffect::trackball, a_ball},  // Logitech MX Ergo
    {0x046d, 0x1028, 0x1028, QuirkEffect::trackball, a_ball},  // Logitech M570
    {0x047d, 0x1020, 0x1023, QuirkEffect::trackball, a_ball},  // Kensington Expert, Orbit
    {0x047d, 0x2041, 0x2041, QuirkEffect::trackball, a_ball},  // Kensington SlimBlade
    {0x047d, 0x2048, 0x2048, QuirkEffect::trackball, a_ball},  // Kensington Orbit with ring
    {0x047d, 0x8018, 0x8019, QuirkEffect::trackball, a_ball},  // Kensington Expert Wireless
    {0x047d, 0x80d4, 0x80d4, QuirkEffect::trackball, a_ball},  // Kensington SlimBlade Pro
    {0x056e, 0x0155, 0x0155, QuirkEffect::trackball, a_ball},  // ELECOM Relacon
    {0x056e, 0x00fb, 0x00ff, QuirkEffect::trackball, a_ball},  // ELECOM EX-G, DEFT
    {0x056e, 0x010c, 0x010d, QuirkEffect::trackball, a_ball},  // ELECOM HUGE
    {0x056e, 0x011c, 0x011c, QuirkEffect::trackball, a_ball},  // ELECOM HUGE
    {0x5043, 0x5c46, 0x5c46, QuirkEffect::trackball, a_ball},  // Ploopy
};

}  // namespace

std::span<const Quirk> quirk_table() { return rows; }

bool named_trackball(std::string_view name) {
    constexpr std::string_view word = "trackball";
    return std::search(name.begin(), name.end(), word.begin(), word.end(), [](char a, char b) {
               return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b;
           }) != name.end();
}

const Quirk* find_quirk(DeviceId id, QuirkEffect effect) {
    const auto* row = std::find_if(std::begin(rows), std::end(rows), [&](const Quirk& q) {
        return q.vendor == id.vendor && id.product >= q.first_product && id.product <= q.last_product && q.effect == effect;
    });
    return row == std::end(rows) ? nullptr : row;
}

}  // namespace surefoot::input
