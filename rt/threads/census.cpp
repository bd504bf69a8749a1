// The census: finds the row of each thread, then checks threads against their rows, and the counts of the rows.
#include "rt/threads/census.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace surefoot::rt {

namespace {

bool matches(const DeclaredThread& row, const ThreadInfo& thread) {
    return row.whole_name ? thread.name == row.name : thread.name.starts_with(row.name);
}

/// Index of the row with the longest matching name; a whole name goes before a prefix of the same length. -1: none.
int row_of(std::span<const DeclaredThread> declared, const ThreadInfo& thread) {
    int best = -1;
    for (std::size_t i = 0; i < declared.size(); ++i) {
        if (!matches(declared[i], thread)) continue;
        if (best >= 0) {
            const DeclaredThread& other = declared[static_cast<std::size_t>(best)];
            if (declared[i].name.size() < other.name.size()) continue;
            if (declared[i].name.size() == other.name.size() && !declared[i].whole_name) continue;
        }
        best = static_cast<int>(i);
    }
    return best;
}

std::string described(Policy policy, int priority) {
    return priority == 0 ? std::string(policy_name(policy)) : fmt::format("{} {}", policy_name(policy), priority);
}

void check_thread(const DeclaredThread& row, const ThreadInfo& thread, std::vector<std::string>& problems) {
    const std::string who = fmt::format("Thread '{}' ({})", thread.name, thread.tid);
    if (thread.policy != row.policy) {
        problems.push_back(fmt::format("{} runs as {} instead of {}", who, described(thread.policy, thread.priority),
                                       described(row.policy, row.priority)));
    } else if (thread.priority != row.priority) {
        problems.push_back(fmt::format("{} has priority {} instead of {}", who, thread.priority, row.priority));
    }
    if (!row.cpus.empty() && !(thread.cpus == row.cpus))
        problems.push_back(fmt::format("{} runs on cores {} instead of {}", who, thread.cpus.text(), row.cpus.text()));
}

}  // namespace

std::vector<std::string> census(std::span<const DeclaredThread> declared, std::span<const ThreadInfo> found) {
    std::vector<std::string> problems;
    std::vector<int> counts(declared.size(), 0);
    for (const ThreadInfo& thread : found) {
        const int row = row_of(declared, thread);
        if (row < 0) {
            problems.push_back(fmt::format("Thread '{}' ({}) is not declared; it runs as {} on cores {}", thread.name, thread.tid,
                                           described(thread.policy, thread.priority), thread.cpus.text()));
            continue;
        }
        ++counts[static_cast<std::size_t>(row)];
        check_thread(declared[static_cast<std::size_t>(row)], thread, problems);
    }
    for (std::size_t i = 0; i < declared.size(); ++i) {
        const DeclaredThread& row = declared[i];
        if (counts[i] < row.min_count)
            problems.push_back(fmt::format("Thread '{}' is missing: {} of at least {}", row.name, counts[i], row.min_count));
        if (counts[i] > row.max_count)
            problems.push_back(
                fmt::format("Thread '{}' is there too often: {} of at most {}", row.name, counts[i], row.max_count));
    }
    return problems;
}

std::vector<CensusRow> census_rows(std::span<const DeclaredThread> declared, std::span<const ThreadInfo> found) {
    std::vector<CensusRow> rows;
    const int undeclared = static_cast<int>(declared.size());
    for (int wanted = 0; wanted <= undeclared; ++wanted) {
        const std::size_t first = rows.size();
        for (const ThreadInfo& thread : found) {
            const int row = row_of(declared, thread);
            if ((row < 0 ? undeclared : row) != wanted) continue;
            const std::string& name = row < 0 ? thread.name : declared[static_cast<std::size_t>(row)].name;
            const auto alike =
                std::find_if(rows.begin() + static_cast<std::ptrdiff_t>(first), rows.end(), [&](const CensusRow& r) {
                    return r.name == name && r.policy == thread.policy && r.priority == thread.priority && r.cpus == thread.cpus;
                });
            if (alike != rows.end()) {
                ++alike->count;
            } else {
                rows.push_back({name, 1, thread.policy, thread.priority, thread.cpus});
            }
        }
    }
    return rows;
}

}  // namespace surefoot::rt
