// Reloaded day after day: a walk that ends and begins anew leaves no descriptor, no thread and no memory behind.
// SUREFOOT_RELOADS=200 reloads that often.
#include <gtest/gtest.h>

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "tests/daemon/running.hpp"

namespace surefoot::daemon::test {
namespace {

#ifdef SUREFOOT_SANITIZED
constexpr bool memory_counts = false;  // a sanitizer keeps what was freed
constexpr int warm_up = 2, usual_reloads = 6;
#else
constexpr bool memory_counts = true;
constexpr int warm_up = 3, usual_reloads = 12;
#endif
// Software GL keeps some of every context (Mesa 22.3: up to 140 KiB); our own parts nothing.
constexpr std::int64_t max_kib_a_reload = 16, max_kib_a_reload_gl = 256;

// What rt::prefault_heap() touches of the frame thread's own heap, and what every other thread's heap grows by at first
// (M_TOP_PAD, rt/threads/memory.cpp). Which of glibc's heaps a thread gets, and how many there are, depends on which threads of
// a walk start together; and a heap stays as large as it was. So locked memory rises by so much once for each heap, and never
// again. By less where the rest of a walk (0.9 MiB) comes to lie in another: so growth is what both later thirds of the walks
// have over the one before.
constexpr std::int64_t prefaulted_kib = 16 << 10, first_growth_kib = 1 << 10, rest_of_a_walk_kib = 1 << 10;
constexpr std::uint64_t heap_alignment = 64U << 20U;  // HEAP_MAX_SIZE of malloc/arena.c

struct Held {
    std::int64_t descriptors = 0, threads = 0;
    std::int64_t resident_kib = 0;  ///< but for what heaps hold beforehand
};

/// Threads' heaps that hold what a frame thread touches, and those that hold at least what a heap grows by at first.
struct Heaps {
    std::int64_t touched = 0, grown = 0;
    std::int64_t kib() const { return touched * prefaulted_kib + grown * first_growth_kib; }
};

Heaps heaps_of(pid_t pid) {
    std::ifstream maps("/proc/" + std::to_string(pid) + "/smaps");
    Heaps heaps;
    bool heap = false;
    for (std::string line; std::getline(maps, line);) {
        std::uint64_t from = 0, to = 0;
        if (std::sscanf(line.c_str(), "%lx-%lx rw-p 00000000 00:00 0", &from, &to) == 2) heap = from % heap_alignment == 0;
        if (!heap || !line.starts_with("Rss:")) continue;
        const std::int64_t kib = std::stoll(line.substr(4));
        if (kib >= prefaulted_kib)
            ++heaps.touched;
        else if (kib >= first_growth_kib)
            ++heaps.grown;
    }
    return heaps;
}

Held held_by(pid_t pid) {
    const std::string folder = "/proc/" + std::to_string(pid);
    Held held;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder + "/fd")) ++held.descriptors;
    std::ifstream status(folder + "/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmRSS:")) held.resident_kib = std::stoll(line.substr(6));
        if (line.starts_with("Threads:")) held.threads = std::stoll(line.substr(8));
    }
    held.resident_kib -= heaps_of(pid).kib();
    return held;
}

/// Why the library cannot be opened here; empty where it can.
std::string why_not_opened(const char* library) {
    void* opened = ::dlopen(library, RTLD_LAZY);
    if (opened == nullptr) return ::dlerror();
    ::dlclose(opened);
    return {};
}

/// The least of each: what comes and goes is no growth.
Held min_of(const Held& a, const Held& b) {
    return {std::min(a.descriptors, b.descriptors), std::min(a.threads, b.threads), std::min(a.resident_kib, b.resident_kib)};
}

class Growth : public testing::TestWithParam<const char*> {};

