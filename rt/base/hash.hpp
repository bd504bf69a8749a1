// FNV-1a 64 for cut hashes and section checksums: order-dependent, the same on every machine.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace surefoot {

constexpr std::uint64_t fnv_start = 0xcbf29ce484222325ULL;

inline std::uint64_t fnv1a(std::uint64_t hash, std::uint64_t value) {
    for (int i = 0; i < 8; ++i) {
        hash = (hash ^ (value & 0xffU)) * 0x100000001b3ULL;
        value >>= 8U;
    }
    return hash;
}

/// Hash of bytes, eight at a time; the tail byte by byte. Not cryptographic: it finds accidental changes, not attacks.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t start = fnv_start);

}  // namespace surefoot
