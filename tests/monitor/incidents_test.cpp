// Incidents on disk: whole or not at all, bounded in number and bytes, a full disk said once, and the trace opens.
#include <gtest/gtest.h>

#include <signal.h>
#include <sys/resource.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "rt/base/file.hpp"
#include "tests/eventually.hpp"
#include "tests/monitor/http.hpp"
#include "tests/temporary_folder.hpp"
#include "tools/monitor/incidents.hpp"

namespace surefoot::monitor {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

rt::IncidentRecorder::Incident an_incident(std::uint64_t number, int frames = 200) {
    rt::IncidentRecorder::Incident incident;
    incident.number = number;
    incident.period_ns = 10'000'000;
    incident.first_frame = 100;
    for (int i = 0; i < frames; ++i) {
        rt::FrameRecord f;
        f.frame = f.slot = static_cast<std::uint64_t>(i);
        f.due_ns = 1'000'000'000 + i * 10'000'000LL;
        f.deadline_ns = f.due_ns + 10'000'000;
        f.woken_ns = f.due_ns + 10'000;
        f.selected_ns = f.woken_ns + 100'000;
        f.submitted_ns = f.selected_ns + 1'000'000;
        f.rastered_ns = f.submitted_ns + 2'000'000;
        f.missed = i >= 100 && i < 104;
        f.complete_ns = f.missed ? f.deadline_ns + 500'000 : f.rastered_ns;
        f.cause = f.missed ? rt::Cause::preempted : rt::Cause::none;
        incident.records.push_back(f);
    }
    return incident;
}

std::set<std::string> names_in(const std::string& dir) {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(dir)) names.insert(entry.path().filename().string());
    return names;
}

