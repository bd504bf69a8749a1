// The .walk file: comes back as it went out; any changed byte, any cut, is a named error.
#include "render/model/walk_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "render/model/loss_groups.hpp"
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
    EXPECT_EQ(a.provenance.quality, b.provenance.quality);
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

// A forger who repairs the checksums still meets validate(): these models are written with right ones.
TEST_F(WalkFile, WrongIndexWithRightChecksumIsRefused) {
    Model model = two_triangles();
    model.indices[1] = 3;
    ASSERT_TRUE(write_walk(file, model).ok());
    const auto read = read_walk(file);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().place.find("parts[0]"), std::string::npos);
}

/// Repairs section, table and header checksums after a change in section `number`.
void repair_checksums(std::vector<std::byte>& bytes, std::size_t number) {
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
            repair_checksums(bad, 0);
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
        repair_checksums(bad, section);
        put(bad);
        const auto read = read_walk(file);
        ASSERT_FALSE(read.ok()) << section;
        EXPECT_EQ(read.error().what.find("checksum"), std::string::npos) << section;  // it came past them
        std::uint64_t size = 0;
        std::memcpy(&size, good.data() + good.size() - 9 * 20 + section * 20 + 4, sizeof(size));
        at += size;
    }
}

TEST_F(WalkFile, WhatIsNoModelIsRefused) {
    put(std::as_bytes(std::span("glTF but surely not a walk file, and longer than any header would ever need to be .......")));
    const auto read = read_walk(file);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().what.find("not a .walk"), std::string::npos);
    EXPECT_FALSE(read_walk(folder / "absent.walk").ok());
    EXPECT_FALSE(read_walk(folder.path()).ok());
}

/// A file taken apart at its section table, to be put together in another way with right checksums.
struct Sections {
    using Bytes = std::vector<std::byte>;
    static constexpr std::size_t header = 56, entry = 20;
    Bytes head, pages;
    std::vector<std::pair<std::uint32_t, Bytes>> list;

    template <class T>
    static T get(std::span<const std::byte> bytes, std::size_t at) {
        T value{};
        std::memcpy(&value, bytes.data() + at, sizeof(value));
        return value;
    }
    template <class T>
    static void add(Bytes& bytes, T value) {
        const auto* const from = reinterpret_cast<const std::byte*>(&value);
        bytes.insert(bytes.end(), from, from + sizeof(value));
    }
    explicit Sections(std::span<const std::byte> file) {
        const std::size_t count = get<std::uint32_t>(file, 12), pages_size = get<std::uint64_t>(file, 24);
        const auto first = file.first(12), middle = file.subspan(header, pages_size), table = file.last(count * entry);
        head.assign(first.begin(), first.end());
        pages.assign(middle.begin(), middle.end());
        std::size_t at = header + pages_size;
        for (std::size_t i = 0; i < count; ++i) {
            const auto section = file.subspan(at, get<std::uint64_t>(table, i * entry + 4));
            list.emplace_back(get<std::uint32_t>(table, i * entry), Bytes(section.begin(), section.end()));
            at += section.size();
        }
    }
    void drop(std::uint32_t id) {
        std::erase_if(list, [=](const auto& one) { return one.first == id; });
    }
    [[nodiscard]] Bytes file() const {
        Bytes table, body = pages, out = head;
        for (const auto& [id, bytes] : list) {
            add(table, id), add(table, std::uint64_t{bytes.size()}), add(table, hash_bytes(bytes));
            body.insert(body.end(), bytes.begin(), bytes.end());
        }
        add(out, static_cast<std::uint32_t>(list.size()));
        add(out, std::uint64_t{header + body.size() + table.size()}), add(out, std::uint64_t{pages.size()});
        add(out, hash_bytes(table)), add(out, std::uint64_t{0});
        add(out, hash_bytes(out));
        out.insert(out.end(), body.begin(), body.end());
        out.insert(out.end(), table.begin(), table.end());
        return out;
    }
};

constexpr std::array<const char*, 15> section_names = {"pages",     "nodes",    "representations", "parts",      "placements",
                                                       "materials", "textures", "effects",         "provenance", "losses",
                                                       "ground",    "tour",     "light",           "motion",     "moving ground"};
constexpr std::uint32_t textures_id = 6, losses_id = 9, ground_id = 10, tour_id = 11, light_id = 12, motion_id = 13,
                        moving_ground_id = 14;  // optional

struct OpenTable : WalkFile {
    Model model = two_triangles();
    [[nodiscard]] Sections sections_of_model() const {
        EXPECT_TRUE(write_walk(file, model).ok());
        return Sections(*read_file(file));
    }
};

