// The .walk file: header, payload pages, sections, section table. No offset is stored: each follows from the sizes before it.
//
//   header   magic, version, section count, file bytes, page bytes, table hash, header hash        56 bytes
//   pages    vertices, indices, texels, light of vertices, each cut at 1 MiB and packed by zstd (or kept raw)
//   sections records of one kind each, in the table's order
//   table    one entry a section: id, bytes, hash; ids that this program does not know are skipped
#include "render/model/walk_file.hpp"

#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <iterator>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "render/model/limits.hpp"
#include "render/model/walk_fields.hpp"
#include "rt/base/file.hpp"
#include "rt/base/hash.hpp"

namespace surefoot::model {

namespace {

static_assert(std::endian::native == std::endian::little, "the file is read and written as it lies in memory");

constexpr std::array<char, 8> magic = {'S', 'F', 'W', 'A', 'L', 'K', '1', '\0'};
constexpr std::uint32_t version = 1;
constexpr std::uint64_t header_bytes = 56, entry_bytes = 20;
constexpr std::uint64_t page_bytes = 1ULL << 20U;
/// No page unpacks to more than this many times its size on disk, so that a small file cannot ask for much memory.
constexpr std::uint64_t max_ratio = 256;
constexpr int compression_level = 3;

enum Section : std::uint32_t {
    pages_section,
    nodes_section,
    reps_section,
    parts_section,
    placements_section,
    materials_section,
    textures_section,
    effects_section,
    rest_section,
    losses_section,
    ground_section,
    tour_section,
    light_section,
    motion_section,
    moving_ground_section,
    section_count
};
constexpr std::array<std::string_view, section_count> section_names = {
    "pages",      "nodes",  "representations", "parts", "placements", "materials", "textures",     "effects",
    "provenance", "losses", "ground",          "tour",  "light",      "motion",    "moving ground"};
/// No model is valid without them; any other that a file has not got is empty.
constexpr bool required(std::uint32_t section) {
    return section != textures_section && section != losses_section && section != ground_section && section != tour_section &&
           section != light_section && section != motion_section && section != moving_ground_section;
}

struct PageEntry {
    std::uint32_t stored = 0;  ///< bytes on disk; equal to the unpacked size: kept raw
    std::uint64_t hash = 0;    ///< of the stored bytes
};

struct PayloadSizes {
    std::uint64_t vertices = 0, indices = 0, texels = 0, sun_seen = 0, lamp_light = 0;  ///< bytes
    [[nodiscard]] std::array<std::uint64_t, 5> all() const { return {vertices, indices, texels, sun_seen, lamp_light}; }
    [[nodiscard]] std::uint64_t sum() const { return vertices + indices + texels + sun_seen + lamp_light; }
    [[nodiscard]] bool has_light() const { return sun_seen + lamp_light > 0; }
};

std::uint64_t pages_of(std::uint64_t bytes) { return bytes / page_bytes + (bytes % page_bytes != 0 ? 1 : 0); }

template <class Archive, class EntryT>
requires std::is_same_v<std::remove_const_t<EntryT>, PageEntry>
void fields(Archive& a, EntryT& e) { a(e.stored), a(e.hash); }

template <class Archive, class Sizes, class Entries>
void page_directory(Archive& a, Sizes& sizes, Entries& entries) {
    a(sizes.vertices), a(sizes.indices), a(sizes.texels);
    a.list(entries);
}

// ---- writing ----

struct Packer {
    std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context{ZSTD_createCCtx(), ZSTD_freeCCtx};
    std::vector<std::byte> buffer = std::vector<std::byte>(ZSTD_compressBound(page_bytes));

