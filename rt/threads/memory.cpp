// Memory that does not fault: mlockall, mallopt, touched stack and heap.
#include "rt/threads/memory.hpp"

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

namespace surefoot::rt {

void keep_heap() {
    mallopt(M_TRIM_THRESHOLD, -1);
    mallopt(M_MMAP_MAX, 0);
}

Result<void> lock_memory() {
    // A soft limit below the hard one is ours to raise; root and CAP_IPC_LOCK need none.
    rlimit limit{};
    if (getrlimit(RLIMIT_MEMLOCK, &limit) == 0 && limit.rlim_cur < limit.rlim_max) {
        limit.rlim_cur = limit.rlim_max;
        setrlimit(RLIMIT_MEMLOCK, &limit);
    }
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        return Error{"memory", std::string("cannot be locked: ") + std::strerror(errno),
                     "grant CAP_IPC_LOCK, or LimitMEMLOCK=infinity in the unit, or `ulimit -l unlimited`"};
    }
    return {};
}

void touch_stack() {
    constexpr std::size_t bytes = 512 * 1024, page = 4096;
    volatile char stack[bytes];
    for (std::size_t i = 0; i < bytes; i += page) stack[i] = 1;
}

void touch_heap(int mib) {
    const std::size_t bytes = static_cast<std::size_t>(mib) << 20U;
    void* block = std::malloc(bytes);
    if (block == nullptr) return;
    std::memset(block, 1, bytes);
    // The compiler may not see through this and drop the pair.
    asm volatile("" : : "r"(block) : "memory");
    std::free(block);
}

}  // namespace surefoot::rt
