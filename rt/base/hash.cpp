// Hashing of whole sections, eight bytes at a time.
#include "rt/base/hash.hpp"

#include <bit>
#include <cstring>

namespace surefoot {

namespace {

constexpr std::uint64_t prime = 0x100000001b3ULL;

std::uint64_t little_endian_word(const std::byte* at) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, sizeof(word));
    if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
    return word;
}

}  // namespace

// Every step is a bijection of the hash for a fixed word, and of the word for a fixed hash (xor, odd factor, rotation):
// so a change within one word always changes the result. The rotation carries high bits down, which FNV alone does not.
std::uint64_t hash_bytes(std::span<const std::byte> bytes, std::uint64_t start) {
    std::uint64_t hash = start;
    std::size_t at = 0;
    for (; at + 8 <= bytes.size(); at += 8) hash = std::rotl((hash ^ little_endian_word(bytes.data() + at)) * prime, 29);
    for (; at < bytes.size(); ++at) hash = (hash ^ std::to_integer<std::uint64_t>(bytes[at])) * prime;
    return hash;
}

}  // namespace surefoot
