// An allocator of whole pages from the system, for arrays of hundreds of MiB. Freed pages go back to the system at once; the heap
// of a locked, never trimmed process would keep them for ever.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>

namespace surefoot {

/// For std::vector. Freed pages are unmapped, whatever the heap's settings and locks.
template <class T>
struct PageMemory {
    using value_type = T;
    PageMemory() = default;
    template <class U>
    PageMemory(const PageMemory<U>& /*other*/) {}  // NOLINT(google-explicit-constructor): allocators convert

    T* allocate(std::size_t count) {
        if (count > std::size_t(-1) / sizeof(T)) throw std::bad_array_new_length();
        void* const pages = mmap(nullptr, count * sizeof(T), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (pages == MAP_FAILED) throw std::bad_alloc();
        return static_cast<T*>(pages);
    }
    void deallocate(T* memory, std::size_t count) { munmap(memory, count * sizeof(T)); }
    bool operator==(const PageMemory&) const = default;
};

}  // namespace surefoot
