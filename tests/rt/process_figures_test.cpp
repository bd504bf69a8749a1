// What the process takes of its machine: on made-up /proc files, and on this process.
#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <string>
#include <thread>

#include "rt/base/file.hpp"
#include "rt/monitor/process.hpp"
#include "rt/threads/usage.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::rt {
namespace {

TEST(ProcessFigures, AreReadFromProcWhateverTheProgramIsCalled) {
    const test::TemporaryFolder root;
    std::filesystem::create_directories(root / "proc/self/fd");
    for (const char* fd : {"0", "1", "2"}) ASSERT_TRUE(write_text(root / (std::string("proc/self/fd/") + fd), "").ok());
    ASSERT_TRUE(write_text(root / "proc/self/status",
                           "Name:\tx\nVmSize:\t    2048 kB\nVmLck:\t       4 kB\nVmRSS:\t    1024 kB\nThreads:\t7\n")
                    .ok());
    ASSERT_TRUE(
        write_text(root / "proc/self/stat", "42 (odd ) (name) S 1 2 3 4 5 6 7 8 9 10 150 50 0 0 20 0 7 0 12345 2097152 256")
            .ok());
    ASSERT_TRUE(write_text(root / "proc/stat", "cpu  1 2 3 4 5 6 7 200 0 0\ncpu0 1 2 3 4 5 6 7 200 0 0\n").ok());
    const ProcessFigures p = read_process(root.path());
    const double ticks = static_cast<double>(sysconf(_SC_CLK_TCK));
    EXPECT_EQ(p.rss_bytes, 1024 * 1024);
    EXPECT_EQ(p.virtual_bytes, 2048 * 1024);
    EXPECT_EQ(p.locked_bytes, 4096);
    EXPECT_EQ(p.threads, 7);
    EXPECT_EQ(p.descriptors, 3);
    EXPECT_DOUBLE_EQ(p.cpu_s, 200 / ticks);
    EXPECT_DOUBLE_EQ(p.started_s, 12345 / ticks);
    EXPECT_DOUBLE_EQ(p.steal_s, 200 / ticks);
}

TEST(ProcessFigures, UnreadableIsMinusOneNotZero) {
    const ProcessFigures p = read_process("/nonexistent");
    EXPECT_EQ(p.rss_bytes, -1);
    EXPECT_EQ(p.descriptors, -1);
    EXPECT_EQ(p.threads, -1);
    EXPECT_EQ(p.cpu_s, -1);
    EXPECT_EQ(p.steal_s, -1);
}

TEST(ProcessFigures, OfThisProcessAreTrue) {
    const ProcessFigures before = read_process();
    EXPECT_GT(before.rss_bytes, 1 << 20);
    const int fd = ::dup(1);
    EXPECT_EQ(read_process().descriptors, before.descriptors + 1);
    ::close(fd);
    EXPECT_EQ(read_process().descriptors, before.descriptors);
    bool seen = false;
    std::thread([&] {
        for (const BusyThread& t : read_busy_threads()) seen = seen || (t.info.tid == own_tid() && t.cpu_ns > 0);
    }).join();
    EXPECT_TRUE(seen);
}

}  // namespace
}  // namespace surefoot::rt
