// The doctor's checks: each one question about the machine, answered from files and probes with evidence and a remedy.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/doctor/machine.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::doctor {

/// unknown never counts as pass.
enum class Status : unsigned char { pass, fail, unknown };
std::string_view status_name(Status status);

/// The result of one check.
struct Finding {
    Status status = Status::unknown;
    std::string evidence;  ///< what was read, and where
    std::string remedy;    ///< an exact command or line of a file; empty only where nothing is to be done
};

inline Finding pass(std::string evidence) { return {Status::pass, std::move(evidence), {}}; }
inline Finding fail(std::string evidence, std::string remedy) { return {Status::fail, std::move(evidence), std::move(remedy)}; }
inline Finding unknown(std::string evidence, std::string remedy) {
    return {Status::unknown, std::move(evidence), std::move(remedy)};
}

/// name: "topic.check", unique, and kept from version to version. Pure: the same machine gives the same finding.
struct Check {
    std::string_view name;
    std::string_view what;  ///< what should be so, in a few words
    Finding (*run)(const Machine&);
};

/// By topic, in the order in which they are shown.
std::span<const Check> kernel_checks();
std::span<const Check> core_checks();
std::span<const Check> interrupt_checks();
std::span<const Check> power_checks();
std::span<const Check> time_checks();
std::span<const Check> limit_checks();
std::span<const Check> memory_checks();
std::span<const Check> device_checks();
std::span<const Check> picture_checks();
std::span<const Check> service_checks();
std::span<const Check> wake_up_checks();
std::vector<Check> all_checks();

/// A check together with its result.
struct Examined {
    Check check;
    Finding finding;
};
std::vector<Examined> examine(const Machine& machine);

/// Counts of results by status.
struct Summary {
    int pass = 0, fail = 0, unknown = 0;
};
Summary summarise(std::span<const Examined> examined);

/// The findings for people, grouped by topic. Evidence is wrapped at the style's width; remedies are not, so that they can be
/// copied.
std::string table(const Machine& machine, std::span<const Examined> examined, const report::TerminalStyle& style);

}  // namespace surefoot::doctor
