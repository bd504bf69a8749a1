// Memory: how much, and what moves, merges, compacts or swaps pages under a running frame.
#include <fmt/format.h>

#include <array>

#include "tools/doctor/check.hpp"
#include "tools/doctor/words.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::int64_t enough_kb = 1 << 20;

std::string keep(std::string_view key, int value) {
    return fmt::format("sysctl -w {0}={1}; to keep it: echo '{0} = {1}' >> /etc/sysctl.d/70-surefoot.conf", key, value);
}

Finding available(const Machine& m) {
    const std::string info = m.text("/proc/meminfo").value_or("");
    for (const std::string_view line : split(info, "\n")) {
        const auto fields = split(line, " ");
        if (fields.size() < 2 || fields[0] != "MemAvailable:") continue;
        const auto kb = number_in(fields[1]);
        if (!kb) break;
        std::string evidence = fmt::format("{} MiB available", *kb >> 10);
        if (*kb >= enough_kb) return pass(std::move(evidence));
        return fail(std::move(evidence) + ", 1024 are needed: all memory of a walk is locked",
                    "stop services that are not needed (systemctl stop), or add memory");
    }
    return unknown("/proc/meminfo has no MemAvailable", "mount -t proc proc /proc");
}

Finding huge_pages(const Machine& m) {
    constexpr std::string_view file = "/sys/kernel/mm/transparent_hugepage/enabled";
    const auto modes = m.text(file);
    const std::string_view mode = modes ? marked_word(*modes, '[', ']') : std::string_view();
    if (mode.empty())
        return unknown(fmt::format("{} cannot be read", file), "nothing to do if this kernel is built without huge pages");
    std::string evidence = fmt::format("transparent huge pages: {}", mode);
    if (mode != "always") return pass(std::move(evidence));
    return fail(std::move(evidence) + ": khugepaged stops threads while it merges their pages into huge ones",
                fmt::format("echo madvise > {}; or boot with transparent_hugepage=madvise", file));
}

Finding swap(const Machine& m) {
    const auto swaps = m.text("/proc/swaps");
    if (!swaps) return unknown("/proc/swaps cannot be read", "mount -t proc proc /proc");
    const auto lines = split(*swaps, "\n");
    if (lines.empty() || !lines[0].starts_with("Filename"))
        return unknown("/proc/swaps has an unknown format", "see swapon --show");
    if (lines.size() == 1) return pass("no swap");
    const auto fields = split(lines[1], " \t");
    const std::string where = fields.empty() ? "?" : std::string(fields[0]);
    const auto swappiness = m.number("/proc/sys/vm/swappiness");
    if (!swappiness)
        return unknown(where + " is on, and vm.swappiness cannot be read", "swapoff -a, and remove it from /etc/fstab");
    std::string evidence = fmt::format("{} is on, vm.swappiness is {}", where, *swappiness);
    if (*swappiness <= 10) return pass(std::move(evidence));
    return fail(std::move(evidence), "swapoff -a, and remove it from /etc/fstab; or " + keep("vm.swappiness", 1));
}

Finding compaction(const Machine& m) {
    const auto value = m.number("/proc/sys/vm/compact_unevictable_allowed");
    if (!value)
        return unknown("/proc/sys/vm/compact_unevictable_allowed cannot be read",
                       "nothing to do if this kernel is built without compaction");
    if (*value == 0) return pass("compaction does not move locked pages (vm.compact_unevictable_allowed is 0)");
    return fail("compaction moves locked pages, which causes page faults (vm.compact_unevictable_allowed is 1)",
                keep("vm.compact_unevictable_allowed", 0));
}

Finding merging(const Machine& m) {
    const auto value = m.number("/sys/kernel/mm/ksm/run");
    if (!value) return unknown("/sys/kernel/mm/ksm/run cannot be read", "nothing to do if this kernel is built without it");
    if (*value != 1) return pass(fmt::format("pages are not merged (ksm/run is {})", *value));
    return fail("KSM merges equal pages, and copies them again at the next write", "echo 2 > /sys/kernel/mm/ksm/run");
}

constexpr std::array all_memory_checks = {
    Check{"memory.available", "enough memory to lock", available},
    Check{"memory.huge_pages", "no transparent huge pages", huge_pages},
    Check{"memory.swap", "no swap", swap},
    Check{"memory.compaction", "no compaction of locked pages", compaction},
    Check{"memory.merging", "no merging of equal pages", merging},
};

}  // namespace

std::span<const Check> memory_checks() { return all_memory_checks; }

}  // namespace surefoot::doctor
