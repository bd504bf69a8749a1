// Reports of real devices, decoded and put into evdev's words, against the events that the kernel made of the same reports.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <iostream>

#include "tests/input/expected_events.hpp"
#include "tests/input/hid_corpus.hpp"

namespace surefoot::input {
namespace {

/// The line before a report says what it was made for: "# usage 00010030 = 255", "# SHORT report".
std::vector<std::string> purposes(const std::filesystem::path& file, const Recording& recording) {
    std::ifstream stream(file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    std::vector<std::string> before;
    for (const RecordedReport& r : recording.reports) before.push_back(r.line >= 2 ? lines.at(r.line - 2) : "");
    return before;
}

ReportFate expected_fate(const std::string& purpose) {
    if (purpose.starts_with("# SHORT")) return ReportFate::too_short;
    if (purpose.starts_with("# LONG")) return ReportFate::too_long;
    if (purpose.starts_with("# UNKNOWN")) return ReportFate::undeclared;
    return ReportFate::accepted;
}

/// The row that explains an event which no control expected; without_control.size() for none.
std::size_t row_of(const std::string& slug, const KernelEvent& e) {
    const auto row = std::find_if(without_control.begin(), without_control.end(), [&](const NoControl& n) {
        if (slug != n.slug) return false;
        return e.type == EventType::key ? e.code >= n.first && e.code <= n.last
                                        : e.type == EventType::key_without_usage && n.unnamed != 0 && e.code == n.unnamed;
    });
    return static_cast<std::size_t>(row - without_control.begin());
}

class HidCorpusReports : public HidCorpus {
protected:
    void compare(const CorpusDevice& device, const std::string& kind, std::size_t count);
    void expect_equal(const CorpusDevice& device, std::vector<KernelEvent> mine, std::vector<KernelEvent> theirs);

    Differences allowed;
    std::array<std::size_t, without_control.size()> unexpected{};
    std::size_t recordings = 0, compared = 0, events_equal = 0, moving_reports = 0;
};

void HidCorpusReports::expect_equal(const CorpusDevice& device, std::vector<KernelEvent> mine, std::vector<KernelEvent> theirs) {
    std::erase_if(theirs, [&](const KernelEvent& e) {
        const std::size_t row = row_of(device.slug, e);
        if (row == without_control.size()) return false;
        ++unexpected[row];
        return true;
    });
    std::sort(mine.begin(), mine.end());
    std::sort(theirs.begin(), theirs.end());
    EXPECT_EQ(mine, theirs);
    events_equal += theirs.size();
    moving_reports += !theirs.empty();
}

void HidCorpusReports::compare(const CorpusDevice& device, const std::string& kind, std::size_t count) {
    const auto file = device.folder / (kind + ".hid");
    auto recording = read_recording(file);
    ASSERT_TRUE(recording.ok()) << recording.error().text();
    ASSERT_EQ(recording->reports.size(), count);
    EXPECT_EQ(recording->descriptor, device.descriptor());
    // Without a node there is no file, and nothing to expect.
    KernelEvents events = read_kernel_events(device.folder / ("kernel-evdev-" + kind + ".txt"));
    for (const auto& line : events.problems) ADD_FAILURE() << "not understood: " << line;
    EXPECT_EQ(events.nodes, device.nodes);
    if (device.nodes == 0) events.reports.resize(count);
    ASSERT_EQ(events.reports.size(), count);
    const HidDevice described = device.described();
    ReportDecoder decoder(described);
    ExpectedEvents expected(described, read_kernel_dump(device.folder / "kernel-rdesc.txt"), events, allowed);
    DeviceState state;
    const auto purpose = purposes(file, *recording);
    for (std::size_t i = 0; i < count; ++i, ++compared) {
        SCOPED_TRACE(device.slug + ", " + kind + " report " + std::to_string(i) + " " + purpose[i]);
        const ReportFate fate = decoder.decode(recording->report(i), static_cast<std::int64_t>(i) + 1, state);
        EXPECT_EQ(fate, expected_fate(purpose[i]));
        if (fate != ReportFate::accepted) allowed.add(Difference::not_as_declared);
        expect_equal(device, fate == ReportFate::accepted ? expected.step(state) : std::vector<KernelEvent>{}, events.reports[i]);
    }
    ++recordings;
}

TEST_F(HidCorpusReports, AreTheEventsOfEvdev) {
    std::size_t recorded = 0, synthetic = 0;
    for (const CorpusDevice& device : devices) {
        recorded += device.recorded;
        synthetic += device.synthetic;
        EXPECT_EQ(std::filesystem::exists(device.folder / "recorded.hid"), device.recorded > 0) << device.slug;
        if (device.recorded > 0) compare(device, "recorded", device.recorded);
        compare(device, "synthetic", device.synthetic);
    }
    std::cout << recordings << " recordings, " << compared << " reports, " << moving_reports << " of them with " << events_equal
              << " events, all foretold\n";
    allowed.print();
    EXPECT_EQ(compared, recorded + synthetic);
    EXPECT_GE(recorded, corpus_recorded);
    EXPECT_GE(synthetic, corpus_synthetic);
    EXPECT_GE(events_equal, corpus_events);
    for (std::size_t i = 0; i < without_control.size(); ++i)
        EXPECT_EQ(unexpected[i], without_control[i].events) << without_control[i].slug << ": " << without_control[i].why;
    // Each difference is needed as often as the reports were made to show it, or not at all.
    EXPECT_EQ(allowed.times(Difference::null_state), 0U);
    EXPECT_EQ(allowed.times(Difference::hat_outside), 0U);
    EXPECT_GT(allowed.times(Difference::deflection), 0U);
    EXPECT_GT(allowed.times(Difference::noise), 0U);
}

/// What a control must show once the element that it stands for is set to `raw`.
bool shows(const ControlInfo& c, bool has_value, std::int32_t value, std::int32_t raw) {
    if (c.kind == ControlKind::button) return has_value && value == (raw != 0 ? 1 : 0);
    if (raw < c.logical_min || raw > c.logical_max) return !has_value;
    if (c.kind == ControlKind::hat) return has_value && value == (raw - c.logical_min) * 8 / (c.logical_max - c.logical_min + 1);
    return has_value && value == raw;
}

TEST_F(HidCorpus, SyntheticReportsCarryTheValuesTheyWereMadeWith) {
    std::array<std::size_t, without_control.size()> unshown{};
    std::size_t shown = 0;
    for (const CorpusDevice& device : devices) {
        const auto file = device.folder / "synthetic.hid";
        auto recording = read_recording(file);
        ASSERT_TRUE(recording.ok()) << recording.error().text();
        const HidDevice described = device.described();
        ReportDecoder decoder(described);
        DeviceState state;
        const auto purpose = purposes(file, *recording);
        for (std::size_t i = 0; i < purpose.size(); ++i) {
            (void)decoder.decode(recording->report(i), 1, state);
            unsigned usage = 0;
            int raw = 0;
            if (std::sscanf(purpose[i].c_str(), "# usage %x = %d", &usage, &raw) != 2) continue;
            // Of several elements with one usage, one was set.
            bool one = false;
            for (std::size_t c = 0; c < described.controls.size(); ++c) {
                const ControlInfo& info = described.controls[c];
                if (full_usage(info.usage_page, info.usage) == usage && !state.carried_over.test(c))
                    one |= shows(info, state.has_value.test(c), state.value[c], raw);
            }
            const std::size_t row = row_of(device.slug, {EventType::key, usage, raw});
            if (!one && row < without_control.size())
                ++unshown[row];
            else
                EXPECT_TRUE(one) << device.slug << " report " << i << " " << purpose[i];
            shown += one;
        }
    }
    std::cout << shown << " values as they were set\n";
    EXPECT_GE(shown, corpus_values);
    for (std::size_t i = 0; i < without_control.size(); ++i)
        EXPECT_EQ(unshown[i], without_control[i].settings) << without_control[i].slug << ": " << without_control[i].why;
}

}  // namespace
}  // namespace surefoot::input