TEST_F(OpenTable, UnknownSectionsAreSkippedWhereverTheyStand) {
    Sections sections = sections_of_model();
    EXPECT_EQ(sections.file(), *read_file(file));
    WalkFileInfo before, after;
    ASSERT_TRUE(read_walk(file, &before).ok());
    const Sections::Bytes unknown(300, std::byte{7});
    sections.list.insert(sections.list.begin(), {77, unknown});
    sections.list.insert(sections.list.begin() + 4, {section_names.size(), {}});
    sections.list.emplace_back(0xffffffffU, unknown);
    put(sections.file());
    const auto read = read_walk(file, &after);
    ASSERT_TRUE(read.ok()) << read.error().text();
    expect_same(model, *read);
    EXPECT_EQ(before.hash, after.hash);
    auto damaged = sections.file();  // skipped, and yet under a checksum
    damaged[Sections::header + sections.pages.size() + 10] ^= std::byte{1};
    put(damaged);
    EXPECT_FALSE(read_walk(file).ok());
}

TEST_F(OpenTable, SectionsMayStandInAnyOrder) {
    Sections sections = sections_of_model();
    std::reverse(sections.list.begin(), sections.list.end());
    put(sections.file());
    const auto read = read_walk(file);
    ASSERT_TRUE(read.ok()) << read.error().text();
    expect_same(model, *read);
}

TEST_F(OpenTable, AMissingOptionalSectionIsEmpty) {
    model.textures.clear();
    model.texels.clear();
    model.materials[0].texture = none;
    model.materials[0].effects = 0;
    for (Representation& rep : model.reps) rep.effects = 0;
    Sections sections = sections_of_model();
    sections.drop(textures_id);
    put(sections.file());
    const auto read = read_walk(file);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_TRUE(read->textures.empty());
    EXPECT_EQ(read->nodes.size(), model.nodes.size());
}

TEST_F(OpenTable, LossesComeBackAndWithoutThemTheModelIsTheSame) {
    WalkFileInfo without, with;
    ASSERT_TRUE(write_walk(file, model).ok());
    ASSERT_TRUE(read_walk(file, &without).ok());
    model.losses.assign(model.reps.size(), {0.5F, {0.25F, 0.125F, 0.0F}});
    model.colours = {{0.5F, 0.25F, 0.125F}, 0.0625F};
    Sections sections = sections_of_model();
    const auto read = read_walk(file, &with);
    ASSERT_TRUE(read.ok()) << read.error().text();
    ASSERT_EQ(read->losses.size(), model.reps.size());
    EXPECT_EQ(read->losses.back().coverage, 0.5F);
    EXPECT_EQ(read->losses.back().colour, model.losses.back().colour);
    EXPECT_EQ(read->colours.mean, model.colours.mean);
    EXPECT_EQ(read->colours.variance, 0.0625F);
    EXPECT_EQ(with.hash, without.hash);
    sections.drop(losses_id);
    put(sections.file());
    const auto dropped = read_walk(file);
    ASSERT_TRUE(dropped.ok()) << dropped.error().text();
    EXPECT_TRUE(dropped->losses.empty());
}

TEST_F(OpenTable, LossesOfGroupsComeBackAndOlderFilesHaveNone) {
    model.losses.assign(model.reps.size(), {});
    const Sections older = sections_of_model();
    const std::size_t entries = LossGroups(model).size();
    ASSERT_GT(entries, 0U);
    model.group_losses.assign(entries, {{0.25F, 0.5F, 0.75F}});
    const Sections newer = sections_of_model();
    const auto read = read_walk(file);
    ASSERT_TRUE(read.ok()) << read.error().text();
    ASSERT_EQ(read->group_losses.size(), entries);
    EXPECT_EQ(read->group_losses.back().colour, model.group_losses.back().colour);
    EXPECT_EQ(newer.file().size(), older.file().size() + 8 + 12 * entries);
    put(older.file());
    const auto without = read_walk(file);
    ASSERT_TRUE(without.ok()) << without.error().text();
    EXPECT_TRUE(without->group_losses.empty());
}

TEST_F(OpenTable, LossesOfGroupsThatAreNoSharesOrTooManyAreRefused) {
    model.losses.assign(model.reps.size(), {});
    const std::size_t entries = LossGroups(model).size();
    for (const float bad : {-0.1F, 1.1F, std::numeric_limits<float>::quiet_NaN()}) {
        model.group_losses.assign(entries, {});
        model.group_losses.back().colour[1] = bad;
        ASSERT_TRUE(write_walk(file, model).ok());
        const auto read = read_walk(file);
        ASSERT_FALSE(read.ok()) << bad;
        EXPECT_NE(read.error().place.find("losses of groups"), std::string::npos) << read.error().text();
    }
    for (const std::size_t wrong : {entries - 1, entries + 1}) {
        model.group_losses.assign(wrong, {});
        ASSERT_TRUE(write_walk(file, model).ok());
        EXPECT_EQ(read_walk(file).ok(), wrong == 0) << wrong;
    }
    model.group_losses.assign(entries, {});
    model.losses.clear();
    EXPECT_FALSE(validate(model).ok()) << "losses of groups without those of forms";
}

TEST(PictureLoss, IsBetweenTheSizesByTheirLogarithm) {
    const PictureLoss loss{0, {0.4F, 0.1F, 0.2F}};  // of 512, 64 and 8 pixels
    for (const auto& [size_px, expected] : {std::pair{512.0F, 0.4F},
                                            {64.0F, 0.1F},
                                            {8.0F, 0.2F},
                                            {256.0F, 0.3F},
                                            {128.0F, 0.2F},
                                            {16.0F, 0.1F + 0.2F / 3},
                                            {1e9F, 0.4F},
                                            {0.0F, 0.2F},
                                            {-1.0F, 0.2F},
                                            {std::numeric_limits<float>::quiet_NaN(), 0.4F}})
        EXPECT_NEAR(loss_at(loss, size_px), expected, 1e-5F) << size_px;
}

