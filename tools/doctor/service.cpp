// What the service leans on: systemd, the journal, disk space.
#include <fmt/format.h>

#include <array>

#include "tools/doctor/check.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::uint64_t enough_bytes = 1ULL << 30U;

Finding manager(const Machine& m) {
    if (m.exists("/run/systemd/system")) return pass("systemd manages this machine (/run/systemd/system)");
    const auto first = m.text("/proc/1/comm");
    if (!first) return unknown("neither /run/systemd/system nor /proc/1/comm can be read", "mount -t proc proc /proc");
    if (*first == "systemd") return pass("the first process is systemd");
    return fail(fmt::format("the first process is '{}', not systemd: nothing starts, monitors and restarts the service", *first),
                "apt install systemd-sysv; reboot");
}

Finding journal(const Machine& m) {
    if (m.exists("/run/systemd/journal/socket")) return pass("/run/systemd/journal/socket exists");
    if (!m.exists("/run")) return unknown("/run does not exist", "systemctl status systemd-journald");
    return fail("/run/systemd/journal/socket does not exist: the service's log is lost", "systemctl start systemd-journald");
}

Finding kept(const Machine& m) {
    if (m.exists("/var/log/journal")) return pass("the journal survives a reboot (/var/log/journal)");
    if (!m.exists("/var/log")) return unknown("/var/log does not exist", "mkdir -p /var/log/journal");
    return fail("the journal is lost at every reboot, and with it the reason for the reboot",
                "mkdir -p /var/log/journal && systemctl restart systemd-journald");
}

Finding disk(const Machine& m) {
    const auto bytes = m.probed().free_state_bytes;
    if (!bytes) return unknown("not checked", "df " + m.wanted().state_folder);
    std::string evidence = fmt::format("{} MiB free for {}", *bytes >> 20U, m.wanted().state_folder);
    if (*bytes >= enough_bytes) return pass(std::move(evidence));
    return fail(std::move(evidence) + ", 1024 are needed for recordings of misses", "journalctl --vacuum-size=200M; apt clean");
}

constexpr std::array all_service_checks = {
    Check{"service.systemd", "systemd runs", manager},
    Check{"service.journald", "journald runs", journal},
    Check{"service.journal_kept", "the journal is kept", kept},
    Check{"service.disk", "disk space for recordings", disk},
};

}  // namespace

std::span<const Check> service_checks() { return all_service_checks; }

}  // namespace surefoot::doctor
