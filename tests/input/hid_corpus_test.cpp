// The corpus of real devices beside the project ($SUREFOOT_DATA/hid): every descriptor against the kernel's own dump.
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>

#include "rt/base/file.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input {
namespace {

namespace fs = std::filesystem;

/// One field as debugfs rdesc prints it; ranges without extent are not printed there.
struct Dumped {
    std::int64_t kind = 0, id = 0, offset = 0, size = 0, count = 0, logical_min = 0, logical_max = 0, physical_min = 0,
                 physical_max = 0, exponent = 0, flags = 0;
    bool operator==(const Dumped&) const = default;
};
struct DumpedField {
    Dumped numbers;
    std::vector<std::string> usages;
};

std::int64_t flags_of(const std::string& text) {
    static const std::pair<const char*, std::int64_t> words[] = {{"Constant", 1},   {"Variable", 2},   {"Relative", 4},
                                                                 {"Wrap", 8},       {"NonLinear", 16}, {"NoPreferredState", 32},
                                                                 {"NullState", 64}, {"Volatile", 128}, {"BufferedByte", 256}};
    std::int64_t flags = 0;
    for (const auto& [word, bit] : words)
        if (text.find(word) != std::string::npos) flags |= bit;
    return flags;
}

std::vector<DumpedField> read_dump(const fs::path& file) {
    std::ifstream stream(file);
    std::vector<DumpedField> fields;
    std::int64_t kind = -1, id = 0;
    int usages_left = 0;
    static const std::regex report(R"(^\s*(INPUT|OUTPUT|FEATURE)(?:\((\d+)\))?\[)"), item(R"(^\s*([A-Z][A-Za-z ]*)\((.*)\)\s*$)");
    for (std::string line; std::getline(stream, line);) {
        std::smatch m;
        if (usages_left > 0) {
            const auto from = line.find_first_not_of(' ');
            fields.back().usages.push_back(from == std::string::npos ? "" : line.substr(from));
            --usages_left;
        } else if (std::regex_search(line, m, report)) {
            kind = m[1] == "INPUT" ? 0 : m[1] == "OUTPUT" ? 1 : 2;
            id = m[2].matched ? std::stoll(m[2]) : 0;
        } else if (std::regex_match(line, m, item)) {
            const std::string key = m[1], value = m[2];
            const auto number = [&] { return std::strtoll(value.c_str(), nullptr, 10); };
            if (key == "Field" && kind >= 0) {
                fields.push_back({});
                fields.back().numbers.kind = kind;
                fields.back().numbers.id = id;
            }
            if (fields.empty()) continue;
            Dumped& f = fields.back().numbers;
            if (key == "Usage") usages_left = static_cast<int>(number());
            if (key == "Logical Minimum") f.logical_min = number();
            if (key == "Logical Maximum") f.logical_max = number();
            if (key == "Physical Minimum") f.physical_min = number();
            if (key == "Physical Maximum") f.physical_max = number();
            if (key == "Unit Exponent") f.exponent = number();
            if (key == "Report Size") f.size = number();
            if (key == "Report Count") f.count = number();
            if (key == "Report Offset") f.offset = number();
            if (key == "Flags") f.flags = flags_of(value);
        }
    }
    return fields;
}

Dumped as_dumped(const Field& f) {
    const bool range = f.logical_min != f.logical_max, physical = f.physical_min != f.physical_max;
    return {std::int64_t(f.kind),
            f.report_id,
            f.bit_offset,
            f.size,
            f.count,
            range ? f.logical_min : 0,
            range ? f.logical_max : 0,
            physical ? f.physical_min : 0,
            physical ? f.physical_max : 0,
            f.exponent,
            f.flags & 0x1ff};
}

/// The descriptor beside a dump: a binary of a likely name, or an R: line.
std::vector<std::byte> descriptor_beside(const fs::path& dump) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(dump.parent_path())) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    for (const auto& file : files) {
        if (file.extension() != ".bin" && file.extension() != ".hid") continue;
        auto bytes = read_file(file, max_recording_bytes);
        if (!bytes) continue;
        if (!looks_like_recording(*bytes)) return *bytes;
        auto r = parse_recording({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, file);
        if (r && !r->descriptor.empty()) return r->descriptor;
    }
    return {};
}

TEST(HidCorpus, LayoutsEqualTheKernelsDumps) {
    const char* data = std::getenv("SUREFOOT_DATA");
    const fs::path root = data != nullptr ? fs::path(data) / "hid" : fs::path();
    if (data == nullptr || !fs::is_directory(root))
        GTEST_SKIP() << "no corpus: SUREFOOT_DATA/hid is not there; the devices in tests/input/devices stand in";
    std::size_t devices = 0, fields = 0;
    // Names are not looked up but must stand for usages one to one.
    std::map<std::uint32_t, std::string> name_of;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
        if (entry.path().filename() != "kernel-rdesc.txt") continue;
        const auto dumped = read_dump(entry.path());
        const auto bytes = descriptor_beside(entry.path());
        EXPECT_FALSE(bytes.empty()) << "no descriptor beside " << entry.path();
        EXPECT_FALSE(dumped.empty()) << "no field is read from " << entry.path();
        if (bytes.empty() || dumped.empty()) continue;
        SCOPED_TRACE(entry.path().string());
        Layout l;
        const auto refusal = parse_descriptor(bytes, l);
        ASSERT_FALSE(refusal) << refusal->what;
        const auto order = l.fields_by_report();
        ASSERT_EQ(order.size(), dumped.size());
        for (std::size_t i = 0; i < order.size(); ++i) {
            const Field& f = l.fields[order[i]];
            EXPECT_TRUE(as_dumped(f) == dumped[i].numbers) << "field " << i << " at byte " << f.offset;
            ASSERT_EQ(f.usages, dumped[i].usages.size());
            for (std::uint32_t k = 0; k < f.usages; ++k) {
                const auto [at, fresh] = name_of.emplace(l.usage_of(f, k), dumped[i].usages[k]);
                EXPECT_TRUE(fresh || at->second == dumped[i].usages[k]) << at->second << " and " << dumped[i].usages[k];
            }
            ++fields;
        }
        ++devices;
    }
    EXPECT_GE(devices, 1U) << "nothing was compared";
    std::cout << devices << " devices, " << fields << " fields\n";
}

}  // namespace
}  // namespace surefoot::input
