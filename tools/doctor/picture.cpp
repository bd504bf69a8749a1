// Drawing: whether GL opens, and whether the cost table is this machine's.
#include <fmt/format.h>

#include <array>

#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

namespace {

Finding renderer(const Machine& m) {
    const auto& found = m.probed().renderer;
    if (!found) return unknown("not opened", "run surefoot doctor on the machine itself");
    if (found->name.empty())
        return fail(found->error, found->remedy.empty() ? "apt install libegl1 libgl1-mesa-dri" : found->remedy);
    return pass(fmt::format("{} ({})", found->name, found->software ? "software: frames cost CPU time" : "hardware"));
}

Finding cost_table(const Machine& m) {
    const auto& table = m.probed().costs;
    if (!table) return unknown("not looked for", "run surefoot doctor on the machine itself");
    const std::string calibrate = "surefoot calibrate";
    if (!table->there) return fail("no cost table: " + table->file, calibrate);
    if (!table->error.empty()) return fail(table->file + " " + table->error, calibrate);
    const auto& drawn = m.probed().renderer;
    if (!drawn || drawn->name.empty())
        return unknown(fmt::format("{} is of \"{}\"; what draws here is not known", table->file, table->machine), calibrate);
    if (drawn->machine == table->machine) return pass(fmt::format("{} is of this machine", table->file));
    return fail(fmt::format("{} is of \"{}\", this is \"{}\"", table->file, table->machine, drawn->machine), calibrate);
}

constexpr std::array all_picture_checks = {
    Check{"picture.renderer", "GL opens", renderer},
    Check{"picture.cost_table", "costs are of this machine", cost_table},
};

}  // namespace

std::span<const Check> picture_checks() { return all_picture_checks; }

}  // namespace surefoot::doctor
