// /proc, read twice and subtracted.
#include "tools/soak/machine_facts.hpp"

#include <fmt/format.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <sstream>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"
#include "rt/clock/clock.hpp"
#include "rt/threads/usage.hpp"

namespace surefoot::soak {

std::uint64_t proc_figure(std::string_view text, std::string_view name) {
    for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1)) {
        std::string_view rest = text.substr(at + name.size());
        const bool is_whole = (at == 0 || text[at - 1] == '\n') && rest.find_first_of(" :") == 0;
        if (!is_whole) continue;
        rest.remove_prefix(std::min(rest.find_first_not_of(" :\t"), rest.size()));
        return leading_number<std::uint64_t>(rest, 0);
    }
    return 0;
}

std::uint64_t proc_figure_of(const std::string& file, std::string_view name) {
    const auto text = read_text(file, 1U << 22U);
    return text ? proc_figure(*text, name) : 0;
}

namespace {

constexpr std::size_t max_interrupts = 20;

std::string text_of(const std::string& file) {
    auto text = read_text(file, 1U << 24U);
    return text ? *text : std::string();
}

std::string without_end(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    return text;
}

/// "  24:  12  34  PCI-MSI  virtio0-input" -> "24 virtio0-input", 46; " LOC: 5 6 Local timer interrupts" -> "LOC Local timer
/// interrupts"
void read_interrupts(const std::string& text, std::map<std::string, double>& counts) {
    std::istringstream lines(text);
    std::string line;
    std::getline(lines, line);  // the cores
    while (std::getline(lines, line)) {
        std::istringstream words(line);
        std::string name, word, what;
        words >> name;
        if (name.empty() || name.back() != ':') continue;
        name.pop_back();
        const bool numbered = name[0] >= '0' && name[0] <= '9';
        double sum = 0;
        bool counting = true;
        while (words >> word) {
            const auto value = number_in<double>(word);
            counting = counting && value;
            if (counting) {
                sum += *value;
            } else {
                what = numbered || what.empty() ? word : what + " " + word;
            }
        }
        counts[what.empty() ? name : name + " " + what] = sum;
    }
}

/// "some avg10=0.00 ... total=123"
void read_pressure(const std::string& text, const std::string& of, std::map<std::string, double>& pressure_us) {
    std::istringstream lines(text);
    std::string line;
    while (std::getline(lines, line)) {
        const std::size_t total = line.find("total=");
        if (total == std::string::npos) continue;
        pressure_us[of + " " + line.substr(0, line.find(' '))] = leading_number(std::string_view(line).substr(total + 6), 0.0);
    }
}

}  // namespace

MachineCounters read_counters(const std::string& root) {
    MachineCounters c;
    c.time_s = static_cast<double>(rt::monotonic_ns()) * 1e-9;
    read_interrupts(text_of(root + "/proc/interrupts"), c.interrupts);
    for (const char* of : {"cpu", "memory", "io"}) read_pressure(text_of(root + "/proc/pressure/" + of), of, c.pressure_us);
    if (const auto steal = rt::read_steal(root)) c.steal_ms = steal->total_ms;
    const std::string stat = text_of(root + "/proc/stat");
    c.context_switches = static_cast<double>(proc_figure(stat, "ctxt"));
    c.processes = static_cast<double>(proc_figure(stat, "processes"));
    return c;
}

SoakMachine machine_facts(const MachineCounters& before, const MachineCounters& after, const std::string& root) {
    SoakMachine m;
    utsname name{};
    if (uname(&name) == 0) m.kernel = fmt::format("{} {} {} {}", name.sysname, name.release, name.version, name.machine);
    m.kernel_command_line = without_end(text_of(root + "/proc/cmdline"));
    const std::string processor = text_of(root + "/proc/cpuinfo");
    if (const std::size_t at = processor.find("model name"); at != std::string::npos) {
        const std::size_t from = processor.find(": ", at), to = processor.find('\n', at);
        if (from != std::string::npos && from < to) m.processor = processor.substr(from + 2, to - from - 2);
    }
    m.cores = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
    const auto since = [](const std::map<std::string, double>& earlier, const std::string& key, double now) {
        const auto found = earlier.find(key);
        return now - (found != earlier.end() ? found->second : 0.0);
    };
    for (const auto& [key, count] : after.interrupts) {
        const double meanwhile = since(before.interrupts, key, count);
        if (meanwhile > 0) m.interrupts.push_back({key, meanwhile});
    }
    std::stable_sort(m.interrupts.begin(), m.interrupts.end(), [](const auto& a, const auto& b) { return a.count > b.count; });
    if (m.interrupts.size() > max_interrupts) {
        double rest = 0;
        for (std::size_t i = max_interrupts; i < m.interrupts.size(); ++i) rest += m.interrupts[i].count;
        m.interrupts.resize(max_interrupts);
        m.interrupts.push_back({"others", rest});
    }
    const double spent_us = std::max((after.time_s - before.time_s) * 1e6, 1.0);
    for (const auto& [key, us] : after.pressure_us) m.pressure.push_back({key, since(before.pressure_us, key, us) / spent_us});
    m.steal_ms = after.steal_ms - before.steal_ms;
    m.context_switches = after.context_switches - before.context_switches;
    m.processes = after.processes - before.processes;
    return m;
}

std::string own_command_line() {
    const std::string raw = text_of("/proc/self/cmdline");
    std::string line, word;
    for (const char c : raw) {
        if (c != '\0') {
            word += c;
            continue;
        }
        const bool quoted = word.empty() || word.find_first_of(" \t'\"") != std::string::npos;
        line += (line.empty() ? "" : " ") + (quoted ? "'" + word + "'" : word);
        word.clear();
    }
    return line;
}

}  // namespace surefoot::soak
