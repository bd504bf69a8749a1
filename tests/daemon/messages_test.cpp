// What leaves the daemon: datagrams to systemd, fields to journald, lines to stderr; and that none of it waits.
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/stat.h>

#include <filesystem>

#include "systemd/daemon/log.hpp"
#include "systemd/daemon/notify.hpp"
#include "tests/daemon/notify_socket.hpp"

namespace surefoot::daemon {
namespace {

using test::NotifySocket;

std::string place(const std::string& name) {
    return (std::filesystem::temp_directory_path() / ("surefoot-" + name + std::to_string(getpid()))).string();
}

TEST(Notifier, ReachesPathsAndAbstractNames) {
    for (const std::string& name : {place("notify"), "@surefoot-test-" + std::to_string(getpid())}) {
        NotifySocket socket(name);
        Notifier notifier(name);
        EXPECT_TRUE(notifier.active());
        EXPECT_TRUE(notifier.send("READY=1\nSTATUS=here")) << name;
        ASSERT_TRUE(socket.wait_for("READY=1", 1)) << name;
        EXPECT_EQ(socket.all[0].text, "READY=1\nSTATUS=here");
    }
}

TEST(Notifier, NobodyThereIsNoFailureAndAVanishedOneIs) {
    Notifier nobody("");
    EXPECT_FALSE(nobody.active());
    EXPECT_TRUE(nobody.send("READY=1"));
    Notifier vanished(place("vanished"));
    EXPECT_FALSE(vanished.send("READY=1"));
    Notifier too_long("/" + std::string(200, 'x'));
    EXPECT_FALSE(too_long.send("READY=1"));
}

TEST(Notifier, ASlowReceiverCostsHalfASecondAtMost) {
    const std::string name = place("slow");
    const NotifySocket socket(name);  // never reads
    Notifier notifier(name);
    bool taken = true;
    for (int i = 0; i < 5000 && taken; ++i) {
        const std::int64_t before = NotifySocket::now_ns();
        taken = notifier.send("STATUS=again");
        ASSERT_LT(NotifySocket::now_ns() - before, 5'000'000'000) << "it waits";
    }
    EXPECT_FALSE(taken) << "its queue never filled, so nothing was shown";
}

TEST(Notifier, StatusIsOneLineOfWholeCharacters) {
    EXPECT_EQ(one_line("a\nb\tc"), "a b c");
    const std::string umlauts = [] {
        std::string text = "x";
        for (int i = 0; i < 2000; ++i) text += "\xc3\xa4";
        return text;
    }();
    const std::string cut = one_line(umlauts);
    EXPECT_LE(cut.size(), 1500U);
    EXPECT_EQ(cut.size() % 2, 1U) << "cut within a character";
}

TEST(Notifier, WatchdogTimesAreForTheProcessThatTheyName) {
    ::setenv("WATCHDOG_USEC", "3000000", 1);
    ::unsetenv("WATCHDOG_PID");
    EXPECT_EQ(watchdog_timeout_ns(), 3'000'000'000);
    ::setenv("WATCHDOG_PID", "1", 1);
    EXPECT_EQ(watchdog_timeout_ns(), 0);
    ::setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
    EXPECT_EQ(watchdog_timeout_ns(), 3'000'000'000);
    ::setenv("WATCHDOG_USEC", "rubbish", 1);
    EXPECT_EQ(watchdog_timeout_ns(), 0);
    ::unsetenv("WATCHDOG_USEC");
    ::unsetenv("WATCHDOG_PID");
    EXPECT_EQ(watchdog_timeout_ns(), 0);
}

TEST(Journal, FieldsAreInItsNativeFormat) {
    const std::string plain = journal_message(Priority::warning, event::misses, "3 missed", {{"SUREFOOT_MISSES", "3"}}, 0);
    EXPECT_EQ(plain,
              "MESSAGE=3 missed\nPRIORITY=4\nSYSLOG_IDENTIFIER=surefootd\nMESSAGE_ID=6b1f0f6c2f0a4c1c9f5d1c1b7d8a3e04\n"
              "SUREFOOT_EVENT=misses\nSUREFOOT_MISSES=3\n");
    const std::string broken = journal_message(Priority::error, event::fault, "a\nb", {}, 7);
    EXPECT_TRUE(broken.starts_with(std::string("MESSAGE\n\x03\0\0\0\0\0\0\0a\nb\nPRIORITY=3\n", 31))) << broken;
    EXPECT_TRUE(broken.ends_with("SUREFOOT_DROPPED_LINES=7\n")) << broken;
}

TEST(Journal, AFullSocketDropsAndTheNextLineNamesTheirNumber) {
    const std::string name = place("journal");
    NotifySocket journal(name);
    LogTarget target;
    target.journal_socket = name;
    Log log(target);
    const std::int64_t before = NotifySocket::now_ns();
    int sent = 0;
    for (; sent < 100'000 && log.dropped() < 5; ++sent) log.write(Priority::info, event::input, "a line");
    ASSERT_EQ(log.dropped(), 5U) << "the socket never filled, so nothing was shown";
    EXPECT_LT(NotifySocket::now_ns() - before, 5'000'000'000) << "it waited";
    journal.take_all();
    EXPECT_EQ(journal.all.size(), static_cast<std::size_t>(sent - 5));
    log.write(Priority::info, event::input, "after");
    log.write(Priority::info, event::input, "last");
    ASSERT_TRUE(journal.wait_for("last", 1));
    EXPECT_TRUE(journal.all[journal.all.size() - 2].has("SUREFOOT_DROPPED_LINES=5\n"));
    EXPECT_FALSE(journal.all.back().has("DROPPED")) << "told once";
}

TEST(PlainLog, IsAPrefixedLineAndNeverWaits) {
    std::array<int, 2> pipe{};
    ASSERT_EQ(::pipe2(pipe.data(), O_CLOEXEC), 0);
    LogTarget target;
    target.fd = pipe[1];
    {
        Log log(target);
        log.write(Priority::error, event::fault, "broken\nin two");
        std::array<char, 200> bytes{};
        const ssize_t got = ::read(pipe[0], bytes.data(), bytes.size());
        EXPECT_EQ(std::string(bytes.data(), static_cast<std::size_t>(got)), "<3>surefootd: broken in two\n");
        const std::string long_line(1000, 'x');
        for (int i = 0; i < 200; ++i) log.write(Priority::info, event::input, long_line);  // 200 kB into 64 kB
        EXPECT_GT(log.dropped(), 100U);
    }
    ::close(pipe[0]);
    ::close(pipe[1]);
}

TEST(PlainLog, TheJournalIsUsedOnlyWhereItReadsOurStderr) {
    ::unsetenv("JOURNAL_STREAM");
    EXPECT_TRUE(default_target().journal_socket.empty());
    ::setenv("JOURNAL_STREAM", "1:2", 1);
    EXPECT_TRUE(default_target().journal_socket.empty()) << "another stream";
    struct stat status {};
    ASSERT_EQ(fstat(STDERR_FILENO, &status), 0);
    ::setenv("JOURNAL_STREAM", (std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino)).c_str(), 1);
    EXPECT_EQ(default_target().journal_socket, "/run/systemd/journal/socket");
    ::unsetenv("JOURNAL_STREAM");
}

}  // namespace
}  // namespace surefoot::daemon
