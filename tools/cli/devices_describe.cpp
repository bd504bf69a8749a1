// surefoot devices describe: what a report descriptor says, and what recorded reports mean, without any device.
#include <fmt/format.h>

#include <functional>
#include <map>

#include "input/hid/decoder.hpp"
#include "input/hid/usages.hpp"
#include "input/replay/recording.hpp"
#include "rt/base/file.hpp"
#include "rt/base/text.hpp"
#include "tools/cli/devices.hpp"
#include "tools/cli/options.hpp"
#include "tools/report/terminal.hpp"

namespace surefoot::cli {

namespace {

using nlohmann::ordered_json;

constexpr std::size_t max_usages_listed = 100'000;  ///< of all fields together; ranges are always listed whole

struct DescribeArguments {
    std::string file, reports, id;
    bool json = false;
};

/// What the files gave.
struct Material {
    std::vector<std::byte> descriptor;
    std::string descriptor_place;
    input::Recording recording;
    std::uint16_t vendor = 0, product = 0;
    std::string name;
};

std::string hex_usage(std::uint32_t usage) { return fmt::format("{:04x}:{:04x}", usage >> 16U, usage & 0xffffU); }

bool parse_id(const std::string& text, std::uint16_t& vendor, std::uint16_t& product) {
    const auto colon = text.find(':');
    if (colon == std::string::npos) return false;
    const std::string_view all = text;
    const auto read_vendor = number_in<std::uint16_t>(all.substr(0, colon), 16);
    const auto read_product = number_in<std::uint16_t>(all.substr(colon + 1), 16);
    if (!read_vendor || !read_product) return false;
    vendor = *read_vendor;
    product = *read_product;
    return true;
}

Result<Material> gather(const DescribeArguments& a) {
    Material m;
    m.descriptor_place = a.file;
    auto bytes = read_file(a.file, input::max_recording_bytes);
    if (!bytes) return bytes.error();
    bool have_recording = false;
    if (input::looks_like_recording(*bytes)) {
        const std::string_view text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
        auto recording = input::parse_recording(text, a.file);
        if (!recording) return recording.error();
        if (recording->descriptor.empty())
            return Error{a.file, "The recording has no R: line with the report descriptor",
                         "Record it again, or name the descriptor's file", ErrorKind::damaged};
        m.descriptor = recording->descriptor;
        m.descriptor_place += ", R: line";
        m.recording = std::move(*recording);
        have_recording = true;
    } else {
        m.descriptor = std::move(*bytes);
    }
    if (!a.reports.empty()) {
        auto recording = input::read_recording(a.reports);
        if (!recording) return recording.error();
        if (recording->reports.empty())
            return Error{a.reports, "The recording holds no reports (E: lines)", "Record it again while you move the device",
                         ErrorKind::damaged};
        if (!recording->descriptor.empty() && recording->descriptor != m.descriptor) {
            notify(a.reports + ": The recording is of a device with another descriptor. Its values may be decoded wrongly.");
        }
        m.recording = std::move(*recording);
        have_recording = true;
    }
    if (have_recording) {
        m.vendor = m.recording.vendor;
        m.product = m.recording.product;
        m.name = printable(m.recording.name);
    }
    if (!a.id.empty()) (void)parse_id(a.id, m.vendor, m.product);  // checked when the command line was read
    return m;
}

const char* kind_text(input::ReportKind kind) {
    return kind == input::ReportKind::input ? "input" : kind == input::ReportKind::output ? "output" : "feature";
}

std::vector<std::string> flag_names(std::uint32_t flags) {
    namespace flag = input::flag;
    std::vector<std::string> names;
    if ((flags & flag::constant) != 0) names.emplace_back("constant");
    names.emplace_back((flags & flag::variable) != 0 ? "variable" : "array");
    names.emplace_back((flags & flag::relative) != 0 ? "relative" : "absolute");
    static constexpr std::pair<std::uint32_t, const char*> further[] = {{flag::wrap, "wrap"},
                                                                        {flag::nonlinear, "nonlinear"},
                                                                        {flag::no_preferred, "no-preferred-state"},
                                                                        {flag::null_state, "null-state"},
                                                                        {flag::is_volatile, "volatile"},
                                                                        {flag::buffered, "buffered-bytes"}};
    for (const auto& [bit, name] : further)
        if ((flags & bit) != 0) names.emplace_back(name);
    return names;
}

ordered_json layout_json(const input::Layout& l) {
    ordered_json list = ordered_json::array();
    std::size_t listed = 0;
    for (const std::uint32_t i : l.fields_by_report()) {
        const input::Field& f = l.fields[i];
        ordered_json usages = ordered_json::array(), ranges = ordered_json::array();
        std::uint32_t k = 0;
        for (std::uint32_t r = f.first_run; r < f.first_run + f.run_count; ++r) {
            const input::UsageRun& run = l.runs[r];
            ranges.push_back({hex_usage(run.at(0)), hex_usage(run.at(run.count - 1))});
            for (std::uint32_t u = 0; u < run.count && listed < max_usages_listed; ++u, ++k, ++listed)
                usages.push_back(run.at(u));
        }
        const input::UsageRun& last = l.runs[f.first_run + f.run_count - 1];
        for (; k < f.usages && listed < max_usages_listed; ++k, ++listed) usages.push_back(last.at(last.count - 1));
        const auto application = l.enclosing(f.collection, input::collection_type::application);
        list.push_back({{"kind", kind_text(f.kind)},
                        {"report_id", f.report_id},
                        {"bit_offset", f.bit_offset},
                        {"size", f.size},
                        {"count", f.count},
                        {"usages", usages},
                        {"usage_count", f.usages},
                        {"usage_ranges", ranges},
                        {"logical_min", f.logical_min},
                        {"logical_max", f.logical_max},
                        {"physical_min", f.physical_min},
                        {"physical_max", f.physical_max},
                        {"unit", f.unit},
                        {"unit_name", input::unit_name(f.unit)},
                        {"exponent", f.exponent},
                        {"flags", flag_names(f.flags)},
                        {"flag_bits", f.flags},
                        {"application", hex_usage(application)},
                        {"byte_offset", f.offset}});
    }
    return list;
}

ordered_json reports_json(const input::Layout& l) {
    ordered_json list = ordered_json::array();
    for (const input::Report& r : l.reports) {
        const bool numbered = l.numbered[static_cast<std::size_t>(r.kind)];
        list.push_back({{"kind", kind_text(r.kind)},
                        {"report_id", r.id},
                        {"bits", r.bits},
                        {"bytes", r.bytes() + (numbered ? 1U : 0U)},
                        {"fields", r.fields}});
    }
    return list;
}

ordered_json controls_json(const input::HidDevice& d) {
    ordered_json list = ordered_json::array();
    for (std::size_t i = 0; i < d.controls.size(); ++i) {
        const input::ControlInfo& c = d.controls[i];
        const input::Field& f = d.layout.fields[d.sources[i].field];
        list.push_back({{"name", c.name},
                        {"kind", input::kind_name(c.kind)},
                        {"collection", c.collection},
                        {"usage_page", c.usage_page},
                        {"usage", c.usage},
                        {"report_id", f.report_id},
                        {"logical_min", c.logical_min},
                        {"logical_max", c.logical_max},
                        {"physical_min", c.physical_min},
                        {"physical_max", c.physical_max},
                        {"unit", c.unit},
                        {"relative", c.relative},
                        {"wraps", c.wraps}});
    }
    return list;
}

const char* fate_text(input::ReportFate fate) {
    switch (fate) {
        case input::ReportFate::accepted:
            return "accepted";
        case input::ReportFate::too_short:
            return "short";
        case input::ReportFate::too_long:
            return "long";
        case input::ReportFate::undeclared:
            return "unknown";
    }
    return "unknown";
}

/// Hands every report with what it changed to `each`, one at a time: hours of them would not fit. Returns the counts.
ordered_json decode_each(const input::HidDevice& d, const input::Recording& recording,
                         const std::function<void(const ordered_json&)>& each) {
    input::ReportDecoder decoder(d);
    input::DeviceState state;
    std::map<std::uint8_t, std::vector<std::uint16_t>> carried;
    std::size_t backward = 0;
    for (std::size_t i = 0; i < recording.reports.size(); ++i) {
        const auto bytes = recording.report(i);
        const auto id =
            static_cast<std::uint8_t>(decoder.numbered() && !bytes.empty() ? std::to_integer<unsigned>(bytes[0]) : 0U);
        const auto fate = decoder.decode(bytes, recording.reports[i].time_us * 1000, state);
        ordered_json report = {{"line", recording.reports[i].line},
                               {"time_s", static_cast<double>(recording.reports[i].time_us) * 1e-6},
                               {"report_id", id},
                               {"bytes", bytes.size()},
                               {"status", fate_text(fate)}};
        if (fate == input::ReportFate::accepted) {
            ordered_json values = ordered_json::object();
            if (!carried.contains(id)) carried[id] = decoder.controls_in(id);
            for (const auto c : carried[id]) {
                values[d.controls[c].name] = state.has_value.test(c) ? ordered_json(state.value[c]) : ordered_json(nullptr);
            }
            report["values"] = std::move(values);
        }
        if (i > 0 && recording.reports[i].time_us < recording.reports[i - 1].time_us) ++backward;
        each(report);
    }
    const auto& n = decoder.counts();
    return {{"accepted", n.accepted},
            {"short", n.too_short},
            {"long", n.too_long},
            {"unknown", n.undeclared},
            {"before_the_last", backward}};
}

ordered_json notes_json(const input::Layout& l) {
    ordered_json list = ordered_json::array();
    for (const input::DescriptorNote& n : l.notes) list.push_back({{"offset", n.offset}, {"what", n.what}});
    return list;
}

std::string range_text(const input::Layout& l, const input::Field& f) {
    std::string text;
    for (std::uint32_t r = f.first_run; r < f.first_run + f.run_count; ++r) {
        const input::UsageRun& run = l.runs[r];
        if (text.size() > 60) return text + " …";
        if (!text.empty()) text += ", ";
        text += input::usage_text(run.at(0));
        if (run.count > 1) text += " to " + input::usage_text(run.at(run.count - 1));
    }
    return text;
}

void print_tables(const input::HidDevice& d) {
    const input::Layout& l = d.layout;
    fmt::print("class: {}: {}\n", input::class_name(d.device_class), d.reason);
    for (const auto& q : d.quirks) fmt::print("quirk: {}\n", q);
    for (const auto& n : l.notes) fmt::print("note: byte {}: {}\n", n.offset, n.what);
    const report::Columns fields(
        {{"report", 8}, {"id", -3}, {"bit", -6}, {"size", -5}, {"count", -6}, {"logical range", -24}, {"flags", 34}, {"usages"}});
    fmt::print("\n{}\n", fields.heading());
    for (const std::uint32_t i : l.fields_by_report()) {
        const input::Field& f = l.fields[i];
        fmt::print("{}\n", fields.row({std::string(kind_text(f.kind)), std::to_string(f.report_id), std::to_string(f.bit_offset),
                                       std::to_string(f.size), std::to_string(f.count),
                                       fmt::format("{} to {}", f.logical_min, f.logical_max),
                                       fmt::format("{}", fmt::join(flag_names(f.flags), " ")), range_text(l, f)}));
    }
    const report::Columns controls({{"control", 18}, {"kind", 7}, {"range", -18}, {"physical range", 24}, {"collection"}});
    if (!d.controls.empty()) fmt::print("\n{}\n", controls.heading());
    for (const auto& c : d.controls) {
        const std::string physical =
            c.physical_min == c.physical_max ? "" : fmt::format("{:g} to {:g} {}", c.physical_min, c.physical_max, c.unit);
        fmt::print("{}{}\n",
                   controls.row({c.name, std::string(input::kind_name(c.kind)),
                                 fmt::format("{} to {}", c.logical_min, c.logical_max), physical, c.collection}),
                   c.relative ? "  (relative)" : "");
    }
    if (d.controls_left_out > 0) fmt::print("and {} more, which are not shown\n", d.controls_left_out);
}

const report::Columns report_columns({{"time", -12}, {"id", -3}, {"status", 8}});

void print_report(const ordered_json& r) {
    std::string values;
    if (r.contains("values")) {
        for (const auto& [name, value] : r["values"].items())
            if (!value.is_null() && (value.get<std::int64_t>() != 0 || !name.starts_with("button")))
                values += fmt::format(" {}={}", name, value.get<std::int64_t>());
    }
    fmt::print("{}{}\n",
               report_columns.row({fmt::format("{:.6f}", r["time_s"].get<double>()),
                                   std::to_string(r["report_id"].get<unsigned>()), r["status"].get<std::string>()}),
               values);
}

void print_decoded(const input::HidDevice& d, const input::Recording& recording) {
    fmt::print("\n{} values\n", report_columns.heading());
    const ordered_json counts = decode_each(d, recording, print_report);
    const auto count = [&](const char* name) { return counts[name].get<std::uint64_t>(); };
    fmt::print("reports: {} accepted, {} short, {} long, {} unknown\n", count("accepted"), count("short"), count("long"),
               count("unknown"));
    if (count("before_the_last") > 0)
        fmt::print("{} of them have a time before that of the previous report\n", count("before_the_last"));
}

/// `head`'s object, with the decoded reports and their counts as its last members.
void print_json_with_reports(const ordered_json& head, const input::HidDevice& d, const input::Recording& recording) {
    const std::string text = json_text(head, 2);
    fmt::print("{},\n  \"reports\": [", std::string_view(text).substr(0, text.rfind("\n}")));
    bool first = true;
    const ordered_json counts = decode_each(d, recording, [&](const ordered_json& report) {
        fmt::print("{}\n{}", first ? "" : ",", json_text(report, 2));
        first = false;
    });
    fmt::print("\n  ],\n  \"counts\": {}\n}}\n", json_text(counts, 2));
}

/// A refused descriptor is a failure, but with --json its place and reason are in the object as well.
int refuse(const DescribeArguments& a, const Material& m, const input::Refusal& refusal) {
    if (a.json) {
        print_json({{"file", a.file},
                    {"bytes", m.descriptor.size()},
                    {"class", "reject"},
                    {"reason", "The report descriptor is refused: " + refusal.what},
                    {"error", {{"offset", refusal.offset}, {"what", refusal.what}, {"remedy", refusal.remedy}}}});
    }
    return fail(
        {fmt::format("{}: byte {}", m.descriptor_place, refusal.offset), refusal.what, refusal.remedy, ErrorKind::damaged});
}

int run_describe(const DescribeArguments& a) {
    auto m = gather(a);
    if (!m) return fail(m.error());
    input::Layout layout;
    if (auto refusal = input::parse_descriptor(m->descriptor, layout)) return refuse(a, *m, *refusal);
    const input::HidDevice d = input::describe_device(std::move(layout), {m->vendor, m->product, m->name});
    const bool reports = !m->recording.reports.empty();
    if (!a.json) {
        print_tables(d);
        if (reports) print_decoded(d, m->recording);
        return exit_success;
    }
    const ordered_json object = {{"file", a.file},
                                 {"bytes", m->descriptor.size()},
                                 {"name", m->name},
                                 {"vid_pid", fmt::format("{:04x}:{:04x}", m->vendor, m->product)},
                                 {"class", input::class_name(d.device_class)},
                                 {"reason", d.reason},
                                 {"quirks", d.quirks},
                                 {"notes", notes_json(d.layout)},
                                 {"note_count", d.layout.note_count},
                                 {"layout", layout_json(d.layout)},
                                 {"reports_declared", reports_json(d.layout)},
                                 {"controls", controls_json(d)},
                                 {"controls_left_out", d.controls_left_out}};
    if (reports)
        print_json_with_reports(object, d, m->recording);
    else
        print_json(object);
    return exit_success;
}

}  // namespace

void add_devices_describe(CLI::App& devices, Context& context) {
    auto a = std::make_shared<DescribeArguments>();
    CLI::App* c = add_command(devices, "describe", "Decode a report descriptor and recorded reports; no device is needed",
                              "surefoot devices describe stick.bin --reports stick.hid --json", a->json);
    c->add_option("descriptor", a->file, "Report descriptor: a binary file, or a recording by hid-recorder with an R: line")
        ->required();
    c->add_option("--reports", a->reports, "Recording by hid-recorder whose reports are decoded");
    c->add_option("--vid-pid", a->id,
                  "Vendor and product id that select quirks, for example 046d:c626 (else those of the recording)")
        ->check([](const std::string& text) {
            std::uint16_t v = 0, p = 0;
            return parse_id(text, v, p) ? std::string() : refused_value(text, "", "ids such as 046d:c626").text();
        });
    c->callback([&context, a] { context.run = [a] { return run_describe(*a); }; });
}

}  // namespace surefoot::cli
