// The loads themselves: each does one thing to the machine as hard as it can under ordinary scheduling, and counts it.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "rt/base/file.hpp"
#include "rt/threads/usage.hpp"
#include "tools/soak/load_board.hpp"
#include "tools/soak/machine_facts.hpp"

namespace surefoot::soak {

namespace {

void doze_ms(std::int64_t ms) {
    const timespec time{ms / 1000, ms % 1000 * 1'000'000};
    nanosleep(&time, nullptr);
}

void burn_cpu(LoadCounters& c, const std::atomic<bool>& stop) {
    std::int64_t counted_ms = rt::own_cpu_ns() / 1'000'000;
    volatile double sink = 1;
    while (!stop.load()) {
        for (int i = 0; i < 2'000'000; ++i) sink = sink * 1.0000001 + 1e-9;
        const std::int64_t ms = rt::own_cpu_ns() / 1'000'000;
        c.amount += static_cast<std::uint64_t>(ms - counted_ms);
        counted_ms = ms;
    }
}

/// Mapped, written page by page out of order, written again as a whole, given back: faults, bandwidth, and the kernel's locks.
void write_memory(LoadCounters& c, std::uint64_t bytes, const std::atomic<bool>& stop) {
    constexpr std::uint64_t page = 4096;
    const std::uint64_t pages = std::max<std::uint64_t>(bytes / page, 1);
    while (!stop.load()) {
        void* const mapped = mmap(nullptr, pages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (mapped == MAP_FAILED) {
            ++c.failures;
            doze_ms(200);
            continue;
        }
        auto* const memory = static_cast<unsigned char*>(mapped);
        rusage before{}, after{};
        getrusage(RUSAGE_SELF, &before);
        for (std::uint64_t i = 0; i < pages && !stop.load(); ++i)
            memory[(i * 7919 % pages) * page] = static_cast<unsigned char>(i);
        for (std::uint64_t at = 0; at < pages && !stop.load(); at += 256) {
            const std::uint64_t run = std::min<std::uint64_t>(256, pages - at);
            std::memset(memory + at * page, static_cast<int>(at), run * page);
            c.amount += run * page >> 20U;
        }
        getrusage(RUSAGE_SELF, &after);
        c.evidence += static_cast<std::uint64_t>(after.ru_minflt - before.ru_minflt);
        munmap(mapped, pages * page);
    }
}

/// A file without a name, written in blocks of 1 MiB, synced every eighth, read back, cut off.
void write_files(LoadCounters& c, const LoadSettings& s, const std::atomic<bool>& stop) {
    constexpr std::size_t block = 1U << 20U;
    std::vector<char> bytes(block, 'w');
    std::string name = s.folder + "/surefoot-soak-XXXXXX";
    const int fd = mkstemp(name.data());
    if (fd < 0) {
        c.refused = errno;
        return;
    }
    unlink(name.c_str());
    std::uint64_t to_device = proc_figure_of("/proc/self/io", "write_bytes");
    while (!stop.load()) {
        for (std::uint64_t at = 0; at < s.file_bytes && !stop.load(); at += block) {
            if (pwrite(fd, bytes.data(), block, static_cast<off_t>(at)) != static_cast<ssize_t>(block)) {
                ++c.failures;
                doze_ms(500);
                break;
            }
            c.amount += block >> 10U;
            if (at / block % 8 == 7 && fdatasync(fd) != 0) ++c.failures;
        }
        for (std::uint64_t at = 0; at < s.file_bytes && !stop.load(); at += block)
            if (pread(fd, bytes.data(), block, static_cast<off_t>(at)) <= 0) break;
        const std::uint64_t now = proc_figure_of("/proc/self/io", "write_bytes");
        c.evidence += (now - to_device) >> 10U;
        to_device = now;
        (void)ftruncate(fd, 0);
    }
    close(fd);
}

/// Batches of processes that touch some memory, write a byte into a pipe and end.
void fork_processes(LoadCounters& c, int number, const std::atomic<bool>& stop) {
    constexpr int batch = 8;
    std::uint64_t made = proc_figure_of("/proc/stat", "processes");
    while (!stop.load()) {
        int ends[2];
        if (pipe(ends) != 0) {
            ++c.failures;
            doze_ms(200);
            continue;
        }
        int children = 0;
        for (; children < batch; ++children) {
            const pid_t child = fork();
            if (child < 0) break;
            if (child > 0) continue;
            volatile char touched[64 * 1024];
            for (std::size_t i = 0; i < sizeof touched; i += 4096) touched[i] = 1;
            _exit(write(ends[1], "x", 1) == 1 && touched[0] == 1 ? 0 : 1);
        }
        close(ends[1]);
        char read_back[batch];
        while (read(ends[0], read_back, sizeof read_back) > 0) {
        }
        close(ends[0]);
        for (int i = 0; i < children; ++i) wait(nullptr);
        c.failures += static_cast<std::uint64_t>(batch - children);
        c.amount += static_cast<std::uint64_t>(children);
        if (number == 0) {
            const std::uint64_t now = proc_figure_of("/proc/stat", "processes");
            c.evidence += now - made;
            made = now;
        }
        if (children < batch) doze_ms(100);
    }
}

/// Drops clean pages every second; what the page cache holds before and after says that it happened.
void drop_caches(LoadCounters& c, const std::atomic<bool>& stop) {
    while (!stop.load()) {
        const std::uint64_t before_kib = proc_figure_of("/proc/meminfo", "Cached");
        const int fd = open("/proc/sys/vm/drop_caches", O_WRONLY | O_CLOEXEC);
        const bool dropped = fd >= 0 && write(fd, "1", 1) == 1;
        if (!dropped) c.refused = errno;
        if (fd >= 0) close(fd);
        if (!dropped) return;
        const std::uint64_t after_kib = proc_figure_of("/proc/meminfo", "Cached");
        ++c.amount;
        c.evidence += before_kib > after_kib ? before_kib - after_kib : 0;
        for (int i = 0; i < 10 && !stop.load(); ++i) doze_ms(100);
    }
}

}  // namespace

int load_processes(LoadKind kind, const LoadSettings& settings) {
    switch (kind) {
        case LoadKind::cpu:
            return settings.cores;
        case LoadKind::forks:
            return 2;
        case LoadKind::reloads:
            return 0;  // work of the soak's own process
        default:
            return 1;
    }
}

void run_load(LoadKind kind, int number, LoadBoard& board, const LoadSettings& settings) {
    LoadCounters& c = board.of(kind);
    switch (kind) {
        case LoadKind::cpu:
            return burn_cpu(c, board.stop);
        case LoadKind::memory:
            return write_memory(c, settings.memory_bytes, board.stop);
        case LoadKind::io:
            return write_files(c, settings, board.stop);
        case LoadKind::forks:
            return fork_processes(c, number, board.stop);
        case LoadKind::caches:
            return drop_caches(c, board.stop);
        case LoadKind::devices:
            return run_device_storm(board, settings);
        case LoadKind::clock:
            return run_clock_steps(board, settings);
        case LoadKind::reloads:
            return;
    }
}

}  // namespace surefoot::soak
