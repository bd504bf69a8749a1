// All checks in order, run on one machine, and counted.
#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

std::string_view status_name(Status status) {
    switch (status) {
        case Status::pass:
            return "pass";
        case Status::fail:
            return "fail";
        case Status::unknown:
            return "unknown";
    }
    return "unknown";
}

std::vector<Check> all_checks() {
    std::vector<Check> all;
    for (const auto topic : {kernel_checks(), core_checks(), interrupt_checks(), power_checks(), time_checks(), limit_checks(),
                             memory_checks(), device_checks(), picture_checks(), service_checks(), wake_up_checks()})
        all.insert(all.end(), topic.begin(), topic.end());
    return all;
}

std::vector<Examined> examine(const Machine& machine) {
    std::vector<Examined> examined;
    for (const Check& check : all_checks()) examined.push_back({check, check.run(machine)});
    return examined;
}

Summary summarise(std::span<const Examined> examined) {
    Summary summary;
    for (const Examined& e : examined)
        ++(e.finding.status == Status::pass ? summary.pass : e.finding.status == Status::fail ? summary.fail : summary.unknown);
    return summary;
}

}  // namespace surefoot::doctor
