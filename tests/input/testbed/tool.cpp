// Running the tool.
#include "tests/input/testbed/tool.hpp"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <sstream>

#include "tests/input/testbed/testbed.hpp"

namespace surefoot::input::test {

int Tool::instances_ = 0;

Tool::Tool(const std::vector<std::string>& arguments, bool terminal, const std::string& command) {
    err_file_ = testing::TempDir() + "/tool-" + std::to_string(getpid()) + "-" + std::to_string(++instances_) + ".err";
    std::vector<std::string> words = {SUREFOOT_TOOL, command};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    int to[2] = {-1, -1}, back[2] = {-1, -1};
    const winsize size{40, 100, 0, 0};
    if (terminal) {
        EXPECT_EQ(openpty(&from_, &back[1], nullptr, nullptr, &size), 0);
        in_ = dup(from_);
        to[0] = dup(back[1]);
    } else {
        EXPECT_EQ(pipe(to), 0);
        EXPECT_EQ(pipe(back), 0);
        in_ = to[1];
        from_ = back[0];
    }
    fcntl(in_, F_SETFD, FD_CLOEXEC);
    fcntl(from_, F_SETFD, FD_CLOEXEC);
    pid_ = fork();
    if (pid_ == 0) {
        dup2(to[0], STDIN_FILENO);
        dup2(back[1], STDOUT_FILENO);
        const int err = terminal ? back[1] : open(err_file_.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
        dup2(err, STDERR_FILENO);
        execv(argv[0], argv.data());
        _exit(126);
    }
    close(to[0]);
    close(back[1]);
}

Tool::~Tool() {
    if (pid_ > 0) {
        kill(pid_, SIGKILL);
        waitpid(pid_, nullptr, 0);
    }
    close(in_);
    close(from_);
    unlink(err_file_.c_str());
}

bool Tool::read_some(int within_ms) {
    pollfd p{from_, POLLIN, 0};
    if (poll(&p, 1, within_ms) <= 0) return true;
    char text[4096];
    const ssize_t n = read(from_, text, sizeof text);
    if (n <= 0) return false;
    out_.append(text, static_cast<std::size_t>(n));
    return true;
}

bool Tool::until(const std::string& text, int within_ms) {
    Patience patience(within_ms);
    while (out_.find(text) == std::string::npos && err().find(text) == std::string::npos)
        if (patience.over() || !read_some(20))
            return out_.find(text) != std::string::npos || err().find(text) != std::string::npos;
    return true;
}

void Tool::key(const std::string& text) { EXPECT_EQ(write(in_, text.data(), text.size()), static_cast<ssize_t>(text.size())); }

void Tool::signal(int number) { kill(pid_, number); }

int Tool::wait(int within_ms) {
    Patience patience(within_ms);
    bool open = true;
    int status = 0;
    const int end = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
    EXPECT_GE(end, 0);
    for (;;) {
        const pid_t done = waitpid(pid_, &status, WNOHANG);
        if (done == pid_) break;
        if (patience.over()) {
            close(end);
            return -1;
        }
        pollfd ended{end, POLLIN, 0};
        if (open)
            open = read_some(20);
        else
            (void)poll(&ended, 1, 100);
    }
    close(end);
    for (std::size_t before = out_.size() + 1; open && before != out_.size();) {
        before = out_.size();
        open = read_some(0);
    }
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string Tool::err() const {
    std::ostringstream text;
    text << std::ifstream(err_file_).rdbuf();
    return text.str();
}

}  // namespace surefoot::input::test