TEST(Incidents, AreALedgerATraceAndASummary) {
    const TemporaryFolder folder;
    const auto written = write_incident(folder.path(), an_incident(17), {}, 1'767'323'045);
    ASSERT_TRUE(written.ok()) << written.error().text();
    EXPECT_EQ(fs::path(*written).filename(), "incident-20260102T030405Z-000017");
    const auto ledger = *read_text(*written + "/ledger.csv");
    EXPECT_EQ(std::count(ledger.begin(), ledger.end(), '\n'), 201);
    const auto summary = nlohmann::json::parse(*read_text(*written + "/incident.json"));
    EXPECT_EQ(summary["misses"], 4);
    EXPECT_EQ(summary["miss_causes"]["preempted"], 4);
    EXPECT_EQ(summary["first_frame"], 100);
    EXPECT_NEAR(summary["worst_frame_ms"].get<double>(), 10.5, 1e-9);
    // The trace, reopened: expected and actual slices of every frame, and the misses with their cause.
    const auto trace = nlohmann::json::parse(*read_text(*written + "/trace.json"));
    std::size_t expected = 0, actual = 0, misses = 0;
    for (const auto& event : trace["traceEvents"]) {
        if (event.value("cat", "") == "expected") ++expected;
        if (event.value("cat", "") == "frame") ++actual;
        if (event.value("cat", "") == "miss") {
            EXPECT_EQ(event["name"], "preempted");
            ++misses;
        }
    }
    EXPECT_EQ(expected, 200U);
    EXPECT_EQ(actual, 200U);
    EXPECT_EQ(misses, 4U);
}

TEST(Incidents, TheOldestMakeRoomByNumberAndByBytes) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_text(folder / "mine.txt", "kept").ok());
    IncidentLimits limits;
    limits.folders = 3;
    for (std::uint64_t n = 1; n <= 6; ++n)
        ASSERT_TRUE(write_incident(folder.path(), an_incident(n), limits, 1'767'323'045 + static_cast<std::int64_t>(n)).ok());
    auto names = names_in(folder.path());
    EXPECT_EQ(names.size(), 4U) << "three, and what is not ours";
    EXPECT_TRUE(names.contains("incident-20260102T030411Z-000006"));
    EXPECT_FALSE(names.contains("incident-20260102T030408Z-000003"));
    std::uint64_t one = 0;
    for (const auto& file : fs::directory_iterator(folder / "incident-20260102T030411Z-000006")) one += file.file_size();
    limits.bytes = 2 * one + one / 2;
    ASSERT_TRUE(write_incident(folder.path(), an_incident(7), limits, 1'767'323'052).ok());
    EXPECT_EQ(names_in(folder.path()).size(), 3U) << "two are what the bytes allow";
    limits.bytes = one / 2;
    EXPECT_FALSE(write_incident(folder.path(), an_incident(8), limits, 1'767'323'053).ok());
    EXPECT_EQ(names_in(folder.path()).size(), 3U) << "one that is too large costs none of the old ones, and leaves nothing";
    EXPECT_EQ(*read_text(folder / "mine.txt"), "kept");
}

TEST(Incidents, KeepTheMissedFrameThatIsTheirs) {
    const TemporaryFolder folder;
    MissedFrame missed{100, [](const std::string& file) { return write_text(file, "the frame"); }};
    auto written = write_incident(folder.path(), an_incident(1), {}, 1'767'323'045, &missed);
    ASSERT_TRUE(written.ok()) << written.error().text();
    EXPECT_EQ(*read_text(*written + "/frame.capture"), "the frame");
    EXPECT_EQ(nlohmann::json::parse(*read_text(*written + "/incident.json"))["capture"]["frame"], 100);
    for (const std::uint64_t of_another : {99, 200}) {
        missed.frame = of_another;
        written = write_incident(folder.path(), an_incident(of_another), {}, 1'767'323'046, &missed);
        ASSERT_TRUE(written.ok()) << written.error().text();
        EXPECT_FALSE(fs::exists(*written + "/frame.capture"));
        EXPECT_FALSE(nlohmann::json::parse(*read_text(*written + "/incident.json")).contains("capture"));
    }
}

TEST(Incidents, KeepTheirMissedFrameWhenOthersMissAfterThem) {
    constexpr std::int64_t second = 1'000'000'000;
    OfferedFrames offered;
    EXPECT_EQ(offered.last_of(0, 1000), nullptr);
    for (std::int64_t i = 0; i <= 40; ++i) offered.add({static_cast<std::uint64_t>(100 + 5 * i), {}}, second + i * second / 20);
    ASSERT_NE(offered.last_of(100, 199), nullptr) << "misses went on for two seconds";
    EXPECT_EQ(offered.last_of(100, 199)->frame, 150U) << "one each half second: 100, 150, and so on";
    EXPECT_EQ(offered.last_of(151, 199), nullptr);
    EXPECT_EQ(offered.last_of(0, 1000)->frame, 300U);
    offered.add({400, {}}, 6 * second);
    EXPECT_EQ(offered.last_of(0, 199), nullptr) << "older than four seconds";
    EXPECT_EQ(offered.last_of(0, 399)->frame, 300U);
    EXPECT_EQ(offered.last_of(0, 1000)->frame, 400U);
    offered.add({3, {}}, 6 * second + 1);
    EXPECT_EQ(offered.last_of(0, 1000)->frame, 3U) << "another walk has begun: its frames are numbered anew";
}

TEST(Incidents, AMissAfterTheBurstDoesNotTakeTheBurstsFrame) {
    const TemporaryFolder folder;
    rt::IncidentRecorderOptions options;
    options.after_s = 0.05;
    rt::IncidentRecorder recorder(options);
    recorder.begin(10'000'000);
    std::string message;
    auto writer = IncidentWriter::start(folder / "incidents", recorder, {}, [&](std::string_view text) { message = text; });
    ASSERT_TRUE(writer.ok()) << writer.error().text();
    const auto frame = [](const char* text) { return [text](const std::string& file) { return write_text(file, text); }; };
    (*writer)->offer({101, frame("of the burst")});
    (*writer)->offer({500, frame("of another")});
    for (const rt::FrameRecord& record : an_incident(1).records) recorder.add(record);
    ASSERT_TRUE(test::eventually(5, [&] { return (*writer)->written() == 1; }));
    writer->reset();
    ASSERT_FALSE(message.empty());
    const std::string incident = folder / "incidents/" + *names_in(folder / "incidents").begin();
    EXPECT_EQ(*read_text(incident + "/frame.capture"), "of the burst") << message;
}

TEST(Incidents, AFullDiskIsReportedOnceAndSurvived) {
    const TemporaryFolder folder;
    const std::string dir = folder / "incidents";
    rt::IncidentRecorderOptions box_options;
    box_options.between_s = 0;
    box_options.keep_s = 2;
    box_options.after_s = 0.05;
    rt::IncidentRecorder box(box_options);
    box.begin(10'000'000);
    std::vector<std::string> messages;
    auto writer = IncidentWriter::start(dir, box, {}, [&](std::string_view text) { messages.emplace_back(text); });
    ASSERT_TRUE(writer.ok()) << writer.error().text();
    std::uint64_t frame = 0;
    const auto burst = [&](std::uint64_t outcomes) {
        for (int i = 0; i < 40; ++i) {
            rt::FrameRecord f = an_incident(1, 1).records[0];
            f.frame = f.slot = frame;
            f.due_ns += static_cast<std::int64_t>(frame++) * 10'000'000;
            f.deadline_ns = f.due_ns + 10'000'000;
            f.missed = i < 3;
            f.complete_ns = f.due_ns + (f.missed ? 11'000'000 : 5'000'000);
            box.add(f);
        }
        EXPECT_TRUE(test::eventually(5, [&] { return (*writer)->written() + (*writer)->failed() >= outcomes; })) << outcomes;
    };
    burst(1);
    EXPECT_EQ((*writer)->written(), 1U);
    // As full as a disk can be made here: no file may grow.
    ::signal(SIGXFSZ, SIG_IGN);
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    rlimit none = before;
    none.rlim_cur = 0;
    setrlimit(RLIMIT_FSIZE, &none);
    burst(2);
    burst(3);
    burst(4);
    setrlimit(RLIMIT_FSIZE, &before);
    EXPECT_EQ((*writer)->failed(), 3U);
    burst(5);
    EXPECT_EQ((*writer)->written(), 2U) << "it goes on when there is room again";
    writer->reset();
    ASSERT_EQ(messages.size(), 3U) << "written; not written, once; written";
    EXPECT_NE(messages[1].find("could not be recorded"), std::string::npos) << messages[1];
    for (const std::string& name : names_in(dir))
        EXPECT_TRUE(name.starts_with("incident-")) << name << ": something half is left";
    EXPECT_EQ(names_in(dir).size(), 2U);
}

TEST(Incidents, WhatAnEarlierProcessLeftHalfIsClearedAway) {
    const TemporaryFolder folder;
    const std::string dir = folder / "incidents";
    fs::create_directories(dir + "/.incident-20260102T030405Z-000001");
    ASSERT_TRUE(write_text(dir + "/.incident-20260102T030405Z-000001/ledger.csv", "half").ok());
    rt::IncidentRecorder box({});
    auto writer = IncidentWriter::start(dir, box, {}, {});
    ASSERT_TRUE(writer.ok());
    EXPECT_TRUE(names_in(dir).empty());
    writer->reset();
}

}  // namespace
}  // namespace surefoot::monitor