    /// The page as it goes to disk: packed, or itself where packing gains nothing or too much (max_ratio).
    std::span<const std::byte> pack(std::span<const std::byte> page) {
        const std::size_t packed =
            ZSTD_compressCCtx(context.get(), buffer.data(), buffer.size(), page.data(), page.size(), compression_level);
        if (ZSTD_isError(packed) != 0U || packed >= page.size() || packed * max_ratio < page.size()) return page;
        return {buffer.data(), packed};
    }
};

Result<void> write_pages(AtomicFile& out, std::span<const std::byte> payload, Packer& packer, std::vector<PageEntry>& entries) {
    for (std::size_t at = 0; at < payload.size(); at += page_bytes) {
        const auto stored = packer.pack(payload.subspan(at, std::min<std::size_t>(page_bytes, payload.size() - at)));
        entries.push_back({static_cast<std::uint32_t>(stored.size()), hash_bytes(stored)});
        if (auto written = out.write(stored); !written) return written;
    }
    return {};
}

std::vector<EffectFinding> looked_for(const Model& m) {
    std::vector<EffectFinding> out;
    std::copy_if(m.effects.begin(), m.effects.end(), std::back_inserter(out),
                 [](const EffectFinding& f) { return f.looked_for; });
    // Files without the newer effects are as before there were any, and earlier programs open them. Where something moves, the
    // file says why it has no shadow.
    const std::uint32_t always = m.motions.empty() ? effect_fog : effect_moving_shadow;
    while (!out.empty() && out.back().bit > always && !out.back().called_for) out.pop_back();
    return out;
}

std::vector<walk::MovingPlacement> moving_placements(const Model& m) {
    std::vector<walk::MovingPlacement> moving;
    for (Index p = 0; p < m.placements.size(); ++p)
        if (m.placements[p].motion != none) moving.push_back({p, m.placements[p].motion});
    return moving;
}

std::vector<std::byte> section_bytes(std::uint32_t section, const Model& m, const PayloadSizes& sizes,
                                     const std::vector<PageEntry>& pages) {
    walk::PutArchive put;
    switch (section) {
        case pages_section:
            page_directory(put, sizes, pages);
            if (sizes.has_light()) put(sizes.sun_seen), put(sizes.lamp_light);
            break;
        case nodes_section:
            put.list(m.nodes);
            break;
        case reps_section:
            put.list(m.reps);
            break;
        case parts_section:
            put.list(m.parts);
            break;
        case placements_section:
            put.list(m.placements);
            break;
        case materials_section:
            put.list(m.materials);
            break;
        case textures_section:
            put.list(m.textures);
            break;
        case effects_section:
            put.list(looked_for(m));
            break;
        case losses_section:
            walk::fields(put, m.colours);
            put.list(m.losses);
            if (!m.group_losses.empty()) put.list(m.group_losses);
            break;
        case ground_section:
            walk::ground(put, m.ground);
            break;
        case tour_section:
            put(m.tour_kind), put.list(m.tour.samples);
            break;
        case light_section:
            walk::fields(put, m.light);
            break;
        case motion_section:
            put.list(m.motions), put.list(m.motion_keys), put.list(moving_placements(m));
            break;
        case moving_ground_section:
            walk::ground(put, m.moving_ground.rest);
            put.list(m.moving_ground.motions);
            break;
        default:
            walk::rest(put, m);
            break;
    }
    return std::move(put.bytes);
}

std::vector<std::byte> header(std::uint64_t file_size, std::uint64_t pages_size, std::span<const std::byte> table) {
    walk::PutArchive put;
    for (const char c : magic) put(c);
    put(version), put(static_cast<std::uint32_t>(table.size() / entry_bytes));
    put(file_size), put(pages_size), put(hash_bytes(table));
    put(std::uint64_t{0});  // room for a later version
    put(hash_bytes(put.bytes));
    return std::move(put.bytes);
}

// ---- reading ----

struct Reading {
    const std::string& file;
    std::span<const std::byte> bytes;
    std::span<const std::byte> pages;
    std::array<std::optional<std::span<const std::byte>>, section_count> sections;  ///< those that the file has
    std::uint64_t model_hash = fnv_start;

