// The corpus of real devices beside the project, $SUREFOOT_DATA/hid: its index, and the fixture that skips without it.
#pragma once

#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

#include "rt/base/file.hpp"
#include "tests/input/hid_test.hpp"

namespace surefoot::input {

/// The corpus as it was first built. It may grow; a smaller one is not the corpus.
constexpr std::size_t corpus_devices = 20, corpus_recorded = 47, corpus_synthetic = 1019, corpus_seeds = 19;
/// Events that the kernel made of the reports and that controls foretell; values that synthetic reports were made with.
constexpr std::size_t corpus_events = 859, corpus_values = 478;

/// One row of INDEX.tsv.
struct CorpusDevice {
    std::string slug, expected_class;
    std::string axes;  ///< "X8,Y16r,Hat4": usage, bits, r where the descriptor says relative; "-" for none
    std::filesystem::path folder;
    std::uint16_t vendor = 0, product = 0;
    std::size_t descriptor_bytes = 0, buttons = 0, recorded = 0, synthetic = 0;
    std::size_t nodes = 0;  ///< of evdev that the kernel made

    [[nodiscard]] std::vector<std::byte> descriptor() const {
        auto bytes = read_file(folder / "rdesc.bin", max_descriptor_bytes);
        EXPECT_TRUE(bytes.ok()) << slug << ": rdesc.bin cannot be read";
        return bytes.ok() ? std::move(*bytes) : std::vector<std::byte>{};
    }
    /// As the service describes it: under its own ids.
    [[nodiscard]] HidDevice described() const { return describe_device(layout_of(descriptor()), {vendor, product, {}}); }
};

/// Rows behind the heading, cut at tabs; every row has at least `columns`.
inline std::vector<std::vector<std::string>> read_table(const std::filesystem::path& file, std::size_t columns) {
    std::vector<std::vector<std::string>> rows;
    std::ifstream stream(file);
    std::string line;
    std::getline(stream, line);
    while (std::getline(stream, line)) {
        std::istringstream cells(line);
        std::vector<std::string> row;
        for (std::string cell; std::getline(cells, cell, '\t');) row.push_back(cell);
        EXPECT_GE(row.size(), columns) << file << ": " << line;
        if (row.size() >= columns) rows.push_back(std::move(row));
    }
    return rows;
}

/// Skips with the reason where the corpus is not on this machine. A folder that is there must hold the whole corpus.
class HidCorpus : public testing::Test {
protected:
    void SetUp() override {
        const char* data = std::getenv("SUREFOOT_DATA");
        if (data == nullptr) GTEST_SKIP() << "SUREFOOT_DATA is not set: no real devices; tests/input/devices stand in";
        root = std::filesystem::path(data) / "hid";
        if (!std::filesystem::is_directory(root)) GTEST_SKIP() << root << " is not there: no real devices";
        for (const auto& row : read_table(root / "INDEX.tsv", 9)) {
            CorpusDevice d;
            d.slug = row[0];
            d.folder = root / d.slug;
            d.vendor = static_cast<std::uint16_t>(std::stoul(row[1], nullptr, 16));
            d.product = static_cast<std::uint16_t>(std::stoul(row[1].substr(row[1].find(':') + 1), nullptr, 16));
            d.descriptor_bytes = std::stoul(row[2]);
            d.expected_class = row[3];
            d.axes = row[4];
            d.buttons = std::stoul(row[5]);
            d.recorded = std::stoul(row[6]);
            d.synthetic = std::stoul(row[7]);
            d.nodes = std::stoul(row[8].substr(row[8].find(',') + 1));
            devices.push_back(d);
        }
        ASSERT_GE(devices.size(), corpus_devices) << root / "INDEX.tsv"
                                                  << " is not whole";
    }

    /// Of the real devices, then the malformed ones.
    [[nodiscard]] std::vector<std::vector<std::byte>> descriptors() const {
        std::vector<std::vector<std::byte>> all;
        for (const CorpusDevice& d : devices) all.push_back(d.descriptor());
        for (const auto& row : read_table(root / "malformed" / "verdicts.tsv", 4)) {
            auto bytes = read_file(root / "malformed" / (row[0] + ".bin"), max_descriptor_bytes);
            EXPECT_TRUE(bytes.ok()) << row[0];
            if (bytes.ok()) all.push_back(std::move(*bytes));
        }
        return all;
    }

    std::filesystem::path root;
    std::vector<CorpusDevice> devices;
};

}  // namespace surefoot::input
