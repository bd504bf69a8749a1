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
    if (!first) return unknown("neither /run/systemd/system nor /proc/1/comm is to be seen", "mount -t proc proc /proc");
    if (*first == "systemd") return pass("the first process is systemd");
    return fail(fmt::format("the first process is '{}', not systemd: nothing starts, watches and restarts the service", *first),
                "apt install systemd-sysv; reboot");
}

Finding journal(const Machine& m) {
    if (m.exists("/run/systemd/journal/socket")) return pass("/run/systemd/journal/socket is there");
    if (!m.exists("/run")) return unknown("/run is not there", "systemctl status systemd-journald");
    return fail("/run/systemd/journal/socket is not there: nobody takes the service's words", "systemctl start systemd-journald");
}

Finding kept(const Machine& m) {
    if (m.exists("/var/log/journal")) return pass("the journal outlives a restart (/var/log/journal)");
    if (!m.exists("/var/log")) return unknown("/var/log is not there", "mkdir -p /var/log/journal");
    return fail("the journal ends with every restart: why it happened is lost",
                "mkdir -p /var/log/journal && systemctl restart systemd-journald");
}

Finding disk(const Machine& m) {
    const auto bytes = m.probed().free_state_bytes;
    if (!bytes) return unknown("not looked for", "df " + m.wanted().state_folder);
    std::string evidence = fmt::format("{} MiB free for {}", *bytes >> 20U, m.wanted().state_folder);
    if (*bytes >= enough_bytes) return pass(std::move(evidence));
    return fail(std::move(evidence) + ", 1024 are wanted for recordings of misses", "journalctl --vacuum-size=200M; apt clean");
}

constexpr std::array all_service_checks = {
    Check{"service.systemd", "somebody restarts it", manager},
    Check{"service.journald", "somebody takes its words", journal},
    Check{"service.journal_kept", "and keeps them", kept},
    Check{"service.disk", "room for recordings", disk},
};

}  // namespace

std::span<const Check> service_checks() { return all_service_checks; }

}  // namespace surefoot::doctor
