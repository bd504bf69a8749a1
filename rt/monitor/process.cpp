// Reading /proc/self.
#include "rt/monitor/process.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <string_view>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"
#include "rt/threads/usage.hpp"

namespace surefoot::rt {

namespace {

constexpr std::uint64_t max_proc_file = 1U << 20U;

/// The number after "name:" in /proc/self/status; -1 where there is none.
std::int64_t status_number(std::string_view status, std::string_view name) {
    std::size_t at = 0;
    while (at < status.size()) {
        const std::string_view line = status.substr(at, status.find('\n', at) - at);
        at += line.size() + 1;
        if (!line.starts_with(name) || line.size() <= name.size() || line[name.size()] != ':') continue;
        const std::size_t digits = line.find_first_of("0123456789");
        return digits != std::string_view::npos ? leading_number<std::int64_t>(line.substr(digits), -1) : -1;
    }
    return -1;
}

std::int64_t kibibytes(std::string_view status, std::string_view name) {
    const std::int64_t value = status_number(status, name);
    return value < 0 ? -1 : value * 1024;
}

/// The n-th field of /proc/self/stat, from 1 as in proc(5); the name, which may hold anything, ends at the last ')'.
std::int64_t stat_field(std::string_view stat, int n) {
    const std::size_t name_end = stat.rfind(')');
    if (name_end == std::string_view::npos) return -1;
    std::string_view rest = stat.substr(name_end + 1);
    for (int field = 3;; ++field) {
        const std::size_t begin = rest.find_first_not_of(' ');
        if (begin == std::string_view::npos) return -1;
        rest.remove_prefix(begin);
        if (field == n) return leading_number<std::int64_t>(rest, -1);
        rest.remove_prefix(std::min(rest.find(' '), rest.size()));
    }
}

std::int64_t entries_in(const std::string& folder) {
    std::error_code problem;
    std::int64_t count = 0;
    std::filesystem::directory_iterator at(folder, problem);
    if (problem) return -1;
    for (; at != std::filesystem::directory_iterator(); at.increment(problem)) {
        if (problem) return -1;
        ++count;
    }
    return count;
}

}  // namespace

ProcessFigures read_process(const std::string& root) {
    ProcessFigures p;
    const std::string self = root + "/proc/self";
    if (const auto status = read_text(self + "/status", max_proc_file)) {
        p.rss_bytes = kibibytes(*status, "VmRSS");
        p.virtual_bytes = kibibytes(*status, "VmSize");
        p.locked_bytes = kibibytes(*status, "VmLck");
        p.threads = status_number(*status, "Threads");
    }
    if (const auto stat = read_text(self + "/stat", max_proc_file)) {
        const double ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
        const std::int64_t user = stat_field(*stat, 14), system = stat_field(*stat, 15), started = stat_field(*stat, 22);
        if (user >= 0 && system >= 0) p.cpu_s = static_cast<double>(user + system) / ticks;
        if (started >= 0) p.started_s = static_cast<double>(started) / ticks;
    }
    // The folder is open while it is counted: that one is not the process's own.
    if (const std::int64_t open = entries_in(self + "/fd"); open > 0) p.descriptors = open - (root.empty() ? 1 : 0);
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
        p.max_descriptors = static_cast<std::int64_t>(limit.rlim_cur);
    if (const auto steal = read_steal(root)) p.steal_s = steal->total_ms * 1e-3;
    return p;
}

std::vector<BusyThread> read_busy_threads() {
    std::vector<BusyThread> busy;
    const auto threads = read_threads();
    if (!threads) return busy;
    for (const ThreadInfo& info : *threads) {
        const std::int64_t cpu_ns = thread_cpu_ns(info.tid);
        if (cpu_ns >= 0) busy.push_back({info, cpu_ns});
    }
    return busy;
}

}  // namespace surefoot::rt
