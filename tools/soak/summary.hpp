// The outputs of a soak: verdict, JSON, table, and the one-page report.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rt/base/result.hpp"
#include "rt/base/statistics.hpp"
#include "tools/report/report.hpp"

namespace surefoot::soak {

/// not_judged: the run was too short, or there was too little data. A verdict holds only if every rule holds.
enum class Judged : std::uint8_t { holds, broken, not_judged };
std::string_view judged_name(Judged judged);  ///< "holds", "broken", "not judged"

/// One point of the verdict.
struct SoakCheck {
    std::string name;  ///< a word or two, the same in every soak
    Judged judged = Judged::not_judged;
    std::string words;  ///< what was seen and what is allowed
};

/// One load that ran beside the walk: for how long, and the proof that it was real.
struct SoakLoad {
    std::string name;
    double seconds = 0;  ///< for which it was on
    bool ran = false;    ///< false: refused by the system; `words` says why
    bool real = false;
    std::string words;  ///< the proof, in figures
    double amount = 0, evidence = 0;
    std::uint64_t failures = 0;
};

/// A stretch of the timetable, and the walk's frames in it.
struct SoakPhase {
    double from_s = 0, to_s = 0;
    std::vector<std::string> loads;
    std::uint64_t frames = 0, misses = 0, own_misses = 0, skipped = 0;
    double frame_ms_p99 = 0, frame_ms_max = 0;
};

/// A column of the chart over time: all the walk's frames in its time.
struct SoakColumn {
    double from_s = 0;
    std::uint32_t frames = 0, misses = 0;
    float low_ms = 0, mean_ms = 0, high_ms = 0;
    float accuracy_min = 0;  ///< rad^-1; 0: none had an error
};

/// One miss of the soak.
struct SoakMiss {
    double time_s = 0, frame_ms = 0;
    std::string_view cause;  ///< one of rt::cause_names
    bool own = false;
    std::uint32_t skipped = 0;  ///< slots that it ran over
};

/// The process at one time.
struct SoakSample {
    double time_s = 0;
    double memory_kib = 0;  ///< anonymous memory in RAM, without mapped files
    double resident_kib = 0;
    std::uint32_t descriptors = 0, threads = 0;
};

/// Something counted by the kernel, from begin to end of the soak.
struct SoakCount {
    std::string name;
    double count = 0;
};

/// The machine that the soak ran on.
struct SoakMachine {
    std::string kernel, kernel_command_line, processor;
    int cores = 0;
    std::vector<SoakCount> interrupts;  ///< most first
    std::vector<SoakCount> pressure;    ///< "cpu some", ...: share of the time, 0..1
    double steal_ms = 0;                ///< of all cores
    double context_switches = 0, processes = 0;
};

/// All figures of a soak.
struct SoakSummary {
    report::WalkSummary walk;  ///< counts are of the walk's own frames, without the control's
    std::string command_line;
    std::uint64_t seed = 0;
    double requested_s = 0, ran_s = 0, warm_up_s = 0;
    bool stopped = false;  ///< before its end, by the user
    std::vector<SoakCheck> checks;
    std::vector<SoakLoad> loads;
    std::vector<SoakPhase> phases;
    std::vector<SoakColumn> columns;
    double column_s = 1;
    std::vector<SoakMiss> misses;  ///< the first few hundred
    std::uint64_t misses_unlisted = 0;
    std::vector<SoakSample> samples;
    Trend memory;                    ///< of memory_kib over time_s, after the warm-up
    std::int64_t grid_drift_ns = 0;  ///< largest difference of a frame's due time from t0 + slot x period
    std::uint64_t slots_elapsed = 0, slots_run = 0, slots_skipped = 0;  ///< the control's among them
    std::uint64_t records_lost = 0;
    SoakMachine machine;
};

/// "45 seconds", "20 minutes", "2 hours".
std::string duration_words(double seconds);
/// holds: every check does; broken: one is; else not judged.
Judged verdict_of(const SoakSummary& summary);
/// "20 minutes under load: 36 012 frames, 2 missed, none by its own doing."
std::string soak_headline(const SoakSummary& summary);

std::string soak_json(const SoakSummary& summary);
/// For a terminal, at most 100 columns.
std::string soak_table(const SoakSummary& summary, bool colour);
/// DIR/index.html, self-contained, and DIR/soak.json.
Result<void> probe_soak_page(const std::string& dir);
Result<void> write_soak_page(const std::string& dir, const SoakSummary& summary);

}  // namespace surefoot::soak
