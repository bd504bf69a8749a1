// What a test program in the guest says: one line a check for people, one JSON object a check for the summary.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace surefoot::vm {

class Checks {
public:
    /// `file` is appended to. `group` stands before every check's name.
    Checks(std::string group, const std::string& file) : group_(std::move(group)), file_(std::fopen(file.c_str(), "a")) {}
    Checks(const Checks&) = delete;
    Checks& operator=(const Checks&) = delete;
    ~Checks() {
        if (file_ != nullptr) std::fclose(file_);
    }

    /// `detail`: the figures, whether it passed or not. Returns `passed`.
    bool check(std::string_view name, bool passed, std::string_view detail);
    void not_run(std::string_view name, std::string_view why);
    /// 0, or 1 when one has failed.
    [[nodiscard]] int status() const { return failed_ > 0 || file_ == nullptr ? 1 : 0; }

private:
    void write(std::string_view name, std::string_view verdict, std::string_view detail);
    std::string group_;
    std::FILE* file_;
    int failed_ = 0;
};

/// CLOCK_MONOTONIC.
std::int64_t now_ns();
/// For a device's pace, and between the turns of a loop that serves what is tested. Where a test only waits:
/// tests/eventually.hpp.
void sleep_ms(double ms);
inline double ms_since(std::int64_t from_ns) { return static_cast<double>(now_ns() - from_ns) * 1e-6; }

/// Of this process: entries of /proc/self/fd.
std::size_t open_descriptors();
/// sysfs, configfs: false, with the reason on stderr, where it cannot be written.
bool put(const std::string& file, std::string_view text);
std::string get(const std::string& file);
/// False: it is not there within so long.
bool wait_for_file(const std::string& file, int within_ms);

}  // namespace surefoot::vm
