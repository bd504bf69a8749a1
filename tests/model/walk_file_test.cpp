// The .walk file: comes back as it went out; any changed byte, any cut, is a named error.
#include "render/model/walk_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "rt/base/file.hpp"
#include "rt/base/hash.hpp"
#include "rt/base/random.hpp"
#include "tests/model/two_triangles.hpp"
#include "tests/temporary_folder.hpp"

namespace surefoot::model {
namespace {

namespace fs = std::filesystem;

struct WalkFile : testing::Test {
    test::TemporaryFolder folder;
    std::string file = folder / "m.walk";
    void put(std::span<const std::byte> bytes) const {
        std::ofstream out(file, std::ios::binary | std::ios::trunc);
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
};

/// More than one page of each payload, some of it hard to pack.
Model several_pages() {
    Model m = two_triangles();
    Random random(3);
    m.vertices.resize(40000);
    for (Vertex& v : m.vertices) {
        for (float& p : v.position) p = static_cast<float>(random.unit());
    }
    m.parts[0].vertex_count = 40000;
    m.texels.resize(20 + (1U << 20U));
    for (std::size_t i = 20; i < m.texels.size(); ++i) m.texels[i] = static_cast<std::byte>(random.next());
    return m;
}

void expect_same(const Model& a, const Model& b) {
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    for (std::size_t i = 0; i < a.nodes.size(); ++i) {
        EXPECT_EQ(a.nodes[i].box.min, b.nodes[i].box.min);
        EXPECT_EQ(a.nodes[i].parent, b.nodes[i].parent);
        EXPECT_EQ(a.nodes[i].first_rep, b.nodes[i].first_rep);
        EXPECT_EQ(a.nodes[i].importance, b.nodes[i].importance);
        EXPECT_STREQ(a.name_of(a.nodes[i]), b.name_of(b.nodes[i]));
    }
    ASSERT_EQ(a.reps.size(), b.reps.size());
    for (std::size_t i = 0; i < a.reps.size(); ++i) {
        EXPECT_EQ(a.reps[i].kind, b.reps[i].kind);
        EXPECT_EQ(a.reps[i].everywhere, b.reps[i].everywhere);
        EXPECT_EQ(a.reps[i].error_m, b.reps[i].error_m);
        EXPECT_EQ(a.reps[i].area_m2, b.reps[i].area_m2);
    }
    EXPECT_EQ(a.placements[0].origin, b.placements[0].origin);
    EXPECT_EQ(a.materials[0].effects, b.materials[0].effects);
    EXPECT_EQ(a.textures[0].levels, b.textures[0].levels);
    ASSERT_EQ(a.vertices.size(), b.vertices.size());
    EXPECT_EQ(std::memcmp(a.vertices.data(), b.vertices.data(), a.vertices.size() * sizeof(Vertex)), 0);
    EXPECT_EQ(a.indices, b.indices);
    EXPECT_EQ(a.texels, b.texels);
    EXPECT_EQ(a.effects[0].reason, b.effects[0].reason);
    EXPECT_EQ(a.provenance.warnings, b.provenance.warnings);
    EXPECT_EQ(a.provenance.bake_s, b.provenance.bake_s);
}

TEST_F(WalkFile, ComesBackAsItWent) {
    const Model model = several_pages();
    const auto written = write_walk(file, model);
    ASSERT_TRUE(written.ok()) << written.error().text();
    EXPECT_EQ(written->bytes, fs::file_size(file));
    EXPECT_EQ(written->pages, 2U + 1U + 2U);
    WalkFileInfo info;
    const auto read = read_walk(file, &info);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(info.payload_bytes, written->payload_bytes);
    expect_same(model, *read);
}

TEST_F(WalkFile, SameModelSameBytes) {
    ASSERT_TRUE(write_walk(file, several_pages()).ok());
    const auto first = *read_file(file);
    ASSERT_TRUE(write_walk(file, several_pages()).ok());
    EXPECT_EQ(first, *read_file(file));
}

TEST_F(WalkFile, EveryByteFlippedIsANamedError) {
    ASSERT_TRUE(write_walk(file, two_triangles()).ok());
    const auto good = *read_file(file);
    Random random(1);
    for (std::size_t i = 0; i < good.size(); ++i) {
        auto bad = good;
        bad[i] ^= static_cast<std::byte>(1U << random.below(8));
        put(bad);
        const auto read = read_walk(file);
        ASSERT_FALSE(read.ok()) << "byte " << i;
        EXPECT_NE(read.error().place.find(file), std::string::npos) << "byte " << i;
        EXPECT_FALSE(read.error().what.empty());
        EXPECT_FALSE(read.error().remedy.empty());
    }
}

TEST_F(WalkFile, EveryTruncationIsAnError) {
    ASSERT_TRUE(write_walk(file, two_triangles()).ok());
    const auto good = *read_file(file);
    for (std::size_t size = 0; size < good.size(); size += 7) {
        put(std::span(good).first(size));
        EXPECT_FALSE(read_walk(file).ok()) << size;
    }
    auto longer = good;
    longer.push_back(std::byte{0});
    put(longer);
    EXPECT_FALSE(read_walk(file).ok());
}

// A forger who mends the checksums still meets validate(): these models are written with right ones.
TEST_F(WalkFile, WrongIndexWithRightChecksumIsRefused) {
    Model model = two_triangles();
    model.indices[1] = 3;
    ASSERT_TRUE(write_walk(file, model).ok());
    const auto read = read_walk(file);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().place.find("parts[0]"), std::string::npos);
}

/// Mends section, table and header checksums after a change in section `number`.
void mend_checksums(std::vector<std::byte>& bytes, std::size_t number) {
    constexpr std::size_t header = 56, entry = 20, sections = 9;
    const auto get = [&](std::size_t at) {
        std::uint64_t value = 0;
        std::memcpy(&value, bytes.data() + at, sizeof(value));
        return value;
    };
    const auto put = [&](std::size_t at, std::uint64_t value) { std::memcpy(bytes.data() + at, &value, sizeof(value)); };
    const std::size_t table = bytes.size() - sections * entry;
    std::size_t at = header + get(24);
    for (std::size_t i = 0; i < number; ++i) at += get(table + i * entry + 4);
    const std::span<const std::byte> all(bytes);
    put(table + number * entry + 12, hash_bytes(all.subspan(at, get(table + number * entry + 4))));
    put(32, hash_bytes(all.subspan(table)));
    put(48, hash_bytes(all.first(48)));
}

// The payload sizes stand first in the page directory: with right checksums only the bounds stand before a huge allocation.
TEST_F(WalkFile, ForgedPayloadSizesDoNotAllocate) {
    ASSERT_TRUE(write_walk(file, two_triangles()).ok());
    const auto good = *read_file(file);
    std::uint64_t pages_size = 0;
    std::memcpy(&pages_size, good.data() + 24, sizeof(pages_size));
    for (std::size_t which = 0; which < 3; ++which) {
        for (const std::uint64_t size : {1ULL << 60U, 1ULL << 20U, 32ULL * 300, 0ULL}) {
            auto bad = good;
            std::memcpy(bad.data() + 56 + pages_size + 8 * which, &size, sizeof(size));
            mend_checksums(bad, 0);
            put(bad);
            EXPECT_FALSE(read_walk(file).ok()) << which << ' ' << size;
        }
    }
}

TEST_F(WalkFile, ForgedRecordCountsDoNotAllocate) {
    ASSERT_TRUE(write_walk(file, two_triangles()).ok());
    const auto good = *read_file(file);
    std::uint64_t at = 0;
    std::memcpy(&at, good.data() + 24, sizeof(at));
    at += 56;
    for (std::size_t section = 0; section < 8; ++section) {
        const std::uint64_t huge = 1ULL << 40U;
        auto bad = good;
        std::memcpy(bad.data() + at + (section == 0 ? 24 : 0), &huge, sizeof(huge));
        mend_checksums(bad, section);
        put(bad);
        const auto read = read_walk(file);
        ASSERT_FALSE(read.ok()) << section;
        EXPECT_EQ(read.error().what.find("checksum"), std::string::npos) << section;  // it came past them
        std::uint64_t size = 0;
        std::memcpy(&size, good.data() + good.size() - 9 * 20 + section * 20 + 4, sizeof(size));
        at += size;
    }
}

TEST_F(WalkFile, WhatIsNoModelIsSaid) {
    put(std::as_bytes(std::span("glTF but surely not a walk file, and longer than any header would ever need to be .......")));
    const auto read = read_walk(file);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().what.find("not a .walk"), std::string::npos);
    EXPECT_FALSE(read_walk(folder / "absent.walk").ok());
    EXPECT_FALSE(read_walk(folder.path()).ok());
}

TEST_F(WalkFile, FailedWriteLeavesTheOldFile) {
    ASSERT_TRUE(write_walk(file, two_triangles()).ok());
    const auto before = *read_file(file);
    EXPECT_FALSE(write_walk(folder / "no/such/folder.walk", two_triangles()).ok());
    EXPECT_EQ(before, *read_file(file));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator{}), 1);  // and no temporary beside it
}

}  // namespace
}  // namespace surefoot::model
