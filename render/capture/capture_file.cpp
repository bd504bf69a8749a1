// The file form of a captured frame: written field by field, read by a bounded reader that trusts no count and no index.
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include <fmt/format.h>

#include "render/capture/capture.hpp"
#include "render/prepare/value.hpp"
#include "rt/base/file.hpp"
#include "rt/base/hash.hpp"
#include "rt/base/reader.hpp"

namespace surefoot::capture {

namespace {

using model::Index;
using model::none;

constexpr std::uint32_t magic = 0x50434653;  // "SFCP"
constexpr std::uint32_t version = 8, version_without_acuity = 7, version_without_guarantee = 6, version_without_reserve = 5,
                        version_without_items = 4, version_without_values = 3;
constexpr std::uint64_t max_bytes = 1ULL << 31U;  // unpacked
constexpr std::uint32_t max_nodes = 1U << 26U;    // replay makes room for them
constexpr std::size_t header_bytes = 40;
constexpr const char* remedy = "Capture the frame again";

// One list of fields for both directions: what is written is what is read.
template <class Io, class Frame>
void each_field(Io& io, Frame& f) {
    io(f.frame, f.region.centre.position.x, f.region.centre.position.y, f.region.centre.position.z, f.region.centre.orientation.w,
       f.region.centre.orientation.x, f.region.centre.orientation.y, f.region.centre.orientation.z, f.region.centre.fov_y_rad,
       f.region.radius_m, f.region.angle_rad, f.viewport.width, f.viewport.height, f.viewport.shift_x, f.viewport.shift_y,
       f.visits, f.truncated, f.full_cost.submit_us, f.full_cost.raster_us, f.target_error_rad, f.cpu_us, f.wall_us);
    if (io.has_values) io(f.resolution, f.full_value);
    if (io.has_acuity) io(f.acuity_rad);
}
template <class Io, class C>
void each_setting(Io& io, C& c) {
    io(c.frame, c.budget_us, c.correction, c.target_error_rad, c.slice_us, c.combine.fixed_us, c.combine.submit_weight,
       c.combine.raster_weight, c.combine.max_weight, c.headroom, c.slice_end_us, c.hysteresis, c.node_count, c.hash,
       c.predicted_us);
    if (io.has_values) io(c.enlarge_ns_per_pixel);
    if (io.has_reserve) io(c.reserve_share);
    if (io.has_guarantee) io(c.max_error_rad);
}
template <class Io, class C>
void each(Io& io, C& c) requires std::is_same_v<std::remove_const_t<C>, prepare::Candidate> {
    io(c.node, c.parent, c.first_child, c.child_count, c.first_choice, c.choice_count, c.children_cost.submit_us,
       c.children_cost.raster_us, c.floor_cost.submit_us, c.floor_cost.raster_us, c.pixels, c.floor_open);
    if (io.has_guarantee) io(c.importance);
}
template <class Io, class C>
void each(Io& io, C& c) requires std::is_same_v<std::remove_const_t<C>, prepare::Choice> {
    io(c.rep, c.cost.submit_us, c.cost.raster_us, c.error_rad, c.benefit, c.subtree_benefit, c.triangles);
    if (io.has_values) io(c.value, c.rate);
}
template <class Io, class M>
void each(Io& io, M& m) requires std::is_same_v<std::remove_const_t<M>, select::Shown> {
    io(m.node, m.form);
}
template <class Io, class I>
void each(Io& io, I& i) requires std::is_same_v<std::remove_const_t<I>, select::CutItem> {
    io(i.candidate, i.node, i.rep, i.choice);
}

template <class Io, class I>
void each(Io& io, I& i) requires std::is_same_v<std::remove_const_t<I>, select::Item> {
    io(i.kind, i.what, i.cost_us, i.value, i.prepaid);
}
template <class Io, class N>
void each(Io& io, N& n) requires std::is_same_v<std::remove_const_t<N>, select::ItemName> {
    io(n.kind, n.what);
}

class Writer {
public:
    template <class... T>
    void operator()(const T&... values) {
        (put(values), ...);
    }
    template <class T>
    void list(const std::vector<T>& items) {
        put(static_cast<std::uint32_t>(items.size()));
        for (const T& item : items) each(*this, item);
    }
    void text(const std::string& s) {
        put(static_cast<std::uint32_t>(s.size()));
        const auto bytes = std::as_bytes(std::span(s));
        out.insert(out.end(), bytes.begin(), bytes.end());
    }
    static constexpr bool has_values = true, has_items = true, has_reserve = true, has_guarantee = true, has_acuity = true;
    std::vector<std::byte> out;

private:
    void put(bool value) { put(static_cast<std::uint8_t>(value)); }
    template <class T>
    void put(const T& value) {
        const auto bytes = std::as_bytes(std::span(&value, 1));
        out.insert(out.end(), bytes.begin(), bytes.end());
    }
};

class Reader {
public:
    Reader(std::span<const std::byte> bytes, std::uint32_t file_version)
        : in(bytes),
          has_values(file_version > version_without_values),
          has_items(file_version > version_without_items),
          has_reserve(file_version > version_without_reserve),
          has_guarantee(file_version > version_without_guarantee),
          has_acuity(file_version > version_without_acuity) {}
    template <class... T>
    void operator()(T&... values) {
        (get(values), ...);
    }
    // Every item takes at least four bytes: a count beyond what is left is refused before anything is allocated.
    template <class T>
    void list(std::vector<T>& items) {
        const auto count = in.read<std::uint32_t>();
        if (in.failed() || count > in.left() / 4) {
            in.skip(in.left() + 1);
            return;
        }
        items.resize(count);
        for (T& item : items) each(*this, item);
    }
    void text(std::string& s) {
        const auto bytes = in.bytes(in.read<std::uint32_t>());
        s.assign(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    ByteReader in;
    bool has_values;  ///< whether choices have values and rates
    bool has_items;   ///< whether it holds what was offered beside forms
    bool has_reserve;
    bool has_guarantee;  ///< whether it holds importance and the guaranteed error
    bool has_acuity;

private:
    void get(bool& value) { value = in.read<std::uint8_t>() != 0; }
    template <class T>
    void get(T& value) {
        value = in.read<T>();
    }
};

template <class Io, class C>
void whole(Io& io, C& c) {
    each_field(io, c.prepared);
    each_setting(io, c);
    io.text(c.selector);
    io.list(c.prepared.candidates);
    io.list(c.prepared.choices);
    io.list(c.memory);
    io.list(c.items);
    if (!io.has_items) return;
    io.list(c.offered);
    io.list(c.bought_before);
}

bool finite(const model::ItemCost& cost) { return std::isfinite(cost.submit_us) && std::isfinite(cost.raster_us); }

const char* wrong_in(const prepare::Candidate& c, std::size_t at, std::size_t& next_child, const Capture& capture) {
    const auto& f = capture.prepared;
    if (c.node >= capture.node_count) return "node out of range";
    if (!(c.importance >= 0.0F && c.importance <= 1.0F)) return "importance out of range";
    if (c.choice_count == 0 || c.first_choice > f.choices.size() || c.choice_count > f.choices.size() - c.first_choice) {
        return "choices out of range";
    }
    if (at == 0 ? c.parent != none : c.parent >= at) return "parent is not before the child";
    if (c.child_count == 0) return c.first_child == none && !c.floor_open ? nullptr : "a leaf with children";
    // Breadth-first: children follow those of the candidate before, so no candidate has two parents and none is left out.
    if (c.first_child != next_child || c.child_count > f.candidates.size() - next_child) return "children out of order";
    next_child += c.child_count;
    for (Index k = c.first_child; k < next_child; ++k) {
        if (f.candidates[k].parent != at) return "a child has another parent";
    }
    return finite(c.children_cost) && finite(c.floor_cost) ? nullptr : "cost is not finite";
}

Result<void> check(const Capture& c, const std::string& place) {
    const auto bad = [&](std::string_view what) { return Error{place, std::string(what), remedy, ErrorKind::damaged}; };
    if (c.node_count == 0 || c.node_count > max_nodes) return bad("The number of nodes is out of range");
    if (!(c.hysteresis >= 1.0F && c.hysteresis <= 16.0F)) return bad("The hysteresis is out of range");
    if (!(c.max_error_rad >= 0.0)) return bad("The guaranteed error is out of range");
    if (!(c.prepared.acuity_rad >= 0.0 && c.prepared.acuity_rad <= 1.0)) return bad("The acuity is out of range");
    if (!(c.reserve_share >= 0.0F && c.reserve_share <= 1.0F)) return bad("The reserve is out of range");
    const auto& f = c.prepared;
    std::size_t next_child = 1;
    for (std::size_t i = 0; i < f.candidates.size(); ++i) {
        if (next_child <= i) return bad(fmt::format("Candidate {} has no parent", i));
        if (const char* what = wrong_in(f.candidates[i], i, next_child, c))
            return bad(fmt::format("Candidate {} is damaged: {}", i, what));
    }
    for (std::size_t i = 0; i < f.choices.size(); ++i) {
        if (!finite(f.choices[i].cost)) return bad(fmt::format("The cost of choice {} is not finite", i));
    }
    if (items_of(c).offered().size() != c.offered.size()) return bad("An item is unsound");
    if (c.bought_before.size() > select::ItemList::capacity) return bad("Too many items are remembered");
    const auto known = [](const auto& i) { return static_cast<std::size_t>(i.kind) < select::item_kind_names.size(); };
    if (!std::all_of(c.offered.begin(), c.offered.end(), known) ||
        !std::all_of(c.bought_before.begin(), c.bought_before.end(), known))
        return bad("The kind of an item is unknown");
    for (const select::Shown& m : c.memory) {
        if (m.node >= c.node_count) return bad("A remembered node is out of range");
    }
    for (const select::CutItem& item : c.items) {
        if (item.candidate >= f.candidates.size() || item.choice >= f.choices.size()) return bad("The cut is out of range");
    }
    return {};
}

}  // namespace

Result<void> write_capture(const std::string& file, const Capture& capture) {
    Writer body;
    whole(body, capture);
    std::vector<std::byte> packed(ZSTD_compressBound(body.out.size()));
    const std::size_t size = ZSTD_compress(packed.data(), packed.size(), body.out.data(), body.out.size(), 3);
    if (ZSTD_isError(size) != 0)
        return Error{file, std::string("The frame cannot be compressed: ") + ZSTD_getErrorName(size), "Free some memory",
                     ErrorKind::no_memory};
    packed.resize(size);
    Writer out;
    out(magic, version, static_cast<std::uint64_t>(body.out.size()), static_cast<std::uint64_t>(size), hash_bytes(packed));
    out(hash_bytes(out.out));
    out.out.insert(out.out.end(), packed.begin(), packed.end());
    return write_file(file, out.out);
}

Result<Capture> parse_capture(std::span<const std::byte> bytes, const std::string& place) {
    ByteReader header(bytes);
    if (header.read<std::uint32_t>() != magic)
        return Error{place, "The file is no captured frame", "Name a file that `surefoot walk --capture` wrote",
                     ErrorKind::damaged};
    const auto file_version = header.read<std::uint32_t>();
    if (file_version < version_without_values || file_version > version)
        return Error{place, "The file is of another version", remedy, ErrorKind::unsupported};
    const auto unpacked = header.read<std::uint64_t>(), packed = header.read<std::uint64_t>(), sum = header.read<std::uint64_t>();
    const auto header_sum = header.read<std::uint64_t>();
    if (header.failed() || hash_bytes(bytes.first(header_bytes - 8)) != header_sum)
        return Error{place, "The header is damaged", remedy, ErrorKind::damaged};
    if (header.left() != packed)
        return Error{place, "The file is truncated, or has bytes after its end", remedy, ErrorKind::damaged};
    const auto payload = header.bytes(packed);
    if (hash_bytes(payload) != sum) return Error{place, "The checksum does not match", remedy, ErrorKind::damaged};
    if (unpacked > max_bytes) return Error{place, "The frame is too large", remedy, ErrorKind::out_of_limits};
    std::vector<std::byte> body(unpacked);
    const std::size_t got = ZSTD_decompress(body.data(), body.size(), payload.data(), payload.size());
    if (ZSTD_isError(got) != 0 || got != unpacked) return Error{place, "The frame does not unpack", remedy, ErrorKind::damaged};
    Capture capture;
    Reader reader(body, file_version);
    whole(reader, capture);
    if (reader.in.failed() || reader.in.left() != 0)
        return Error{place, "The lists do not add up to the size", remedy, ErrorKind::damaged};
    if (auto sound = check(capture, place); !sound) return sound.error();
    if (!reader.has_values) prepare::estimate_values(capture.combine, capture.prepared);
    return capture;
}

Result<Capture> read_capture(const std::string& file) {
    auto bytes = read_file(file, max_bytes);
    if (!bytes) return bytes.error();
    return parse_capture(*bytes, file);
}

}  // namespace surefoot::capture