TEST_P(Growth, OfManyReloadsIsNone) {
    const std::string backend = GetParam();
    if (backend != "null") {
#ifdef SUREFOOT_WATCHES_THREADS
        GTEST_SKIP() << "no GL is opened where the thread sanitizer watches";
#endif
        const std::string why = why_not_opened(backend == "egl" ? "libEGL.so.1" : "libOSMesa.so.8");
        const bool absent = why.find("No such file") != std::string::npos;
        if (absent) GTEST_SKIP() << why << "; apt install " << (backend == "egl" ? "libegl1" : "libosmesa6");
        ASSERT_EQ(why, "");
    }
    const char* requested = std::getenv("SUREFOOT_RELOADS");
    const int reloads = requested != nullptr ? std::max(usual_reloads, std::atoi(requested)) : usual_reloads;
    const int few = reloads / 3;
    Running daemon("reload-growth-" + backend);
    daemon.rate_hz = 100;  // a walk rehearses 24 periods: short ones begin sooner
    // In turns another size: nothing of the last walk fits the next.
    const auto size = [](int n) { return n % 2 == 0 ? "160x120" : "192x144"; };
    const auto config = [&](int n) {  // the budget: what a fuller picture would cost is no part of a reload
        daemon.write_config(
            std::string("budget_ms = 2\n") + (n % 2 == 0 ? "width = 160\nheight = 120\n" : "width = 192\nheight = 144\n"),
            backend);
    };
    config(0);
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.log_text();
    const Held all{1'000'000, 1'000'000, 1'000'000'000};
    Held before = all, between = all, after = all;  // least of each third of the walks after the warm-up
    for (int n = 1; n <= warm_up + reloads; ++n) {
        config(n);
        ::kill(daemon.pid, SIGHUP);
        ASSERT_TRUE(daemon.socket.wait_for("RELOADING=1", 5)) << daemon.log_text();
        ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << "reload " << n << ": " << daemon.log_text();
        ASSERT_TRUE(daemon.socket.all.back().has(size(n))) << "refused, or taken back: " << daemon.socket.text();
        const Held held = held_by(daemon.pid);
        if (n <= warm_up) continue;
        Held& third = n <= warm_up + few ? before : n <= warm_up + reloads - few ? between : after;
        third = min_of(third, held);
    }
    const Heaps heaps = heaps_of(daemon.pid);
    std::printf(
        "%s, %d reloads: descriptors %ld to %ld, threads %ld to %ld, resident %ld, %ld, %ld KiB beside %ld heaps of 16 MiB and "
        "%ld "
        "of 1 MiB\n",
        backend.c_str(), reloads, static_cast<long>(before.descriptors), static_cast<long>(after.descriptors),
        static_cast<long>(before.threads), static_cast<long>(after.threads), static_cast<long>(before.resident_kib),
        static_cast<long>(between.resident_kib), static_cast<long>(after.resident_kib), static_cast<long>(heaps.touched),
        static_cast<long>(heaps.grown));
    EXPECT_LE(heaps.touched, after.threads);
    EXPECT_LE(heaps.grown, 2 * after.threads);  // a walk's threads, and those that prepare it
    EXPECT_LE(after.descriptors, before.descriptors);
    EXPECT_LE(after.threads, before.threads);
    if (memory_counts) {
        const std::int64_t max_kib = backend == "null" ? max_kib_a_reload : max_kib_a_reload_gl;
        const std::int64_t first = between.resident_kib - before.resident_kib, then = after.resident_kib - between.resident_kib;
        EXPECT_LE(first + then, max_kib * (reloads - few) + rest_of_a_walk_kib);
        EXPECT_LE(std::min(first, then), max_kib * few) << "it grows on and on: by " << first << " KiB, then by " << then;
    }
    ::kill(daemon.pid, SIGTERM);
    EXPECT_EQ(daemon.wait_exit(10), 0) << daemon.log_text();
}

INSTANTIATE_TEST_SUITE_P(Backends, Growth, testing::Values("null", "egl", "osmesa"),
                         [](const testing::TestParamInfo<const char*>& of) { return std::string(of.param); });

}  // namespace
}  // namespace surefoot::daemon::test
