// The machine that checks read: files below a root directory, and results of system calls. Checks read nothing else, so tests can
// make up machines.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "rt/threads/placement.hpp"

namespace surefoot::doctor {

/// What a wake-up run found (wake_up.hpp); times in microseconds, how late a slot's start was.
struct WakeFigures {
    std::string source;  ///< "surefoot" or "cyclictest"
    double seconds = 0;
    std::uint64_t slots = 0;    ///< counted, those passed over included
    std::uint64_t skipped = 0;  ///< slots that a stall ran over; cyclictest does not count them
    double p50_us = 0, p99_us = 0, p999_us = 0, max_us = 0;
    int core = -1;
    int priority = 0;      ///< SCHED_FIFO; 0: refused, ordinary scheduling
    double steal_ms = -1;  ///< taken by the host from this core meanwhile; -1: not known
};

/// A renderer that a back end opened.
struct RendererFound {
    std::string name;     ///< GL_RENDERER; empty: none opened
    std::string error;    ///< why not
    std::string remedy;   ///< of the error
    std::string machine;  ///< what a cost table must have been measured on
    bool software = false;
};

/// A screen that can be driven without a window system.
struct ScreenFound {
    std::string name;  ///< of its connector
    std::string mode;  ///< that it prefers
    bool connected = false;
    std::optional<bool> counts_refreshes;  ///< absent: it shows nothing now
};

/// The screens of this machine, or why none was found.
struct ScreensFound {
    std::vector<ScreenFound> screens;
    std::string error, remedy;
};

/// The cost table of this machine, if there is one.
struct CostTableFound {
    std::string file;
    bool there = false;
    std::string error;    ///< why it cannot be read
    std::string machine;  ///< where it was measured
};

/// Results of system calls. Absent: not tried (another root, --quick), or unknown.
struct Probed {
    std::optional<int> fifo_priority;  ///< highest SCHED_FIFO priority granted up to the wanted one; 0: refused
    rt::CpuMask isolated;              ///< isolated cores that a thread gets when it asks, though outside of this process's mask
    std::optional<bool> locks_memory;  ///< 1 GiB of address space may be locked
    std::optional<bool> holds_c_states;  ///< /dev/cpu_dma_latency may be opened for writing
    std::optional<RendererFound> renderer;
    std::optional<ScreensFound> screens;
    std::optional<CostTableFound> costs;
    std::optional<std::uint64_t> free_state_bytes;  ///< of the disk that holds the state folder
    std::optional<WakeFigures> wake_up, cyclictest;
};

/// What the service will request.
struct Wanted {
    int frame_priority = 80;
    std::optional<int> frame_core;  ///< absent: chosen as below
    std::string state_folder = "/var/lib/surefoot";
};

/// A file node's owner and rights.
struct Node {
    std::uint32_t group = 0;
    std::uint32_t mode = 0;  ///< the nine permission bits
};

/// The machine as the checks see it: files below a root, and results of system calls.
class Machine {
public:
    /// root: a directory that stands for "/"; empty: this machine itself.
    Machine(std::string root, Wanted wanted, Probed probed);

    /// The file's text without blanks at its ends; nothing where it cannot be read. `path` starts with '/'. At most 1 MiB.
    [[nodiscard]] std::optional<std::string> text(std::string_view path) const;
    [[nodiscard]] std::optional<std::int64_t> number(std::string_view path) const;
    [[nodiscard]] std::optional<rt::CpuMask> cpus(std::string_view path) const;  ///< a list such as "0-2,5"
    /// Names in a directory, sorted, numbers by value; nothing where it cannot be read.
    [[nodiscard]] std::optional<std::vector<std::string>> names(std::string_view path) const;
    [[nodiscard]] bool exists(std::string_view path) const;
    [[nodiscard]] std::optional<Node> node(std::string_view path) const;

    /// A word of the kernel's command line: "1" for a bare word, the text behind '=' else; the last one wins.
    [[nodiscard]] std::optional<std::string> boot_word(std::string_view key) const;
    /// "y", "m", a value, or "n" from the kernel's build configuration; nothing where it is not to be had.
    [[nodiscard]] std::optional<std::string> build_option(std::string_view key) const;
    /// Whether a flag of /proc/cpuinfo is set; nothing where it lists no flags.
    [[nodiscard]] std::optional<bool> processor_flag(std::string_view flag) const;
    /// Major and minor number.
    struct Version {
        int major = 0, minor = 0;
        [[nodiscard]] bool before(int a, int b) const { return major < a || (major == a && minor < b); }
    };
    [[nodiscard]] std::optional<Version> kernel() const;
    /// "Cpus_allowed_list" and the like from /proc/self/status.
    [[nodiscard]] std::optional<std::string> own_status(std::string_view key) const;
    /// Whether this process holds a capability, by its number.
    [[nodiscard]] std::optional<bool> has_capability(int number) const;
    /// The group's number in /etc/group.
    [[nodiscard]] std::optional<std::uint32_t> group(std::string_view name) const;

    /// The core that the frame thread would have: the requested one, else rt::default_frame_core(), as in a walk.
    [[nodiscard]] std::optional<int> frame_core() const { return frame_core_; }
    [[nodiscard]] rt::CpuMask isolated() const;
    [[nodiscard]] const Wanted& wanted() const { return wanted_; }
    [[nodiscard]] const Probed& probed() const { return probed_; }

private:
    std::string root_;
    Wanted wanted_;
    Probed probed_;
    std::optional<int> frame_core_;
    std::optional<std::string> build_configuration_;
};

/// What can only be found by trying it on this machine: FIFO, locking, the renderer, the cost table, disk space; everything but
/// the wake-up run. Leaves limits, threads and files as they were; opens GL once (a few tenths of a second).
Probed probe_machine(const Wanted& wanted);

}  // namespace surefoot::doctor
