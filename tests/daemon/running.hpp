// surefootd as a process: a settings file, a fake notify socket, and its end.
#pragma once

#include <gtest/gtest.h>

#include <linux/capability.h>
#include <poll.h>
#include <signal.h>
#include <sys/inotify.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "rt/base/file.hpp"
#include "tests/daemon/notify_socket.hpp"
#include "tests/walk/walk_fixture.hpp"

namespace surefoot::daemon::test {

using surefoot::test::Forest;

/// What is taken from the daemon before it starts.
struct Taken {
    bool sys_nice = false;         ///< CAP_SYS_NICE, and RLIMIT_RTPRIO 0
    bool memory_lock = false;      ///< CAP_IPC_LOCK, and RLIMIT_MEMLOCK of 1 MiB
    std::uint64_t file_bytes = 0;  ///< RLIMIT_FSIZE, as a full disk; 0: none
};

inline void drop_capability(unsigned capability) {
    prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
    __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
    std::array<__user_cap_data_struct, 2> sets{};
    if (syscall(SYS_capget, &header, sets.data()) != 0) return;
    const unsigned bit = 1U << (capability % 32);
    auto& set = sets[capability / 32];
    set.effective &= ~bit;
    set.permitted &= ~bit;
    set.inheritable &= ~bit;
    syscall(SYS_capset, &header, sets.data());
}

/// A descriptor has something to read, or its process has ended; false: not within so long.
inline bool readable(int fd, double seconds) {
    const auto ns = static_cast<std::int64_t>(std::max(0.0, seconds) * 1e9);
    const timespec limit{ns / 1'000'000'000, ns % 1'000'000'000};
    pollfd one{fd, POLLIN, 0};
    return ::ppoll(&one, 1, &limit, nullptr) > 0;
}

/// Below a folder of its own, which goes away with it. Everything is small, and drawn by nobody.
class Running {
public:
    explicit Running(const std::string& name)
        : dir(Forest::get().dir + "/" + name), config_file(dir + "/surefoot.toml"), socket((make(dir), dir + "/notify")) {
        write_config();
    }
    ~Running() {
        if (pid > 0) {
            ::kill(pid, SIGKILL);
            int status = 0;
            ::waitpid(pid, &status, 0);
        }
    }
    Running(const Running&) = delete;
    Running& operator=(const Running&) = delete;

    /// Over the defaults of these tests; the model is the small forest.
    void write_config(const std::string& more = "", const std::string& backend = "null") const {
        const std::string text = "model = \"" + Forest::get().model_file + "\"\nbackend = \"" + backend +
                                 "\"\nrate_hz = " + std::to_string(rate_hz) + "\nstate = \"" + dir + "\"\n" + more;
        EXPECT_TRUE(write_text(config_file, text).ok());
    }

    void start(std::vector<std::string> arguments = {}, const Taken& taken = {}, const std::string& program = SUREFOOT_DAEMON) {
        arguments.insert(arguments.begin(), {program, "--config", config_file});
        const std::string err = dir + "/stderr", out = dir + "/stdout";
        pid = ::fork();
        ASSERT_GE(pid, 0);
        if (pid > 0) return;
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        ::setenv("NOTIFY_SOCKET", (dir + "/notify").c_str(), 1);
        ::unsetenv("JOURNAL_STREAM");
        ::unsetenv("STATE_DIRECTORY");
        ::unsetenv("RUNTIME_DIRECTORY");
        for (const auto& [key, value] : environment) ::setenv(key.c_str(), value.c_str(), 1);
        std::freopen(err.c_str(), "w", stderr);
        std::freopen(out.c_str(), "w", stdout);
        take(taken);
        std::vector<char*> argv;
        for (std::string& argument : arguments) argv.push_back(argument.data());
        argv.push_back(nullptr);
        ::execv(program.c_str(), argv.data());
        ::_exit(127);
    }
    /// The exit code, or -signal, or -1000 where it still runs after `seconds`.
    int wait_exit(double seconds) {
        const int end = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
        EXPECT_GE(end, 0) << std::strerror(errno);
        const bool ended = test::readable(end, seconds);
        ::close(end);
        int status = 0;
        if (!ended || ::waitpid(pid, &status, WNOHANG) != pid) return -1000;
        pid = -1;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    }
    [[nodiscard]] bool runs() { return wait_exit(0) == -1000; }
    /// Waits until stderr has more lines with the words than `before`; false: none has come after `seconds`.
    [[nodiscard]] bool wait_line(std::string_view words, int before, double seconds) const {
        const int changes = ::inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
        EXPECT_GE(::inotify_add_watch(changes, (dir + "/stderr").c_str(), IN_MODIFY), 0) << std::strerror(errno);
        const std::int64_t until_ns = NotifySocket::now_ns() + static_cast<std::int64_t>(seconds * 1e9);
        bool found = false;
        for (std::int64_t now_ns = 0; !(found = lines_with(words) > before) && (now_ns = NotifySocket::now_ns()) < until_ns;) {
            if (!test::readable(changes, static_cast<double>(until_ns - now_ns) * 1e-9)) continue;
            std::array<char, 4096> events{};
            (void)!::read(changes, events.data(), events.size());
        }
        ::close(changes);
        return found;
    }
    [[nodiscard]] std::string log_text() const { return text_of(dir + "/stderr"); }
    [[nodiscard]] std::string printed() const { return text_of(dir + "/stdout"); }
    /// Lines of stderr that hold the words.
    [[nodiscard]] int lines_with(std::string_view words) const {
        std::ifstream file(dir + "/stderr");
        int found = 0;
        for (std::string line; std::getline(file, line);) found += line.find(words) != std::string::npos ? 1 : 0;
        return found;
    }
    /// The thread of that name; 0: there is none.
    [[nodiscard]] pid_t thread(std::string_view name) const {
        for (const auto& task : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
            if (text_of(task.path().string() + "/comm") == std::string(name) + "\n")
                return std::stoi(task.path().filename().string());
        }
        return 0;
    }

    std::string dir, config_file;
    int rate_hz = 50;  ///< of the configurations that are written
    NotifySocket socket;
    std::vector<std::pair<std::string, std::string>> environment;
    pid_t pid = -1;

private:
    static void make(const std::string& folder) { std::filesystem::create_directories(folder); }
    static std::string text_of(const std::string& file) {
        std::ifstream stream(file);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    static void take(const Taken& taken) {
        if (taken.sys_nice) {
            const rlimit none{0, 0};
            setrlimit(RLIMIT_RTPRIO, &none);
            drop_capability(CAP_SYS_NICE);
        }
        if (taken.memory_lock) {
            const rlimit little{1U << 20U, 1U << 20U};
            setrlimit(RLIMIT_MEMLOCK, &little);
            drop_capability(CAP_IPC_LOCK);
        }
        if (taken.file_bytes > 0) {
            const rlimit full{taken.file_bytes, taken.file_bytes};
            setrlimit(RLIMIT_FSIZE, &full);
        }
        if (taken.sys_nice || taken.memory_lock) drop_capability(CAP_SYS_RESOURCE);
    }
};

/// Time for a start beside other work on a small machine; a pass needs a fraction.
constexpr double start_s = 60;

}  // namespace surefoot::daemon::test
