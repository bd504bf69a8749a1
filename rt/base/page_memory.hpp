// Memory for arrays of hundreds of MiB with a life of their own: whole pages from the system, back to it when they are freed. The
// heap of a process that keeps its memory (locked, never trimmed) would keep them to its end.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <new>

namespace surefoot {

/// For std::vector. The pages are the system's own: no allocator setting and no lock keeps them once they are freed.
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
