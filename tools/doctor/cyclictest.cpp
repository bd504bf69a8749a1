// cyclictest: found, run as a child, its histogram read.
#include "tools/doctor/wake_up.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <vector>

#include "tools/doctor/words.hpp"

extern char** environ;

namespace surefoot::doctor {

namespace {

constexpr const char* run_by_hand = "Run it by hand to see its output, or run again with --quick";

/// The number behind "# Max Latencies:".
std::optional<std::int64_t> figure(std::string_view line, std::string_view name) {
    if (!line.starts_with(name)) return std::nullopt;
    return number_in(trimmed(line.substr(name.size())));
}

struct Child {
    pid_t pid = -1;
    int output = -1;
};

Result<Child> start(const std::string& program, std::vector<std::string> words) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        return Error{program, fmt::format("No pipe to the program can be opened: {}", std::strerror(errno)),
                     "Close other programs", ErrorKind::out_of_limits};
    std::vector<char*> arguments;
    arguments.reserve(words.size() + 1);
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    Child child;
    const int failed = posix_spawn(&child.pid, program.c_str(), &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    child.output = ends[0];
    if (failed == 0) return child;
    close(ends[0]);
    return Error{program, fmt::format("The program cannot be started: {}", std::strerror(failed)),
                 "Run: apt install --reinstall rt-tests", ErrorKind::not_found};
}

}  // namespace

std::optional<std::string> find_program(const std::string& name) {
    const char* const path = std::getenv("PATH");
    for (const std::string_view folder : split(path == nullptr ? "/usr/bin:/bin" : path, ":")) {
        const std::string file = std::string(folder) + "/" + name;
        if (access(file.c_str(), X_OK) == 0) return file;
    }
    return std::nullopt;
}

Result<WakeFigures> read_cyclictest(std::string_view printed) {
    const auto late = std::make_unique<rt::Histogram>();
    std::int64_t max_us = 0, over = 0;
    for (const std::string_view line : split(printed, "\n")) {
        if (const auto value = figure(line, "# Max Latencies:")) max_us = *value;
        if (const auto value = figure(line, "# Histogram Overflows:")) over = *value;
        if (line.starts_with('#')) continue;
        const auto fields = split(line, " \t");
        if (fields.size() != 2) continue;
        const auto us = number_in(fields[0]), times = number_in(fields[1]);
        if (!us || !times || *us < 0 || *us > 1'000'000'000 || *times < 0)
            return Error{"cyclictest", fmt::format("It printed '{}', which is not a line of a histogram of one thread", line),
                         run_by_hand, ErrorKind::damaged};
        if (*times > 0) late->add(*us * 1000, static_cast<std::uint64_t>(*times));
    }
    if (over > 0 && max_us >= 0 && max_us < 1'000'000'000) late->add(max_us * 1000, static_cast<std::uint64_t>(over));
    if (late->count() == 0) return Error{"cyclictest", "It printed nothing that can be counted", run_by_hand, ErrorKind::damaged};
    return figures_of(*late, "cyclictest");
}

Result<WakeFigures> run_cyclictest(const std::string& program, const WakeOptions& o, const Progress& progress) {
    const double seconds = std::max(1.0, std::round(o.seconds));
    std::vector<std::string> words = {program,
                                      "-q",
                                      "-m",
                                      "-t1",
                                      fmt::format("-a{}", o.core),
                                      fmt::format("-i{}", o.period_ns / 1000),
                                      fmt::format("-D{:.0f}", seconds),
                                      "-h100000",
                                      "--default-system"};
    if (o.priority > 0) words.push_back(fmt::format("-p{}", o.priority));
    auto child = start(program, std::move(words));
    if (!child) return child.error();
    const auto begun = std::chrono::steady_clock::now();
    const auto passed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count(); };
    std::string printed;
    std::array<char, 65536> part{};
    bool given_up = false;
    while (true) {
        if (progress.report) progress.report("cyclictest", std::min(passed() / seconds, 1.0));
        const bool stopped = progress.stop != nullptr && progress.stop->load();
        if ((stopped || passed() > seconds + 20) && !given_up) {
            given_up = true;
            kill(child->pid, SIGKILL);
        }
        pollfd waiting{child->output, POLLIN, 0};
        if (poll(&waiting, 1, 100) <= 0) continue;
        const ssize_t got = read(child->output, part.data(), part.size());
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) break;
        if (printed.size() < 1U << 24U) printed.append(part.data(), static_cast<std::size_t>(got));
    }
    close(child->output);
    int status = 0;
    while (waitpid(child->pid, &status, 0) < 0 && errno == EINTR) {
    }
    if (given_up) return Error{program, "The program was stopped before its end", run_by_hand, ErrorKind::stopped};
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        return Error{program,
                     WIFEXITED(status) ? fmt::format("The program ended with status {}", WEXITSTATUS(status))
                                       : "The program was ended by a signal",
                     run_by_hand};
    auto figures = read_cyclictest(printed);
    if (figures) {
        figures->seconds = passed();
        figures->core = o.core;
        figures->priority = o.priority;
    }
    return figures;
}

}  // namespace surefoot::doctor
