// The census: a pure comparison, so that it can be tested without threads.
#include "rt/threads/census.hpp"

#include <fmt/format.h>

namespace surefoot::rt {

namespace {

std::string described(const Placement& p) { return fmt::format("{} {} on cores {:#x}", policy_name(p.policy), p.priority, p.cores); }

const Declared* row_of(std::span<const Declared> table, const std::string& name, std::size_t& index) {
    for (index = 0; index < table.size(); ++index) {
        if (name.starts_with(table[index].prefix)) return &table[index];
    }
    return nullptr;
}

}  // namespace

std::vector<std::string> census(std::span<const Declared> table, std::span<const ThreadInfo> threads, int frame_core) {
    std::vector<std::string> problems;
    std::vector<int> counts(table.size(), 0);
    const std::uint64_t frame_bit = frame_core < 0 ? 0 : 1ULL << static_cast<unsigned>(frame_core);
    for (const ThreadInfo& thread : threads) {
        std::size_t index = 0;
        const Declared* row = row_of(table, thread.name, index);
        if (row == nullptr) {
            problems.push_back(fmt::format("thread {} '{}' ({}) is not declared", thread.tid, thread.name, described(thread.placement)));
            continue;
        }
        ++counts[index];
        const Placement& is = thread.placement;
        const Placement& should = row->placement;
        const bool real_time = is.policy == Policy::fifo || is.policy == Policy::round_robin;
        if (row->any_policy) {
            if (real_time && (is.cores & frame_bit) != 0) {
                problems.push_back(fmt::format("thread {} '{}' is {}: it may compete with the frame thread", thread.tid, thread.name, described(is)));
            }
            continue;
        }
        if (is.policy != should.policy || is.priority != should.priority || (should.cores != 0 && is.cores != should.cores)) {
            problems.push_back(fmt::format("thread {} '{}' is {}, declared {}", thread.tid, thread.name, described(is), described(should)));
        }
    }
    for (std::size_t i = 0; i < table.size(); ++i) {
        if (counts[i] < table[i].at_least || counts[i] > table[i].at_most) {
            problems.push_back(fmt::format("{} threads named '{}*', declared {} to {}", counts[i], table[i].prefix, table[i].at_least, table[i].at_most));
        }
    }
    return problems;
}

}  // namespace surefoot::rt
