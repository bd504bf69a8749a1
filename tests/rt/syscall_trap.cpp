// A seccomp filter that lets the declared calls pass and turns the others into SIGSYS. The handler counts, then carries the
// call out through a gate: one `syscall` instruction whose address the filter lets through.
#include "tests/rt/syscall_trap.hpp"

#include <fmt/format.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <vector>

#include "rt/threads/guard.hpp"

namespace surefoot::rt {

namespace {

constinit thread_local TrapCounters trap_state __attribute__((tls_model("initial-exec"))) = {};

constexpr std::array<long, 4> frame_calls = {SYS_clock_nanosleep, SYS_clock_gettime, SYS_getrusage, SYS_restart_syscall};

struct CallName {
    long number;
    const char* name;
};
// The calls that code of ours or a library's might plausibly make.
constexpr std::array call_names = {
    CallName{SYS_read, "read"},
    CallName{SYS_write, "write"},
    CallName{SYS_openat, "openat"},
    CallName{SYS_close, "close"},
    CallName{SYS_ioctl, "ioctl"},
    CallName{SYS_mmap, "mmap"},
    CallName{SYS_munmap, "munmap"},
    CallName{SYS_mprotect, "mprotect"},
    CallName{SYS_mremap, "mremap"},
    CallName{SYS_madvise, "madvise"},
    CallName{SYS_brk, "brk"},
    CallName{SYS_futex, "futex"},
    CallName{SYS_nanosleep, "nanosleep"},
    CallName{SYS_clock_nanosleep, "clock_nanosleep"},
    CallName{SYS_clock_gettime, "clock_gettime"},
    CallName{SYS_getrusage, "getrusage"},
    CallName{SYS_sched_yield, "sched_yield"},
    CallName{SYS_sched_setaffinity, "sched_setaffinity"},
    CallName{SYS_sched_setscheduler, "sched_setscheduler"},
    CallName{SYS_gettid, "gettid"},
    CallName{SYS_getpid, "getpid"},
    CallName{SYS_tgkill, "tgkill"},
    CallName{SYS_ppoll, "ppoll"},
    CallName{SYS_recvmsg, "recvmsg"},
    CallName{SYS_sendmsg, "sendmsg"},
    CallName{SYS_writev, "writev"},
    CallName{SYS_pread64, "pread64"},
    CallName{SYS_fstat, "fstat"},
    CallName{SYS_lseek, "lseek"},
    CallName{SYS_fcntl, "fcntl"},
    CallName{SYS_getrandom, "getrandom"},
    CallName{SYS_membarrier, "membarrier"},
    CallName{SYS_rt_sigaction, "rt_sigaction"},
    CallName{SYS_rt_sigprocmask, "rt_sigprocmask"},
    CallName{SYS_getppid, "getppid"},
};

}  // namespace

#if defined(__x86_64__) && !defined(SUREFOOT_SANITIZED)

// The label stands behind the instruction: that is the address which the filter sees.
extern "C" long surefoot_call_gate(long number, const long* arguments);
extern "C" const char surefoot_call_gate_passed[];
asm(R"(
    .text
    .globl surefoot_call_gate
    .globl surefoot_call_gate_passed
    .type surefoot_call_gate, @function
surefoot_call_gate:
    mov %rdi, %rax
    mov %rsi, %r11
    mov 0(%r11), %rdi
    mov 16(%r11), %rdx
    mov 24(%r11), %r10
    mov 32(%r11), %r8
    mov 40(%r11), %r9
    mov 8(%r11), %rsi
    syscall
surefoot_call_gate_passed:
    ret
    .size surefoot_call_gate, . - surefoot_call_gate
)");

namespace {

// What the handler cannot carry out on the caller's behalf, for it would act on the handler's own frame or stack.
constexpr std::array<long, 6> never_trapped = {SYS_rt_sigreturn, SYS_sigaltstack, SYS_exit,
                                               SYS_exit_group,   SYS_clone,       SYS_clone3};

/// The signal mask that counts is the one restored when the handler returns. SIGSYS is left out of it: a trap while it is
/// blocked would end the process, and the C library blocks all signals around the end of a thread.
long change_mask(const std::array<long, 6>& arguments, ucontext_t& context) {
    std::uint64_t mask = 0;
    std::memcpy(&mask, &context.uc_sigmask, sizeof mask);
    const std::uint64_t before = mask;
    if (const auto* requested = reinterpret_cast<const void*>(arguments[1]); requested != nullptr) {
        std::uint64_t set = 0;
        std::memcpy(&set, requested, sizeof set);
        switch (arguments[0]) {
            case SIG_BLOCK:
                mask |= set;
                break;
            case SIG_UNBLOCK:
                mask &= ~set;
                break;
            case SIG_SETMASK:
                mask = set;
                break;
            default:
                return -EINVAL;
        }
    }
    mask &= ~(1ULL << (SIGSYS - 1U));
    std::memcpy(&context.uc_sigmask, &mask, sizeof mask);
    if (auto* old = reinterpret_cast<void*>(arguments[2]); old != nullptr) std::memcpy(old, &before, sizeof before);
    return 0;
}

void on_trap(int /*signal*/, siginfo_t* info, void* context_pointer) {
    TrapCounters& counters = trap_state;
    if (in_own_scope()) {
        ++counters.own;
        if (counters.first_own < 0) counters.first_own = info->si_syscall;
        counters.last_own = info->si_syscall;
    } else {
        ++counters.other;
    }
    auto& context = *static_cast<ucontext_t*>(context_pointer);
    auto& registers = context.uc_mcontext.gregs;
    const std::array<long, 6> arguments = {registers[REG_RDI], registers[REG_RSI], registers[REG_RDX],
                                           registers[REG_R10], registers[REG_R8],  registers[REG_R9]};
    registers[REG_RAX] = info->si_syscall == SYS_rt_sigprocmask ? change_mask(arguments, context)
                                                                : surefoot_call_gate(info->si_syscall, arguments.data());
}

constexpr sock_filter load(std::size_t offset) { return BPF_STMT(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(offset)); }

std::vector<sock_filter> make_filter(std::span<const long> allowed) {
    const auto gate = reinterpret_cast<std::uintptr_t>(&surefoot_call_gate_passed[0]);
    const auto low = static_cast<std::uint32_t>(gate), high = static_cast<std::uint32_t>(gate >> 32U);
    constexpr std::size_t at = offsetof(seccomp_data, instruction_pointer);
    std::vector<sock_filter> filter = {
        load(offsetof(seccomp_data, arch)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, AUDIT_ARCH_X86_64, 1, 0),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_KILL_PROCESS),
        load(at),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, low, 0, 3),
        load(at + 4),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, high, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
        load(offsetof(seccomp_data, nr)),
    };
    const auto allow = [&](long number) {
        filter.push_back(BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(number), 0, 1));
        filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW));
    };
    std::ranges::for_each(never_trapped, allow);
    std::ranges::for_each(allowed, allow);
    filter.push_back(BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP));
    return filter;
}

