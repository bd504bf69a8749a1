// Reads report descriptors item by item: global and local state, collections, and fields placed bit by bit.
#include "input/hid/descriptor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "input/hid/item.hpp"

namespace surefoot::input {

namespace {

/// HID 1.11, 6.2.2.7. PUSH and POP save and restore it whole, report id included.
struct Globals {
    std::uint32_t usage_page = 0;
    std::int32_t logical_min = 0, logical_max = 0, physical_min = 0, physical_max = 0;
    std::int32_t exponent = 0;
    std::uint32_t unit = 0, size = 0, count = 0, report_id = 0;
};

/// HID 1.11, 6.2.2.8. Forgotten after every main item, collections included. Its runs are the tail of Layout::runs.
struct Locals {
    std::uint32_t first_run = 0;
    std::uint32_t usages = 0;
    std::uint32_t minimum = 0;
    std::uint32_t delimiter_offset = 0;
    std::uint32_t alternatives = 0;  ///< delimited sets seen; only the first counts
    bool delimited = false;
};

class DescriptorParser {
public:
    DescriptorParser(std::span<const std::byte> bytes, Layout& layout) : bytes_(bytes), layout_(layout) {
        for (auto& kind : report_index_) kind.fill(no_report);
    }

    std::optional<Refusal> run();

private:
    using Outcome = std::optional<Refusal>;
    static constexpr std::uint16_t no_report = 0xffff;

    Outcome main_item(const Item& item);
    Outcome global_item(const Item& item);
    Outcome local_item(const Item& item);
    Outcome usage_range(const Item& item);
    Outcome open_collection(const Item& item);
    Outcome add_field(const Item& item, ReportKind kind);
    Outcome add_usages(const Item& item, std::uint32_t first, std::uint32_t count);
    void apply_last_usage_page();
    Report& report_of(ReportKind kind);
    Outcome at_end() const;

    [[nodiscard]] static Refusal refuse(const Item& item, std::string what, std::string remedy = device_is_broken) {
        return {item.offset, std::move(what), std::move(remedy)};
    }
    void add_note(std::uint32_t offset, std::string what) {
        ++layout_.note_count;
        if (layout_.notes.size() < max_notes) layout_.notes.push_back({offset, std::move(what)});
    }
    [[nodiscard]] std::uint32_t innermost() const { return open_.empty() ? no_collection : open_.back(); }

    static constexpr const char* device_is_broken = "Ask its maker for new firmware: no operating system reads this device";

