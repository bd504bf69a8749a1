// Reloaded day after day: a walk that ends and begins anew leaves no descriptor, no thread and no memory behind.
#include <gtest/gtest.h>

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "tests/daemon/running.hpp"

namespace surefoot::daemon::test {
namespace {

#ifdef SUREFOOT_SANITIZED
constexpr bool memory_counts = false;  // a sanitizer keeps what was freed
constexpr int warm_up = 2, reloads = 6;
#else
constexpr bool memory_counts = true;
constexpr int warm_up = 3, reloads = 12;
#endif
constexpr int few = reloads / 3;
// Software GL keeps some of every context (Mesa 22.3: 80 to 110 KiB); our own parts nothing.
constexpr std::int64_t most_kib_a_reload = 16, most_kib_a_reload_gl = 256;

struct Held {
    std::int64_t descriptors = 0, threads = 0, resident_kib = 0;
};

Held held_by(pid_t pid) {
    const std::string folder = "/proc/" + std::to_string(pid);
    Held held;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder + "/fd")) ++held.descriptors;
    std::ifstream status(folder + "/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmRSS:")) held.resident_kib = std::stoll(line.substr(6));
        if (line.starts_with("Threads:")) held.threads = std::stoll(line.substr(8));
    }
    return held;
}

/// The least of each: what comes and goes is no growth. A walk's heap lies in whichever arena was free, so one may hold more.
Held least_of(const Held& a, const Held& b) {
    return {std::min(a.descriptors, b.descriptors), std::min(a.threads, b.threads), std::min(a.resident_kib, b.resident_kib)};
}

class Growth : public testing::TestWithParam<const char*> {};

TEST_P(Growth, OfManyReloadsIsNone) {
    const std::string backend = GetParam();
    const char* library = backend == "egl" ? "libEGL.so.1" : backend == "osmesa" ? "libOSMesa.so.8" : nullptr;
#ifdef __SANITIZE_THREAD__
    if (library != nullptr) GTEST_SKIP() << "no GL is opened where the thread sanitizer watches";
#endif
    if (library != nullptr) {
        void* opened = ::dlopen(library, RTLD_LAZY);
        if (opened == nullptr) GTEST_SKIP() << ::dlerror();
        ::dlclose(opened);
    }
    Running daemon("reload-growth-" + backend);
    // In turns another size: nothing of the last walk fits the next.
    const auto size = [](int n) { return n % 2 == 0 ? "160x120" : "192x144"; };
    const auto config = [&](int n) {
        daemon.write_config(n % 2 == 0 ? "width = 160\nheight = 120\n" : "width = 192\nheight = 144\n", backend);
    };
    config(0);
    daemon.start();
    ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << daemon.said();
    const Held all{1'000'000, 1'000'000, 1'000'000'000};
    Held before = all, after = all;  // least of the first and of the last few walks after the warm-up
    for (int n = 1; n <= warm_up + reloads; ++n) {
        config(n);
        ::kill(daemon.pid, SIGHUP);
        ASSERT_TRUE(daemon.socket.wait_for("RELOADING=1", 5)) << daemon.said();
        ASSERT_TRUE(daemon.socket.wait_for("READY=1", start_s)) << "reload " << n << ": " << daemon.said();
        ASSERT_TRUE(daemon.socket.all.back().has(size(n))) << "refused, or taken back: " << daemon.socket.text();
        const Held held = held_by(daemon.pid);
        if (n > warm_up && n <= warm_up + few) before = least_of(before, held);
        if (n > warm_up + reloads - few) after = least_of(after, held);
    }
    std::printf("%s, %d reloads: descriptors %ld to %ld, threads %ld to %ld, resident %ld to %ld KiB\n", backend.c_str(), reloads,
                static_cast<long>(before.descriptors), static_cast<long>(after.descriptors), static_cast<long>(before.threads),
                static_cast<long>(after.threads), static_cast<long>(before.resident_kib), static_cast<long>(after.resident_kib));
    EXPECT_LE(after.descriptors, before.descriptors);
    EXPECT_LE(after.threads, before.threads);
    if (memory_counts) {
        const std::int64_t most_kib = backend == "null" ? most_kib_a_reload : most_kib_a_reload_gl;
        EXPECT_LE(after.resident_kib - before.resident_kib, most_kib * (reloads - few));
    }
    ::kill(daemon.pid, SIGTERM);
    EXPECT_EQ(daemon.wait_exit(10), 0) << daemon.said();
}

INSTANTIATE_TEST_SUITE_P(Backends, Growth, testing::Values("null", "egl", "osmesa"),
                         [](const testing::TestParamInfo<const char*>& of) { return std::string(of.param); });

}  // namespace
}  // namespace surefoot::daemon::test
