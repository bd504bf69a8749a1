// Prepares memory before the first frame: the allocator keeps its pages, then pages are touched and locked.
#include "rt/threads/memory.hpp"

#include <alloca.h>
#include <fmt/format.h>
#include <malloc.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string_view>

#include "rt/base/file.hpp"
#include "rt/base/text.hpp"
#include "rt/threads/usage.hpp"

namespace surefoot::rt {

namespace {

constexpr const char* lock_remedy = "Grant CAP_IPC_LOCK, or RLIMIT_MEMLOCK unlimited (LimitMEMLOCK=infinity in the unit)";

/// The number of kB behind `key` in /proc/self/status, in bytes; 0 when it is not there.
std::uint64_t status_bytes(std::string_view key) {
    const auto text = read_text("/proc/self/status", 1U << 16U);
    if (!text) return 0;
    const auto at = text->find(key);
    if (at == std::string::npos) return 0;
    const auto digit = text->find_first_of("0123456789", at + key.size());
    if (digit == std::string::npos) return 0;
    return leading_number<std::uint64_t>(std::string_view(*text).substr(digit), 0) << 10U;
}

Result<void> lock_all(std::uint64_t growth_bytes) {
    rlimit limit{};
    getrlimit(RLIMIT_MEMLOCK, &limit);
    if (limit.rlim_cur < limit.rlim_max) {
        limit.rlim_cur = limit.rlim_max;
        setrlimit(RLIMIT_MEMLOCK, &limit);
    }
    const std::uint64_t mapped = status_bytes("VmSize:");
    if (limit.rlim_cur < mapped + growth_bytes && !lock_unlimited())
        return Error{"mlockall",
                     fmt::format("Memory cannot be locked: the limit is {} MiB, {} MiB are wanted", limit.rlim_cur >> 20U,
                                 (mapped + growth_bytes) >> 20U),
                     lock_remedy, ErrorKind::no_real_time};
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0)
        return Error{"mlockall",
                     fmt::format("Memory cannot be locked: {}", std::strerror(errno)),  // NOLINT(concurrency-mt-unsafe)
                     lock_remedy, ErrorKind::no_real_time};
    return {};
}

}  // namespace

// Many blocks, so that the heap grows by them whatever the allocator's bins do; given back to it touched.
void prefault_heap(std::size_t bytes) {
    constexpr std::size_t block = 64U << 10U;
    struct Link {
        Link* next;
    };
    Link* first = nullptr;
    for (std::size_t done = 0; done < bytes; done += block) {
        auto* memory = static_cast<Link*>(std::malloc(block));  // NOLINT: the allocator itself is what is being exercised
        if (memory == nullptr) break;
        // Each page is written by hand: malloc and memset become one calloc, which leaves fresh pages untouched.
        for (std::size_t at = 0; at < block; at += 4096) reinterpret_cast<volatile char*>(memory)[at] = 0;
        memory->next = first;
        first = memory;
    }
    while (first != nullptr) {
        Link* const next = first->next;
        std::free(first);  // NOLINT
        first = next;
    }
}

Result<void> prepare_memory(const MemoryOptions& options) {
    mallopt(M_TRIM_THRESHOLD, -1);
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TOP_PAD, 1 << 20);  // a grown heap grows by a useful amount
    prefault_heap(options.heap_bytes);
    return options.lock ? lock_all(options.growth_bytes) : Result<void>{};
}

void release_memory() {
    munlockall();
    // glibc's defaults (mallopt(3)); they cannot be read back.
    mallopt(M_TRIM_THRESHOLD, 128 << 10);
    mallopt(M_TOP_PAD, 128 << 10);
    mallopt(M_MMAP_MAX, 65536);
    malloc_trim(0);
}

__attribute__((noinline)) void prefault_stack(std::size_t bytes) {
    pthread_attr_t attributes;
    std::size_t whole = 0;
    if (pthread_getattr_np(pthread_self(), &attributes) == 0) {
        pthread_attr_getstacksize(&attributes, &whole);
        pthread_attr_destroy(&attributes);
    }
    const std::size_t size = std::min(bytes, whole / 2);
    if (size == 0) return;
    auto* const stack = static_cast<volatile char*>(alloca(size));
    for (std::size_t at = 0; at < size; at += 1024) stack[at] = 1;
    stack[size - 1] = 1;
}

std::int64_t minor_fault_cost_ns() {
    constexpr std::size_t pages = 1024, page = 4096;
    constexpr std::int64_t min_ns = 500, max_ns = 5000;
    void* const mapped = mmap(nullptr, pages * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) return max_ns;
    madvise(mapped, pages * page, MADV_NOHUGEPAGE);
    auto* const memory = static_cast<volatile unsigned char*>(mapped);
    const ThreadUsage before = read_own_usage();
    for (std::size_t i = 0; i < pages; ++i) memory[i * page] = 1;
    const ThreadUsage spent = read_own_usage() - before;
    munmap(mapped, pages * page);
    const auto faults = static_cast<std::int64_t>(spent.minor_faults);
    return std::clamp(faults > 0 ? 2 * spent.cpu_ns / faults : min_ns, min_ns, max_ns);
}

bool lock_unlimited() {
    rlimit limit{};
    getrlimit(RLIMIT_MEMLOCK, &limit);
    if (limit.rlim_cur == RLIM_INFINITY) return true;
    // More than the limit is refused at once without the capability: address space alone is asked for, and ONFAULT touches
    // nothing.
    const std::size_t bytes = limit.rlim_cur + (1U << 20U);
    void* const memory = mmap(nullptr, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED) return false;
    const bool locked = mlock2(memory, bytes, MLOCK_ONFAULT) == 0;
    munmap(memory, bytes);
    return locked;
}

std::uint64_t locked_bytes() { return status_bytes("VmLck:"); }

}  // namespace surefoot::rt