    std::span<const std::byte> bytes_;
    Layout& layout_;
    Globals globals_;
    Locals locals_;
    std::vector<Globals> pushed_;
    std::vector<std::uint32_t> open_;  ///< collections, outermost first
    std::array<std::array<std::uint16_t, 256>, 3> report_index_{};
};

std::optional<Refusal> DescriptorParser::run() {
    if (bytes_.empty()) return Refusal{0, "The descriptor is empty", "Read it again from the device's report_descriptor"};
    if (bytes_.size() > max_descriptor_bytes) {
        return Refusal{max_descriptor_bytes,
                       fmt::format("The descriptor has {} bytes; at most {} are read", bytes_.size(), max_descriptor_bytes),
                       "Check that this is a report descriptor"};
    }
    std::uint32_t at = 0;
    while (at < bytes_.size()) {
        const Item item = fetch_item(bytes_, at);
        if (item.long_form) return refuse(item, "A long item stands here; HID defines none");
        if (item.cut_off) {
            return refuse(item, fmt::format("An item of {} bytes is cut off: {} are left", item.size + 1, bytes_.size() - at),
                          "Read the descriptor again: it is incomplete");
        }
        Outcome wrong;
        switch (item.type) {
            case ItemType::main:
                wrong = main_item(item);
                break;
            case ItemType::global:
                wrong = global_item(item);
                break;
            case ItemType::local:
                wrong = local_item(item);
                break;
            case ItemType::reserved:
                add_note(item.offset, "An item of a reserved type is ignored");
                break;
        }
        if (wrong) return wrong;
        at += item.size + 1;
    }
    return at_end();
}

DescriptorParser::Outcome DescriptorParser::at_end() const {
    if (!open_.empty()) {
        return Refusal{layout_.collections[open_.back()].offset,
                       fmt::format("The collection opened here is not closed by the descriptor's end, byte {}", bytes_.size()),
                       device_is_broken};
    }
    if (locals_.delimited) {
        return Refusal{locals_.delimiter_offset,
                       fmt::format("The delimiter opened here is not closed by the descriptor's end, byte {}", bytes_.size()),
                       device_is_broken};
    }
    return std::nullopt;
}

/// A usage of 1 or 2 bytes takes the usage page of the *main* item (6.2.2.8). As the kernel reads it: the page is taken
/// where the usage stands; a page item between the last usage and the main item moves the usages, from the last one
/// back to the first that has that page already.
void DescriptorParser::apply_last_usage_page() {
    for (std::size_t i = layout_.runs.size(); i-- > locals_.first_run;) {
        UsageRun& run = layout_.runs[i];
        if (run.extended) continue;
        if (run.page == globals_.usage_page) break;
        run.page = static_cast<std::uint16_t>(globals_.usage_page);
    }
}

DescriptorParser::Outcome DescriptorParser::main_item(const Item& item) {
    apply_last_usage_page();
    Outcome wrong;
    bool kept = false;
    switch (item.tag) {
        case tag::input:
        case tag::output:
        case tag::feature: {
            const auto fields = layout_.fields.size();
            wrong = add_field(item, item.tag == tag::input    ? ReportKind::input
                                    : item.tag == tag::output ? ReportKind::output
                                                              : ReportKind::feature);
            kept = layout_.fields.size() > fields;
            break;
        }
        case tag::collection:
            wrong = open_collection(item);
            break;
        case tag::end_collection:
            if (open_.empty())
                wrong = refuse(item, "A collection is closed that was never opened");
            else
                open_.pop_back();
            break;
        default:
            add_note(item.offset, fmt::format("An unknown main item (tag {}) is ignored", item.tag));
    }
    if (locals_.delimited) add_note(item.offset, "A main item stands inside an open delimiter and ends it");
    if (!kept) layout_.runs.resize(locals_.first_run);
    locals_ = {};
    locals_.first_run = static_cast<std::uint32_t>(layout_.runs.size());
    return wrong;
}

DescriptorParser::Outcome DescriptorParser::open_collection(const Item& item) {
    Collection c;
    c.usage = locals_.usages > 0 ? layout_.runs[locals_.first_run].at(0) : 0;
    c.parent = innermost();
    c.level = static_cast<std::uint16_t>(open_.size());
    c.offset = static_cast<std::uint16_t>(item.offset);
    c.type = static_cast<std::uint8_t>(item.unsigned_value() & 0xffU);
    open_.push_back(static_cast<std::uint32_t>(layout_.collections.size()));
    layout_.collections.push_back(c);
    // Depth is not refused: parents are indexes in a flat array, so depth costs nothing, and the kernel has no limit.
    if (open_.size() == 65) add_note(item.offset, "Collections are nested more than 64 deep");
    return std::nullopt;
}

Report& DescriptorParser::report_of(ReportKind kind) {
    auto& index = report_index_[static_cast<std::size_t>(kind)][globals_.report_id];
    if (index == no_report) {
        index = static_cast<std::uint16_t>(layout_.reports.size());
        layout_.reports.push_back({kind, static_cast<std::uint8_t>(globals_.report_id), 0, 0});
        if (globals_.report_id != 0) layout_.numbered[static_cast<std::size_t>(kind)] = true;
    }
    return layout_.reports[index];
}

DescriptorParser::Outcome DescriptorParser::add_field(const Item& item, ReportKind kind) {
    const Globals& g = globals_;
    const bool empty_range = g.logical_min < 0
                                 ? g.logical_max < g.logical_min
                                 : static_cast<std::uint32_t>(g.logical_max) < static_cast<std::uint32_t>(g.logical_min);
    if (empty_range) {
        return refuse(item, fmt::format("The logical range is reversed: {} to {}", g.logical_min, g.logical_max));
    }
    Report& report = report_of(kind);
    const std::uint32_t bit_offset = report.bits;
    report.bits += g.size * g.count;  // at most 256 * 12288: no overflow
    if (report.bits > max_report_bits) {
        return refuse(
            item, fmt::format("Report {} grows to {} bits; at most {} are possible", g.report_id, report.bits, max_report_bits));
    }
    if (locals_.usages == 0) return std::nullopt;  // padding
    if (report.fields == max_fields_per_report) {
        add_note(item.offset, fmt::format("Report {} has more than {} fields; this field and later ones give no control",
                                          g.report_id, max_fields_per_report));
        return std::nullopt;
    }
    ++report.fields;
    Field f;
    f.kind = kind;
    f.report_id = static_cast<std::uint8_t>(g.report_id);
    f.offset = static_cast<std::uint16_t>(item.offset);
    f.bit_offset = bit_offset;
    f.size = g.size;
    f.count = g.count;
    f.flags = item.unsigned_value();
    f.logical_min = g.logical_min;
    f.logical_max = g.logical_max;
    f.physical_min = g.physical_min;
    f.physical_max = g.physical_max;
    f.unit = g.unit;
    f.exponent = g.exponent;
    f.first_run = locals_.first_run;
    f.run_count = static_cast<std::uint32_t>(layout_.runs.size()) - locals_.first_run;
    f.usages = std::max(locals_.usages, g.count);
    f.collection = innermost();
    if (f.collection == no_collection) add_note(item.offset, "A field outside every collection gives no control");
    if (g.size == 0 || g.count == 0) add_note(item.offset, "A field without bits gives no control");
    if (g.size > 32) add_note(item.offset, fmt::format("Elements of {} bits give no control; at most 32 are read", g.size));
    if (g.logical_min >= 0 && g.logical_max < 0 && !f.constant()) {
        add_note(item.offset, fmt::format("A range reaches {}; above 2147483647 only buttons give a control",
                                          static_cast<std::uint32_t>(g.logical_max)));
    }
    layout_.fields.push_back(f);
    return std::nullopt;
}

DescriptorParser::Outcome DescriptorParser::global_item(const Item& item) {
    Globals& g = globals_;
    const std::uint32_t u = item.unsigned_value();
    const std::int32_t s = item.signed_value();
    switch (item.tag) {
        case tag::usage_page:
            g.usage_page = u;
            break;
        case tag::logical_minimum:
            g.logical_min = s;
            break;
        // Makers write 25 FF for 255: a maximum is signed only where the minimum, as it stands then, is below zero.
        case tag::logical_maximum:
            g.logical_max = g.logical_min < 0 ? s : static_cast<std::int32_t>(u);
            break;
        case tag::physical_minimum:
            g.physical_min = s;
            break;
        case tag::physical_maximum:
            g.physical_max = g.physical_min < 0 ? s : static_cast<std::int32_t>(u);
            break;
        // By the book a nibble in two's complement; many makers write a whole signed number. Both are told apart by size.
        case tag::unit_exponent:
            g.exponent = s >= 8 && s <= 15 ? s - 16 : s;
            break;
        case tag::unit:
            g.unit = u;
            break;
        case tag::report_size:
            if (u > max_report_size)
                return refuse(item, fmt::format("An element has {} bits; at most {} are possible", u, max_report_size));
            g.size = u;
            break;
        case tag::report_count:
            if (u > max_usages)
                return refuse(item, fmt::format("A field has {} elements; at most {} are possible", u, max_usages));
            g.count = u;
            break;
        case tag::report_id:
            if (u == 0 || u > 255) return refuse(item, fmt::format("The report id is {}; ids are 1 to 255", u));
            g.report_id = u;
            break;
        case tag::push:
            if (pushed_.size() == max_push_depth)
                return refuse(item, fmt::format("More than {} PUSH items are open", max_push_depth));
            pushed_.push_back(g);
            break;
        case tag::pop:
            if (pushed_.empty()) return refuse(item, "A POP has no PUSH before it");
            g = pushed_.back();
            pushed_.pop_back();
            break;
        default:
            return refuse(item, fmt::format("A global item is unknown (tag {})", item.tag));
    }
    return std::nullopt;
}

DescriptorParser::Outcome DescriptorParser::add_usages(const Item& item, std::uint32_t first, std::uint32_t count) {
    if (count == 0) return std::nullopt;
    if (locals_.usages + count > max_usages) return refuse(item, fmt::format("A field has more than {} usages", max_usages));
    locals_.usages += count;
    layout_.runs.push_back({first, count, static_cast<std::uint16_t>(globals_.usage_page), item.size > 2});
    return std::nullopt;
}

/// Minimum and maximum. The sums wrap in 32 bits as the kernel's do, so that absurd ranges end the same.
DescriptorParser::Outcome DescriptorParser::usage_range(const Item& item) {
    const std::uint32_t minimum = locals_.minimum;
    std::uint32_t maximum = item.unsigned_value();
    if (maximum - minimum + locals_.usages >= max_usages) {
        maximum = max_usages - locals_.usages + minimum - 1;
        if (maximum == 0) return refuse(item, fmt::format("A field has more than {} usages", max_usages));
        if (maximum != 0xffffffffU)
            add_note(item.offset, fmt::format("A range of usages is cut: a field holds at most {}", max_usages));
    }
    if (maximum == 0xffffffffU) return refuse(item, "A range of usages has no end");
    return maximum < minimum ? std::nullopt : add_usages(item, minimum, maximum - minimum + 1);
}

DescriptorParser::Outcome DescriptorParser::local_item(const Item& item) {
    const std::uint32_t u = item.unsigned_value();
    if (item.tag == tag::delimiter) {
        if (u != 0) {
            if (locals_.delimited) return refuse(item, "A delimiter stands inside a delimiter");
            locals_.delimited = true;
            locals_.delimiter_offset = item.offset;
            ++locals_.alternatives;
        } else {
            if (!locals_.delimited) return refuse(item, "A delimiter is closed that was never opened");
            locals_.delimited = false;
        }
        return std::nullopt;
    }
    // Of alternative usages the first set is taken, as the kernel does; what stood before it counts for all sets.
    const bool ignored = locals_.alternatives > 1;
    switch (item.tag) {
        case tag::usage:
            return ignored ? std::nullopt : add_usages(item, u, 1);
        case tag::usage_minimum:
            if (!ignored) locals_.minimum = u;
            break;
        case tag::usage_maximum:
            return ignored ? std::nullopt : usage_range(item);
        default:
            break;  // designators and strings do not touch the layout
    }
    return std::nullopt;
}

}  // namespace

std::optional<Refusal> parse_descriptor(std::span<const std::byte> bytes, Layout& layout) {
    layout = {};
    return DescriptorParser(bytes, layout).run();
}

Result<Layout> read_descriptor(std::span<const std::byte> bytes, const std::string& place) {
    Layout layout;
    if (auto refusal = parse_descriptor(bytes, layout)) {
        return Error{fmt::format("{}: byte {}", place, refusal->offset), std::move(refusal->what), std::move(refusal->remedy),
                     ErrorKind::damaged};
    }
    return layout;
}

}  // namespace surefoot::input