TEST_F(OpenTable, LossesThatAreNoSharesAreRefused) {
    for (const float bad : {-0.1F, 1.1F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        for (std::size_t at = 0; at < 4; ++at) {
            model.losses.assign(model.reps.size(), {});
            (at == 0 ? model.losses[0].coverage : model.losses[0].colour[at - 1]) = bad;
            ASSERT_TRUE(write_walk(file, model).ok());
            const auto read = read_walk(file);
            ASSERT_FALSE(read.ok()) << bad << ' ' << at;
            EXPECT_NE(read.error().place.find("losses[0]"), std::string::npos) << read.error().text();
        }
    }
    model.losses.assign(model.reps.size() + 1, {});
    ASSERT_TRUE(write_walk(file, model).ok());
    EXPECT_FALSE(read_walk(file).ok());
    model.losses.assign(model.reps.size(), {});
    model.colours.variance = 2;
    ASSERT_TRUE(write_walk(file, model).ok());
    EXPECT_FALSE(read_walk(file).ok());
}

TEST_F(OpenTable, AMissingRequiredSectionIsAnErrorByItsName) {
    const Sections whole = sections_of_model();
    for (std::uint32_t id = 0; id < section_names.size(); ++id) {
        if (id == textures_id || id == losses_id || id == ground_id || id == tour_id || id == light_id || id == motion_id ||
            id == moving_ground_id)
            continue;
        Sections sections = whole;
        sections.drop(id);
        put(sections.file());
        const auto read = read_walk(file);
        ASSERT_FALSE(read.ok()) << section_names[id];
        EXPECT_NE(read.error().place.find(section_names[id]), std::string::npos) << read.error().text();
        EXPECT_NE(read.error().what.find("missing"), std::string::npos) << read.error().text();
    }
    Sections empty = whole;
    empty.list.clear();
    put(empty.file());
    EXPECT_FALSE(read_walk(file).ok());
}

TEST_F(OpenTable, MoreThanDrawingCanNumberIsRefusedBeforeItIsRead) {
    constexpr std::uint32_t pages_id = 0;
    struct Case {
        std::size_t at;  ///< of its bytes in the page directory
        std::uint64_t bytes;
        const char* what;
    };
    for (const Case& c : {Case{0, (std::uint64_t{1} << 31U) * sizeof(Vertex), "2147483648 vertices"},
                          Case{8, (std::uint64_t{1} << 32U) * sizeof(std::uint32_t), "4294967296 indices"}}) {
        Sections sections = sections_of_model();
        ASSERT_EQ(sections.list[0].first, pages_id);
        std::memcpy(sections.list[0].second.data() + c.at, &c.bytes, sizeof c.bytes);
        put(sections.file());
        const auto read = read_walk(file);
        ASSERT_FALSE(read.ok()) << c.what;
        EXPECT_EQ(read.error().place, file);
        EXPECT_NE(read.error().what.find(std::string("out of limits: ") + c.what), std::string::npos) << read.error().text();
        EXPECT_NE(read.error().remedy.find("several parts"), std::string::npos) << read.error().text();
    }
}

TEST_F(OpenTable, ASectionThatIsThereTwiceIsAnError) {
    Sections sections = sections_of_model();
    sections.list.push_back(sections.list[3]);
    put(sections.file());
    const auto read = read_walk(file);
    ASSERT_FALSE(read.ok());
    EXPECT_NE(read.error().place.find("parts"), std::string::npos);
    EXPECT_NE(read.error().what.find("twice"), std::string::npos);
}

// Baked while the file still kept the bake's time, and its table exactly nine sections.
TEST_F(WalkFile, AnOldOneStillOpens) {
    WalkFileInfo old, again;
    const auto read = read_walk(std::string(SUREFOOT_SOURCE_DIR) + "/tests/model/golden/yard.walk", &old);
    ASSERT_TRUE(read.ok()) << read.error().text();
    EXPECT_EQ(read->triangles(), 968U);
    EXPECT_EQ(read->nodes.size(), 8U);
    EXPECT_EQ(read->reps.size(), 19U);
    EXPECT_EQ(read->textures.size(), 1U);
    EXPECT_EQ(read->provenance.sources, std::vector<std::string>{"yard.obj"});
    EXPECT_EQ(read->provenance.quality, "draft");
    ASSERT_EQ(read->effects.size(), static_cast<std::size_t>(effect_count)) << "of those that it did not know, too";
    EXPECT_FALSE(read->effects.back().called_for);
    ASSERT_TRUE(write_walk(file, *read).ok());
    ASSERT_TRUE(read_walk(file, &again).ok());
    EXPECT_EQ(old.hash, again.hash);
    EXPECT_EQ(old.bytes, again.bytes);
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
