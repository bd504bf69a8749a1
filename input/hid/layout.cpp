// Questions to a layout: a field's usages, its surroundings, and the order in which the kernel prints the fields.
#include <algorithm>
#include <numeric>
#include <utility>

#include "input/hid/descriptor.hpp"

namespace surefoot::input {

std::uint32_t Layout::usage_of(const Field& field, std::uint32_t k) const {
    for (std::uint32_t r = field.first_run; r < field.first_run + field.run_count; ++r) {
        if (k < runs[r].count) return runs[r].at(k);
        k -= runs[r].count;
    }
    const UsageRun& last = runs[field.first_run + field.run_count - 1];
    return last.at(last.count - 1);
}

std::uint32_t Layout::enclosing(std::uint32_t collection, std::uint8_t type) const {
    for (; collection != no_collection; collection = collections[collection].parent)
        if (collections[collection].type == type) return collections[collection].usage;
    return 0;
}

std::vector<std::uint32_t> Layout::fields_by_report() const {
    std::array<std::array<std::uint16_t, 256>, 3> place{};
    for (std::size_t r = 0; r < reports.size(); ++r)
        place[static_cast<std::size_t>(reports[r].kind)][reports[r].id] = static_cast<std::uint16_t>(r);
    std::vector<std::uint32_t> order(fields.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto key = [&](std::uint32_t i) {
        const auto kind = static_cast<std::size_t>(fields[i].kind);
        return std::pair(kind, place[kind][fields[i].report_id]);
    };
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    return order;
}

const Report* Layout::find(ReportKind kind, std::uint8_t id) const {
    for (const Report& report : reports)
        if (report.kind == kind && report.id == id) return &report;
    return nullptr;
}

}  // namespace surefoot::input
