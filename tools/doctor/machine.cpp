// Reading below a root directory: sysfs, procfs and /etc as text, numbers, lists and words.
#include "tools/doctor/machine.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <filesystem>
#include <system_error>

#include "rt/base/file.hpp"
#include "rt/threads/capability.hpp"
#include "tools/doctor/words.hpp"

namespace surefoot::doctor {

namespace {

constexpr std::uint64_t max_bytes = 1U << 20U;

/// /proc/config.gz or a plain file: gzread takes both.
std::optional<std::string> unpacked(const std::string& file) {
    const gzFile in = gzopen(file.c_str(), "rb");
    if (in == nullptr) return std::nullopt;
    std::string text;
    std::array<char, 16384> part{};
    int got = 0;
    while (text.size() < 4 * max_bytes && (got = gzread(in, part.data(), part.size())) > 0)
        text.append(part.data(), static_cast<std::size_t>(got));
    gzclose(in);
    if (got < 0 || text.empty()) return std::nullopt;
    return text;
}

bool by_number(const std::string& a, const std::string& b) {
    const auto x = number_in(a), y = number_in(b);
    return x && y ? *x < *y : a < b;
}

std::optional<int> choose_core(const Machine& machine, const std::optional<int>& requested, const rt::CpuMask& granted) {
    if (requested) return requested;
    const auto list = machine.own_status("Cpus_allowed_list");
    auto allowed = list ? rt::CpuMask::parse(*list) : Result<rt::CpuMask>(Error{});
    if (!allowed) {
        const auto online = machine.cpus("/sys/devices/system/cpu/online");
        if (!online) return std::nullopt;
        allowed = *online;
    }
    rt::CpuMask isolated;
    for (const int cpu : machine.isolated().cpus()) {
        if (allowed->has(cpu) || granted.has(cpu)) isolated.add(cpu);
    }
    const int core = rt::default_frame_core(*allowed, isolated);
    return core < 0 ? std::nullopt : std::optional<int>(core);
}

}  // namespace

Machine::Machine(std::string root, Wanted wanted, Probed probed)
    : root_(std::move(root)), wanted_(std::move(wanted)), probed_(std::move(probed)) {
    build_configuration_ = unpacked(root_ + "/proc/config.gz");
    if (!build_configuration_) {
        if (const auto release = text("/proc/sys/kernel/osrelease")) build_configuration_ = text("/boot/config-" + *release);
    }
    frame_core_ = choose_core(*this, wanted_.frame_core, probed_.isolated);
}

std::optional<std::string> Machine::text(std::string_view path) const {
    auto content = read_text(root_ + std::string(path), max_bytes);
    if (!content) return std::nullopt;
    return std::string(trimmed(*content));
}

std::optional<std::int64_t> Machine::number(std::string_view path) const {
    const auto content = text(path);
    return content ? number_in(*content) : std::nullopt;
}

std::optional<rt::CpuMask> Machine::cpus(std::string_view path) const {
    const auto content = text(path);
    if (!content || *content == "(null)") return content ? std::optional(rt::CpuMask{}) : std::nullopt;
    auto mask = rt::CpuMask::parse(*content);
    return mask ? std::optional(*mask) : std::nullopt;
}

std::optional<std::vector<std::string>> Machine::names(std::string_view path) const {
    std::error_code error;
    std::vector<std::string> found;
    for (std::filesystem::directory_iterator at(root_ + std::string(path), error), end; !error && at != end; at.increment(error))
        found.push_back(at->path().filename().string());
    if (error) return std::nullopt;
    std::sort(found.begin(), found.end(), by_number);
    return found;
}

bool Machine::exists(std::string_view path) const {
    std::error_code error;
    return std::filesystem::exists(root_ + std::string(path), error);
}

std::optional<Node> Machine::node(std::string_view path) const {
    struct stat status {};
    if (stat((root_ + std::string(path)).c_str(), &status) != 0) return std::nullopt;
    return Node{status.st_gid, status.st_mode & 0777U};
}

std::optional<std::string> Machine::boot_word(std::string_view key) const {
    const auto line = text("/proc/cmdline");
    if (!line) return std::nullopt;
    std::optional<std::string> value;
    for (const std::string_view word : split(*line, " \t\n")) {
        if (word == key) value = "1";
        if (word.starts_with(key) && word.substr(key.size()).starts_with('=')) value = std::string(word.substr(key.size() + 1));
    }
    return value;
}

std::optional<std::string> Machine::build_option(std::string_view key) const {
    if (!build_configuration_) return std::nullopt;
    const std::string wanted = std::string(key) + "=";
    for (const std::string_view line : split(*build_configuration_, "\n")) {
        if (line.starts_with(wanted)) return std::string(line.substr(wanted.size()));
    }
    return "n";
}

std::optional<bool> Machine::processor_flag(std::string_view flag) const {
    const auto info = text("/proc/cpuinfo");
    if (!info) return std::nullopt;
    for (const std::string_view line : split(*info, "\n")) {
        if (!line.starts_with("flags")) continue;
        const auto words = split(line.substr(std::min(line.find(':'), line.size())), " \t:");
        return std::find(words.begin(), words.end(), flag) != words.end();
    }
    return std::nullopt;
}

std::optional<Machine::Version> Machine::kernel() const {
    const auto release = text("/proc/sys/kernel/osrelease");
    if (!release) return std::nullopt;
    const auto parts = split(*release, ".-+");
    if (parts.size() < 2) return std::nullopt;
    const auto major = number_in(parts[0]), minor = number_in(parts[1]);
    if (!major || !minor) return std::nullopt;
    return Version{static_cast<int>(*major), static_cast<int>(*minor)};
}

std::optional<std::string> Machine::own_status(std::string_view key) const {
    const auto status = text("/proc/self/status");
    if (!status) return std::nullopt;
    for (const std::string_view line : split(*status, "\n")) {
        if (line.starts_with(key) && line.substr(key.size()).starts_with(':'))
            return std::string(trimmed(line.substr(key.size() + 1)));
    }
    return std::nullopt;
}

std::optional<bool> Machine::has_capability(int number) const {
    const auto effective = own_status("CapEff");
    if (!effective) return std::nullopt;
    std::uint64_t bits = 0;
    const char* const end = effective->data() + effective->size();
    if (std::from_chars(effective->data(), end, bits, 16).ptr != end) return std::nullopt;
    return (bits >> static_cast<unsigned>(number) & 1U) != 0;
}

std::optional<std::uint32_t> Machine::group(std::string_view name) const {
    const auto groups = text("/etc/group");
    if (!groups) return std::nullopt;
    for (const std::string_view line : split(*groups, "\n")) {
        const auto fields = split(line, ":");
        if (fields.size() < 3 || fields[0] != name) continue;
        const auto id = number_in(fields[2]);
        return id ? std::optional(static_cast<std::uint32_t>(*id)) : std::nullopt;
    }
    return std::nullopt;
}

rt::CpuMask Machine::isolated() const { return cpus("/sys/devices/system/cpu/isolated").value_or(rt::CpuMask{}); }

}  // namespace surefoot::doctor
