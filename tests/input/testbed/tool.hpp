// The tool itself as a child of the test, on the same synthetic devices; its stdout may be a terminal.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

namespace surefoot::input::test {

class Tool {
public:
    /// Runs `surefoot COMMAND ARGUMENTS`. terminal: stdin, stdout and stderr are one of 40 x 100.
    explicit Tool(const std::vector<std::string>& arguments, bool terminal = false, const std::string& command = "devices");
    ~Tool();
    Tool(const Tool&) = delete;
    Tool& operator=(const Tool&) = delete;

    /// Reads what it prints until `text` is in it; false after so long. Time in which this process was held up does not count:
    /// then the tool was, too.
    bool until(const std::string& text, int within_ms = 10'000);
    void key(const std::string& text);
    void signal(int number);
    /// Waits for its end: its exit code, or -1 after so long or by a signal.
    int wait(int within_ms = 10'000);
    [[nodiscard]] const std::string& out() const { return out_; }
    [[nodiscard]] std::string err() const;

private:
    bool read_some(int within_ms);
    pid_t pid_ = -1;
    static int instances_;
    int in_ = -1, from_ = -1;
    std::string out_, err_file_;
};

}  // namespace surefoot::input::test