    [[nodiscard]] Error error(std::string_view where, std::string what) const {
        return {fmt::format("{}: {}", file, where), std::move(what), "Copy the file again, or bake the model again",
                ErrorKind::damaged};
    }
};

std::string name_of_section(std::uint32_t id) {
    return id < section_count ? std::string(section_names[id]) : fmt::format("section {}", id);
}

/// Sections that this program does not know are checked and skipped: whoever wrote them can do without this program reading them.
Result<void> open_sections(Reading& in, std::span<const std::byte> table, std::span<const std::byte> rest) {
    walk::TakeArchive entries{ByteReader(table)};
    std::array<std::uint64_t, section_count> hashes{};
    for (std::size_t i = 0; i < table.size() / entry_bytes; ++i) {
        std::uint32_t id = 0;
        std::uint64_t size = 0, hash = 0;
        entries(id), entries(size), entries(hash);
        if (size > rest.size()) return in.error(name_of_section(id), "The section does not fit the file");
        const auto section = rest.first(size);
        rest = rest.subspan(size);
        if (hash_bytes(section) != hash) return in.error(name_of_section(id), "The checksum does not match: the file is damaged");
        if (id >= section_count) continue;
        if (in.sections[id]) return in.error(name_of_section(id), "The section is there twice");
        in.sections[id] = section;
        hashes[id] = hash;
    }
    if (!rest.empty()) return in.error("section table", "Some bytes belong to no section");
    for (std::uint32_t id = 0; id < section_count; ++id) {
        if (required(id) && !in.sections[id]) return in.error(section_names[id], "The section is missing");
        const bool drawn = id != rest_section && id != losses_section && id != ground_section && id != tour_section &&
                           id != moving_ground_section;
        const bool newer = id >= light_section && !in.sections[id];  // files without it keep the hash that they had
        if (drawn && !newer) in.model_hash = fnv1a(in.model_hash, hashes[id]);
    }
    return {};
}

Result<void> open_header(Reading& in) {
    if (in.bytes.size() < header_bytes) return in.error("header", "The file is shorter than a header");
    walk::TakeArchive take{ByteReader(in.bytes.first(header_bytes))};
    std::array<char, 8> found{};
    for (char& c : found) take(c);
    if (found != magic)
        return Error{in.file, "The file is not a .walk model", "Bake one: surefoot bake IN... -o MODEL.walk", ErrorKind::damaged};
    std::uint32_t file_version = 0, sections = 0;
    std::uint64_t file_size = 0, pages_size = 0, table_hash = 0, spare = 0, header_hash = 0;
    take(file_version), take(sections), take(file_size), take(pages_size), take(table_hash), take(spare), take(header_hash);
    if (file_version != version) {
        return Error{in.file + ": header",
                     fmt::format("The format has version {}; this program reads version {}", file_version, version),
                     "Bake the model again with this program", ErrorKind::unsupported};
    }
    if (header_hash != hash_bytes(in.bytes.first(header_bytes - 8)))
        return in.error("header", "The checksum does not match: the file is damaged");
    if (file_size != in.bytes.size()) {
        return in.error("header", fmt::format("The header announces {} bytes, and the file has {}: it is truncated or grown",
                                              file_size, in.bytes.size()));
    }
    const std::uint64_t table_size = sections * entry_bytes, room = in.bytes.size() - header_bytes;
    if (spare != 0 || room < table_size || pages_size > room - table_size) {
        return in.error("header", "The sizes do not fit the file");
    }
    const auto table = in.bytes.last(table_size);
    if (hash_bytes(table) != table_hash) return in.error("section table", "The checksum does not match: the file is damaged");
    in.pages = in.bytes.subspan(header_bytes, pages_size);
    return open_sections(in, table, in.bytes.subspan(header_bytes + pages_size, room - table_size - pages_size));
}

/// False: a placement is not there, or named out of order.
bool take_moving(walk::TakeArchive& take, Model& m) {
    take.list(m.motions), take.list(m.motion_keys);
    std::vector<walk::MovingPlacement> moving;
    take.list(moving);
    Index next = 0;
    for (const walk::MovingPlacement& one : moving) {
        if (take.failed() || one.placement < next || one.placement >= m.placements.size()) return false;
        m.placements[one.placement].motion = one.motion;
        next = one.placement + 1;
    }
    return true;
}

Result<void> take_section(const Reading& in, std::uint32_t section, Model& m, PayloadSizes& sizes,
                          std::vector<PageEntry>& pages) {
    if (!in.sections[section]) return {};
    walk::TakeArchive take{ByteReader(*in.sections[section])};
    switch (section) {
        case pages_section:
            page_directory(take, sizes, pages);
            if (take.reader.left() != 0) take(sizes.sun_seen), take(sizes.lamp_light);  // most files end here
            break;
        case nodes_section:
            take.list(m.nodes);
            break;
        case reps_section:
            take.list(m.reps);
            break;
        case parts_section:
            take.list(m.parts);
            break;
        case placements_section:
            take.list(m.placements);
            break;
        case materials_section:
            take.list(m.materials);
            break;
        case textures_section:
            take.list(m.textures);
            break;
        case effects_section:
            take.list(m.effects);
            if (m.effects.size() < static_cast<std::size_t>(first_effect_count)) break;  // validate() refuses it
            for (auto e = m.effects.size(); e < static_cast<std::size_t>(effect_count); ++e)
                m.effects.push_back({1U << e, false, 0,
                                     1U << e > effect_fog ? "nothing calls for it, or an older bake did not look for it"
                                                          : "an older bake did not look for it",
                                     false});
            break;
        case losses_section:
            walk::fields(take, m.colours);
            take.list(m.losses);
            if (take.reader.left() != 0) take.list(m.group_losses);  // older files end here
            break;
        case ground_section:
            walk::ground(take, m.ground);
            break;
        case tour_section:
            take(m.tour_kind), take.list(m.tour.samples);
            break;
        case light_section:
            walk::fields(take, m.light);
            break;
        case motion_section:
            if (!take_moving(take, m)) return in.error(section_names[section], "A placement is out of range, or out of order");
            break;
        case moving_ground_section:
            walk::ground(take, m.moving_ground.rest);
            take.list(m.moving_ground.motions);
            break;
        default:
            walk::rest(take, m);
            break;
    }
    if (take.failed() || take.reader.left() != 0)
        return in.error(section_names[section], "The records do not fill the section exactly");
    return {};
}

Result<void> unpack_page(const Reading& in, std::span<const std::byte> stored, std::span<std::byte> out, std::size_t number) {
    if (stored.size() == out.size()) {
        std::memcpy(out.data(), stored.data(), out.size());
        return {};
    }
    const std::size_t size = ZSTD_decompress(out.data(), out.size(), stored.data(), stored.size());
    if (ZSTD_isError(size) != 0U || size != out.size())
        return in.error(fmt::format("page {}", number), "The page does not unpack");
    return {};
}

/// Checks every page's place, hash and ratio before anything is allocated for it.
Result<void> check_pages(const Reading& in, const PayloadSizes& sizes, const std::vector<PageEntry>& pages) {
    std::uint64_t count = 0;
    for (const std::uint64_t bytes : sizes.all()) count += pages_of(bytes);
    if (count != pages.size() || sizes.vertices % sizeof(Vertex) != 0 || sizes.indices % sizeof(std::uint32_t) != 0 ||
        sizes.sun_seen % sizeof(SunSeen) != 0 || sizes.lamp_light % sizeof(LampLight) != 0) {
        return in.error("pages", "The sizes in the directory and of the pages disagree");
    }
    std::size_t number = 0;
    auto rest = in.pages;
    for (const std::uint64_t bytes : sizes.all()) {
        for (std::uint64_t at = 0; at < bytes; at += page_bytes, ++number) {
            const PageEntry& page = pages[number];
            const std::uint64_t unpacked = std::min(page_bytes, bytes - at);
            const std::string where = fmt::format("page {}", number);
            if (page.stored == 0 || page.stored > unpacked || page.stored > rest.size() || unpacked > page.stored * max_ratio) {
                return in.error(where, "The size is out of bounds");
            }
            if (hash_bytes(rest.first(page.stored)) != page.hash)
                return in.error(where, "The checksum does not match: the file is damaged");
            rest = rest.subspan(page.stored);
        }
    }
    if (!rest.empty()) return in.error("pages", "Some bytes belong to no page");
    return {};
}

Result<void> unpack(const Reading& in, std::span<std::byte> out, const std::vector<PageEntry>& pages, std::size_t& number,
                    std::uint64_t& at) {
    for (std::size_t done = 0; done < out.size(); done += page_bytes, ++number) {
        const auto target = out.subspan(done, std::min<std::size_t>(page_bytes, out.size() - done));
        if (auto page = unpack_page(in, in.pages.subspan(at, pages[number].stored), target, number); !page) return page;
        at += pages[number].stored;
    }
    return {};
}

}  // namespace

Result<WalkFileInfo> write_walk(const std::string& file, const Model& model) {
    auto created = AtomicFile::create(file);
    if (!created) return created.error();
    AtomicFile& out = *created;
    const std::vector<std::byte> blank(header_bytes);
    if (auto written = out.write(blank); !written) return written.error();

    Packer packer;
    std::vector<PageEntry> pages;
    const std::array payloads = {std::as_bytes(std::span(model.vertices)), std::as_bytes(std::span(model.indices)),
                                 std::span<const std::byte>(model.texels), std::as_bytes(std::span(model.sun_seen)),
                                 std::as_bytes(std::span(model.lamp_light))};
    for (const auto payload : payloads) {
        if (auto written = write_pages(out, payload, packer, pages); !written) return written.error();
    }
    std::uint64_t pages_size = 0;
    for (const PageEntry& page : pages) pages_size += page.stored;

    const PayloadSizes sizes{payloads[0].size(), payloads[1].size(), payloads[2].size(), payloads[3].size(), payloads[4].size()};
    std::uint64_t file_size = header_bytes + pages_size;
    walk::PutArchive table;
    for (std::uint32_t section = 0; section < section_count; ++section) {
        if (section == losses_section && model.losses.empty()) continue;
        if (section == ground_section && model.ground.empty()) continue;
        if (section == tour_section && model.tour.samples.empty()) continue;
        if (section == light_section && model.light == LightFacts{}) continue;
        if (section == motion_section && model.motions.empty()) continue;
        if (section == moving_ground_section && model.moving_ground.empty()) continue;
        const auto bytes = section_bytes(section, model, sizes, pages);
        table(section), table(static_cast<std::uint64_t>(bytes.size())), table(hash_bytes(bytes));
        if (auto written = out.write(bytes); !written) return written.error();
        file_size += bytes.size();
    }
    file_size += table.bytes.size();
    if (auto written = out.write(table.bytes); !written) return written.error();
    if (auto written = out.write_at(0, header(file_size, pages_size, table.bytes)); !written) return written.error();
    if (auto committed = out.commit(); !committed) return committed.error();
    return WalkFileInfo{file_size, sizes.sum(), static_cast<std::uint32_t>(pages.size())};
}

Result<Model> read_walk(const std::string& file, WalkFileInfo* info) {
    auto bytes = read_file(file);
    if (!bytes) return bytes.error();
    Reading in{file, *bytes, {}, {}};
    if (auto opened = open_header(in); !opened) return opened.error();

    Model model;
    PayloadSizes sizes;
    std::vector<PageEntry> pages;
    for (std::uint32_t section = 0; section < section_count; ++section) {
        if (auto taken = take_section(in, section, model, sizes, pages); !taken) return taken.error();
    }
    Counts counts = counts_of(model);
    counts.vertices = sizes.vertices / sizeof(Vertex);
    counts.indices = sizes.indices / sizeof(std::uint32_t);
    if (auto fits = check_limits(counts, file); !fits) return fits.error();
    if (auto checked = check_pages(in, sizes, pages); !checked) return checked.error();
    model.vertices.resize(sizes.vertices / sizeof(Vertex));
    model.indices.resize(sizes.indices / sizeof(std::uint32_t));
    model.texels.resize(sizes.texels);
    model.sun_seen.resize(sizes.sun_seen / sizeof(SunSeen));
    model.lamp_light.resize(sizes.lamp_light / sizeof(LampLight));
    std::size_t number = 0;
    std::uint64_t at = 0;
    for (const auto out : {std::as_writable_bytes(std::span(model.vertices)), std::as_writable_bytes(std::span(model.indices)),
                           std::span<std::byte>(model.texels), std::as_writable_bytes(std::span(model.sun_seen)),
                           std::as_writable_bytes(std::span(model.lamp_light))}) {
        if (auto unpacked = unpack(in, out, pages, number, at); !unpacked) return unpacked.error();
    }
    if (auto valid = validate(model); !valid) {
        return Error{fmt::format("{}: {}", file, valid.error().place), valid.error().what, valid.error().remedy,
                     valid.error().kind};
    }
    index_instances(model.ground);
    index_moving_ground(model);
    if (info != nullptr) *info = {bytes->size(), sizes.sum(), static_cast<std::uint32_t>(pages.size()), in.model_hash};
    return model;
}

}  // namespace surefoot::model
