// Drawing: whether GL opens, and whether the cost table is this machine's.
#include <fmt/format.h>

#include <array>

#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

namespace {

Finding renderer(const Machine& m) {
    const auto& found = m.probed().renderer;
    if (!found) return unknown("GL was not opened", "run surefoot doctor on the machine itself");
    if (found->name.empty())
        return fail(found->error, found->remedy.empty() ? "apt install libegl1 libgl1-mesa-dri" : found->remedy);
    return pass(fmt::format("{} ({})", found->name, found->software ? "software: frames cost CPU time" : "hardware"));
}

Finding cost_table(const Machine& m) {
    const auto& table = m.probed().costs;
    if (!table) return unknown("not checked", "run surefoot doctor on the machine itself");
    const std::string calibrate = "surefoot calibrate";
    if (!table->there) return fail("no cost table: " + table->file, calibrate);
    if (!table->error.empty()) return fail(table->file + ": " + table->error, calibrate);
    const auto& drawn = m.probed().renderer;
    if (!drawn || drawn->name.empty())
        return unknown(fmt::format("{} was measured on \"{}\"; the renderer here is not known", table->file, table->machine),
                       calibrate);
    if (drawn->machine == table->machine) return pass(fmt::format("{} was measured on this machine", table->file));
    return fail(fmt::format("{} was measured on \"{}\", this is \"{}\"", table->file, table->machine, drawn->machine), calibrate);
}

/// Without a window system. A window's screen is its server's.
Finding screen(const Machine& m) {
    const auto& found = m.probed().screens;
    if (!found) return unknown("not checked", "run surefoot doctor on the machine itself");
    if (found->screens.empty()) return unknown(found->error, found->remedy + "; nothing to do where an X server has the screen");
    std::string good, bad, dark;
    for (const ScreenFound& one : found->screens) {
        if (!one.connected) continue;
        std::string& list = !one.counts_refreshes ? dark : *one.counts_refreshes ? good : bad;
        list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", one.name, one.mode);
    }
    if (!bad.empty())
        return fail(bad + " counts no refreshes: pictures are shown by this machine's clock, and may be torn",
                    "use the screen of another card");
    if (!good.empty()) return pass(good + " counts refreshes: frames can be held to them");
    if (!dark.empty()) return unknown(dark + " shows nothing now", "run it again while something is shown");
    return unknown("no screen is connected", "connect one; nothing to do where none is wanted");
}

constexpr std::array all_picture_checks = {
    Check{"picture.renderer", "OpenGL works", renderer},
    Check{"picture.screen", "frames can be held to a screen", screen},
    Check{"picture.cost_table", "the cost table is of this machine", cost_table},
};

}  // namespace

std::span<const Check> picture_checks() { return all_picture_checks; }

}  // namespace surefoot::doctor
