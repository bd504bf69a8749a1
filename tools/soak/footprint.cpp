// /proc/self, read without allocating.
#include "tools/soak/footprint.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "rt/clock/clock.hpp"

namespace surefoot::soak {

namespace {

/// Entries of a folder of /proc, less "." and "..", and less the descriptor that reads it where that is counted too.
std::uint32_t entries_of(const char* folder, std::uint32_t own) {
    DIR* const open_folder = opendir(folder);
    if (open_folder == nullptr) return 0;
    std::uint32_t count = 0;
    while (const dirent* entry = readdir(open_folder)) count += entry->d_name[0] != '.' ? 1 : 0;
    closedir(open_folder);
    return count > own ? count - own : 0;
}

}  // namespace

SoakSample read_footprint() {
    SoakSample sample;
    char text[128] = {};
    if (const int fd = open("/proc/self/statm", O_RDONLY | O_CLOEXEC); fd >= 0) {
        (void)!read(fd, text, sizeof text - 1);
        close(fd);
    }
    unsigned long total = 0, resident = 0, shared = 0;
    if (std::sscanf(text, "%lu %lu %lu", &total, &resident, &shared) == 3) {
        const double page_kib = static_cast<double>(sysconf(_SC_PAGESIZE)) / 1024.0;
        sample.resident_kib = static_cast<double>(resident) * page_kib;
        sample.memory_kib = static_cast<double>(resident - shared) * page_kib;
    }
    sample.descriptors = entries_of("/proc/self/fd", 1);
    sample.threads = entries_of("/proc/self/task", 0);
    return sample;
}

void Footprint::take(double time_s) {
    if (samples_.size() == samples_.capacity()) return;
    SoakSample sample = read_footprint();
    sample.time_s = time_s;
    samples_.push_back(sample);
}

void Footprint::watch(std::int64_t start_ns, double every_s, std::function<void(double)> also) {
    thread_ = std::thread([this, start_ns, every_s, also = std::move(also)] {
        constexpr std::int64_t look_ns = 50'000'000;
        const auto every_ns = static_cast<std::int64_t>(every_s * 1e9);
        rt::RealClock clock;
        std::int64_t due_ns = start_ns;
        while (!stopping_.load()) {
            const std::int64_t now_ns = clock.now_ns();
            if (now_ns < due_ns) {
                clock.sleep_until_ns(std::min(due_ns, now_ns + look_ns));
                continue;
            }
            const double time_s = static_cast<double>(now_ns - start_ns) * 1e-9;
            if (also) also(time_s);
            take(time_s);
            due_ns += every_ns * (1 + (now_ns - due_ns) / every_ns);
        }
    });
}

void Footprint::stop() {
    stopping_.store(true);
    if (thread_.joinable()) thread_.join();
}

}  // namespace surefoot::soak
