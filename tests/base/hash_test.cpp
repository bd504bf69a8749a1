// Hashes and readers: any changed byte is found, and no read goes past the end.
#include "rt/base/hash.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <set>
#include <vector>

#include "rt/base/random.hpp"
#include "rt/base/reader.hpp"

namespace surefoot {
namespace {

std::vector<std::byte> noise(std::size_t size) {
    Random random(7);
    std::vector<std::byte> bytes(size);
    for (auto& b : bytes) b = static_cast<std::byte>(random.below(256));
    return bytes;
}

TEST(Hash, AnySingleByteChangeIsFound) {
    for (const std::size_t size : {1U, 7U, 8U, 9U, 31U, 64U, 67U}) {
        auto bytes = noise(size);
        const auto before = hash_bytes(bytes);
        for (std::size_t i = 0; i < size; ++i)
            for (int change = 1; change < 256; ++change) {
                bytes[i] ^= static_cast<std::byte>(change);
                EXPECT_NE(hash_bytes(bytes), before) << "size " << size << " byte " << i;
                bytes[i] ^= static_cast<std::byte>(change);
            }
    }
}

TEST(Hash, LengthOfZerosCounts) {
    const std::vector<std::byte> zeros(40);
    std::set<std::uint64_t> seen;
    for (std::size_t n = 0; n <= zeros.size(); ++n) seen.insert(hash_bytes(std::span(zeros).first(n)));
    EXPECT_EQ(seen.size(), zeros.size() + 1);
}

TEST(Hash, OrderOfWordsCounts) {
    auto bytes = noise(16);
    const auto before = hash_bytes(bytes);
    std::swap_ranges(bytes.begin(), bytes.begin() + 8, bytes.begin() + 8);
    EXPECT_NE(hash_bytes(bytes), before);
}

TEST(Hash, ValueIsTheSameOnEveryMachine) {
    std::array<std::byte, 11> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i);
    EXPECT_EQ(hash_bytes(bytes), 0xf874c345c239affbULL);
    EXPECT_EQ(hash_bytes({}), fnv_start);
    EXPECT_EQ(fnv1a(fnv_start, 0x0102030405060708ULL), 0x0c6d4496e17859d5ULL);
}

TEST(Reader, PastTheEndFailsForGoodAndReadsZero) {
    const std::array<std::byte, 3> bytes{std::byte{1}, std::byte{2}, std::byte{3}};
    ByteReader reader(bytes);
    EXPECT_EQ(reader.read<std::uint8_t>(), 1);
    EXPECT_EQ(reader.read<std::uint32_t>(), 0U);
    EXPECT_TRUE(reader.failed());
    EXPECT_EQ(reader.read<std::uint8_t>(), 0);
}

TEST(Reader, HugeCountDoesNotWrapAround) {
    const std::array<std::byte, 3> bytes{};
    ByteReader reader(bytes);
    (void)reader.read<std::uint8_t>();
    EXPECT_TRUE(reader.bytes(~0ULL).empty());
    EXPECT_TRUE(reader.failed());
}

TEST(Random, SequenceIsTheSameOnEveryMachine) {
    Random random(1);
    EXPECT_EQ(random.next(), 0xb3f2af6d0fc710c5ULL);
    EXPECT_EQ(random.next(), 0x853b559647364ceaULL);
}

}  // namespace
}  // namespace surefoot
