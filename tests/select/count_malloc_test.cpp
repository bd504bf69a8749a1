// The counter itself: an allocation that it does not see would make every proof of none worthless.
#include "tests/select/count_malloc.hpp"

#include <gtest/gtest.h>

#include <cerrno>
#include <cstddef>
#include <vector>

#ifndef SUREFOOT_SANITIZED

namespace {
thread_local std::uint64_t count = 0;
}

// glibc's own names: the interposer has nothing to look up, so it cannot recurse.
extern "C" {
void* __libc_malloc(std::size_t);                 // NOLINT
void* __libc_calloc(std::size_t, std::size_t);    // NOLINT
void* __libc_realloc(void*, std::size_t);         // NOLINT
void* __libc_memalign(std::size_t, std::size_t);  // NOLINT
void __libc_free(void*);                          // NOLINT
void* malloc(std::size_t n) {
    ++count;
    return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
    ++count;
    return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) {
    ++count;
    return __libc_realloc(p, n);
}
void* aligned_alloc(std::size_t alignment, std::size_t n) {
    ++count;
    return __libc_memalign(alignment, n);
}
// The whole set, as glibc wants it: none of the guard's own is then linked beside it.
void* memalign(std::size_t alignment, std::size_t n) {
    ++count;
    return __libc_memalign(alignment, n);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t n) {
    ++count;
    *memory = __libc_memalign(alignment, n);
    return *memory == nullptr ? ENOMEM : 0;
}
void free(void* p) { __libc_free(p); }
}

namespace surefoot::test {
std::uint64_t allocations() { return count; }
}  // namespace surefoot::test

TEST(Count, SeesNewAndVectors) {
    const std::uint64_t before = surefoot::test::allocations();
    std::vector<int> v(100);
    v.push_back(1);
    EXPECT_GE(surefoot::test::allocations(), before + 2);
}

#else

namespace surefoot::test {
std::uint64_t allocations() { return 0; }
}  // namespace surefoot::test

#endif