Error trap_refused(int error) {
    return {"system call trap", std::strerror(error),  // NOLINT(concurrency-mt-unsafe)
            "the kernel needs CONFIG_SECCOMP_FILTER"};
}

}  // namespace

Result<void> trap_system_calls(std::span<const long> allowed) {
    struct sigaction action {};
    action.sa_sigaction = on_trap;
    action.sa_flags = SA_SIGINFO | SA_NODEFER;
    sigemptyset(&action.sa_mask);
    if (sigaction(SIGSYS, &action, nullptr) != 0) return trap_refused(errno);
    std::vector<sock_filter> filter = make_filter(allowed);
    const sock_fprog program{static_cast<unsigned short>(filter.size()), filter.data()};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return trap_refused(errno);
    // No SECCOMP_FILTER_FLAG_TSYNC: this thread only.
    if (syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) != 0) return trap_refused(errno);
    return {};
}

#else

Result<void> trap_system_calls(std::span<const long> /*allowed*/) {
    return Error{"system call trap", "is not made for this processor, nor for sanitizer builds", "use a plain x86-64 build"};
}

#endif

std::span<const long> frame_thread_system_calls() { return frame_calls; }

TrapCounters trap_counters() noexcept { return trap_state; }

std::string system_call_name(long number) {
    const auto found = std::ranges::find(call_names, number, &CallName::number);
    return found != call_names.end() ? std::string(found->name) : fmt::format("system call {}", number);
}

}  // namespace surefoot::rt
