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

constexpr std::array all_picture_checks = {
    Check{"picture.renderer", "OpenGL works", renderer},
    Check{"picture.cost_table", "the cost table is of this machine", cost_table},
};

}  // namespace

std::span<const Check> picture_checks() { return all_picture_checks; }

}  // namespace surefoot::doctor
